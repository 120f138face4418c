/* OUT.history.csv: the rows of the history while the run goes on, each written when it is made, so
 * that a crash loses no row. A line holds the values of a row and the XXH3 of the text before its
 * last comma; what a crash tore off does not fit and is dropped. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_HISTORY_FILE_H
#define TOSUI_SPHSOLVE_OUTPUT_HISTORY_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

struct history_file {
  int file;     /* descriptor + 1; 0: not open */
  size_t count; /* whole rows in the file */
  int width;    /* values in a row */
  char *path, *header, *line;
  double synced; /* on the monotonic clock */
};

/* Opens `path` for rows of `width` values under the line `header` (without its end). With `keep`,
 * whole rows that are there stay if they are `count` or more; else the file is begun anew with
 * `rows` [count][width]. */
enum status history_file_open(struct history_file *history, const char *path, const char *header,
                              int width, size_t count, const double *rows, bool keep);
/* Row number `index`, from 0; one that the file already holds is passed over. */
enum status history_file_row(struct history_file *history, size_t index, const double *row);
/* Forgets all rows but the first `count`. */
enum status history_file_truncate(struct history_file *history, size_t count);
/* Closes; with `remove` the file goes, since OUT.hdf holds it all. */
void history_file_close(struct history_file *history, bool remove);

#endif
