/* Reads datasets with the layout of h5_dataset_layout by several threads, as HDF5 itself
 * decompresses one chunk after the other. */
#include "common/hdf5_unpack.h"

#include <limits.h>
#include <omp.h>
#include <string.h>
#include <zlib.h>

#include "common/memory.h"

/* At most 1 / BATCH_DIVISOR of the chunks is decompressed at a time, each with two buffers. */
#define BATCH_DIVISOR 16

struct layout {
  /* Bytes of a number; components that are stored in chunks of their own. */
  size_t item, components;
  size_t row; /* bytes of one step along the axis that is cut */
  /* Steps along that axis: of the dataset, of a chunk; number of chunks along it. */
  size_t length, step, count;
  size_t chunks, bytes; /* chunks of the dataset; bytes of a chunk, decompressed */
  int axis;
};

struct unpacked {
  unsigned char *packed, *shuffled;
  size_t size; /* compressed */
  uint32_t skipped;
};

/* Whether a dataset has numbers of the type in memory, contiguous chunks (or components in chunks
 * of their own), and the filters shuffle and deflate. All others are left to HDF5. */
static bool has_own_layout(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                           struct layout *layout) {
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
  *layout = (struct layout){.item = h5_type_size(type), .row = h5_type_size(type), .chunks = 1};
  layout->components = axes < rank ? dims[rank - 1] : 1;
  for (int i = 0; i < axes; i++)
    if (chunk[i] < dims[i]) layout->axis = i;
  for (int i = 0; i < rank && simple; i++) {
    simple =
        dims[i] > 0 && chunk[i] > 0 && chunk[i] <= dims[i] && (i >= layout->axis || chunk[i] == 1);
    if (i < layout->axis) layout->chunks *= dims[i];
    if (i > layout->axis) layout->row *= dims[i];
  }
  if (!simple) return false;
  layout->length = dims[layout->axis];
  layout->step = chunk[layout->axis];
  layout->count = (layout->length + layout->step - 1) / layout->step;
  layout->chunks *= layout->count * layout->components;
  layout->bytes = layout->step * layout->row / layout->components;
  return true;
}

/* Reads a compressed chunk; false if the file has no such chunk. */
static bool read_packed(hid_t set, const struct layout *layout, int rank, const size_t *dims,
                        size_t chunk, size_t capacity, struct unpacked *into) {
  hsize_t at[H5S_MAX_RANK] = {0}, size = 0;
  size_t before = chunk / layout->components;
  if (layout->components > 1) at[rank - 1] = chunk % layout->components;
  at[layout->axis] = before % layout->count * layout->step;
  before /= layout->count;
  for (int d = layout->axis; d-- > 0; before /= dims[d]) at[d] = before % dims[d];
  if (H5Dget_chunk_storage_size(set, at, &size) < 0 || size == 0 || size > capacity) return false;
  into->size = (size_t)size;
  return H5Dread_chunk(set, H5P_DEFAULT, at, &into->skipped, into->packed) >= 0 &&
         into->skipped == 0;
}

/* Reverses the shuffle: byte k of value i is at in[k * n + i]; values are written `step` bytes
 * apart. */
static inline void unshuffle(size_t item, const unsigned char *in, size_t n, size_t count,
                             size_t step, char *to) {
  if (step == item && item != 4) {
    for (size_t k = 0; k < item; k++)
      for (size_t i = 0; i < count; i++) to[i * item + k] = (char)in[k * n + i];
    return;
  }
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < item; k++) to[i * step + k] = (char)in[k * n + i];
}

static bool unpack(const struct layout *layout, size_t chunk, struct unpacked *from, char *data) {
  const size_t component = chunk % layout->components, at = chunk / layout->components;
  const size_t first = at % layout->count * layout->step, left = layout->length - first;
  const size_t item = layout->item, n = layout->bytes / item, step = item * layout->components;
  const size_t count = (left < layout->step ? left : layout->step) * layout->row / step;
  char *to = data + (at / layout->count * layout->length + first) * layout->row + component * item;
  uLong size = layout->bytes;
  if (uncompress(from->shuffled, &size, from->packed, from->size) != Z_OK || size != layout->bytes)
    return false;
  if (step == 1)
    memcpy(to, from->shuffled, count);
  else if (item == 4)
    unshuffle(4, from->shuffled, n, count, step, to);
  else if (item == 8)
    unshuffle(8, from->shuffled, n, count, step, to);
  else
    unshuffle(item, from->shuffled, n, count, step, to);
  return true;
}

enum status h5_read_chunks(hid_t set, hid_t stored, enum h5_type type, int rank, const size_t *dims,
                           void *data, bool *done) {
  enum status status = STATUS_OK;
  size_t batch = 2 * (size_t)omp_get_max_threads(), allocated = 0;
  struct layout layout;
  struct unpacked *chunks = NULL;
  *done = false;
  if (!has_own_layout(set, stored, type, rank, dims, &layout)) return STATUS_OK;
  if (batch > layout.chunks / BATCH_DIVISOR) batch = layout.chunks / BATCH_DIVISOR;
  if (batch < 2) return STATUS_OK;
  const size_t capacity = compressBound(layout.bytes);
  TRY(memory_allocate(&chunks, batch, sizeof *chunks, "chunks"));
  for (; allocated < batch; allocated++) {
    TRY(memory_allocate(&chunks[allocated].packed, capacity + layout.bytes, 1, "chunks"));
    chunks[allocated].shuffled = chunks[allocated].packed + capacity;
  }
  bool good = true;
  for (size_t first = 0; first < layout.chunks && good; first += batch) {
    const size_t n = layout.chunks - first < batch ? layout.chunks - first : batch;
    for (size_t i = 0; i < n && good; i++)
      good = read_packed(set, &layout, rank, dims, first + i, capacity, &chunks[i]);
    if (!good) break;
#pragma omp parallel for schedule(dynamic) reduction(&& : good)
    for (size_t i = 0; i < n; i++) good = unpack(&layout, first + i, &chunks[i], data) && good;
  }
  *done = good;
cleanup:
  for (size_t i = 0; i < allocated; i++) memory_free(&chunks[i].packed);
  memory_free(&chunks);
  return status;
}

/* A chunk that might inflate to more than this is inflated beforehand, into nothing, and refused if
 * it holds more than a chunk: the library would allocate whatever comes out. */
#define UNSEEN_BYTES ((double)(1ul << 28))
#define DEFLATE_RATIO_MOST 1032.0

/* Whether a stream inflates to at most `most` bytes. */
static bool inflates_within(const unsigned char *in, size_t size, size_t most,
                            unsigned char scratch[1 << 16]) {
  z_stream z = {.next_in = (Bytef *)(uintptr_t)in, .avail_in = (uInt)size};
  int code = Z_OK;
  if (size > UINT_MAX || inflateInit(&z) != Z_OK) return false;
  while (code == Z_OK && z.total_out <= most) {
    z.next_out = scratch;
    z.avail_out = 1 << 16;
    code = inflate(&z, Z_NO_FLUSH);
  }
  const bool within = z.total_out <= most;
  inflateEnd(&z);
  return within; /* the library tells of damage */
}

enum status h5_check_chunks(const char *path, const char *name, hid_t set, size_t number_size,
                            int rank, const size_t *start, const size_t *extent) {
  enum status status = STATUS_OK;
  hsize_t chunk[H5S_MAX_RANK], at[H5S_MAX_RANK];
  unsigned char *scratch = NULL, *packed = NULL;
  double bytes = (double)number_size;
  const hid_t list = H5Dget_create_plist(set);
  const bool chunked = rank > 0 && H5Pget_layout(list) == H5D_CHUNKED &&
                       H5Pget_chunk(list, H5S_MAX_RANK, chunk) == rank && H5Pget_nfilters(list) > 0;
  H5Pclose(list);
  for (int d = 0; d < rank && chunked; d++) bytes *= (double)chunk[d];
  for (int d = 0; d < rank; d++) {
    if (!chunked || extent[d] == 0) return STATUS_OK;
    at[d] = start[d] / chunk[d] * chunk[d];
  }
  for (int d = 0; d >= 0;) {
    hsize_t size = 0;
    uint32_t skipped = 0;
    if (H5Dget_chunk_storage_size(set, at, &size) >= 0 &&
        DEFLATE_RATIO_MOST * (double)size > UNSEEN_BYTES) {
      /* What is packed is hardly ever longer, and a checksum of four bytes may come along. */
      if ((double)size > 1.01 * bytes + 1024.0)
        TRY_FAIL(STATUS_INPUT, "%s: %s is damaged: a chunk of %.0f bytes is stored in %llu", path,
                 name, bytes, (unsigned long long)size);
      if (scratch == NULL) TRY(memory_allocate(&scratch, 1 << 16, 1, "a chunk"));
      TRY(memory_allocate(&packed, (size_t)size, 1, "a chunk"));
      if (H5Dread_chunk(set, H5P_DEFAULT, at, &skipped, packed) >= 0 && skipped == 0 &&
          !inflates_within(packed, (size_t)size, (size_t)bytes + 4, scratch))
        TRY_FAIL(STATUS_INPUT, "%s: %s is damaged: a chunk of %.0f bytes inflates to more", path,
                 name, bytes);
      memory_free(&packed);
    }
    for (d = rank - 1; d >= 0; d--) {
      at[d] += chunk[d];
      if (at[d] < start[d] + extent[d]) break;
      at[d] = start[d] / chunk[d] * chunk[d];
    }
  }
cleanup:
  MEMORY_FREE(&packed, &scratch);
  return status;
}
