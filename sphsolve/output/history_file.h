/* OUT.history.csv: the rows of the history during the run, each written when it is made, so that a
 * crash loses no row. A line contains the values of a row and the XXH3 hash of the text before its
 * last comma; incomplete lines after a crash fail this check and are dropped. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_HISTORY_FILE_H
#define TOSUI_SPHSOLVE_OUTPUT_HISTORY_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

struct history_file {
  int file;     /* descriptor + 1; 0: not open */
  size_t count; /* complete rows in the file */
  int width;    /* values per row */
  char *path, *header, *line;
  double synced; /* time of the last sync on the monotonic clock, s */
};

/* Opens `path` for rows of `width` values with the line `header` (without line end). With `keep`,
 * the complete rows of an existing file are kept if there are at least `count` of them; otherwise
 * the file is written anew with `rows` [count][width]. */
enum status history_file_open(struct history_file *history, const char *path, const char *header,
                              int width, size_t count, const double *rows, bool keep);
/* Writes row number `index`, from 0; does nothing if the file already contains it. */
enum status history_file_row(struct history_file *history, size_t index, const double *row);
/* Removes all rows but the first `count`. */
enum status history_file_truncate(struct history_file *history, size_t count);
/* Closes the file; `remove` deletes it, as OUT.hdf contains all rows. */
void history_file_close(struct history_file *history, bool remove);

#endif
