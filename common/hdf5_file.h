/* HDF5 behind checked reads and atomic writes. The only header that programs see of HDF5.
 *
 * A file being written lives at PATH.part until h5_commit renames it; a crash never leaves half a
 * file under its final name. Reads check rank, type class and sizes before memory is allocated;
 * external links and unknown filters are refused. */
#ifndef TOSUI_COMMON_HDF5_FILE_H
#define TOSUI_COMMON_HDF5_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct h5_file;
enum h5_type { H5_U8, H5_I32, H5_U32, H5_I64, H5_U64, H5_F32, H5_F64 };
/* Bytes of a value in memory. */
size_t h5_type_size(enum h5_type type);

/* A new file, written at PATH.part; ends with h5_commit or h5_close. */
enum status h5_create(const char *path, struct h5_file **file);
/* Read only, as an input, which no output may replace. A process of its own looks at the file
 * first: see hdf5_probe.c. */
enum status h5_open(const char *path, struct h5_file **file);
/* The same of a file that may be replaced afterwards. */
enum status h5_open_output(const char *path, struct h5_file **file);
/* The same without the probe, for a file whose bytes are known to be ours by a checksum. */
enum status h5_open_sealed(const char *path, struct h5_file **file);
/* Flushes, syncs, renames to the final name, frees. On failure the part file is removed. */
enum status h5_commit(struct h5_file *file);
/* Whether, from here on, h5_write ends with STATUS_INTERRUPTED where a signal has come: for large
 * files that can be written again. At first not: checkpoints are written after a signal. */
void h5_leave_on_signal(bool leave);
/* Closes; a file being written is removed. NULL is fine. */
void h5_close(struct h5_file *file);
const char *h5_path(const struct h5_file *file);

/* Intermediate groups of `name` are created. */
enum status h5_write(struct h5_file *file, const char *name, enum h5_type type, int rank,
                     const size_t *dims, const void *data, bool compress);
/* Collective (common/ranks.h): the same dataset, of which this rank holds the next dims[0] rows. */
enum status h5_write_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                          const size_t *dims, const void *data, bool compress);
enum status h5_write_text(struct h5_file *file, const char *name, const char *text);
/* A 1-D array of strings. */
enum status h5_write_texts(struct h5_file *file, const char *name, size_t count,
                           const char *const *texts);
enum status h5_make_group(struct h5_file *file, const char *name);
/* `target` may be absent yet. */
enum status h5_soft_link(struct h5_file *file, const char *target, const char *name);

/* Attributes of the object `name` ("/" for the root). count 1 writes a scalar. */
enum status h5_write_attribute(struct h5_file *file, const char *name, const char *attribute,
                               enum h5_type type, size_t count, const void *data);
enum status h5_write_attribute_text(struct h5_file *file, const char *name, const char *attribute,
                                    const char *text); /* fixed length, as VTKHDF wants */

/* Whether an object of that name is in the file (a broken link is not). */
bool h5_exists(struct h5_file *file, const char *name);
/* Names of a group's members, sorted; free with h5_free_texts. */
enum status h5_list(struct h5_file *file, const char *group, size_t *count, char ***names);
enum status h5_list_attributes(struct h5_file *file, const char *object, size_t *count,
                               char ***names);
bool h5_attribute_exists(struct h5_file *file, const char *name, const char *attribute);
/* Shape of a dataset: rank <= max_rank, dims filled. */
enum status h5_shape(struct h5_file *file, const char *name, int max_rank, int *rank, size_t *dims);
/* How the numbers of a dataset are stored: bits, and 'u', 'i' or 'f'. */
enum status h5_number_format(struct h5_file *file, const char *name, int *bits, char *format);
/* Reads a whole dataset of exactly `rank` dimensions, converted to `type`, into new memory
 * (memory_free); dims filled. Any integer or float type on disk is accepted for a number. */
enum status h5_read(struct h5_file *file, const char *name, enum h5_type type, int rank,
                    size_t *dims, void *data);
/* Rows first .. first + dims[0] alone of a dataset that has `rows`. */
enum status h5_read_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                         size_t rows, size_t first, size_t *dims, void *data);
/* Collective: as h5_read; each rank reads a part of the rows, and those on one machine hold them
 * once (common/node_memory.h). */
enum status h5_read_together(struct h5_file *file, const char *name, enum h5_type type, int rank,
                             size_t *dims, void *data);
enum status h5_read_text(struct h5_file *file, const char *name, char **text);
enum status h5_read_texts(struct h5_file *file, const char *name, size_t *count, char ***texts);
void h5_free_texts(size_t count, char ***texts);
/* Reads exactly `count` values. */
enum status h5_read_attribute(struct h5_file *file, const char *name, const char *attribute,
                              enum h5_type type, size_t count, void *data);
/* One number that may be absent or of another kind: NAN then, and no error. */
double h5_attribute_or_nan(struct h5_file *file, const char *name, const char *attribute);
enum status h5_read_attribute_text(struct h5_file *file, const char *name, const char *attribute,
                                   char **text);

#endif
