/* Which arrays a file holds, in whatever group. */
#include <stdlib.h>
#include <string.h>

#include "common/hdf5_store.h"
#include "common/memory.h"

struct found {
  size_t count, room;
  char **names;
  enum status status;
};

/* Whether an object is an array of numbers with more than one of them along two axes or more. */
static bool is_array(hid_t root, const char *name) {
  hsize_t extent[H5S_MAX_RANK];
  hid_t set = H5Dopen2(root, name, H5P_DEFAULT);
  hid_t space = H5Dget_space(set), stored = H5Dget_type(set);
  const int rank = H5Sget_simple_extent_dims(space, extent, NULL);
  const H5T_class_t class = H5Tget_class(stored);
  int long_axes = 0;
  for (int i = 0; i < rank; i++) long_axes += extent[i] > 1;
  H5Tclose(stored);
  H5Sclose(space);
  H5Dclose(set);
  return long_axes >= 2 && (class == H5T_INTEGER || class == H5T_FLOAT || class == H5T_ENUM);
}

static herr_t add_array(hid_t root, const char *name, const H5O_info_t *info, void *to) {
  struct found *found = to;
  if (info->type != H5O_TYPE_DATASET || !is_array(root, name)) return 0;
  if (found->count == found->room) {
    const size_t room = found->room > 0 ? 2 * found->room : 8;
    found->status = memory_resize(&found->names, room, sizeof *found->names, "names of datasets");
    if (found->status != STATUS_OK) return 1;
    found->room = room;
  }
  char **at = &found->names[found->count];
  found->status = memory_allocate(at, strlen(name) + 2, 1, "the name of a dataset");
  if (found->status != STATUS_OK) return 1;
  (*at)[0] = '/';
  strcpy(*at + 1, name);
  found->count++;
  return 0;
}

enum status h5_list_arrays(struct h5_file *file, size_t *count, char ***names) {
  struct found found = {0, 0, NULL, STATUS_OK};
  *count = 0;
  *names = NULL;
  if (H5Ovisit2(file->id, H5_INDEX_NAME, H5_ITER_INC, add_array, &found, H5O_INFO_BASIC) < 0)
    found.status = FAIL(STATUS_INPUT, "%s: cannot be listed", file->path);
  if (found.status != STATUS_OK) {
    h5_free_texts(found.count, &found.names);
    return found.status;
  }
  *count = found.count;
  *names = found.names;
  return STATUS_OK;
}

bool h5_is_partial(struct h5_file *file, const char *name) {
  hsize_t extent[H5S_MAX_RANK], chunk[H5S_MAX_RANK], there = 0;
  double wanted = 1.0;
  hid_t set = H5Dopen2(file->id, name, H5P_DEFAULT);
  hid_t space = H5Dget_space(set), layout = H5Dget_create_plist(set);
  const int rank = H5Sget_simple_extent_dims(space, extent, NULL);
  bool partial = false;
  if (H5Pget_layout(layout) == H5D_CHUNKED) {
    if (H5Pget_chunk(layout, rank, chunk) == rank && H5Dget_num_chunks(set, space, &there) >= 0) {
      for (int i = 0; i < rank; i++) wanted *= (double)((extent[i] + chunk[i] - 1) / chunk[i]);
      partial = (double)there < wanted;
    }
  } else if (H5Pget_layout(layout) == H5D_CONTIGUOUS) {
    partial = H5Dget_storage_size(set) == 0;
  }
  H5Pclose(layout);
  H5Sclose(space);
  H5Dclose(set);
  return partial;
}
