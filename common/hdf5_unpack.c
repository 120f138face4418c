/* Datasets as h5_dataset_layout makes them, read by several threads: HDF5 itself unpacks one chunk
 * after the other. */
#include <omp.h>
#include <string.h>
#include <zlib.h>

#include "common/hdf5_internal.h"
#include "common/memory.h"

/* Chunks on their way take no more than this part of what is read, twice. */
#define SHARE_UNDER_WAY 16

struct parts {
  size_t item, components;    /* bytes of a number; numbers apart that lie together in memory */
  size_t row;                 /* bytes of one step along the axis that is cut */
  size_t length, step, count; /* of that axis, of a chunk along it, chunks along it */
  size_t chunks, bytes;       /* all of them; of one, unpacked */
  int axis;
};

struct unpacked {
  unsigned char *packed, *shuffled;
  size_t size; /* packed */
  uint32_t skipped;
};

/* Numbers as in memory, chunks that are runs of memory or of one component there, a shuffle and a
 * deflate: all else is left to HDF5. */
static bool is_simple(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                      struct parts *parts) {
  hsize_t chunk[H5S_MAX_RANK] = {0};
  const hid_t list = H5Dget_create_plist(set);
  bool simple = H5Tequal(stored, h5_memory_type(type)) > 0 && rank > 0 &&
                H5Pget_layout(list) == H5D_CHUNKED &&
                H5Pget_chunk(list, H5S_MAX_RANK, chunk) == rank && H5Pget_nfilters(list) == 2;
  for (unsigned i = 0; i < 2 && simple; i++) {
    unsigned flags, config;
    size_t none = 0;
    simple = H5Pget_filter2(list, i, &flags, &none, NULL, 0, NULL, &config) ==
             (i == 0 ? H5Z_FILTER_SHUFFLE : H5Z_FILTER_DEFLATE);
  }
  H5Pclose(list);
  const int axes = simple ? h5_chunk_axes(rank, dims, chunk) : 0;
  *parts = (struct parts){.item = h5_type_size(type), .row = h5_type_size(type), .chunks = 1};
  parts->components = axes < rank ? dims[rank - 1] : 1;
  for (int i = 0; i < axes; i++)
    if (chunk[i] < dims[i]) parts->axis = i;
  for (int i = 0; i < rank && simple; i++) {
    simple =
        dims[i] > 0 && chunk[i] > 0 && chunk[i] <= dims[i] && (i >= parts->axis || chunk[i] == 1);
    if (i < parts->axis) parts->chunks *= dims[i];
    if (i > parts->axis) parts->row *= dims[i];
  }
  if (!simple) return false;
  parts->length = dims[parts->axis];
  parts->step = chunk[parts->axis];
  parts->count = (parts->length + parts->step - 1) / parts->step;
  parts->chunks *= parts->count * parts->components;
  parts->bytes = parts->step * parts->row / parts->components;
  return true;
}

/* False where the file holds no such chunk. */
static bool take(hid_t set, const struct parts *parts, int rank, const size_t *dims, size_t chunk,
                 size_t room, struct unpacked *into) {
  hsize_t at[H5S_MAX_RANK] = {0}, size = 0;
  size_t before = chunk / parts->components;
  if (parts->components > 1) at[rank - 1] = chunk % parts->components;
  at[parts->axis] = before % parts->count * parts->step;
  before /= parts->count;
  for (int d = parts->axis; d-- > 0; before /= dims[d]) at[d] = before % dims[d];
  if (H5Dget_chunk_storage_size(set, at, &size) < 0 || size == 0 || size > room) return false;
  into->size = (size_t)size;
  return H5Dread_chunk(set, H5P_DEFAULT, at, &into->skipped, into->packed) >= 0 &&
         into->skipped == 0;
}

/* Numbers from their bytes, which lie n apart, each `step` bytes after the one before. */
static inline void spread(size_t item, const unsigned char *in, size_t n, size_t count, size_t step,
                          char *to) {
  if (step == item && item != 4) {
    for (size_t k = 0; k < item; k++)
      for (size_t i = 0; i < count; i++) to[i * item + k] = (char)in[k * n + i];
    return;
  }
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < item; k++) to[i * step + k] = (char)in[k * n + i];
}

static bool unpack(const struct parts *parts, size_t chunk, struct unpacked *from, char *data) {
  const size_t component = chunk % parts->components, at = chunk / parts->components;
  const size_t first = at % parts->count * parts->step, left = parts->length - first;
  const size_t item = parts->item, n = parts->bytes / item, step = item * parts->components;
  const size_t count = (left < parts->step ? left : parts->step) * parts->row / step;
  char *to = data + (at / parts->count * parts->length + first) * parts->row + component * item;
  uLong size = parts->bytes;
  if (uncompress(from->shuffled, &size, from->packed, from->size) != Z_OK || size != parts->bytes)
    return false;
  if (step == 1)
    memcpy(to, from->shuffled, count);
  else if (item == 4)
    spread(4, from->shuffled, n, count, step, to);
  else if (item == 8)
    spread(8, from->shuffled, n, count, step, to);
  else
    spread(item, from->shuffled, n, count, step, to);
  return true;
}

enum status h5_read_chunks(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                           void *data, bool *done) {
  enum status status = STATUS_OK;
  size_t batch = 2 * (size_t)omp_get_max_threads(), made = 0;
  struct parts parts;
  struct unpacked *chunks = NULL;
  *done = false;
  if (!is_simple(set, stored, type, rank, dims, &parts)) return STATUS_OK;
  if (batch > parts.chunks / SHARE_UNDER_WAY) batch = parts.chunks / SHARE_UNDER_WAY;
  if (batch < 2) return STATUS_OK;
  const size_t room = compressBound(parts.bytes);
  TRY(memory_allocate(&chunks, batch, sizeof *chunks, "chunks"));
  for (; made < batch; made++) {
    TRY(memory_allocate(&chunks[made].packed, room + parts.bytes, 1, "chunks"));
    chunks[made].shuffled = chunks[made].packed + room;
  }
  bool good = true;
  for (size_t first = 0; first < parts.chunks && good; first += batch) {
    const size_t n = parts.chunks - first < batch ? parts.chunks - first : batch;
    for (size_t i = 0; i < n && good; i++)
      good = take(set, &parts, rank, dims, first + i, room, &chunks[i]);
    if (!good) break;
#pragma omp parallel for schedule(dynamic) reduction(&& : good)
    for (size_t i = 0; i < n; i++) good = unpack(&parts, first + i, &chunks[i], data) && good;
  }
  *done = good;
cleanup:
  for (size_t i = 0; i < made; i++) memory_free(&chunks[i].packed);
  memory_free(&chunks);
  return status;
}
