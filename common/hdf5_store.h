/* How numbers lie in files: types, chunks, filters, groups. The one header that includes that of
 * HDF5; for common/hdf5_*.c only. */
#ifndef TOSUI_COMMON_HDF5_STORE_H
#define TOSUI_COMMON_HDF5_STORE_H

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
/* Creates the missing groups on the way to `name` (and `name` itself with `last`), without time
 * stamps, so that two equal runs give equal bytes. */
enum status h5_make_groups(struct h5_file *file, const char *name, bool last);
/* Whether a dataset is stored in its own file and uses no filters but those of HDF5. */
bool h5_filters_known(hid_t set);
#endif
