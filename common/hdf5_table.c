#include "common/hdf5_table.h"

#include <stdio.h>
#include <string.h>

#include "common/memory.h"

static enum status write_column(struct h5_file *file, const char *path, size_t rows, size_t stride,
                                const struct h5_column *c) {
  enum status status = STATUS_OK;
  const bool texts = c->components <= 0;
  const size_t dims[2] = {rows, texts ? 1 : (size_t)c->components};
  const size_t size = texts ? sizeof(char *) : dims[1] * h5_type_size(c->type);
  char *values = NULL;
  TRY(memory_allocate(&values, rows, size, "a table"));
  for (size_t i = 0; i < rows; i++) {
    const char *at = (const char *)c->first + i * stride;
    memcpy(values + i * size, c->components == H5_TEXT ? (const void *)&at : at, size);
  }
  TRY(texts ? h5_write_texts(file, path, rows, (const char *const *)(const void *)values)
            : h5_write(file, path, c->type, dims[1] > 1 ? 2 : 1, dims, values, false));
cleanup:
  memory_free(&values);
  return status;
}

enum status h5_write_columns(struct h5_file *file, const char *group, size_t rows, size_t stride,
                             size_t n, const struct h5_column *columns) {
  enum status status = STATUS_OK;
  char path[96];
  for (size_t k = 0; k < n; k++) {
    snprintf(path, sizeof path, "%s/%s", group, columns[k].name);
    TRY(write_column(file, path, rows, stride, &columns[k]));
  }
cleanup:
  return status;
}
