#include "sphsolve/output/history_columns.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"

void history_column(struct history_columns *columns, const char *unit, int width,
                    const double *value, const char *name, ...) {
  if (columns->recorder != NULL && columns->status == STATUS_OK) {
    char text[64];
    va_list arguments;
    va_start(arguments, name);
    vsnprintf(text, sizeof text, name, arguments);
    va_end(arguments);
    columns->status = recorder_add_column(columns->recorder, text, unit, width);
  }
  if (columns->values != NULL)
    memcpy(columns->values + columns->count, value, (size_t)width * sizeof *value);
  columns->count += (size_t)width;
}

enum status history_columns_declare(struct recorder *recorder, history_walk *walk,
                                    const void *state) {
  struct history_columns columns = {.recorder = recorder};
  walk(&columns, state);
  return columns.status;
}

enum status history_columns_row(struct recorder *recorder, const struct history_row *row,
                                history_walk *walk, const void *state) {
  struct history_columns columns = {0};
  enum status status = memory_allocate(&columns.values, recorder_extra_width(recorder),
                                       sizeof *columns.values, "a row of the history");
  if (status != STATUS_OK) return status;
  walk(&columns, state);
  status = recorder_row(recorder, row, columns.values);
  memory_free(&columns.values);
  return status;
}
