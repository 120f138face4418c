/* Declarations shared by the writing and the reading half of the HDF5 layer; for common/hdf5_*.c
 * only. */
#ifndef TOSUI_COMMON_HDF5_INTERNAL_H
#define TOSUI_COMMON_HDF5_INTERNAL_H

#include <hdf5.h>

#include "common/hdf5_file.h"

struct h5_file {
  hid_t id;
  bool writing;
  char *path, *part; /* final name, and the name while being written */
};

/* The HDF5 types of numbers in memory and, little-endian, in files. */
hid_t h5_memory_type(enum h5_type type);
hid_t h5_disk_type(enum h5_type type);
/* Dataset layout: chunks of at most about 1 MB along the slowest axis, with byte shuffle and fast
 * deflate. Vectors in double precision, such as coordinates, are split into their components if
 * they fill more than one chunk, because the components of neighbouring sites compress better. */
hid_t h5_dataset_layout(enum h5_type type, int rank, const size_t *dims, bool compress);
/* Number of axes along which a chunk is contiguous in memory: `rank`, or one less if the components
 * are split. */
int h5_chunk_axes(int rank, const size_t *dims, const hsize_t *chunk);
enum { H5_DEFLATE = 2 }; /* level */
/* The value set by h5_leave_on_signal. */
bool h5_leaves_on_signal(void);
/* Writes a whole dataset with the layout of h5_dataset_layout and chunks of size `chunk`,
 * compressed by several threads into the format of HDF5's filters. *written is false if the file
 * did not accept them. */
enum status h5_write_chunks(hid_t set, enum h5_type type, int rank, const size_t *dims,
                            const hsize_t *chunk, const void *data, bool *written);
/* Reads a whole dataset with that layout, its chunks decompressed by several threads. *done is
 * false if the layout is different or the data are damaged; HDF5 itself then reads the dataset or
 * reports the error. */
enum status h5_read_chunks(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                           void *data, bool *done);
/* Refuses chunks in [start, start + extent) of a dataset that inflate to more than a chunk. */
enum status h5_check_chunks(const char *path, const char *name, hid_t set, size_t number_size,
                            int rank, const size_t *start, const size_t *extent);
/* Creates the missing groups on the way to `name` (and `name` itself with `last`), without time
 * stamps, so that two equal runs give equal bytes. */
enum status h5_make_groups(struct h5_file *file, const char *name, bool last);
/* Whether a dataset is stored in its own file and uses no filters but those of HDF5. */
bool h5_filters_known(hid_t set);
/* An input error if the HDF5 library crashes or hangs on the file. */
enum status h5_try(const char *path);

#endif
