#include "sphsolve/scene/keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/options.h"
#include "common/units.h"

static const char *const eos_names[] = {"gauge", "absolute", NULL};
static const char *const isph_kernel_names[] = {"quintic", "cubic", NULL};
static const char *const form_names[] = {"akbari", "m15", NULL};
static const char *const switch_names[] = {"auto", "on", "off", NULL};
static const char *const solver_names[] = {"grid", "petsc", NULL};
static const char *const porosity_names[] = {"clamp", "m15", NULL};

/* Exponents of metre, kilogram, second. */
#define PLAIN 0, 0, 0
#define METRE 1, 0, 0
#define PER_METRE -1, 0, 0
#define SECOND 0, 0, 1
#define VELOCITY 1, 0, -1
#define ACCELERATION 1, 0, -2
#define DENSITY -3, 1, 0
#define VISCOSITY -1, 1, -1
#define TENSION 0, 1, -2
#define PRESSURE_GRADIENT -2, 1, -2
#define DIFFUSION 2, 0, -1

#define GROUP .kind = KEY_GROUP
#define LIST .kind = KEY_LIST
#define TEXT .kind = KEY_TEXT
#define BOOL .kind = KEY_BOOL
#define CHOICE(names) .kind = KEY_CHOICE, .choices = names
#define NUMBER(...) .kind = KEY_NUMBER, .dimension = {__VA_ARGS__}
#define AUTO(...) .kind = KEY_NUMBER, .or_auto = true, .dimension = {__VA_ARGS__}
#define VECTOR(...) .kind = KEY_VECTOR, .dimension = {__VA_ARGS__}
#define FORM_OF(m_, kg_, s_, words) .kind = KEY_FORM, .dimension = {m_, kg_, s_}, .form = words
#define FORM(...) FORM_OF(__VA_ARGS__)

#define ANY .low = 1, .high = 0
#define FROM(a) .low = a, .high = INFINITY
#define ABOVE(a) .low = a, .above = true, .high = INFINITY
#define FROM_TO(a, b) .low = a, .high = b
#define FROM_TO_BELOW(a, b) .low = a, .high = b, .below = true
#define ABOVE_TO(a, b) .low = a, .above = true, .high = b
#define ABOVE_TO_BELOW(a, b) .low = a, .above = true, .high = b, .below = true

#define PRESET(value) .preset = value
#define SAYS(words) .told = words
#define NO_DEFAULT(value, words) .preset = value, .told = words
#define OPTIONAL .told = ""
#define OPTIONAL_AS(value) .preset = value, .told = ""
#define REQUIRED(example) .needs = example
#define REQUIRED_BESIDE .preset = NAN, .told = "required"

#define INTO(type, member)                                                                         \
  .stored = true, .offset = offsetof(struct type, member),                                         \
  .size = sizeof(((struct type *)0)->member)
#define NOWHERE .stored = false
#define SCENE(member) INTO(scene, member)
#define REGION(member) INTO(region, member)
#define GAUGE(member) INTO(gauge, member)
#define HINT(words) , .hint = words
#define WITH(key) .with = key
#define WATER (1u << REGION_WATER)
#define POROUS (1u << REGION_POROUS)
#define WALL (1u << REGION_WALL)
#define INFLOW (1u << REGION_INFLOW)
#define WELL (1u << REGION_WELL)
#define DRAIN (1u << REGION_DRAIN)
#define RAIN (1u << REGION_RAIN)
#define IN_REGIONS(set) .types = set,

#define KEY(group_, name_, value, range, missing, owner_, target, text_)                           \
  {.group = group_, .name = name_, .owner = owner_, .text = text_, value, range, missing, target},
static const struct scene_key keys[] = {
#include "sphsolve/scene/keys.def"
};
enum { KEY_COUNT = sizeof keys / sizeof *keys, KEY_PATH = 128 };

const struct scene_key *keys_all(size_t *count) {
  *count = KEY_COUNT;
  return keys;
}

/* Whether a key stands in a group of this path; `types`: bit of the region's type, 0 for any. */
static bool stands_in(const struct scene_key *key, const char *path, unsigned types) {
  return !strcmp(key->group, path) && (types == 0 || key->types == 0 || (key->types & types) != 0);
}

static const struct scene_key *find_key(const char *path, const char *name) {
  for (size_t i = 0; i < KEY_COUNT; i++)
    if (!strcmp(keys[i].name, name) && !strcmp(keys[i].group, path)) return &keys[i];
  return NULL;
}

void keys_range(const struct scene_key *key, char *text, size_t size) {
  if (key->low > key->high)
    snprintf(text, size, "%s", "");
  else if (isinf(key->high))
    snprintf(text, size, key->above ? "above %g" : "%g or more", key->low);
  else
    snprintf(text, size, "%s %g to %s%g", key->above ? "above" : "from", key->low,
             key->below ? "below " : "", key->high);
}

static enum status check_range(const struct config *config, const config_node *node,
                               const struct scene_key *key, double value) {
  const bool plain = key->dimension.m == 0 && key->dimension.kg == 0 && key->dimension.s == 0;
  char range[80];
  if (key->low > key->high || ((key->above ? value > key->low : value >= key->low) &&
                               (key->below ? value < key->high : value <= key->high)))
    return STATUS_OK;
  keys_range(key, range, sizeof range);
  const char *more = key->hint != NULL ? "; " : "", *hint = key->hint != NULL ? key->hint : "";
  if (!(isinf(key->high) && key->low == 0))
    return config_error(config, node, "%s is possible%s%s", range, more, hint);
  if (!key->above) return config_error(config, node, "must not be negative%s%s", more, hint);
  return config_error(config, node,
                      plain ? "must be greater than 0%s%s%s%s"
                            : "must be greater than 0, like \"%s\"%s%s%s",
                      plain ? "" : dimension_example(key->dimension), more, hint, "");
}

static enum status read_number(struct config *config, config_node *group,
                               const struct scene_key *key, double *value) {
  enum status status = STATUS_OK;
  bool automatic = false, given;
  TRY(key->or_auto ? config_auto_quantity(config, group, key->name, key->dimension, value,
                                          &automatic, &given)
                   : config_quantity(config, group, key->name, key->dimension, value, &given));
  if (given && !automatic) TRY(check_range(config, config_child(group, key->name), key, *value));
cleanup:
  return status;
}

enum status keys_read_number(struct config *config, config_node *group, const char *path,
                             const char *name, double *value) {
  return read_number(config, group, find_key(path, name), value);
}

void keys_spread(const struct scene *scene, int count, double vector[3]) {
  if (scene->dimensions == 2 && count == 2) {
    vector[2] = vector[1];
    vector[1] = 0;
  }
}

enum status keys_read_vector(struct config *config, config_node *group, const char *name,
                             const struct scene *scene, struct dimension dimension,
                             double vector[3]) {
  int count = 3;
  bool given;
  int least = scene->dimensions == 2 ? 2 : 3;
  enum status status =
      config_quantities(config, group, name, dimension, least, 3, vector, &count, &given);
  if (status == STATUS_OK && given) {
    keys_spread(scene, count, vector);
    if (scene->dimensions == 2 && vector[1] != 0)
      return config_error(config, config_child(group, name),
                          "a 2-D scene lives in x and z: the y component must be 0");
  }
  return status;
}

/* A choice is an enum or, of two, a bool. */
static void store_choice(const struct scene_key *key, void *member, int choice) {
  if (key->size == sizeof(bool))
    *(bool *)member = choice != 0;
  else
    *(unsigned *)member = (unsigned)choice;
}

static enum status read_key(struct config *config, config_node *group, const struct scene_key *key,
                            const struct scene *scene, void *member) {
  enum status status = STATUS_OK;
  const char *text = key->told;
  int choice;
  switch (key->kind) {
  case KEY_NUMBER:
    *(double *)member = key->preset;
    TRY(read_number(config, group, key, member));
    break;
  case KEY_VECTOR:
    TRY(keys_read_vector(config, group, key->name, scene, key->dimension, member));
    break;
  case KEY_BOOL:
    *(bool *)member = key->preset > 0;
    TRY(config_bool(config, group, key->name, member, NULL));
    break;
  case KEY_CHOICE:
    choice = (int)key->preset;
    TRY(config_choice(config, group, key->name, key->choices, &choice, NULL));
    store_choice(key, member, choice);
    break;
  case KEY_TEXT:
    TRY(config_string(config, group, key->name, &text, NULL));
    snprintf(member, key->size, "%s", text);
    break;
  case KEY_GROUP:
  case KEY_LIST:
  case KEY_FORM:
    break; /* read by the file of their kind */
  }
cleanup:
  return status;
}

enum status keys_read(struct config *config, config_node *group, const char *path, unsigned types,
                      const struct scene *scene, void *target) {
  enum status status = STATUS_OK;
  for (const struct scene_key *key = keys; key < keys + KEY_COUNT; key++) {
    if (!key->stored || !stands_in(key, path, types)) continue;
    if (key->needs != NULL && config_child(group, key->name) == NULL)
      TRY(config_error(config, group, "%s is missing, like %s = %s", key->name, key->name,
                       key->needs));
    TRY(read_key(config, group, key, scene, (char *)target + key->offset));
  }
cleanup:
  return status;
}

/* The type of a region as a bit; 0 where it has none. */
static unsigned type_of(config_node *region) {
  config_node *type = config_child(region, "type");
  for (unsigned i = 0; type != NULL && config_is_text(type) && region_type_names[i] != NULL; i++)
    if (!strcmp(region_type_names[i], config_text_value(type))) return 1u << i;
  return 0;
}

static enum status refuse_unknown(const struct config *config, config_node *child, const char *path,
                                  unsigned types, bool misspelt_only) {
  const char *names[KEY_COUNT + 1];
  size_t n = 0;
  char list[400] = "";
  for (size_t i = 0; i < KEY_COUNT; i++)
    if (stands_in(&keys[i], path, types)) names[n++] = keys[i].name;
  names[n] = NULL;
  const char *near = nearest_name(config_name(child), names);
  if (near != NULL) return config_error(config, child, "unknown key; did you mean '%s'?", near);
  if (misspelt_only) return STATUS_OK;
  for (size_t k = 0, used = 0; k < n; k++, used = strlen(list))
    snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", names[k]);
  return config_error(config, child, "unknown key; known here: %s", list);
}

/* A group or list where the table wants one; the message shows the first keys of the group. */
static enum status check_kind(const struct config *config, config_node *node,
                              const struct scene_key *key) {
  char path[KEY_PATH], like[120] = "";
  if (key->kind == KEY_LIST && !config_is_list(node))
    return config_error(config, node, "a list is wanted, like %s = ( { ... }, { ... } );",
                        key->name);
  if (key->kind != KEY_GROUP || config_is_group(node)) return STATUS_OK;
  snprintf(path, sizeof path, "%s%s%s", key->group, *key->group ? "." : "", key->name);
  size_t shown = 0;
  for (size_t i = 0; i < KEY_COUNT && shown < 4; i++)
    if (stands_in(&keys[i], path, 0)) {
      const size_t used = strlen(like);
      snprintf(like + used, sizeof like - used, "%s = ...; ", keys[i].name);
      shown++;
    }
  return config_error(config, node, "a group is wanted, like %s = { %s};", key->name, like);
}

/* Whether one of the keys "one other" stands in a group. */
static bool has_one_of(config_node *group, const char *names) {
  char name[64];
  for (const char *at = names; *at; at += strspn(at, " ")) {
    const size_t n = strcspn(at, " ");
    snprintf(name, sizeof name, "%.*s", (int)n, at);
    if (config_child(group, name) != NULL) return true;
    at += n;
  }
  return false;
}

static enum status check_group(struct config *config, config_node *group, const char *path,
                               bool misspelt_only) {
  enum status status = STATUS_OK;
  const unsigned types = !strcmp(path, "regions[]") ? type_of(group) : 0;
  char inner[KEY_PATH];
  for (size_t i = 0; i < config_count(group); i++) {
    config_node *child = config_item(group, i);
    const struct scene_key *key = find_key(path, config_name(child));
    if (key == NULL || !stands_in(key, path, types)) {
      TRY(refuse_unknown(config, child, path, types, misspelt_only));
      continue;
    }
    TRY(check_kind(config, child, key));
    if (!misspelt_only && key->with != NULL && !has_one_of(group, key->with))
      TRY(config_error(config, child, "counts only beside %s; leave it out",
                       !strcmp(key->with, "corners centre") ? "corners or centre" : key->with));
    if (key->kind != KEY_GROUP && key->kind != KEY_LIST) continue;
    snprintf(inner, sizeof inner, "%s%s%s%s", path, *path ? "." : "", key->name,
             key->kind == KEY_LIST ? "[]" : "");
    if (key->kind == KEY_GROUP) TRY(check_group(config, child, inner, misspelt_only));
    for (size_t k = 0; key->kind == KEY_LIST && k < config_count(child); k++)
      if (config_is_group(config_item(child, k)))
        TRY(check_group(config, config_item(child, k), inner, misspelt_only));
  }
cleanup:
  return status;
}

enum status keys_check_names(struct config *config, bool misspelt_only) {
  return check_group(config, config_root(config), "", misspelt_only);
}
