/* An anonymous file for data that need not be in memory: in the folder of the results, and removed
 * with the process however that ends. */
#ifndef TOSUI_COMMON_SCRATCH_FILE_H
#define TOSUI_COMMON_SCRATCH_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "common/error.h"

struct scratch_file {
  FILE *file; /* NULL: not open */
};

/* Opens a scratch file in the folder of `beside`, any path in the folder of the results. STATUS_RUN
 * if that is impossible. */
enum status scratch_open(const char *beside, struct scratch_file *scratch);
/* Writes or reads `size` bytes at byte `offset`. Writing past the end extends the file. */
enum status scratch_write(const struct scratch_file *scratch, size_t offset, const void *data,
                          size_t size);
enum status scratch_read(const struct scratch_file *scratch, size_t offset, void *data,
                         size_t size);
void scratch_close(struct scratch_file *scratch);

#endif
