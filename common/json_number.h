/* Numbers in JSON, which has no NaN and no infinity: what is not known is null. */
#ifndef TOSUI_COMMON_JSON_NUMBER_H
#define TOSUI_COMMON_JSON_NUMBER_H

#include <jansson.h>
#include <math.h>
#include <stddef.h>

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

#endif
