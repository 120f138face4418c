#include "common/constant.h"

#include <string.h>

#include "common/hdf5_table.h"
#include "common/memory.h"

enum status constants_write(struct h5_file *file, size_t tables,
                            const struct constant *const *table) {
  enum status status = STATUS_OK;
  size_t n = 0;
  struct constant *all = NULL;
  for (size_t t = 0; t < tables; t++) {
    size_t more = 0;
    while (table[t] != NULL && table[t][more].name != NULL) more++;
    if (more == 0) continue;
    TRY(memory_resize(&all, n + more, sizeof *all, "constants"));
    memcpy(all + n, table[t], more * sizeof *all);
    n += more;
  }
  if (n == 0) return STATUS_OK;
  const struct h5_column columns[] = {{"name", 0, H5_TEXT_AT, &all->name},
                                      {"value", H5_F64, 1, &all->value},
                                      {"unit", 0, H5_TEXT_AT, &all->unit},
                                      {"origin", 0, H5_TEXT_AT, &all->origin},
                                      {"text", 0, H5_TEXT_AT, &all->text}};
  TRY(h5_write_columns(file, "/run/constants", n, sizeof *all, 5, columns));
cleanup:
  memory_free(&all);
  return status;
}
