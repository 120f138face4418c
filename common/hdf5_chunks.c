#include <omp.h>
#include <string.h>
#include <zlib.h>

#include "common/hdf5_internal.h"
#include "common/interrupt.h"
#include "common/memory.h"

/* Chunks on their way, three times a chunk each, take no more than a fifth of what is written: a
 * method's memory has room for that, see tests/cli/memory.bats. */
#define SHARE_UNDER_WAY 16

/* What h5_dataset_layout makes: chunks are runs of memory, cut along one axis, or one component of
 * each value there. */
struct runs {
  const char *data;
  size_t item, components;    /* bytes of a number; numbers apart that lie together in memory */
  size_t row;                 /* bytes of one step along the axis that is cut */
  size_t length, step, count; /* of that axis, of a chunk along it, chunks along it */
  size_t bytes;               /* of a chunk */
  int axis;
};

/* A chunk on its way. */
struct packed {
  unsigned char *plain, *shuffled, *bytes;
  uLong size; /* 0: memory is short */
};

/* Byte k of every value together, then byte k + 1: HDF5's shuffle. */
static void shuffle(const unsigned char *in, size_t n, size_t item, unsigned char *out) {
  for (size_t k = 0; k < item; k++)
    for (size_t i = 0; i < n; i++) out[k * n + i] = in[i * item + k];
}

/* Whether bytes are noise: about as many of each value, and few beside their like. */
#define SAMPLES 4096
static bool is_noise(const unsigned char *in, size_t n) {
  size_t count[256] = {0}, alike = 0, square = 0;
  if (n < 2 * SAMPLES) return false;
  for (size_t i = 0; i < SAMPLES; i++) {
    const unsigned char *at = in + i * (n / SAMPLES);
    count[at[0]]++;
    alike += at[0] == at[1];
  }
  for (size_t v = 0; v < 256; v++) square += count[v] * count[v];
  return alike < SAMPLES / 50 && 4 * square < 5 * (size_t)SAMPLES * SAMPLES / 256;
}

/* One stream of zlib in which noise is stored and of the rest only runs of one value are sought,
 * which of the bytes of measured or solved numbers loses next to nothing and takes half the time.
 * The stream has the checksum of all (Adler-32), so what is stored is as safe as what is not: a
 * chunk past the filter, stored raw, would have none, and damage to it go unseen. */
static bool deflate_runs(const unsigned char *in, size_t planes, size_t n, unsigned char *out,
                         uLong *size) {
  z_stream z = {.next_out = out, .avail_out = (uInt)*size};
  bool good = deflateInit2(&z, 1, Z_DEFLATED, MAX_WBITS, MAX_MEM_LEVEL, Z_RLE) == Z_OK;
  for (size_t k = 0; k < planes && good; k++) {
    const bool last = k + 1 == planes;
    good = deflateParams(&z, is_noise(in + k * n, n) ? 0 : 1, Z_RLE) == Z_OK;
    z.next_in = (Bytef *)(uintptr_t)(in + k * n);
    z.avail_in = (uInt)n;
    good = good && deflate(&z, last ? Z_FINISH : Z_NO_FLUSH) == (last ? Z_STREAM_END : Z_OK) &&
           z.avail_in == 0;
  }
  *size = z.total_out;
  deflateEnd(&z);
  return good;
}

/* One number of each `components` that lie together, up to `bytes` of them. */
static inline void take_component(size_t item, const char *from, size_t component,
                                  size_t components, size_t bytes, unsigned char *to) {
  for (size_t i = 0; i < bytes / item; i++)
    memcpy(to + i * item, from + (i * components + component) * item, item);
}

/* `by_runs`: as above, where it fits; else as HDF5's filter does. */
static void pack(const struct runs *runs, size_t chunk, size_t room, bool by_runs,
                 struct packed *packed) {
  const size_t component = chunk % runs->components, at = chunk / runs->components;
  const size_t first = at % runs->count * runs->step, bytes = runs->bytes, item = runs->item;
  const size_t steps = runs->length - first < runs->step ? runs->length - first : runs->step;
  const size_t filled = steps * runs->row / runs->components;
  const char *from = runs->data + (at / runs->count * runs->length + first) * runs->row;
  if (runs->components == 1)
    memcpy(packed->plain, from, filled);
  else if (item == 4)
    take_component(4, from, component, runs->components, filled, packed->plain);
  else
    take_component(item, from, component, runs->components, filled, packed->plain);
  memset(packed->plain + filled, 0, bytes - filled);
  const unsigned char *stored = packed->plain;
  if (runs->item > 1) {
    shuffle(packed->plain, bytes / runs->item, runs->item, packed->shuffled);
    stored = packed->shuffled;
  }
  packed->size = room;
  if (by_runs && deflate_runs(stored, runs->item, bytes / runs->item, packed->bytes, &packed->size))
    return;
  packed->size = room;
  if (compress2(packed->bytes, &packed->size, stored, bytes, H5_DEFLATE) != Z_OK) packed->size = 0;
}

/* Whether runs are as good as all that repeats, by the chunk in the middle, of each component. */
static bool runs_will_do(const struct runs *runs, size_t chunks, size_t room,
                         struct packed *packed) {
  const size_t middle = chunks / 2 / runs->components * runs->components;
  uLong all = 0, by_runs = 0;
  if (runs->item == 1) return false;
  for (size_t c = 0; c < runs->components; c++) {
    pack(runs, middle + c, room, false, packed);
    all += packed->size;
    pack(runs, middle + c, room, true, packed);
    by_runs += packed->size;
  }
  return by_runs < all + all / 32;
}

enum status h5_write_chunks(hid_t set, enum h5_type type, int rank, const size_t *dims,
                            const hsize_t *chunk, const void *data, bool *written) {
  enum status status = STATUS_OK;
  struct runs runs = {.data = data, .item = h5_type_size(type), .row = h5_type_size(type)};
  const int axes = h5_chunk_axes(rank, dims, chunk);
  size_t batch = 2 * (size_t)omp_get_max_threads();
  struct packed *packed = NULL;
  size_t chunks = 1, made = 0;
  runs.components = axes < rank ? dims[rank - 1] : 1;
  for (int i = 0; i < axes; i++)
    if (chunk[i] < dims[i]) runs.axis = i; /* what lies before it is cut into single steps */
  for (int i = 0; i < runs.axis; i++) chunks *= dims[i];
  for (int i = runs.axis + 1; i < rank; i++) runs.row *= dims[i];
  runs.length = dims[runs.axis];
  runs.step = chunk[runs.axis];
  runs.count = (runs.length + runs.step - 1) / runs.step;
  runs.bytes = runs.step * runs.row / runs.components;
  chunks *= runs.count * runs.components;
  if (batch > chunks / SHARE_UNDER_WAY) batch = chunks / SHARE_UNDER_WAY;
  if (batch < 1) {
    *written = H5Dwrite(set, h5_memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
    return STATUS_OK;
  }
  const size_t bytes = runs.bytes, room = compressBound(bytes);
  TRY(memory_allocate(&packed, batch, sizeof *packed, "chunks"));
  for (; made < batch; made++) {
    TRY(memory_allocate(&packed[made].plain, 2 * bytes + room, 1, "chunks"));
    packed[made].shuffled = packed[made].plain + bytes;
    packed[made].bytes = packed[made].shuffled + bytes;
  }
  *written = true;
  const bool by_runs = runs_will_do(&runs, chunks, room, &packed[0]);
  for (size_t first = 0; first < chunks && *written; first += batch) {
    const size_t n = chunks - first < batch ? chunks - first : batch;
    if (h5_leaves_on_signal()) TRY(interrupt_look());
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) pack(&runs, first + i, room, by_runs, &packed[i]);
    for (size_t i = 0; i < n && *written; i++) {
      hsize_t at[H5S_MAX_RANK] = {0};
      size_t before = (first + i) / runs.components;
      if (runs.components > 1) at[rank - 1] = (first + i) % runs.components;
      at[runs.axis] = before % runs.count * runs.step;
      before /= runs.count;
      for (int d = runs.axis; d-- > 0; before /= dims[d]) at[d] = before % dims[d];
      *written = packed[i].size > 0 &&
                 H5Dwrite_chunk(set, H5P_DEFAULT, 0, at, packed[i].size, packed[i].bytes) >= 0;
    }
  }
cleanup:
  for (size_t i = 0; i < made; i++) memory_free(&packed[i].plain);
  memory_free(&packed);
  return status;
}
