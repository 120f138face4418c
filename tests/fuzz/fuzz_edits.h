/* A sound HDF5 file with other contents: the fuzzer's bytes are edits of a file that one of the
 * programs wrote (objects and attributes removed, put in place of others, of other types, ranks and
 * values, linked to each other and to other files). The library itself is sound on such files, so
 * that what is tested is how we read, in this process; damaged files are for fuzz_hdf5.c. */
#ifndef TOSUI_FUZZ_EDITS_H
#define TOSUI_FUZZ_EDITS_H

#include <hdf5.h>
#include <string.h>

#include "common/hdf5_probe.h"
#include "fuzz_input.h"

/* In place of the probe by a process of its own (common/hdf5_probe.c). */
enum status h5_try(const char *path) {
  (void)path;
  return STATUS_OK;
}

enum { EDIT_NAMES = 400, EDIT_NAME = 80 };

/* A base: its bytes, and the names of its objects and of their attributes. */
struct edit_base {
  uint8_t *bytes;
  size_t size;
  int objects, attributes;
  char object[EDIT_NAMES][EDIT_NAME], holder[EDIT_NAMES][EDIT_NAME],
      attribute[EDIT_NAMES][EDIT_NAME];
};

static struct edit_base *edit_noted; /* by the two visitors */
static const char *edit_holder;

static inline herr_t edit_note_attribute(hid_t id, const char *name, const H5A_info_t *info,
                                         void *unused) {
  struct edit_base *base = edit_noted;
  (void)id, (void)info, (void)unused;
  if (base->attributes < EDIT_NAMES) {
    snprintf(base->holder[base->attributes], EDIT_NAME, "%s", edit_holder);
    snprintf(base->attribute[base->attributes++], EDIT_NAME, "%s", name);
  }
  return 0;
}

static inline herr_t edit_note_object(hid_t root, const char *name, const H5O_info_t *info,
                                      void *unused) {
  struct edit_base *base = edit_noted;
  (void)info, (void)unused;
  if (base->objects < EDIT_NAMES && strlen(name) + 2 < EDIT_NAME)
    sprintf(base->object[base->objects++], "/%s", strcmp(name, ".") ? name : "");
  edit_holder = base->object[base->objects - 1];
  hid_t object = H5Oopen(root, name, H5P_DEFAULT);
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, edit_note_attribute, NULL);
  H5Oclose(object);
  return 0;
}

/* Reads the base; `cut` bytes at its end are not HDF5's. */
static inline void edit_base_read(const char *path, size_t cut, struct edit_base *base) {
  /* HDF5 keeps what it frees: each file opened takes half a megabyte, which the sanitizer would map
   * and unmap anew, a quarter of the time. */
  H5set_free_list_limits(-1, -1, -1, -1, -1, -1);
  FILE *file = fopen(path, "rb");
  if (file == NULL) abort();
  fseek(file, 0, SEEK_END);
  base->size = (size_t)ftell(file) - cut;
  rewind(file);
  base->bytes = malloc(base->size);
  if (base->bytes == NULL || fread(base->bytes, 1, base->size, file) != base->size) abort();
  fclose(file);
  hid_t id = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  edit_noted = base;
  if (id < 0 ||
      H5Ovisit2(id, H5_INDEX_NAME, H5_ITER_INC, edit_note_object, NULL, H5O_INFO_BASIC) < 0)
    abort();
  H5Fclose(id);
}

/* The fuzzer's bytes, taken one after the other; zeros behind the end. */
struct edit_bytes {
  const uint8_t *data;
  size_t size;
};
static inline unsigned edit_take(struct edit_bytes *bytes) {
  if (bytes->size == 0) return 0;
  bytes->size--;
  return *bytes->data++;
}

static inline hid_t edit_type(unsigned kind, unsigned width) {
  const hid_t numbers[] = {H5T_STD_U8LE,   H5T_STD_I32LE, H5T_STD_U64BE, H5T_IEEE_F32LE,
                           H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_B8LE,  H5T_NATIVE_HBOOL};
  hid_t type = H5Tcopy(kind % 12 < 8 ? numbers[kind % 12] : H5T_C_S1);
  if (kind % 12 == 8) H5Tset_size(type, 1 + width);
  if (kind % 12 == 9) H5Tset_size(type, H5T_VARIABLE);
  if (kind % 12 == 10) {
    H5Tclose(type);
    type = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(type, "a", 0, H5T_STD_I32LE);
  }
  if (kind % 12 == 11) {
    hsize_t two = 2;
    H5Tclose(type);
    type = H5Tarray_create2(H5T_IEEE_F64LE, 1, &two);
  }
  return type;
}

/* 0 to 4 dimensions of 0 to 15, or vast ones. */
static inline hid_t edit_space(struct edit_bytes *bytes, hsize_t *points) {
  unsigned rank = edit_take(bytes) % 6;
  hsize_t dims[5] = {0};
  *points = 1;
  if (rank == 5) return H5Screate(H5S_NULL);
  for (unsigned i = 0; i < rank; i++) {
    unsigned byte = edit_take(bytes);
    dims[i] = byte < 240 ? byte % 16 : (hsize_t)1 << (byte - 200);
    *points = dims[i] > 0 && *points > ((hsize_t)1 << 60) / dims[i] ? (hsize_t)1 << 60
                                                                    : *points * dims[i];
  }
  return rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple((int)rank, dims, NULL);
}

/* Values for `points` of `type`, of the fuzzer's bytes again and again; NULL where they are many.
 */
static inline void *edit_values(struct edit_bytes *bytes, hid_t type, hsize_t points) {
  static char word[] = "word", *words[4096];
  size_t width = H5Tget_size(type), n = points < 4096 ? (size_t)points * width : 0;
  uint8_t pattern[8], *values = n > 0 ? malloc(n) : NULL;
  if (values == NULL) return NULL;
  if (H5Tis_variable_str(type) > 0) {
    for (size_t i = 0; i < 4096; i++) words[i] = word;
    memcpy(values, words, n);
    return values;
  }
  unsigned period = 1 + edit_take(bytes) % 8;
  for (unsigned i = 0; i < period; i++) pattern[i] = (uint8_t)edit_take(bytes);
  for (size_t i = 0; i < n; i++) values[i] = pattern[i % period];
  return values;
}

static inline void edit_dataset(hid_t file, const char *name, struct edit_bytes *bytes) {
  hsize_t points, chunk[5] = {4, 4, 4, 4, 4};
  unsigned kind = edit_take(bytes), storage = edit_take(bytes);
  hid_t type = edit_type(kind, storage), space = edit_space(bytes, &points);
  hid_t layout = H5Pcreate(H5P_DATASET_CREATE), links = H5Pcreate(H5P_LINK_CREATE);
  int rank = H5Sget_simple_extent_ndims(space);
  if (points > 4096 || storage % 4 == 1) {
    if (rank > 0) H5Pset_chunk(layout, rank, chunk);
    if (storage % 8 == 1) H5Pset_deflate(layout, 1);
  } else if (storage % 16 == 2) {
    H5Pset_external(layout, "/dev/shm/elsewhere", 0, 64);
  }
  H5Pset_create_intermediate_group(links, 1);
  H5Ldelete(file, name, H5P_DEFAULT);
  hid_t set = H5Dcreate2(file, name, type, space, links, layout, H5P_DEFAULT);
  void *values = set >= 0 && storage % 16 != 2 ? edit_values(bytes, type, points) : NULL;
  if (values != NULL) H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  free(values);
  if (set >= 0) H5Dclose(set);
  H5Pclose(links);
  H5Pclose(layout);
  H5Sclose(space);
  H5Tclose(type);
}

static inline void edit_attribute(hid_t file, const char *holder, const char *name,
                                  struct edit_bytes *bytes) {
  hsize_t points;
  unsigned kind = edit_take(bytes);
  hid_t object = H5Oopen(file, holder, H5P_DEFAULT);
  if (object < 0) return;
  hid_t type = edit_type(kind, kind / 12), space = edit_space(bytes, &points);
  H5Adelete(object, name);
  hid_t id = points > 4096 ? -1 : H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  void *values = id >= 0 ? edit_values(bytes, type, points) : NULL;
  if (values != NULL) H5Awrite(id, type, values);
  free(values);
  if (id >= 0) H5Aclose(id);
  H5Sclose(space);
  H5Tclose(type);
  H5Oclose(object);
}

/* Other values in a dataset that stays. */
static inline void edit_overwrite(hid_t file, const char *name, struct edit_bytes *bytes) {
  hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  if (set < 0) return;
  hid_t type = H5Dget_type(set), space = H5Dget_space(set);
  hssize_t points = H5Sget_simple_extent_npoints(space);
  void *values = points > 0 ? edit_values(bytes, type, (hsize_t)points) : NULL;
  if (values != NULL) H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  free(values);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
}

static inline void edit_once(hid_t file, const struct edit_base *base, struct edit_bytes *bytes) {
  unsigned what = edit_take(bytes) % 9, n = edit_take(bytes) << 8 | edit_take(bytes);
  const char *object = base->object[n % (unsigned)base->objects];
  const char *holder = base->holder[n % (unsigned)base->attributes];
  const char *attribute = base->attribute[n % (unsigned)base->attributes];
  switch (what) {
  case 0:
    H5Ldelete(file, object, H5P_DEFAULT);
    break;
  case 1:
    edit_dataset(file, object, bytes);
    break;
  case 2:
    H5Adelete_by_name(file, holder, attribute, H5P_DEFAULT);
    break;
  case 3:
  case 4:
    edit_attribute(file, holder, attribute, bytes);
    break;
  case 5:
    edit_overwrite(file, object, bytes);
    break;
  case 6:
    H5Ldelete(file, object, H5P_DEFAULT);
    H5Lcreate_soft(base->object[edit_take(bytes) % (unsigned)base->objects], file, object,
                   H5P_DEFAULT, H5P_DEFAULT);
    break;
  case 7:
    H5Ldelete(file, object, H5P_DEFAULT);
    H5Lcreate_external("elsewhere.hdf", "/", file, object, H5P_DEFAULT, H5P_DEFAULT);
    break;
  default:
    H5Lmove(file, object, file, base->object[edit_take(bytes) % (unsigned)base->objects],
            H5P_DEFAULT, H5P_DEFAULT);
  }
}

/* The base with the edits, as a file whose name ends in `ending`. */
static inline const char *edit_file(const struct edit_base *base, const char *ending,
                                    const uint8_t *data, size_t size) {
  struct edit_bytes bytes = {data, size};
  const char *path = fuzz_file(ending, base->bytes, base->size);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  if (file < 0) abort();
  for (int i = 0; i < 16 && bytes.size > 0; i++) edit_once(file, base, &bytes);
  H5Fclose(file);
  return path;
}

#endif
