/* Numbers and texts in JSON, which has no NaN, no infinity and only UTF-8. jansson returns NULL for
 * these, and json_pack then returns NULL for the whole object. */
#ifndef TOSUI_COMMON_JSON_NUMBER_H
#define TOSUI_COMMON_JSON_NUMBER_H

#include <jansson.h>
#include <math.h>
#include <stddef.h>

/* A number; null if it is not finite. */
static inline json_t *json_number(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

static inline json_t *json_numbers(const double *values, size_t n) {
  json_t *array = json_array();
  for (size_t i = 0; i < n; i++) json_array_append_new(array, json_number(values[i]));
  return array;
}

static inline void json_put_number(json_t *object, const char *key, double value) {
  json_object_set_new(object, key, json_number(value));
}

/* A text; if it is not valid UTF-8, its readable characters, at most 255 bytes. */
static inline json_t *json_text(const char *text) {
  json_t *value = json_string(text);
  if (value != NULL) return value;
  char ascii[256];
  size_t n = 0;
  for (; n + 1 < sizeof ascii && text[n] != '\0'; n++)
    ascii[n] = (unsigned char)text[n] < 0x80 ? text[n] : '?';
  return json_stringn(ascii, n);
}

/* The number of that name in an object, or NAN. */
static inline double json_number_or_nan(const json_t *object, const char *key) {
  const json_t *value = json_object_get(object, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

#endif
