/* One dataset written or read by all ranks. Only here do all ranks open a file for writing;
 * otherwise the first rank alone does, so that the layout of a file does not depend on the number
 * of ranks. */
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "common/hdf5_store.h"
#include "common/memory.h"
#include "common/node_memory.h"
#include "common/output_file.h"
#include "common/ranks.h"

#ifndef TOSUI_MPI
enum status h5_write_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                          const size_t *dims, const void *data, bool compress) {
  return h5_write(file, name, type, rank, dims, data, compress);
}
enum status h5_read_together(struct h5_file *file, const char *name, enum h5_type type, int rank,
                             size_t *dims, void *data) {
  return h5_read(file, name, type, rank, dims, data);
}

#else
/* Reads the rows [start[own], start[own + 1]) of this rank; fills `start`. */
static enum status read_own_rows(struct h5_file *file, const char *name, enum h5_type type,
                                 int rank, size_t *dims, size_t *start, size_t *row_bytes,
                                 char **data) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  size_t shape[H5S_MAX_RANK], share[H5S_MAX_RANK], all, row = h5_type_size(type);
  int found;
  TRY(h5_shape(file, name, H5S_MAX_RANK, &found, shape));
  if (found != rank)
    TRY_FAIL(STATUS_INPUT, "%s: %s has %d dimensions, %d are wanted", file->path, name, found,
             rank);
  memcpy(dims, shape, (size_t)rank * sizeof *dims);
  for (size_t r = 0; r <= ranks; r++) start[r] = dims[0] / ranks * r + dims[0] % ranks * r / ranks;
  share[0] = start[own + 1] - start[own];
  TRY(h5_read_rows(file, name, type, rank, dims[0], start[own], share, data));
  for (int i = 1; i < rank; i++)
    if (!size_multiply(row, dims[i], &row)) row = 0;
  if (row == 0 || !size_multiply(row, dims[0], &all))
    TRY_FAIL(STATUS_INPUT, "%s: %s claims an impossible size", file->path, name);
  *row_bytes = row;
cleanup:
  return status;
}

enum status h5_read_together(struct h5_file *file, const char *name, enum h5_type type, int rank,
                             size_t *dims, void *data) {
  enum status status = STATUS_OK;
  size_t *start = NULL, row = 0;
  char *values = NULL, *share = NULL;
  if (ranks_count() == 1) return h5_read(file, name, type, rank, dims, data);
  TRY(memory_allocate(&start, (size_t)ranks_count() + 1, sizeof *start, name));
  TRY(ranks_agree(read_own_rows(file, name, type, rank, dims, start, &row, &share)));
  TRY(node_allocate(&values, dims[0], row, name));
  const size_t own = (size_t)ranks_own();
  if (start[own + 1] > start[own])
    memcpy(values + start[own] * row, share, (start[own + 1] - start[own]) * row);
  memory_free(&share);
  node_share(values, start, row);
  memcpy(data, &values, sizeof values);
  values = NULL;
cleanup:
  MEMORY_FREE(&values, &share, &start);
  return status;
}

static hid_t open_together(const char *path) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110);
  H5Pset_fapl_mpio(access, MPI_COMM_WORLD, MPI_INFO_NULL);
  hid_t file = H5Fopen(path, H5F_ACC_RDWR, access);
  H5Pclose(access);
  return file;
}

static hid_t open_alone(const char *path) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110);
  hid_t file = H5Fopen(path, H5F_ACC_RDWR, access);
  H5Pclose(access);
  return file;
}

static bool write_rows(hid_t set, hid_t whole, enum h5_type type, int rank, const hsize_t *start,
                       const hsize_t *extent, const void *data) {
  const char none = 0;
  hid_t own = H5Screate_simple(rank, extent, NULL), transfer = H5Pcreate(H5P_DATASET_XFER);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  if (extent[0] > 0) {
    H5Sselect_hyperslab(whole, H5S_SELECT_SET, start, NULL, extent, NULL);
  } else {
    H5Sselect_none(whole);
    H5Sselect_none(own);
    data = &none;
  }
  herr_t failed = H5Dwrite(set, h5_memory_type(type), own, whole, transfer, data);
  H5Pclose(transfer);
  H5Sclose(own);
  return failed >= 0;
}

enum status h5_write_rows(struct h5_file *file, const char *name, enum h5_type type, int rank,
                          const size_t *dims, const void *data, bool compress) {
  enum status status = STATUS_OK;
  hsize_t start[H5S_MAX_RANK] = {0}, extent[H5S_MAX_RANK], full[H5S_MAX_RANK];
  size_t total, whole_dims[H5S_MAX_RANK];
  hid_t together = -1, set = -1, layout = -1, whole = -1;
  if (ranks_count() == 1) return h5_write(file, name, type, rank, dims, data, compress);
  start[0] = ranks_offset(dims[0], &total);
  for (int i = 0; i < rank; i++) {
    whole_dims[i] = i == 0 ? total : dims[i];
    full[i] = whole_dims[i];
    extent[i] = dims[i];
  }
  if (total == 0) return h5_write(file, name, type, rank, whole_dims, data, compress);
  if (ranks_own() == 0) {
    status = h5_make_groups(file, name, false);
    if (H5Fclose(file->id) < 0 && status == STATUS_OK)
      status = FAIL(STATUS_RUN, "%s: cannot be written; is the disk full?", file->path);
    file->id = -1;
  }
  TRY(ranks_agree(status));
  together = open_together(file->part);
  if (together < 0) status = FAIL(STATUS_RUN, "%s: cannot be opened by all ranks", file->path);
  TRY(ranks_agree(status));
  layout = h5_dataset_layout(type, rank, whole_dims, compress);
  whole = H5Screate_simple(rank, full, NULL);
  set = H5Dcreate2(together, name, h5_disk_type(type), whole, H5P_DEFAULT, layout, H5P_DEFAULT);
  /* Either all ranks write or none does: a single rank would wait forever. */
  bool ready = set >= 0 && !output_fails();
  if (!ranks_any(!ready)) ready = write_rows(set, whole, type, rank, start, extent, data);
  if (!ready)
    status = FAIL(STATUS_RUN, "%s: %s cannot be written; is the disk full?", file->path, name);
  /* HDF5 would flush what is left and wait for a rank whose write fails: the run ends, and the file
   * stays open. */
  if (ranks_any(!ready)) set = together = -1;
cleanup:
  if (set >= 0) H5Dclose(set);
  if (whole >= 0) H5Sclose(whole);
  if (layout >= 0) H5Pclose(layout);
  if (together >= 0 && H5Fclose(together) < 0 && status == STATUS_OK)
    status = FAIL(STATUS_RUN, "%s: %s cannot be written; is the disk full?", file->path, name);
  status = ranks_agree(status);
  if (ranks_own() == 0 && status == STATUS_OK) {
    file->id = open_alone(file->part);
    if (file->id < 0) status = FAIL(STATUS_RUN, "%s: cannot be opened again", file->path);
  }
  if (ranks_own() == 0 && status != STATUS_OK) unlink(file->part);
  return status;
}
#endif
