/* Every wrong scene of bad_scenes.txt ends sphsolve with exit code 3 and one line that names the
 * file, the line and what to do. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/image_file.h"
#include "common/model_file.h"

int sphsolve_main(int argc, char **argv);
#define main sphsolve_main
#include "sphsolve/sphsolve.c"
#undef main

enum { LINES_MAX = 16, TEXT_MAX = 1024 };

struct pair {
  char name[48], text[TEXT_MAX];
};
struct base {
  char name[32], line[LINES_MAX][TEXT_MAX];
  int lines;
};

static struct pair lets[48];
static struct base bases[16];
static int let_count, base_count;
static char folder[] = "/tmp/tosui-scenes-XXXXXX";

static void write_model(const char *name, int solid) {
  enum { N = 8 };
  uint8_t sites[N * N * N];
  struct voxel_model model = {.size = {N, N, N},
                              .spacing = {1e-5, 1e-5, 1e-5},
                              .periodic = {true, true, true},
                              .mirror_plane = -1,
                              .solid = sites};
  struct h5_file *file;
  char path[128];
  for (int i = 0; i < N * N * N; i++) sites[i] = (uint8_t)(solid || i % N < 3);
  snprintf(path, sizeof path, "%s/%s", folder, name);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(model_write(file, &model), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
}

/* What a run leaves of a slit, as far as a solute needs it; `soil`: with pores below the voxel. */
static void write_flow(const char *name, const char *method, bool soil) {
  enum { N = 8 };
  static float distance[N][N][N], velocity[N][N][N][3];
  const double spacing[3] = {1e-5, 1e-5, 1e-5};
  const size_t size[3] = {N, N, N}, shape[4] = {N, N, N, 3};
  struct h5_file *file;
  char path[128];
  for (int i = 0; i < N; i++)
    for (int at = 0; at < N * N; at++) {
      distance[at / N][at % N][i] = (float)(1e-5 * (i < 4 ? i - 0.5 : 6.5 - i));
      velocity[at / N][at % N][i][2] = i > 0 && i < 7 ? 1e-3f : 0;
    }
  snprintf(path, sizeof path, "%s/%s.hdf", folder, name);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_make_group(file, "/run"), STATUS_OK);
  assert_int_equal(h5_write_attribute_text(file, "/run", "method", method), STATUS_OK);
  if (soil) assert_int_equal(h5_make_group(file, "/run/micro"), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  snprintf(path, sizeof path, "%s/%s-image.hdf", folder, name);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(image_file_begin(file, size, spacing, spacing), STATUS_OK);
  assert_int_equal(
      h5_write(file, "/VTKHDF/PointData/wall_distance", H5_F32, 3, size, distance, false),
      STATUS_OK);
  assert_int_equal(h5_write(file, "/VTKHDF/PointData/velocity", H5_F32, 4, shape, velocity, false),
                   STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
}

static void add_let(const char *name, const char *text) {
  snprintf(lets[let_count].name, sizeof lets->name, "{%s}", name);
  snprintf(lets[let_count++].text, TEXT_MAX, "%s", text);
}

/* Puts the text of each `let` in its place. */
static void expand(const char *text, char out[TEXT_MAX]) {
  char work[TEXT_MAX];
  snprintf(out, TEXT_MAX, "%s", text);
  for (int i = 0; i < let_count; i++)
    for (char *at; (at = strstr(out, lets[i].name)) != NULL;) {
      snprintf(work, sizeof work, "%.*s%s%s", (int)(at - out), out, lets[i].text,
               at + strlen(lets[i].name));
      memcpy(out, work, TEXT_MAX);
    }
}

static const struct base *find_base(const char *name) {
  for (int i = 0; i < base_count; i++)
    if (!strcmp(bases[i].name, name)) return &bases[i];
  fail_msg("bad_scenes.txt: no base '%s'", name);
  return NULL;
}

/* Runs `sphsolve explain` on the base with a line replaced (0: none); stderr into `said`. */
static int explain_with(const struct base *base, int line, const char *text, const char *path,
                        char *said, size_t size) {
  FILE *file = fopen(path, "w");
  for (int i = 1; i <= base->lines; i++) {
    char out[TEXT_MAX];
    expand(i == line ? text : base->line[i - 1], out);
    fprintf(file, "%s\n", out);
  }
  fclose(file);
  char *argv[] = {(char[]){"sphsolve"}, (char[]){"explain"}, (char *)(uintptr_t)path, NULL};
  fflush(NULL);
  int streams[2] = {dup(1), dup(2)};
  char errors[160];
  snprintf(errors, sizeof errors, "%s/stderr", folder);
  assert_non_null(freopen("/dev/null", "w", stdout));
  assert_non_null(freopen(errors, "w", stderr));
  int code = sphsolve_main(3, argv);
  fflush(NULL);
  dup2(streams[0], 1);
  dup2(streams[1], 2);
  close(streams[0]);
  close(streams[1]);
  error_clear();
  file = fopen(errors, "r");
  said[fread(said, 1, size - 1, file)] = '\0';
  fclose(file);
  return code;
}

/* "" when the message is as it must be, else what is wrong with it. */
static const char *judge(int code, const char *said, const char *path, int line, const char *says) {
  char place[160];
  if (code != STATUS_INPUT) return "the exit code is not 3";
  const char *end = strchr(said, '\n');
  if (end == NULL || end[1] != '\0') return "not one line";
  snprintf(place, sizeof place, "sphsolve: %s:%d: ", path, line);
  if (strncmp(said, place, strlen(place))) return "does not begin with file and line";
  if (strstr(said, says) == NULL) return "does not say what it must";
  return "";
}

/* BASE LINE | text | says [= line]; returns 1 when it fails. */
static int try_case(char *text, int number) {
  char name[32], said[4096], path[128], *bar = strchr(text, '|'), *second = strrchr(text, '|');
  int line, reported;
  if (bar == NULL || second == bar || sscanf(text, "%31s %d", name, &line) != 2)
    fail_msg("bad_scenes.txt:%d: not a case: %s", number, text);
  *second = '\0';
  char *says = second + 1 + strspn(second + 1, " "), *with = bar + 1 + strspn(bar + 1, " ");
  char *other = strstr(says, " = ");
  reported = line;
  if (other != NULL) {
    reported = atoi(other + 3);
    *other = '\0';
  }
  snprintf(path, sizeof path, "%s/scene.cfg", folder);
  int code = explain_with(find_base(name), line, with, path, said, sizeof said);
  const char *wrong = judge(code, said, path, reported, says);
  if (!*wrong) return 0;
  print_error("bad_scenes.txt:%d: %s (exit code %d, '%s' wanted)\n  %s\n  -> %s\n", number, wrong,
              code, says, with, said);
  return 1;
}

static void test_bad_scenes(void **state) {
  (void)state;
  char text[TEXT_MAX], said[4096], path[128];
  int number = 0, cases = 0, failed = 0;
  struct base *open = NULL;
  FILE *file = fopen("tests/unit/bad_scenes.txt", "r");
  assert_non_null(file);
  while (fgets(text, sizeof text, file) != NULL) {
    number++;
    text[strcspn(text, "\n")] = '\0';
    char name[32];
    if (open != NULL) {
      if (!strcmp(text, "end"))
        open = NULL;
      else
        snprintf(open->line[open->lines++], TEXT_MAX, "%s", text);
    } else if (sscanf(text, "let %31s", name) == 1) {
      add_let(name, text + 5 + strlen(name));
    } else if (sscanf(text, "base %31s", name) == 1) {
      open = &bases[base_count++];
      snprintf(open->name, sizeof open->name, "%s", name);
    } else if (*text != '\0' && *text != '#') {
      cases++;
      failed += try_case(text, number);
    }
  }
  fclose(file);
  snprintf(path, sizeof path, "%s/scene.cfg", folder);
  for (int i = 0; i < base_count; i++)
    if (explain_with(&bases[i], 0, "", path, said, sizeof said) != STATUS_OK)
      fail_msg("base %s: %s", bases[i].name, said);
  print_message("# %d wrong scenes, %d not told as they must be\n", cases, failed);
  assert_true(cases >= 200);
  assert_int_equal(failed, 0);
}

static int make_folder(void **state) {
  (void)state;
  char path[128], command[160];
  setenv("OMP_WAIT_POLICY", "passive", 1); /* or main would start the test anew */
  if (mkdtemp(folder) == NULL) return 1;
  write_model("model.hdf", 0);
  write_model("dry.hdf", 1);
  write_flow("flow", "stokes", false);
  write_flow("particles", "wcsph", false);
  write_flow("soil", "stokes", true);
  snprintf(command, sizeof command, "echo no HDF5 > %s/text.hdf", folder);
  if (system(command) != 0) return 1;
  snprintf(path, sizeof path, "%s/model.hdf", folder);
  add_let("MODEL", path);
  snprintf(path, sizeof path, "%s/dry.hdf", folder);
  add_let("DRY", path);
  snprintf(path, sizeof path, "%s/flow.hdf", folder);
  add_let("FLOW", path);
  snprintf(path, sizeof path, "%s/particles.hdf", folder);
  add_let("PARTICLES", path);
  snprintf(path, sizeof path, "%s/soil.hdf", folder);
  add_let("SOILFLOW", path);
  snprintf(path, sizeof path, "%s/text.hdf", folder);
  add_let("TEXT", path);
  return 0;
}

static int remove_folder(void **state) {
  (void)state;
  char command[160];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_bad_scenes)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
