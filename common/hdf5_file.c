#include "common/hdf5_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/hdf5_chunks.h"
#include "common/hdf5_probe.h"
#include "common/hdf5_store.h"
#include "common/interrupt.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/ranks.h"

const char *h5_path(const struct h5_file *file) {
  return file->path;
}

static enum status new_file(const char *path, bool writing, struct h5_file **result) {
  enum status status = STATUS_OK;
  struct h5_file *file;
  char target[OUTPUT_NAME_MAX];
  /* The exit handler of HDF5 1.10 crashes if a file could not be flushed (full disk). All files are
   * closed explicitly, so it is not needed. Only the first call has an effect. */
  H5dont_atexit();
  /* The error stack of the library is of no use to users; our message names the file and the
   * object. */
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  if (writing) {
    TRY(output_follow(path, target));
    path = target;
  }
  const size_t length = strlen(path);
  TRY(memory_allocate(&file, 1, sizeof *file, "a file handle"));
  *result = file;
  file->id = -1;
  file->writing = writing;
  TRY(memory_allocate(&file->path, length + 1, 1, "a path"));
  memcpy(file->path, path, length);
  TRY(memory_allocate(&file->part, length + 6, 1, "a path"));
  sprintf(file->part, "%s.part", path);
cleanup:
  return status;
}

/* Whether this rank does not write: everything but h5_write_rows is written by the first rank. */
static bool idle(void) {
  return ranks_own() > 0;
}

enum status h5_create(const char *path, struct h5_file **result) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  hid_t access = -1, creation = -1;
  TRY(new_file(path, true, &file));
  if (idle()) goto cleanup;
  access = H5Pcreate(H5P_FILE_ACCESS);
  creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110);
  /* Object times would make files of equal runs differ. */
  H5Pset_obj_track_times(creation, 0);
  errno = 0;
  file->id = output_fails() ? -1 : H5Fcreate(file->part, H5F_ACC_TRUNC, creation, access);
  if (file->id < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) /* the library locks it */
    TRY_FAIL(STATUS_RUN,
             "%s: another program is writing it (%s is locked); give another name with -o, or wait "
             "for its end",
             path, file->part);
  if (file->id < 0) {
    const char *why = strerror(errno ? errno : EACCES);
    unlink(file->part); /* of which not even the first bytes could be written */
    TRY_FAIL(STATUS_RUN, "%s: cannot be written (%s)", path, why);
  }
cleanup:
  if (access >= 0) H5Pclose(access);
  if (creation >= 0) H5Pclose(creation);
  if (status != STATUS_OK) {
    h5_close(file);
    file = NULL;
  }
  *result = file;
  return status;
}

/* Hint at the file that was probably meant: the same name with the ending that the programs add. */
#define HINT (OUTPUT_NAME_MAX + 20)
static const char *hint_at(const char *path, char text[HINT]) {
  size_t length = strlen(path);
  while (length > 1 && path[length - 1] == '/') length--;
  if (length + 5 > OUTPUT_NAME_MAX) return "";
  const int start = snprintf(text, HINT, "; ");
  snprintf(text + start, HINT - (size_t)start, "%.*s.hdf", (int)length, path);
  if (access(text + start, R_OK) != 0) return "";
  strcat(text, " is there");
  return text;
}

static enum status open_file(const char *path, bool try_first, struct h5_file **result) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct stat info;
  char hint[HINT];
  TRY(new_file(path, false, &file));
  if (*path == '\0') TRY_FAIL(STATUS_INPUT, "'': the name of a file is wanted");
  if (access(path, R_OK) != 0 || stat(path, &info) != 0) {
    const char *why = strerror(errno);
    TRY_FAIL(STATUS_INPUT, "%s: %s%s", path, why, hint_at(path, hint));
  }
  if (!S_ISREG(info.st_mode)) TRY_FAIL(STATUS_INPUT, "%s: is no file%s", path, hint_at(path, hint));
  if (try_first && !idle()) TRY(h5_try(path));
  file->id = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file->id < 0)
    TRY_FAIL(STATUS_INPUT, "%s: is no HDF5 file, or is damaged; make or copy it anew", path);
cleanup:
  if (status != STATUS_OK) {
    h5_close(file);
    file = NULL;
  }
  *result = file;
  return status;
}

enum status h5_open(const char *path, struct h5_file **file) {
  enum status status = open_file(path, true, file);
  if (status == STATUS_OK) output_protect(path);
  return status;
}
enum status h5_open_output(const char *path, struct h5_file **file) {
  return open_file(path, true, file);
}
enum status h5_open_sealed(const char *path, struct h5_file **file) {
  return open_file(path, false, file);
}

void h5_close(struct h5_file *file) {
  if (file == NULL) return;
  if (file->id >= 0) {
    H5Fclose(file->id);
    if (file->writing) unlink(file->part);
  }
  MEMORY_FREE(&file->path, &file->part, &file);
}

static enum status sync_path(const char *path, int flags) {
  int descriptor = open(path, flags);
  if (descriptor < 0) return FAIL(STATUS_RUN, "%s: %s", path, strerror(errno));
  const bool synced = output_sync(descriptor);
  close(descriptor);
  return !synced ? FAIL(STATUS_RUN, "%s: %s", path, strerror(errno)) : STATUS_OK;
}

enum status h5_commit(struct h5_file *file) {
  enum status status = STATUS_OK;
  hid_t id = file->id;
  file->id = -1;
  if (idle()) goto cleanup;
  if (H5Fclose(id) < 0 || output_fails())
    TRY_FAIL(STATUS_RUN, "%s: cannot be written to the end; is the disk full?", file->path);
  TRY(sync_path(file->part, O_RDONLY));
  TRY(output_rename(file->part, file->path));
cleanup:
  if (status != STATUS_OK) unlink(file->part);
  h5_close(file);
  return ranks_agree(status);
}

/* Byte order of this machine; files are written little-endian. */
static bool is_little_endian(void) {
  const uint16_t one = 1;
  uint8_t first;
  memcpy(&first, &one, 1);
  return first == 1;
}

enum status h5_write(struct h5_file *file, const char *name, enum h5_type type, int rank,
                     const size_t *dims, const void *data, bool compress) {
  enum status status = STATUS_OK;
  hsize_t extent[H5S_MAX_RANK];
  bool empty = false;
  for (int i = 0; i < rank; i++) {
    extent[i] = dims[i];
    empty = empty || dims[i] == 0;
  }
  if (idle()) return STATUS_OK;
  if (h5_leaves_on_signal()) status = interrupt_look();
  if (status == STATUS_OK) status = h5_make_groups(file, name, false);
  if (status != STATUS_OK) return status;
  hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, extent, NULL);
  hid_t layout =
      empty ? H5Pcreate(H5P_DATASET_CREATE) : h5_dataset_layout(type, rank, dims, compress);
  hid_t set =
      H5Dcreate2(file->id, name, h5_disk_type(type), space, H5P_DEFAULT, layout, H5P_DEFAULT);
  hsize_t chunk[H5S_MAX_RANK];
  bool written = set >= 0 && !output_fails();
  if (written && H5Pget_layout(layout) == H5D_CHUNKED && is_little_endian() &&
      H5Pget_chunk(layout, rank, chunk) == rank)
    status = h5_write_chunks(set, type, rank, dims, chunk, data, &written);
  else if (written && !empty)
    written = H5Dwrite(set, h5_memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
  if (status == STATUS_OK && !written)
    status = FAIL(STATUS_RUN, "%s: %s cannot be written; is the disk full?", file->path, name);
  if (set >= 0 && H5Dclose(set) < 0 && status == STATUS_OK)
    status = FAIL(STATUS_RUN, "%s: %s cannot be written; is the disk full?", file->path, name);
  H5Pclose(layout);
  H5Sclose(space);
  return status;
}

/* Writes strings of fixed length, padded with zeros. Strings of variable length are stored in a
 * heap, on some damaged forms of which the reader of HDF5 1.10 never returns. Closes `space`. */
static enum status write_strings(struct h5_file *file, const char *name, hid_t space, size_t count,
                                 const char *const *texts) {
  enum status status = STATUS_OK;
  size_t width = 1;
  char *padded = NULL;
  hid_t set = -1, type = H5Tcopy(H5T_C_S1), layout = H5Pcreate(H5P_DATASET_CREATE);
  if (idle()) goto cleanup;
  for (size_t i = 0; i < count; i++)
    if (strlen(texts[i]) > width) width = strlen(texts[i]);
  TRY(h5_make_groups(file, name, false));
  TRY(memory_allocate(&padded, count, width, name));
  for (size_t i = 0; i < count; i++) memcpy(padded + i * width, texts[i], strlen(texts[i]));
  H5Tset_size(type, width);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  H5Pset_obj_track_times(layout, 0);
  set = H5Dcreate2(file->id, name, type, space, H5P_DEFAULT, layout, H5P_DEFAULT);
  if (set < 0 || output_fails() ||
      (count > 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded) < 0))
    status = FAIL(STATUS_RUN, "%s: %s cannot be written; is the disk full?", file->path, name);
cleanup:
  if (set >= 0) H5Dclose(set);
  H5Pclose(layout);
  H5Tclose(type);
  H5Sclose(space);
  memory_free(&padded);
  return status;
}

enum status h5_write_text(struct h5_file *file, const char *name, const char *text) {
  return write_strings(file, name, H5Screate(H5S_SCALAR), 1, &text);
}

enum status h5_write_texts(struct h5_file *file, const char *name, size_t count,
                           const char *const *texts) {
  hsize_t extent = count;
  return write_strings(file, name, H5Screate_simple(1, &extent, NULL), count, texts);
}

enum status h5_make_group(struct h5_file *file, const char *name) {
  return idle() ? STATUS_OK : h5_make_groups(file, name, true);
}

enum status h5_soft_link(struct h5_file *file, const char *target, const char *name) {
  if (idle()) return STATUS_OK;
  enum status status = h5_make_groups(file, name, false);
  if (status != STATUS_OK) return status;
  herr_t failed =
      output_fails() ? -1 : H5Lcreate_soft(target, file->id, name, H5P_DEFAULT, H5P_DEFAULT);
  return failed < 0 ? FAIL(STATUS_RUN, "%s: link %s cannot be made", file->path, name) : STATUS_OK;
}

static enum status write_attribute(struct h5_file *file, const char *name, const char *attribute,
                                   hid_t on_disk, hid_t in_memory, hid_t space, const void *data) {
  enum status status = STATUS_OK;
  if (idle()) {
    H5Sclose(space);
    return STATUS_OK;
  }
  hid_t object = H5Oopen(file->id, name, H5P_DEFAULT);
  if (object >= 0 && H5Aexists(object, attribute) > 0) H5Adelete(object, attribute);
  hid_t id =
      object < 0 ? -1 : H5Acreate2(object, attribute, on_disk, space, H5P_DEFAULT, H5P_DEFAULT);
  if (id < 0 || output_fails() || H5Awrite(id, in_memory, data) < 0)
    status =
        FAIL(STATUS_RUN, "%s: attribute %s of %s cannot be written", file->path, attribute, name);
  if (id >= 0) H5Aclose(id);
  if (object >= 0) H5Oclose(object);
  H5Sclose(space);
  return status;
}

enum status h5_write_attribute(struct h5_file *file, const char *name, const char *attribute,
                               enum h5_type type, size_t count, const void *data) {
  hsize_t extent = count;
  hid_t space = count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &extent, NULL);
  return write_attribute(file, name, attribute, h5_disk_type(type), h5_memory_type(type), space,
                         data);
}

enum status h5_write_numbers(struct h5_file *file, const char *object, size_t n,
                             const struct h5_number *numbers) {
  enum status status = STATUS_OK;
  for (const struct h5_number *k = numbers; k < numbers + n; k++)
    TRY(h5_write_attribute(file, object, k->name, k->type, k->count, k->at));
cleanup:
  return status;
}

enum status h5_write_attribute_text(struct h5_file *file, const char *name, const char *attribute,
                                    const char *text) {
  hid_t type = H5Tcopy(H5T_C_S1);
  size_t length = strlen(text);
  H5Tset_size(type, length > 0 ? length : 1);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  enum status status =
      write_attribute(file, name, attribute, type, type, H5Screate(H5S_SCALAR), text);
  H5Tclose(type);
  return status;
}
