#include "common/constant.h"

#include <stdio.h>

#include "common/memory.h"

enum status constants_write(struct h5_file *file, size_t tables,
                            const struct constant *const *table) {
  enum status status = STATUS_OK;
  size_t n = 0, at = 0;
  const char **names = NULL, **units = NULL, **origins = NULL, **texts = NULL;
  double *values = NULL;
  for (size_t t = 0; t < tables; t++)
    for (const struct constant *c = table[t]; c != NULL && c->name != NULL; c++) n++;
  TRY(memory_allocate(&names, n, sizeof *names, "constants"));
  TRY(memory_allocate(&units, n, sizeof *units, "constants"));
  TRY(memory_allocate(&origins, n, sizeof *origins, "constants"));
  TRY(memory_allocate(&texts, n, sizeof *texts, "constants"));
  TRY(memory_allocate(&values, n, sizeof *values, "constants"));
  for (size_t t = 0; t < tables; t++)
    for (const struct constant *c = table[t]; c != NULL && c->name != NULL; c++, at++) {
      names[at] = c->name, units[at] = c->unit, origins[at] = c->origin, texts[at] = c->text;
      values[at] = c->value;
    }
  TRY(h5_write_texts(file, "/run/constants/name", n, names));
  TRY(h5_write(file, "/run/constants/value", H5_F64, 1, &n, values, false));
  TRY(h5_write_texts(file, "/run/constants/unit", n, units));
  TRY(h5_write_texts(file, "/run/constants/origin", n, origins));
  TRY(h5_write_texts(file, "/run/constants/text", n, texts));
cleanup:
  MEMORY_FREE(&names, &units, &origins, &texts, &values);
  return status;
}
