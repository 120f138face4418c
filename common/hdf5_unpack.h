/* Datasets decompressed by several threads; for common/hdf5_*.c only. */
#ifndef TOSUI_COMMON_HDF5_UNPACK_H
#define TOSUI_COMMON_HDF5_UNPACK_H

#include "common/hdf5_store.h"

/* Reads a whole dataset with that layout, its chunks decompressed by several threads. *done is
 * false if the layout is different or the data are damaged; HDF5 itself then reads the dataset or
 * reports the error. */
enum status h5_read_chunks(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                           void *data, bool *done);
/* Refuses chunks in [start, start + extent) of a dataset that inflate to more than a chunk. */
enum status h5_check_chunks(const char *path, const char *name, hid_t set, size_t number_size,
                            int rank, const size_t *start, const size_t *extent);

#endif
