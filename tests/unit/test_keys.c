/* The table of keys of a scene: each is read, belongs to something, and stands on the page. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/error.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/keys_print.h"
#include "sphsolve/scene/scene_read.h"

static char path[] = "/tmp/tosui-keys-XXXXXX";

/* A type of region that has the key. */
static const char *type_with(const struct scene_key *key) {
  for (unsigned i = 0; region_type_names[i] != NULL; i++)
    if (key->types == 0 || (key->types & 1u << i)) return region_type_names[i];
  return NULL;
}

/* Writes a scene with all that the key may need beside it, but not the key itself. */
static void write_scene(const struct scene_key *key) {
  const bool solute = !strcmp(key->owner, "solute"), model = !strcmp(key->group, "micro");
  const bool soil = strstr(key->group, "regions[].") != NULL;
  const char *needs = key->with != NULL ? key->with : "";
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  if (solute) {
    fprintf(file, "scene = { };\nflow = { file = \"%s\"; };\nsolute = { };\n", path);
    fclose(file);
    return;
  }
  fprintf(file, "scene = { end_time = \"1 s\"; };\n");
  if (model || !strcmp(key->group, "model") || !strcmp(key->group, "lattice"))
    fprintf(file, "model = { file = \"%s\"; };\n", path);
  else
    fprintf(file, "domain = { size = [\"1 m\", \"1 m\", \"1 m\"]; spacing = \"10 cm\"; };\n");
  fprintf(file, "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n"
                "force = { gravity = [\"0\", \"0\", \"-9.8 m/s^2\"]; };\n"
                "gauges = ( { at = [\"0\", \"0\", \"0\"]; } );\nplanes = ( { } );\n");
  if (!model)
    fprintf(file, "regions = ( { type = \"%s\"; %s %s } );\n", soil ? "porous" : type_with(key),
            strstr(needs, "centre")     ? "centre = [\"0.5 m\", \"0.5 m\"]; radius = \"0.2 m\";"
            : !strcmp(needs, "stl")     ? "stl = \"none.stl\";"
            : !strcmp(key->name, "stl") ? "stl_unit = \"1 mm\";"
            : !strcmp(key->name, "corners") || !strcmp(key->name, "centre")
                ? ""
                : "box = [\"0\", \"0\", \"0\", \"1 m\", \"1 m\", \"1 m\"];",
            soil || (key->types & 1u << REGION_POROUS) ? "porosity = 0.4; grain_size = \"1 mm\";"
                                                       : "");
  fclose(file);
}

/* A key that nothing reads could be given in vain: each one refuses a group for its value. */
static void test_every_key_is_read(void **state) {
  (void)state;
  size_t count;
  const struct scene_key *keys = keys_all(&count);
  for (const struct scene_key *key = keys; key < keys + count; key++) {
    char name[160] = "", set[200];
    struct scene scene;
    if (key->kind == KEY_GROUP || key->kind == KEY_LIST) continue;
    for (const char *c = key->group; *c; c++) /* regions[] -> regions[0] */
      snprintf(name + strlen(name), sizeof name - strlen(name), *c == ']' ? "0]" : "%c", *c);
    snprintf(name + strlen(name), sizeof name - strlen(name), ".%s", key->name);
    snprintf(set, sizeof set, "%s={zzqq=1;}", name);
    const char *overrides[] = {set};
    write_scene(key);
    if (scene_read(path, overrides, 1, &scene) == STATUS_OK) fail_msg("%s is not read", name);
    if (strstr(error_message(), name) == NULL) fail_msg("%s: %s", name, error_message());
    error_clear();
  }
}

static bool is_owner(const char *name, size_t length) {
  if (length == 5 && !strncmp(name, "scene", 5)) return true;
  for (size_t m = 0; methods_all[m] != NULL; m++) {
    if (strlen(methods_all[m]->name) == length && !strncmp(methods_all[m]->name, name, length))
      return true;
    for (size_t i = 0; methods_all[m]->effects[i] != NULL; i++)
      if (strlen(methods_all[m]->effects[i]->name) == length &&
          !strncmp(methods_all[m]->effects[i]->name, name, length))
        return true;
  }
  return false;
}

static void test_owners_exist(void **state) {
  (void)state;
  size_t count;
  const struct scene_key *keys = keys_all(&count);
  for (const struct scene_key *key = keys; key < keys + count; key++) {
    for (const char *at = key->owner; *at; at += strspn(at, ", ")) {
      const size_t length = strcspn(at, ",");
      if (!is_owner(at, length)) fail_msg("%s.%s: no %.*s", key->group, key->name, (int)length, at);
      at += length;
    }
    for (const struct scene_key *other = keys; other < key; other++)
      if (!strcmp(other->group, key->group) && !strcmp(other->name, key->name))
        fail_msg("%s.%s stands twice", key->group, key->name);
  }
}

/* docs/reference/scene.md is what `sphsolve keys --markdown` prints. */
static void test_page_is_the_table(void **state) {
  (void)state;
  char *made = NULL, *kept = NULL;
  size_t size = 0, kept_size = 0;
  FILE *stream = open_memstream(&made, &size);
  keys_print_markdown(stream);
  fclose(stream);
  FILE *file = fopen("docs/reference/scene.md", "rb"), *copy = open_memstream(&kept, &kept_size);
  assert_non_null(file);
  for (int c; (c = fgetc(file)) != EOF;) fputc(c, copy);
  fclose(copy);
  fclose(file);
  if (strcmp(made, kept) != 0)
    fail_msg("run: build/bin/sphsolve keys --markdown > docs/reference/scene.md");
  free(made);
  free(kept);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_key_is_read),
                                     cmocka_unit_test(test_owners_exist),
                                     cmocka_unit_test(test_page_is_the_table)};
  const int handle = mkstemp(path);
  if (handle < 0) return 1;
  close(handle);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(path);
  return failed;
}
