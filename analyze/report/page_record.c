#include "analyze/report/page_record.h"

#include <string.h>

#include "common/json_number.h"
#include "common/memory.h"

/* Inputs that are listed; a model may be made from thousands of slices. */
enum { INPUTS_SHOWN = 12 };

/* A number, three numbers, or a text; NULL if the attribute is none of these. */
static json_t *attribute_value(struct h5_file *file, const char *object, const char *name) {
  double numbers[3];
  char *text = NULL;
  json_t *value = NULL;
  if (h5_read_attribute(file, object, name, H5_F64, 1, numbers) == STATUS_OK)
    return json_number(numbers[0]);
  error_clear();
  if (h5_read_attribute(file, object, name, H5_F64, 3, numbers) == STATUS_OK)
    return json_numbers(numbers, 3);
  error_clear();
  if (h5_read_attribute_text(file, object, name, &text) == STATUS_OK)
    value = json_text(text);
  else
    error_clear();
  memory_free(&text);
  return value;
}

static json_t *number_rows(const double *values, int rank, const size_t dims[2]) {
  if (rank == 1) return json_numbers(values, dims[0]);
  json_t *rows = json_array();
  for (size_t i = 0; i < dims[0]; i++)
    json_array_append_new(rows, json_numbers(values + i * dims[1], dims[1]));
  return rows;
}

/* A dataset; NULL if it is too large, or neither numbers nor texts. */
static json_t *dataset_value(struct h5_file *file, const char *name) {
  size_t dims[2] = {1, 1}, count = 0;
  int rank = 0, bits;
  char format, **texts = NULL, *text = NULL;
  double *values = NULL;
  json_t *value = NULL;
  if (h5_shape(file, name, 2, &rank, dims) != STATUS_OK) goto cleanup;
  if (rank == 0) {
    if (h5_read_text(file, name, &text) == STATUS_OK) value = json_text(text);
    goto cleanup;
  }
  if (dims[0] > RECORD_MOST || (rank == 2 && dims[0] * dims[1] > RECORD_MOST)) goto cleanup;
  if (h5_number_format(file, name, &bits, &format) == STATUS_OK) {
    if (h5_read(file, name, H5_F64, rank, dims, &values) == STATUS_OK)
      value = number_rows(values, rank, dims);
    goto cleanup;
  }
  error_clear();
  if (rank == 1 && h5_read_texts(file, name, &count, &texts) == STATUS_OK) {
    const bool inputs = strstr(name, "/provenance/input_") != NULL;
    value = json_array();
    for (size_t i = 0; i < count && !(inputs && i == INPUTS_SHOWN); i++)
      json_array_append_new(value, json_text(texts[i]));
  }
cleanup:
  error_clear();
  memory_free(&values);
  memory_free(&text);
  h5_free_texts(count, &texts);
  return value;
}

static enum status add_group(struct h5_file *file, const char *group, json_t *object) {
  enum status status = STATUS_OK;
  char **names = NULL, path[256];
  size_t count = 0;
  json_t *attributes = json_object(), *record = json_pack("{s:o}", "attributes", attributes);
  json_object_set_new(object, strrchr(group, '/') + 1, record);
  TRY(h5_list_attributes(file, group, &count, &names));
  for (size_t i = 0; i < count; i++) {
    json_t *value = attribute_value(file, group, names[i]);
    if (value != NULL) json_object_set_new(attributes, names[i], value);
  }
  h5_free_texts(count, &names);
  TRY(h5_list(file, group, &count, &names));
  for (size_t i = 0; i < count; i++) {
    if (snprintf(path, sizeof path, "%s/%s", group, names[i]) >= (int)sizeof path) continue;
    json_t *value = dataset_value(file, path);
    if (value != NULL) json_object_set_new(record, names[i], value);
  }
cleanup:
  h5_free_texts(count, &names);
  return status;
}

enum status record_groups(struct h5_file *file, const char *const *groups, json_t *object) {
  enum status status = STATUS_OK;
  for (; *groups != NULL; groups++)
    if (h5_exists(file, *groups)) TRY(add_group(file, *groups, object));
cleanup:
  return status;
}
