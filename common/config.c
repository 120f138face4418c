#include "common/config.h"

#include <ctype.h>
#include <errno.h>
#include <libconfig.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/input_file.h"
#include "common/memory.h"
#include "common/options.h"

struct config {
  config_t tree;
  char *path, *folder, *text;
};

static int line_at(const char *text, const char *place) {
  int line = 1;
  for (; text < place; text++) line += *text == '\n';
  return line;
}

/* Start of an unclosed comment, which libconfig would take for the end of the file, or NULL. */
static const char *open_comment(const char *text) {
  for (const char *c = text; *c; c++) {
    if (*c == '"') {
      for (c++; *c && *c != '"'; c++)
        if (*c == '\\' && c[1]) c++;
    } else if (*c == '#' || (*c == '/' && c[1] == '/')) {
      c += strcspn(c, "\n");
    } else if (*c == '/' && c[1] == '*') {
      const char *end = strstr(c + 2, "*/");
      if (end == NULL) return c;
      c = end + 1;
    }
    if (!*c) break;
  }
  return NULL;
}

/* libconfig compares each setting, "a = 1" or "a : 1", with all earlier ones of its group. */
#define SETTINGS_MAX 20000

static enum status read_text(const char *path, char **text) {
  enum status status = STATUS_OK;
  FILE *file = NULL;
  size_t capacity = 1 << 16, used = 0;
  *text = NULL;
  TRY(input_open(path, &file));
  TRY(memory_allocate(text, capacity, 1, "the scene's text"));
  for (;;) {
    used += fread(*text + used, 1, capacity - used - 1, file);
    if (used < capacity - 1) break;
    capacity *= 2;
    if (capacity > (1 << 24)) TRY_FAIL(STATUS_INPUT, "%s: over 8 MB: no scene file", path);
    TRY(memory_resize(text, capacity, 1, "the scene's text"));
  }
  if (ferror(file)) TRY_FAIL(STATUS_INPUT, "%s: cannot be read (%s)", path, strerror(errno));
  if (used > 8 && memcmp(*text, "\211HDF\r\n\032\n", 8) == 0)
    TRY_FAIL(
        STATUS_INPUT,
        "%s: is an HDF5 file; a scene is text, and names a model in model = { file = \"...\"; }",
        path);
  if (used > 2 && (memcmp(*text, "\377\376", 2) == 0 || memcmp(*text, "\376\377", 2) == 0))
    TRY_FAIL(STATUS_INPUT, "%s: is text in UTF-16; save it as UTF-8", path);
  /* UTF-8 byte order mark that some editors write. */
  if (used > 3 && memcmp(*text, "\357\273\277", 3) == 0) memset(*text, ' ', 3);
  if (memchr(*text, 0, used))
    TRY_FAIL(STATUS_INPUT, "%s:%d: holds zero bytes: no scene file; write it as text", path,
             line_at(*text, *text + strlen(*text)));
  size_t settings = 0;
  for (const char *c = *text; (c = strpbrk(c, "=:")) != NULL; c++) settings++;
  if (settings > SETTINGS_MAX)
    TRY_FAIL(STATUS_INPUT, "%s: %zu settings: no scene file; at most %d are read", path, settings,
             SETTINGS_MAX);
cleanup:
  if (file != NULL) fclose(file);
  if (status != STATUS_OK) memory_free(text);
  return status;
}

/* Follows `path` ("isph.tau", "regions.[1].porosity", "regions[1].porosity", "regions.1.porosity")
 * and creates missing groups. Returns the last group, and the last name in `last`. */
static config_setting_t *walk_path(config_setting_t *root, const char *path, char *last,
                                   size_t last_size) {
  config_setting_t *at = root;
  char word[128];
  while (at != NULL) {
    const bool bracket = *path == '[';
    size_t n = bracket ? strcspn(path, "]") + 1 : strcspn(path, ".[");
    if (n == 0 || n >= sizeof word || n > strlen(path)) return NULL;
    memcpy(word, path, n);
    word[n] = '\0';
    if (path[n] == '\0') {
      snprintf(last, last_size, "%s", word);
      return at;
    }
    path += path[n] == '.' ? n + 1 : n;
    if (bracket || (!config_setting_is_group(at) && isdigit((unsigned char)word[0]))) {
      at = config_setting_get_elem(at, (unsigned)strtoul(word + bracket, NULL, 10));
    } else {
      config_setting_t *child = config_setting_get_member(at, word);
      if (child == NULL) child = config_setting_add(at, word, CONFIG_TYPE_GROUP);
      at = child;
    }
  }
  return NULL;
}

/* Copies a setting with its contents; false if `parent` accepts no setting of this name. */
static bool copy_setting(config_setting_t *parent, const char *name, const config_setting_t *from) {
  int type = config_setting_type(from);
  config_setting_t *to = config_setting_add(parent, name, type);
  if (to == NULL) return false;
  switch (type) {
  case CONFIG_TYPE_INT:
    config_setting_set_int(to, config_setting_get_int(from));
    break;
  case CONFIG_TYPE_INT64:
    config_setting_set_int64(to, config_setting_get_int64(from));
    break;
  case CONFIG_TYPE_FLOAT:
    config_setting_set_float(to, config_setting_get_float(from));
    break;
  case CONFIG_TYPE_STRING:
    config_setting_set_string(to, config_setting_get_string(from));
    break;
  case CONFIG_TYPE_BOOL:
    config_setting_set_bool(to, config_setting_get_bool(from));
    break;
  default:
    for (int i = 0; i < config_setting_length(from); i++) {
      const config_setting_t *item = config_setting_get_elem(from, (unsigned)i);
      if (!copy_setting(to, config_setting_name(item), item)) return false;
    }
  }
  return true;
}

/* Applies "path=value". The value is parsed by libconfig ("0.4", "true", "[1, 2]"); if that fails
 * it is taken as a string. */
static enum status apply_override(struct config *config, const char *text) {
  enum status status = STATUS_OK;
  const char *equals = strchr(text, '=');
  char path[512], name[128];
  if (equals == NULL || equals == text || (size_t)(equals - text) >= sizeof path)
    return FAIL(STATUS_USAGE, "--set %s: write it as path=value, like --set isph.tau='0.05 s'",
                text);
  memcpy(path, text, (size_t)(equals - text));
  path[equals - text] = '\0';
  config_t parsed;
  config_init(&parsed);
  char *source = NULL;
  TRY(memory_allocate(&source, strlen(equals) + 16, 1, "an override"));
  sprintf(source, "value = %s;", equals + 1);
  config_setting_t *value = NULL;
  if (config_read_string(&parsed, source) == CONFIG_TRUE) value = config_lookup(&parsed, "value");
  if (value == NULL) {
    config_destroy(&parsed);
    config_init(&parsed);
    value = config_setting_add(config_root_setting(&parsed), "value", CONFIG_TYPE_STRING);
    config_setting_set_string(value, equals + 1);
  }
  config_setting_t *group = walk_path(config_root_setting(&config->tree), path, name, sizeof name);
  if (group == NULL || config_setting_is_group(group) != CONFIG_TRUE)
    TRY_FAIL(STATUS_USAGE,
             "--set %s: there is no such place in %s; an entry of a list is named by its number "
             "from 0, like fluids[0].viscosity",
             text, config->path);
  config_setting_remove(group, name);
  if (!copy_setting(group, name, value))
    TRY_FAIL(STATUS_USAGE, "--set %s: '%s' cannot be set in %s", text, name, config->path);
cleanup:
  memory_free(&source);
  config_destroy(&parsed);
  return status;
}

enum status config_open(const char *path, const char *const *overrides, size_t n,
                        struct config **result) {
  enum status status = STATUS_OK;
  struct config *config;
  *result = NULL;
  TRY(memory_allocate(&config, 1, sizeof *config, "a scene file"));
  config_init(&config->tree);
  size_t length = strlen(path);
  TRY(memory_allocate(&config->path, length + 1, 1, "a path"));
  memcpy(config->path, path, length);
  TRY(memory_allocate(&config->folder, length + 1, 1, "a path"));
  const char *slash = strrchr(path, '/');
  if (slash != NULL) memcpy(config->folder, path, (size_t)(slash - path) + 1);
  TRY(read_text(path, &config->text));
  config_set_options(&config->tree, CONFIG_OPTION_AUTOCONVERT);
  /* Includes are refused: a scene is a single file and may not read another. */
  const char *include = strstr(config->text, "@include"), *comment = open_comment(config->text);
  if (include != NULL)
    TRY_FAIL(STATUS_INPUT, "%s:%d: @include is not supported; a scene is one file", path,
             line_at(config->text, include));
  if (comment != NULL)
    TRY_FAIL(STATUS_INPUT, "%s:%d: this comment has no end; close it with */", path,
             line_at(config->text, comment));
  if (config_read_string(&config->tree, config->text) != CONFIG_TRUE)
    TRY_FAIL(
        STATUS_INPUT, "%s:%d: %s; %s", path, config_error_line(&config->tree),
        config_error_text(&config->tree),
        strstr(config_error_text(&config->tree), "mismatched") != NULL
            ? "quantities are texts with their unit, like [\"0\", \"-9.8 m/s^2\"], and numbers "
              "all have a point or none"
            : "a setting is written name = value; and a text in quotes");
  size_t used = strlen(config->text);
  for (size_t i = 0; i < n; i++) {
    TRY(apply_override(config, overrides[i]));
    size_t more = strlen(overrides[i]) + 32;
    TRY(memory_resize(&config->text, used + more, 1, "the scene's text"));
    used += (size_t)sprintf(config->text + used, "%s# --set %s\n",
                            used && config->text[used - 1] != '\n' ? "\n" : "", overrides[i]);
  }
  *result = config;
cleanup:
  if (status != STATUS_OK) config_close(config);
  return status;
}

void config_close(struct config *config) {
  if (config == NULL) return;
  config_destroy(&config->tree);
  MEMORY_FREE(&config->path, &config->folder, &config->text, &config);
}

config_node *config_root(struct config *config) {
  return config_root_setting(&config->tree);
}
const char *config_text(const struct config *config) {
  return config->text;
}
const char *config_folder(const struct config *config) {
  return config->folder;
}

config_node *config_child(config_node *parent, const char *name) {
  if (parent == NULL || config_setting_is_group(parent) != CONFIG_TRUE) return NULL;
  return config_setting_get_member(parent, name);
}
const char *config_name(const config_node *node) {
  return config_setting_name(node);
}

config_node *config_item(config_node *list, size_t i) {
  return list == NULL ? NULL : config_setting_get_elem(list, (unsigned)i);
}
size_t config_count(const config_node *node) {
  return node == NULL ? 0 : (size_t)config_setting_length(node);
}
bool config_is_list(const config_node *node) {
  return config_setting_is_list(node) == CONFIG_TRUE ||
         config_setting_is_array(node) == CONFIG_TRUE;
}
bool config_is_group(const config_node *node) {
  return config_setting_is_group(node) == CONFIG_TRUE;
}
bool config_is_text(const config_node *node) {
  return config_setting_type(node) == CONFIG_TYPE_STRING;
}
bool config_is_number(const config_node *node) {
  return config_setting_is_number(node) == CONFIG_TRUE;
}

bool config_boolean_value(const config_node *node) {
  return config_setting_get_bool(node) != 0;
}
const char *config_text_value(const config_node *node) {
  return config_setting_get_string(node);
}
int config_line(const config_node *node) {
  return (int)config_setting_source_line(node);
}

/* "regions[1].porosity" for a setting. */
static void format_path(const config_node *node, char *text, size_t size) {
  const config_node *parent = config_setting_parent(node);
  if (parent == NULL) {
    text[0] = '\0';
    return;
  }
  format_path(parent, text, size);
  size_t used = strlen(text);
  const char *name = config_setting_name(node);
  if (name != NULL)
    snprintf(text + used, size - used, "%s%s", used ? "." : "", name);
  else
    snprintf(text + used, size - used, "[%d]", config_setting_index(node));
}

enum status config_error(const struct config *config, const config_node *node, const char *format,
                         ...) {
  char path[256] = "", message[768];
  if (node != NULL) format_path(node, path, sizeof path);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  unsigned line =
      node != NULL ? config_setting_source_line(node) : 1; /* without a node: the first line */
  char place[32] = "";
  if (line > 0)
    snprintf(place, sizeof place, "%u:", line);
  else if (node != NULL && *path)
    snprintf(place, sizeof place, "(--set)");
  return FAIL(STATUS_INPUT, "%s:%s %s%s%s", config->path, place, path, *path ? ": " : "", message);
}

static enum status parse_quantity(const struct config *config, config_node *node,
                                  struct dimension dimension, double *value) {
  if (config_is_number(node)) {
    double number = config_setting_get_float(node);
    bool plain = dimension.m == 0 && dimension.kg == 0 && dimension.s == 0;
    if (!isfinite(number)) return config_error(config, node, "is not finite");
    if (!plain && number != 0)
      return config_error(config, node, "%g has no unit; write it like \"%s\"", number,
                          dimension_example(dimension));
    *value = number;
    return STATUS_OK;
  }
  if (!config_is_text(node))
    return config_error(config, node, "a quantity is wanted, like \"%s\"",
                        dimension_example(dimension));
  enum status status = quantity_parse(config_setting_get_string(node), dimension, value);
  if (status == STATUS_OK) return STATUS_OK;
  char message[768];
  snprintf(message, sizeof message, "%s", error_message());
  error_clear();
  return config_error(config, node, "%s", message);
}

enum status config_quantity(struct config *config, config_node *group, const char *name,
                            struct dimension dimension, double *value, bool *given) {
  config_node *node = config_child(group, name);
  if (given != NULL) *given = node != NULL;
  return node == NULL ? STATUS_OK : parse_quantity(config, node, dimension, value);
}

enum status config_number(struct config *config, config_node *group, const char *name,
                          double *value, bool *given) {
  return config_quantity(config, group, name, DIM_NONE, value, given);
}

enum status config_bool(struct config *config, config_node *group, const char *name, bool *value,
                        bool *given) {
  config_node *node = config_child(group, name);
  if (given != NULL) *given = node != NULL;
  if (node == NULL) return STATUS_OK;
  if (config_setting_type(node) != CONFIG_TYPE_BOOL)
    return config_error(config, node, "true or false is wanted");
  *value = config_setting_get_bool(node) != 0;
  return STATUS_OK;
}

enum status config_string(struct config *config, config_node *group, const char *name,
                          const char **value, bool *given) {
  config_node *node = config_child(group, name);
  if (given != NULL) *given = node != NULL;
  if (node == NULL) return STATUS_OK;
  if (!config_is_text(node)) return config_error(config, node, "a text in quotes is wanted");
  *value = config_setting_get_string(node);
  return STATUS_OK;
}

enum status config_choice(struct config *config, config_node *group, const char *name,
                          const char *const *choices, int *value, bool *given) {
  config_node *node = config_child(group, name);
  if (given != NULL) *given = node != NULL;
  if (node == NULL) return STATUS_OK;
  const char *text = config_is_text(node) ? config_setting_get_string(node) : NULL;
  char list[256] = "";
  for (int i = 0; choices[i]; i++) {
    if (text != NULL && !strcmp(choices[i], text)) {
      *value = i;
      return STATUS_OK;
    }
    size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s\"%s\"", i ? ", " : "", choices[i]);
  }
  if (text == NULL)
    return config_error(config, node, "a text in quotes is wanted, one of %s", list);
  const char *near = nearest_name(text, choices);
  return config_error(config, node, "\"%s\"%s%s%s is none of %s", text,
                      near ? " (did you mean \"" : "", near ? near : "", near ? "\"?)" : "", list);
}

enum status config_quantities(struct config *config, config_node *group, const char *name,
                              struct dimension dimension, int min, int max, double *values,
                              int *count, bool *given) {
  config_node *node = config_child(group, name);
  if (given != NULL) *given = node != NULL;
  if (node == NULL) return STATUS_OK;
  int n = config_is_list(node) ? config_setting_length(node) : 0;
  if (n < min || n > max || !config_is_list(node)) {
    char range[32];
    if (min == max)
      snprintf(range, sizeof range, "%d", min);
    else
      snprintf(range, sizeof range, "%d to %d", min, max);
    const struct dimension none = DIM_NONE;
    if (memcmp(&dimension, &none, sizeof none) == 0)
      return config_error(config, node, "a list of %s numbers is wanted, like [1.0, ...]", range);
    return config_error(config, node, "a list of %s quantities is wanted, like [\"%s\", ...]",
                        range, dimension_example(dimension));
  }
  for (int i = 0; i < n; i++) {
    enum status status =
        parse_quantity(config, config_setting_get_elem(node, (unsigned)i), dimension, &values[i]);
    if (status != STATUS_OK) return status;
  }
  if (count != NULL) *count = n;
  return STATUS_OK;
}

enum status config_auto_quantity(struct config *config, config_node *group, const char *name,
                                 struct dimension dimension, double *value, bool *automatic,
                                 bool *given) {
  config_node *node = config_child(group, name);
  if (given != NULL) *given = node != NULL;
  *automatic = node == NULL;
  if (node == NULL) return STATUS_OK;
  *automatic = config_is_text(node) && !strcmp(config_setting_get_string(node), "auto");
  return *automatic ? STATUS_OK : parse_quantity(config, node, dimension, value);
}
