/* The columns that a method adds to the history, in one walk over them: each line of the walk gives
 * a column's name, unit and value. The recorder walks once to declare the columns, before the first
 * row, and once for each row, so that names and values cannot part. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_HISTORY_COLUMNS_H
#define TOSUI_SPHSOLVE_OUTPUT_HISTORY_COLUMNS_H

#include "sphsolve/output/recorder.h"

struct history_columns {
  struct recorder *recorder; /* declares the columns; NULL: fills `values` */
  double *values;
  size_t count;
  enum status status; /* of the first column that cannot be declared */
};

/* Walks over the columns of a method's state, always in the same order. */
typedef void history_walk(struct history_columns *columns, const void *state);

/* One column of `width` components; its name is formatted. */
void history_column(struct history_columns *columns, const char *unit, int width,
                    const double *value, const char *name, ...)
    __attribute__((format(printf, 5, 6)));
/* The same for one number. */
#define history_number(columns, unit, value, ...)                                                  \
  history_column(columns, unit, 1, &(double){value}, __VA_ARGS__)

/* Declares the columns of a walk, before the first row. */
enum status history_columns_declare(struct recorder *recorder, history_walk *walk,
                                    const void *state);
/* Appends a row with the columns of the walk. */
enum status history_columns_row(struct recorder *recorder, const struct history_row *row,
                                history_walk *walk, const void *state);

#endif
