/* Datasets compressed by several threads; for common/hdf5_*.c only. */
#ifndef TOSUI_COMMON_HDF5_CHUNKS_H
#define TOSUI_COMMON_HDF5_CHUNKS_H

#include "common/hdf5_store.h"

/* Writes a whole dataset with the layout of h5_dataset_layout and chunks of size `chunk`,
 * compressed by several threads into the format of HDF5's filters. *written is false if the file
 * did not accept them. */
enum status h5_write_chunks(hid_t set, enum h5_type type, int rank, const size_t *dims,
                            const hsize_t *chunk, const void *data, bool *written);

#endif
