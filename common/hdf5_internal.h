/* What the writing and the reading half of the HDF5 layer share; for common/hdf5_*.c alone. */
#ifndef TOSUI_COMMON_HDF5_INTERNAL_H
#define TOSUI_COMMON_HDF5_INTERNAL_H

#include <hdf5.h>

#include "common/hdf5_file.h"

struct h5_file {
  hid_t id;
  bool writing;
  char *path, *part; /* final name, and the name while being written */
};

hid_t h5_memory_type(enum h5_type type);
hid_t h5_disk_type(enum h5_type type);
/* Chunks of at most about 1 MB along the slowest axis; fast deflate behind a byte shuffle. Vectors
 * in double precision, as coordinates are, are parted into their components where there is more
 * than a chunk of them: what is alike in a row of sites then lies together. */
hid_t h5_dataset_layout(enum h5_type type, int rank, const size_t *dims, bool compress);
/* Axes along which chunks are runs of memory: `rank`, or one less where components are parted. */
int h5_chunk_axes(int rank, const size_t *dims, const hsize_t *chunk);
enum { H5_DEFLATE = 2 }; /* level */
/* What h5_leave_on_signal has set. */
bool h5_leaves_on_signal(void);
/* Writes all of a dataset of that layout, whose chunks are `chunk`, its parts compressed by several
 * threads to what HDF5's filters unpack. *written: whether the file took them. */
enum status h5_write_chunks(hid_t set, enum h5_type type, int rank, const size_t *dims,
                            const hsize_t *chunk, const void *data, bool *written);
/* Reads all of such a dataset, its chunks unpacked by several threads. *done: false where it is no
 * such one or something is wrong with it; then HDF5 reads it, or says what is wrong. */
enum status h5_read_chunks(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                           void *data, bool *done);
/* Makes the groups on the way to `name` (and `name` itself with `last`) where they are missing,
 * without times of their own, so that two equal runs give equal bytes. */
enum status h5_make_groups(struct h5_file *file, const char *name, bool last);
/* Whether a dataset lies in its file, behind no filter but HDF5's own. */
bool h5_filters_known(hid_t set);
/* An input error where the library crashes or hangs on the file. */
enum status h5_try(const char *path);

#endif
