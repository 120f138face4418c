#include "common/hdf5_store.h"

#include <string.h>

#include "common/output_file.h"

hid_t h5_memory_type(enum h5_type type) {
  const hid_t types[] = {
      [H5_U8] = H5T_NATIVE_UINT8,  [H5_I32] = H5T_NATIVE_INT32,  [H5_U32] = H5T_NATIVE_UINT32,
      [H5_I64] = H5T_NATIVE_INT64, [H5_U64] = H5T_NATIVE_UINT64, [H5_F32] = H5T_NATIVE_FLOAT,
      [H5_F64] = H5T_NATIVE_DOUBLE};
  return types[type];
}

hid_t h5_disk_type(enum h5_type type) {
  const hid_t types[] = {
      [H5_U8] = H5T_STD_U8LE,   [H5_I32] = H5T_STD_I32LE, [H5_U32] = H5T_STD_U32LE,
      [H5_I64] = H5T_STD_I64LE, [H5_U64] = H5T_STD_U64LE, [H5_F32] = H5T_IEEE_F32LE,
      [H5_F64] = H5T_IEEE_F64LE};
  return types[type];
}

size_t h5_type_size(enum h5_type type) {
  return H5Tget_size(h5_memory_type(type));
}
#define CHUNK_BYTES ((size_t)1 << 20)

int h5_chunk_axes(int rank, const size_t *dims, const hsize_t *chunk) {
  return rank > 1 && chunk[rank - 1] == 1 && dims[rank - 1] > 1 ? rank - 1 : rank;
}

hid_t h5_dataset_layout(enum h5_type type, int rank, const size_t *dims, bool compress) {
  hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(list, 0);
  size_t total = h5_type_size(type);
  for (int i = 0; i < rank; i++) total *= dims[i];
  if (!compress || rank == 0 || total < 4096) return list;
  hsize_t chunk[H5S_MAX_RANK];
  size_t below = h5_type_size(type);
  const bool parted = type == H5_F64 && rank > 1 && dims[rank - 1] == 3 && total > CHUNK_BYTES;
  if (parted) chunk[rank - 1] = 1;
  for (int i = parted ? rank - 1 : rank; i-- > 0;) {
    size_t room = CHUNK_BYTES / below;
    chunk[i] = dims[i] < room ? dims[i] : room > 0 ? room : 1;
    below *= chunk[i];
  }
  H5Pset_chunk(list, rank, chunk);
  H5Pset_shuffle(list);
  H5Pset_deflate(list, H5_DEFLATE);
  return list;
}

/* Only filters of HDF5 itself are allowed, each once: a file must not make the library load a
 * plug-in, nor inflate what it has inflated. */
bool h5_filters_known(hid_t set) {
  hid_t layout = H5Dget_create_plist(set);
  bool known = true;
  int n = H5Pget_nfilters(layout), deflated = 0;
  for (int i = 0; i < n; i++) {
    unsigned flags;
    size_t values = 0;
    H5Z_filter_t filter = H5Pget_filter2(layout, (unsigned)i, &flags, &values, NULL, 0, NULL, NULL);
    known = known && (filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE ||
                      filter == H5Z_FILTER_FLETCHER32);
    deflated += filter == H5Z_FILTER_DEFLATE;
  }
  known = known && deflated <= 1 && H5Pget_external_count(layout) == 0 &&
          H5Pget_layout(layout) != H5D_VIRTUAL;
  H5Pclose(layout);
  return known;
}

enum status h5_make_groups(struct h5_file *file, const char *name, bool last) {
  enum status status = STATUS_OK;
  char path[512];
  size_t length = strlen(name);
  hid_t creation = H5Pcreate(H5P_GROUP_CREATE);
  H5Pset_obj_track_times(creation, 0);
  if (length >= sizeof path) TRY_FAIL(STATUS_RUN, "%s: the name %s is too long", file->path, name);
  memcpy(path, name, length + 1);
  for (size_t i = 1; i <= length; i++) {
    if (path[i] != '/' && !(path[i] == '\0' && last)) continue;
    char kept = path[i];
    path[i] = '\0';
    if (H5Lexists(file->id, path, H5P_DEFAULT) <= 0) {
      hid_t group =
          output_fails() ? -1 : H5Gcreate2(file->id, path, H5P_DEFAULT, creation, H5P_DEFAULT);
      if (group < 0)
        TRY_FAIL(STATUS_RUN, "%s: group %s cannot be made; is the disk full?", file->path, path);
      H5Gclose(group);
    }
    path[i] = kept;
  }
cleanup:
  H5Pclose(creation);
  return status;
}

static bool leaves;
void h5_leave_on_signal(bool leave) {
  leaves = leave;
}
bool h5_leaves_on_signal(void) {
  return leaves;
}
