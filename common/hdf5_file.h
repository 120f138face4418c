/* HDF5 with checked reads and atomic writes. Programs include no other HDF5 header.
 *
 * A file being written has the name PATH.part until h5_commit renames it, so that a crash never
 * leaves an incomplete file under the final name. Reads check rank, type class and sizes before
 * memory is allocated; external links and unknown filters are refused. */
#ifndef TOSUI_COMMON_HDF5_FILE_H
#define TOSUI_COMMON_HDF5_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct h5_file;
enum h5_type { H5_U8, H5_I32, H5_U32, H5_I64, H5_U64, H5_F32, H5_F64 };
/* Size of a value in memory, in bytes. */
size_t h5_type_size(enum h5_type type);

/* Creates a file, written at PATH.part; to be ended by h5_commit or h5_close. */
enum status h5_create(const char *path, struct h5_file **file);
/* Opens a file read-only and registers it as an input, which no output may replace. A child process
 * reads the file first: see hdf5_probe.c. */
enum status h5_open(const char *path, struct h5_file **file);
/* The same for a file that may be replaced afterwards. */
enum status h5_open_output(const char *path, struct h5_file **file);
/* The same without the probe, for a file that a checksum has shown to be written by Tosui. */
enum status h5_open_sealed(const char *path, struct h5_file **file);
/* Flushes, syncs, renames to the final name and frees. On failure the part file is removed. */
enum status h5_commit(struct h5_file *file);
/* With `leave`, h5_write returns STATUS_INTERRUPTED after a signal: for large files that can be
 * written again. Off by default, because checkpoints are written after a signal. */
void h5_leave_on_signal(bool leave);
/* Closes and frees; a file being written is removed. NULL is allowed. */
void h5_close(struct h5_file *file);
/* The path with which the file was opened or created. */
const char *h5_path(const struct h5_file *file);

/* Writes a dataset; missing parent groups are created. */
enum status h5_write(struct h5_file *file, const char *name, enum h5_type type, int rank,
                     const size_t *dims, const void *data, bool compress);
/* Collective (common/ranks.h): writes the same dataset, to which this rank contributes the next
 * dims[0] rows. */
enum status h5_write_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                          const size_t *dims, const void *data, bool compress);
/* A scalar string. */
enum status h5_write_text(struct h5_file *file, const char *name, const char *text);
/* A 1-D array of strings. */
enum status h5_write_texts(struct h5_file *file, const char *name, size_t count,
                           const char *const *texts);
enum status h5_make_group(struct h5_file *file, const char *name);
/* `target` need not exist yet. */
enum status h5_soft_link(struct h5_file *file, const char *target, const char *name);

/* Attributes of the object `name` ("/" for the root). A count of 1 writes a scalar. */
enum status h5_write_attribute(struct h5_file *file, const char *name, const char *attribute,
                               enum h5_type type, size_t count, const void *data);
enum status h5_write_attribute_text(struct h5_file *file, const char *name, const char *attribute,
                                    const char *text); /* of fixed length, as VTKHDF requires */

/* Whether an object of that name exists in the file; false for a broken link. */
bool h5_exists(struct h5_file *file, const char *name);
/* Names of a group's members, sorted; free with h5_free_texts. */
enum status h5_list(struct h5_file *file, const char *group, size_t *count, char ***names);
/* Names of the datasets of numbers in any group that have several values along two axes or more,
 * each once; links out of the file are not followed. Free with h5_free_texts. */
enum status h5_list_arrays(struct h5_file *file, size_t *count, char ***names);
/* Whether a part of an existing dataset was never written; HDF5 fills it in when it is read. */
bool h5_is_partial(struct h5_file *file, const char *name);
enum status h5_list_attributes(struct h5_file *file, const char *object, size_t *count,
                               char ***names);
bool h5_attribute_exists(struct h5_file *file, const char *name, const char *attribute);
/* Shape of a dataset of at most `max_rank` dimensions. */
enum status h5_shape(struct h5_file *file, const char *name, int max_rank, int *rank, size_t *dims);
/* Storage format of the numbers of a dataset: bits, and 'u', 'i' or 'f'. */
enum status h5_number_format(struct h5_file *file, const char *name, int *bits, char *format);
/* Reads a whole dataset of exactly `rank` dimensions, converted to `type`, into new memory
 * (memory_free); dims filled. Any integer or float type on disk is accepted for a number. */
enum status h5_read(struct h5_file *file, const char *name, enum h5_type type, int rank,
                    size_t *dims, void *data);
/* Reads only the rows [first, first + dims[0]) of a dataset with `rows` rows in all. */
enum status h5_read_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                         size_t rows, size_t first, size_t *dims, void *data);
/* Reads [first, first + length) along one axis of a dataset, and all along the others. */
enum status h5_read_slab(struct h5_file *file, const char *name, enum h5_type type, int rank,
                         int axis, size_t first, size_t length, void *data);
/* Collective: as h5_read, but each rank reads a part of the rows, and ranks on the same machine
 * share the memory (common/node_memory.h). */
enum status h5_read_together(struct h5_file *file, const char *name, enum h5_type type, int rank,
                             size_t *dims, void *data);
/* A string, or an array of strings, in new memory: memory_free, h5_free_texts. */
enum status h5_read_text(struct h5_file *file, const char *name, char **text);
enum status h5_read_texts(struct h5_file *file, const char *name, size_t *count, char ***texts);
void h5_free_texts(size_t count, char ***texts);
/* Reads exactly `count` values. */
enum status h5_read_attribute(struct h5_file *file, const char *name, const char *attribute,
                              enum h5_type type, size_t count, void *data);
/* Numbers in memory that an object of a file has as attributes, each by its name. */
struct h5_number {
  const char *name;
  enum h5_type type; /* of an int H5_I32, of a size_t H5_U64, ... */
  size_t count;
  const void *at; /* written to where a file is read */
};
enum status h5_write_numbers(struct h5_file *file, const char *object, size_t n,
                             const struct h5_number *numbers);
enum status h5_read_numbers(struct h5_file *file, const char *object, size_t n,
                            const struct h5_number *numbers);
/* A single number; NAN, without an error, if it is missing or not a number. */
double h5_attribute_or_nan(struct h5_file *file, const char *name, const char *attribute);
/* A text in new memory (memory_free), NULL where it fails. */
enum status h5_read_attribute_text(struct h5_file *file, const char *name, const char *attribute,
                                   char **text);
/* One text or up to 16, with colons between. Of references to objects (DIMENSION_LIST) the names.
 */
enum status h5_read_attribute_texts(struct h5_file *file, const char *name, const char *attribute,
                                    char **text);

#endif
