/* A file without a name for what need not lie in memory: beside the results, on the same disk, and
 * gone with the process, however that ends. */
#ifndef TOSUI_COMMON_SCRATCH_FILE_H
#define TOSUI_COMMON_SCRATCH_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "common/error.h"

struct scratch_file {
  FILE *file; /* NULL: none */
};

/* `beside`: any path in the folder of the results. STATUS_RUN where none can be made there. */
enum status scratch_open(const char *beside, struct scratch_file *scratch);
/* `size` bytes from byte `offset` on; past the end, the file grows. */
enum status scratch_write(const struct scratch_file *scratch, size_t offset, const void *data,
                          size_t size);
enum status scratch_read(const struct scratch_file *scratch, size_t offset, void *data,
                         size_t size);
void scratch_close(struct scratch_file *scratch);

#endif
