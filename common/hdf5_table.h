/* Tables whose rows lie in memory as structs: each column becomes a dataset. */
#ifndef TOSUI_COMMON_HDF5_TABLE_H
#define TOSUI_COMMON_HDF5_TABLE_H

#include "common/hdf5_file.h"

/* Components of a column of texts: a char[] or a const char * in each row. */
enum { H5_TEXT = 0, H5_TEXT_AT = -1 };

struct h5_column {
  const char *name;
  enum h5_type type; /* of numbers */
  int components;
  const void *first; /* in the first row */
};

/* Writes GROUP/NAME for each of `n` columns of `rows` rows, `stride` bytes apart. */
enum status h5_write_columns(struct h5_file *file, const char *group, size_t rows, size_t stride,
                             size_t n, const struct h5_column *columns);

#endif
