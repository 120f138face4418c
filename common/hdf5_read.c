/* The reading half of the HDF5 layer: every size, type and link is checked before it is used. */
#include "common/constants.h"
#include "common/hdf5_file.h"

#include <math.h>
#include <string.h>

#include "common/hdf5_store.h"
#include "common/hdf5_unpack.h"
#include "common/memory.h"

/* True if every link on the way to `name` exists and none leaves the file. */
static bool path_inside(struct h5_file *file, const char *name) {
  char path[512];
  size_t length = strlen(name);
  if (length == 0 || length >= sizeof path) return false;
  if (!strcmp(name, "/")) return true;
  memcpy(path, name, length + 1);
  for (size_t i = 1; i <= length; i++) {
    if (path[i] != '/' && path[i] != '\0') continue;
    char kept = path[i];
    path[i] = '\0';
    H5L_info_t info;
    if (H5Lexists(file->id, path, H5P_DEFAULT) <= 0 ||
        H5Lget_info(file->id, path, &info, H5P_DEFAULT) < 0 || info.type == H5L_TYPE_EXTERNAL ||
        H5Oexists_by_name(file->id, path, H5P_DEFAULT) <= 0)
      return false;
    path[i] = kept;
  }
  return true;
}

bool h5_exists(struct h5_file *file, const char *name) {
  return path_inside(file, name);
}

bool h5_attribute_exists(struct h5_file *file, const char *name, const char *attribute) {
  return path_inside(file, name) && H5Aexists_by_name(file->id, name, attribute, H5P_DEFAULT) > 0;
}

static enum status open_dataset(struct h5_file *file, const char *name, hid_t *set) {
  *set = path_inside(file, name) ? H5Dopen2(file->id, name, H5P_DEFAULT) : -1;
  if (*set < 0) return FAIL(STATUS_INPUT, "%s: has no dataset %s", file->path, name);
  return STATUS_OK;
}

enum status h5_shape(struct h5_file *file, const char *name, int max_rank, int *rank,
                     size_t *dims) {
  enum status status = STATUS_OK;
  hid_t set = -1, space = -1;
  hsize_t extent[H5S_MAX_RANK];
  TRY(open_dataset(file, name, &set));
  space = H5Dget_space(set);
  *rank = H5Sget_simple_extent_ndims(space);
  if (*rank < 0 || *rank > max_rank)
    TRY_FAIL(STATUS_INPUT, "%s: %s has %d dimensions, at most %d are wanted", file->path, name,
             *rank, max_rank);
  H5Sget_simple_extent_dims(space, extent, NULL);
  for (int i = 0; i < *rank; i++) dims[i] = extent[i];
cleanup:
  if (space >= 0) H5Sclose(space);
  if (set >= 0) H5Dclose(set);
  return status;
}

/* Largest number and longest string of fixed length, in bytes, that valid files contain. The
 * library allocates whatever a damaged type claims, up to 4 GB for a number. */
#define NUMBER_BYTES_MAX 16
#define TEXT_BYTES_MAX (1u << 24)

/* Booleans count as numbers; h5py stores them as a one-byte enumeration. */
static bool holds_numbers(hid_t stored) {
  H5T_class_t class = H5Tget_class(stored);
  if (class == H5T_ENUM) return H5Tget_size(stored) == 1;
  return (class == H5T_INTEGER || class == H5T_FLOAT) && H5Tget_size(stored) <= NUMBER_BYTES_MAX;
}

/* What a type without numbers is, for messages. */
static const char *kind_of(hid_t stored) {
  switch (H5Tget_class(stored)) {
  case H5T_BITFIELD:
    return "bits (H5T_BITFIELD)";
  case H5T_COMPOUND:
    return "compounds, as of complex numbers";
  case H5T_STRING:
    return "texts";
  case H5T_ARRAY:
    return "arrays of several numbers each";
  case H5T_REFERENCE:
    return "references";
  default:
    return "values of another type";
  }
}

static bool holds_texts(hid_t stored) {
  return H5Tget_class(stored) == H5T_STRING && H5Tget_size(stored) <= TEXT_BYTES_MAX;
}

enum status h5_number_format(struct h5_file *file, const char *name, int *bits, char *format) {
  enum status status = STATUS_OK;
  hid_t set = -1, stored = -1;
  TRY(open_dataset(file, name, &set));
  stored = H5Dget_type(set);
  if (!holds_numbers(stored))
    TRY_FAIL(STATUS_INPUT, "%s: %s holds no numbers, but %s; save it as integers or floats",
             file->path, name, kind_of(stored));
  const H5T_class_t class = H5Tget_class(stored);
  *bits = 8 * (int)H5Tget_size(stored);
  *format = class == H5T_FLOAT                                            ? 'f'
            : class == H5T_INTEGER && H5Tget_sign(stored) == H5T_SGN_NONE ? 'u'
            : class == H5T_INTEGER                                        ? 'i'
                                                                          : 'u';
cleanup:
  if (stored >= 0) H5Tclose(stored);
  if (set >= 0) H5Dclose(set);
  return status;
}

#define UNCHECKED_BYTES (1 << 24) /* bytes up to which this is allowed */

static enum status check_storage(struct h5_file *file, hid_t set, hid_t stored, const char *name) {
  const hid_t space = H5Dget_space(set);
  const double bytes = (double)H5Sget_simple_extent_npoints(space) * (double)H5Tget_size(stored);
  const double there = (double)H5Dget_storage_size(set);
  H5Sclose(space);
  if (bytes <= UNCHECKED_BYTES || bytes <= DEFLATE_RATIO_MAX * there) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: %s claims %.0f bytes, but the %.0f stored can hold at most %.0f; write it whole",
              file->path, name, bytes, there, DEFLATE_RATIO_MAX * there);
}

/* Reads `rows` rows of an axis from `first` on; all rows if SIZE_MAX. */
static enum status read_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                             int axis, size_t first, size_t rows, size_t *dims, void *data) {
  enum status status = STATUS_OK;
  void *values = NULL;
  hid_t set = -1, stored = -1, from = H5S_ALL, to = H5S_ALL;
  int found;
  bool done = false;
  size_t count = 1, shape[H5S_MAX_RANK], begin[H5S_MAX_RANK] = {0};
  TRY(h5_shape(file, name, H5S_MAX_RANK, &found, shape));
  if (found != rank)
    TRY_FAIL(STATUS_INPUT, "%s: %s has %d dimensions, %d are wanted", file->path, name, found,
             rank);
  TRY(open_dataset(file, name, &set));
  stored = H5Dget_type(set);
  if (!holds_numbers(stored)) TRY_FAIL(STATUS_INPUT, "%s: %s holds no numbers", file->path, name);
  if (H5Tget_class(stored) == H5T_FLOAT && type != H5_F32 && type != H5_F64)
    TRY_FAIL(STATUS_INPUT, "%s: %s holds floats, integers are wanted", file->path, name);
  if (!h5_filters_known(set))
    TRY_FAIL(STATUS_INPUT,
             "%s: %s uses a filter or storage outside this file; store it plain or "
             "with deflate",
             file->path, name);
  if (rows != SIZE_MAX && rank > 0) {
    hsize_t start[H5S_MAX_RANK] = {0}, extent[H5S_MAX_RANK];
    if (first > shape[axis] || rows > shape[axis] - first)
      TRY_FAIL(STATUS_INPUT, "%s: %s has %zu rows, %zu are wanted", file->path, name, shape[axis],
               first + rows);
    shape[axis] = rows;
    start[axis] = first;
    begin[axis] = first;
    for (int i = 0; i < rank; i++) extent[i] = shape[i];
    from = H5Dget_space(set);
    to = H5Screate_simple(rank, extent, NULL);
    H5Sselect_hyperslab(from, H5S_SELECT_SET, start, NULL, extent, NULL);
  }
  for (int i = 0; i < rank; i++) {
    dims[i] = shape[i];
    if (!size_multiply(count, shape[i], &count))
      TRY_FAIL(STATUS_INPUT, "%s: %s claims an impossible size", file->path, name);
  }
  /* If memory is insufficient the allocation below reports it; otherwise the stored size is checked
   * before the memory is filled. */
  if (memory_has_room(count, h5_type_size(type))) TRY(check_storage(file, set, stored, name));
  TRY(memory_allocate(&values, count, h5_type_size(type), name));
  if (rows == SIZE_MAX) TRY(h5_read_chunks(set, stored, type, rank, shape, values, &done));
  if (!done) TRY(h5_check_chunks(file->path, name, set, H5Tget_size(stored), rank, begin, shape));
  if (count > 0 && !done && H5Dread(set, h5_memory_type(type), to, from, H5P_DEFAULT, values) < 0)
    TRY_FAIL(STATUS_INPUT, "%s: %s is damaged and cannot be read", file->path, name);
  memcpy(data, &values, sizeof values);
  values = NULL;
cleanup:
  memory_free(&values);
  if (from != H5S_ALL) H5Sclose(from);
  if (to != H5S_ALL) H5Sclose(to);
  if (stored >= 0) H5Tclose(stored);
  if (set >= 0) H5Dclose(set);
  return status;
}

enum status h5_read(struct h5_file *file, const char *name, enum h5_type type, int rank,
                    size_t *dims, void *data) {
  return read_rows(file, name, type, rank, 0, 0, SIZE_MAX, dims, data);
}

enum status h5_read_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                         size_t rows, size_t first, size_t *dims, void *data) {
  enum status status = STATUS_OK;
  size_t shape[H5S_MAX_RANK] = {0};
  int found = 0;
  TRY(h5_shape(file, name, rank, &found, shape));
  if (found != rank || shape[0] != rows)
    TRY_FAIL(STATUS_INPUT, "%s: %s has %zu rows, not %zu", file->path, name,
             found > 0 ? shape[0] : 1, rows);
  TRY(read_rows(file, name, type, rank, 0, first, dims[0], dims, data));
cleanup:
  return status;
}

enum status h5_read_slab(struct h5_file *file, const char *name, enum h5_type type, int rank,
                         int axis, size_t first, size_t length, void *data) {
  size_t dims[H5S_MAX_RANK];
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* in this thread too, as h5_open in its own */
  return read_rows(file, name, type, rank, axis, first, length, dims, data);
}

void h5_free_texts(size_t count, char ***texts) {
  if (*texts == NULL) return;
  for (size_t i = 0; i < count; i++) memory_free(&(*texts)[i]);
  memory_free(texts);
}

static enum status copy_text(const char *from, size_t limit, char **to) {
  size_t length = from != NULL ? strnlen(from, limit) : 0;
  enum status status = memory_allocate(to, length + 1, 1, "a text");
  if (status == STATUS_OK && length > 0) memcpy(*to, from, length);
  return status;
}

enum status h5_read_texts(struct h5_file *file, const char *name, size_t *count, char ***texts) {
  enum status status = STATUS_OK;
  hid_t set = -1, stored = -1, space = -1, type = -1;
  char *fixed = NULL;
  char **variable = NULL, **copies = NULL;
  size_t n = 0;
  *texts = NULL;
  TRY(open_dataset(file, name, &set));
  stored = H5Dget_type(set);
  space = H5Dget_space(set);
  hssize_t points = H5Sget_simple_extent_npoints(space);
  if (!holds_texts(stored) || points < 0 || !h5_filters_known(set))
    TRY_FAIL(STATUS_INPUT, "%s: %s holds no text", file->path, name);
  n = (size_t)points;
  TRY(memory_allocate(&copies, n, sizeof *copies, name));
  if (H5Tis_variable_str(stored) > 0) {
    TRY(memory_allocate(&variable, n, sizeof *variable, name));
    type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5Tget_cset(stored));
    if (n > 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, variable) < 0)
      TRY_FAIL(STATUS_INPUT, "%s: %s is damaged and cannot be read", file->path, name);
    for (size_t i = 0; i < n; i++) TRY(copy_text(variable[i], (size_t)1 << 40, &copies[i]));
  } else {
    size_t width = H5Tget_size(stored);
    TRY(memory_allocate(&fixed, n, width, name));
    if (n > 0 && H5Dread(set, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, fixed) < 0)
      TRY_FAIL(STATUS_INPUT, "%s: %s is damaged and cannot be read", file->path, name);
    for (size_t i = 0; i < n; i++) TRY(copy_text(fixed + i * width, width, &copies[i]));
  }
  *count = n;
  *texts = copies;
  copies = NULL;
cleanup:
  if (variable != NULL && type >= 0) H5Dvlen_reclaim(type, space, H5P_DEFAULT, variable);
  MEMORY_FREE(&variable, &fixed);
  h5_free_texts(n, &copies);
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  if (stored >= 0) H5Tclose(stored);
  if (set >= 0) H5Dclose(set);
  return status;
}

enum status h5_list(struct h5_file *file, const char *group, size_t *count, char ***names) {
  enum status status = STATUS_OK;
  H5G_info_t info;
  size_t n = 0;
  *count = 0;
  *names = NULL;
  hid_t id = path_inside(file, group) ? H5Gopen2(file->id, group, H5P_DEFAULT) : -1;
  if (id < 0 || H5Gget_info(id, &info) < 0)
    TRY_FAIL(STATUS_INPUT, "%s: has no group %s", file->path, group);
  n = (size_t)info.nlinks;
  TRY(memory_allocate(names, n, sizeof **names, group));
  for (size_t i = 0; i < n; i++) {
    ssize_t length =
        H5Lget_name_by_idx(id, ".", H5_INDEX_NAME, H5_ITER_INC, i, NULL, 0, H5P_DEFAULT);
    if (length < 0) TRY_FAIL(STATUS_INPUT, "%s: %s cannot be listed", file->path, group);
    TRY(memory_allocate(&(*names)[i], (size_t)length + 1, 1, group));
    H5Lget_name_by_idx(id, ".", H5_INDEX_NAME, H5_ITER_INC, i, (*names)[i], (size_t)length + 1,
                       H5P_DEFAULT);
  }
  *count = n;
cleanup:
  if (status != STATUS_OK) h5_free_texts(n, names);
  if (id >= 0) H5Gclose(id);
  return status;
}

enum status h5_list_attributes(struct h5_file *file, const char *object, size_t *count,
                               char ***names) {
  enum status status = STATUS_OK;
  H5O_info_t info;
  size_t n = 0;
  *count = 0;
  *names = NULL;
  if (!path_inside(file, object) ||
      H5Oget_info_by_name2(file->id, object, &info, H5O_INFO_NUM_ATTRS, H5P_DEFAULT) < 0)
    TRY_FAIL(STATUS_INPUT, "%s: has no object %s", file->path, object);
  n = (size_t)info.num_attrs;
  TRY(memory_allocate(names, n, sizeof **names, object));
  for (size_t i = 0; i < n; i++) {
    ssize_t length =
        H5Aget_name_by_idx(file->id, object, H5_INDEX_NAME, H5_ITER_INC, i, NULL, 0, H5P_DEFAULT);
    if (length < 0) TRY_FAIL(STATUS_INPUT, "%s: %s cannot be listed", file->path, object);
    TRY(memory_allocate(&(*names)[i], (size_t)length + 1, 1, object));
    H5Aget_name_by_idx(file->id, object, H5_INDEX_NAME, H5_ITER_INC, i, (*names)[i],
                       (size_t)length + 1, H5P_DEFAULT);
  }
  *count = n;
cleanup:
  if (status != STATUS_OK) h5_free_texts(n, names);
  return status;
}

enum status h5_read_text(struct h5_file *file, const char *name, char **text) {
  char **texts = NULL;
  size_t count = 0;
  enum status status = h5_read_texts(file, name, &count, &texts);
  if (status != STATUS_OK) return status;
  if (count != 1) {
    h5_free_texts(count, &texts);
    return FAIL(STATUS_INPUT, "%s: %s holds %zu texts, one is wanted", file->path, name, count);
  }
  *text = texts[0];
  memory_free(&texts);
  return STATUS_OK;
}

static enum status open_attribute(struct h5_file *file, const char *name, const char *attribute,
                                  hid_t *id) {
  *id = -1;
  if (h5_attribute_exists(file, name, attribute))
    *id = H5Aopen_by_name(file->id, name, attribute, H5P_DEFAULT, H5P_DEFAULT);
  if (*id < 0) return FAIL(STATUS_INPUT, "%s: %s has no attribute %s", file->path, name, attribute);
  return STATUS_OK;
}

enum status h5_read_attribute(struct h5_file *file, const char *name, const char *attribute,
                              enum h5_type type, size_t count, void *data) {
  enum status status = STATUS_OK;
  hid_t id, stored = -1, space = -1;
  TRY(open_attribute(file, name, attribute, &id));
  stored = H5Aget_type(id);
  space = H5Aget_space(id);
  hssize_t points = H5Sget_simple_extent_npoints(space);
  if (!holds_numbers(stored) ||
      (H5Tget_class(stored) == H5T_FLOAT && type != H5_F32 && type != H5_F64))
    TRY_FAIL(STATUS_INPUT, "%s: attribute %s of %s has the wrong type", file->path, attribute,
             name);
  if (points != (hssize_t)count)
    TRY_FAIL(STATUS_INPUT, "%s: attribute %s of %s holds %lld values, %zu are wanted", file->path,
             attribute, name, (long long)points, count);
  if (H5Aread(id, h5_memory_type(type), data) < 0)
    TRY_FAIL(STATUS_INPUT, "%s: attribute %s of %s cannot be read", file->path, attribute, name);
cleanup:
  if (space >= 0) H5Sclose(space);
  if (stored >= 0) H5Tclose(stored);
  if (id >= 0) H5Aclose(id);
  return status;
}

double h5_attribute_or_nan(struct h5_file *file, const char *name, const char *attribute) {
  double value = NAN;
  if (h5_attribute_exists(file, name, attribute) &&
      h5_read_attribute(file, name, attribute, H5_F64, 1, &value) != STATUS_OK)
    error_clear();
  return value;
}

enum status h5_read_numbers(struct h5_file *file, const char *object, size_t n,
                            const struct h5_number *numbers) {
  enum status status = STATUS_OK;
  for (const struct h5_number *k = numbers; k < numbers + n; k++)
    TRY(h5_read_attribute(file, object, k->name, k->type, k->count, (void *)k->at));
cleanup:
  return status;
}

/* Adds a text of at most `limit` bytes to others, a colon between. */
static enum status add_text(const char *from, size_t limit, char **to) {
  const size_t used = *to != NULL ? strlen(*to) + 1 : 0;
  const size_t length = from != NULL ? strnlen(from, limit) : 0;
  const enum status status = memory_resize(to, used + length + 1, 1, "a text");
  if (status != STATUS_OK) return status;
  if (used > 0) (*to)[used - 1] = ':';
  if (length > 0) memcpy(*to + used, from, length);
  (*to)[used + length] = '\0';
  return STATUS_OK;
}

enum { TEXTS_MOST = 16 };

/* Adds the last parts of the names of objects, to the first of which each list of an attribute
 * refers. */
static enum status add_names(hid_t id, hid_t stored, hid_t space, char **text) {
  enum status status = STATUS_OK;
  hvl_t lists[TEXTS_MOST] = {{0, NULL}};
  const size_t count = (size_t)H5Sget_simple_extent_npoints(space);
  const bool whole = H5Aread(id, stored, lists) >= 0;
  for (size_t i = 0; i < count && whole; i++) {
    char name[240] = "";
    const hid_t object =
        lists[i].len > 0 ? H5Rdereference2(id, H5P_DEFAULT, H5R_OBJECT, lists[i].p) : -1;
    if (object >= 0) {
      (void)H5Iget_name(object, name, sizeof name);
      H5Oclose(object);
    }
    const char *slash = strrchr(name, '/');
    TRY(add_text(slash != NULL ? slash + 1 : name, sizeof name, text));
  }
cleanup:
  if (whole) H5Dvlen_reclaim(stored, space, H5P_DEFAULT, lists);
  return status;
}

/* Whether a type is a list of references to objects, as of HDF5's dimension scales. */
static bool holds_references(hid_t stored) {
  if (H5Tget_class(stored) != H5T_VLEN) return false;
  const hid_t of = H5Tget_super(stored);
  const bool yes = H5Tequal(of, H5T_STD_REF_OBJ) > 0;
  H5Tclose(of);
  return yes;
}

static enum status read_texts(struct h5_file *file, const char *name, const char *attribute,
                              hssize_t most, char **text) {
  enum status status = STATUS_OK;
  hid_t id, stored = -1, space = -1;
  char *fixed = NULL, *variable[TEXTS_MOST] = {NULL};
  *text = NULL;
  TRY(open_attribute(file, name, attribute, &id));
  stored = H5Aget_type(id);
  space = H5Aget_space(id);
  const hssize_t points = H5Sget_simple_extent_npoints(space);
  const bool refers = most > 1 && holds_references(stored);
  if ((!refers && !holds_texts(stored)) || points < 1 || points > most)
    TRY_FAIL(STATUS_INPUT, "%s: attribute %s of %s is no text", file->path, attribute, name);
  if (refers) {
    status = add_names(id, stored, space, text);
    goto cleanup;
  }
  const bool varies = H5Tis_variable_str(stored) > 0;
  const size_t width = varies ? (size_t)1 << 40 : H5Tget_size(stored);
  if (!varies) TRY(memory_allocate(&fixed, (size_t)points, width, attribute));
  if (H5Aread(id, stored, varies ? (void *)variable : fixed) < 0)
    TRY_FAIL(STATUS_INPUT, "%s: attribute %s of %s cannot be read", file->path, attribute, name);
  for (hssize_t i = 0; i < points; i++)
    TRY(add_text(varies ? variable[i] : fixed + (size_t)i * width, width, text));
cleanup:
  for (int i = 0; i < TEXTS_MOST; i++)
    if (variable[i] != NULL) H5free_memory(variable[i]);
  if (status != STATUS_OK) memory_free(text);
  memory_free(&fixed);
  if (space >= 0) H5Sclose(space);
  if (stored >= 0) H5Tclose(stored);
  if (id >= 0) H5Aclose(id);
  return status;
}

enum status h5_read_attribute_text(struct h5_file *file, const char *name, const char *attribute,
                                   char **text) {
  return read_texts(file, name, attribute, 1, text);
}

enum status h5_read_attribute_texts(struct h5_file *file, const char *name, const char *attribute,
                                    char **text) {
  return read_texts(file, name, attribute, TEXTS_MOST, text);
}
