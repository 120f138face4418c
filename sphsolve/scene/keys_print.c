#include "sphsolve/scene/keys_print.h"

#include <ctype.h>
#include <jansson.h>
#include <string.h>

#include "sphsolve/scene/keys.h"

enum { WORDS = 200, PAGE_WIDTH = 119 };

/* What a key takes: "m/s, above 0", "auto, on, off", "list of 4 or 6, m". */
static void format_value(const struct scene_key *key, char *text, size_t size) {
  const bool plain = key->dimension.m == 0 && key->dimension.kg == 0 && key->dimension.s == 0;
  char unit[32] = "", range[80];
  size_t used;
  if (!plain) dimension_format(key->dimension, unit, sizeof unit);
  keys_range(key, range, sizeof range);
  switch (key->kind) {
  case KEY_GROUP:
    snprintf(text, size, "{ ... }");
    return;
  case KEY_LIST:
    snprintf(text, size, "( { ... }, ... )");
    return;
  case KEY_TEXT:
    snprintf(text, size, "text");
    return;
  case KEY_BOOL:
    snprintf(text, size, "true, false");
    return;
  case KEY_CHOICE:
    *text = '\0';
    for (size_t i = 0; key->choices[i] != NULL; i++) {
      used = strlen(text);
      snprintf(text + used, size - used, "%s\"%s\"", used ? ", " : "", key->choices[i]);
    }
    return;
  case KEY_NUMBER:
    snprintf(text, size, "%s%s", key->or_auto ? "\"auto\" or " : "", plain ? "number" : unit);
    break;
  case KEY_VECTOR:
    snprintf(text, size, "one for each axis%s%s", plain ? "" : ", ", unit);
    break;
  case KEY_FORM:
    snprintf(text, size, "%s%s%s", key->form, plain ? "" : ", ", unit);
    break;
  }
  used = strlen(text);
  if (*range) snprintf(text + used, size - used, ", %s", range);
}

static void format_default(const struct scene_key *key, char *text, size_t size) {
  if (key->needs != NULL)
    snprintf(text, size, "required");
  else if (key->told != NULL)
    snprintf(text, size, "%s", key->told);
  else if (key->kind == KEY_CHOICE)
    snprintf(text, size, "%s", key->choices[(size_t)key->preset]);
  else if (key->kind == KEY_BOOL)
    snprintf(text, size, "%s", key->preset > 0 ? "true" : "false");
  else
    snprintf(text, size, "%g", key->preset);
}

/* The types of region that have the key, "wall, water"; "" for all. */
static void format_types(const struct scene_key *key, char *text, size_t size) {
  *text = '\0';
  for (unsigned i = 0; region_type_names[i] != NULL; i++)
    if (key->types & 1u << i) {
      const size_t used = strlen(text);
      snprintf(text + used, size - used, "%s%s", used ? ", " : "", region_type_names[i]);
    }
}

void keys_print(FILE *stream) {
  size_t count;
  const struct scene_key *keys = keys_all(&count);
  char value[WORDS], preset[WORDS], types[WORDS];
  for (const struct scene_key *key = keys; key < keys + count; key++) {
    format_value(key, value, sizeof value);
    format_default(key, preset, sizeof preset);
    format_types(key, types, sizeof types);
    fprintf(stream, "%s%s%s%s: %s%s%s\n", *key->group ? "" : "\n", key->group,
            *key->group ? "." : "", key->name, value, *preset ? "; default " : "", preset);
    fprintf(stream, "    %s%s%s%s\n", *types ? "(" : "", types, *types ? ") " : "", key->text);
  }
}

/* Writes words, broken into lines of at most PAGE_WIDTH characters with `indent` spaces before all
 * but the first. */
static void put_wrapped(FILE *stream, const char *text, int indent) {
  int column = 0;
  for (const char *at = text; *at; at += strspn(at, " ")) {
    const int length = (int)strcspn(at, " ");
    if (column > 0 && column + 1 + length > PAGE_WIDTH)
      column = fprintf(stream, "\n%*s", indent, "") - 1;
    else if (column > 0)
      fputc(' ', stream), column++;
    column += fprintf(stream, "%.*s", length, at);
    at += length;
  }
  fputc('\n', stream);
}

static const char page_head[] =
    "A scene is one text file of groups (`wcsph = { ... };`) and lists of groups (`regions = ( { "
    "... "
    "}, { ... } );`). Quantities are texts with their unit, `\"1e-3 Pa s\"`; any unit of that "
    "dimension is possible, and `\"0\"` needs none. `--set PATH=VALUE` overrides a key of one run: "
    "`--set 'regions[1].porosity=0.4'`. A key that is not on this page is an error, which names "
    "the "
    "nearest one.";
static const char page_columns[] =
    "Each key with what it takes, its default (*required*: none), the regions that have it, and in "
    "italics the method or effect that it belongs to ([physics](../physics/index.md)). This page "
    "is "
    "the output of `sphsolve keys --markdown`; `sphsolve keys` prints it for a terminal, `sphsolve "
    "keys --json` for programs.";

/* One group: its heading, its sentence and its keys. */
static void print_group(FILE *stream, const struct scene_key *group, const char *path) {
  size_t count;
  const struct scene_key *keys = keys_all(&count);
  char value[WORDS], preset[WORDS], types[WORDS], line[5 * WORDS];
  fprintf(stream, "\n## %s\n", path);
  snprintf(line, sizeof line, "%c%s%s.", toupper((unsigned char)*group->text), group->text + 1,
           group->needs != NULL ? " (required)" : "");
  put_wrapped(stream, line, 0);
  for (const struct scene_key *key = keys; key < keys + count; key++) {
    if (strcmp(key->group, path) != 0) continue;
    format_value(key, value, sizeof value);
    format_default(key, preset, sizeof preset);
    format_types(key, types, sizeof types);
    const bool scene = !strcmp(key->owner, "scene"), required = !strcmp(preset, "required");
    snprintf(line, sizeof line, "- `%s` (%s%s%s%s%s%s%s%s%s): %s", key->name, value,
             *preset ? "; " : "",
             required  ? ""
             : *preset ? "default "
                       : "",
             required ? "*required*" : preset, *types ? "; in " : "", types, scene ? "" : "; *",
             scene ? "" : key->owner, scene ? "" : "*", key->text);
    put_wrapped(stream, line, 2);
  }
}

void keys_print_markdown(FILE *stream) {
  size_t count;
  const struct scene_key *keys = keys_all(&count);
  fputs("# The scene file\n\n", stream);
  put_wrapped(stream, page_head, 0);
  fputc('\n', stream);
  put_wrapped(stream, page_columns, 0);
  for (const struct scene_key *key = keys; key < keys + count; key++) {
    char path[WORDS];
    if (key->kind != KEY_GROUP && key->kind != KEY_LIST) continue;
    snprintf(path, sizeof path, "%s%s%s%s", key->group, *key->group ? "." : "", key->name,
             key->kind == KEY_LIST ? "[]" : "");
    print_group(stream, key, path);
  }
}

enum status keys_print_json(void) {
  size_t count;
  const struct scene_key *keys = keys_all(&count);
  json_t *list = json_array();
  for (const struct scene_key *key = keys; key < keys + count; key++) {
    char value[WORDS], preset[WORDS], types[WORDS];
    format_value(key, value, sizeof value);
    format_default(key, preset, sizeof preset);
    format_types(key, types, sizeof types);
    json_array_append_new(list,
                          json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s}", "group", key->group,
                                    "key", key->name, "value", value, "default", preset, "regions",
                                    types, "of", key->owner, "meaning", key->text));
  }
  if (list == NULL) return FAIL(STATUS_RUN, "the JSON array cannot be made");
  json_dumpf(list, stdout, JSON_INDENT(2));
  putchar('\n');
  json_decref(list);
  return STATUS_OK;
}
