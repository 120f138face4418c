#include "common/hdf5_chunks.h"

#include <omp.h>
#include <string.h>
#include <zlib.h>

#include "common/interrupt.h"
#include "common/memory.h"

/* At most 1 / BATCH_DIVISOR of the chunks is compressed at a time. With three buffers for each
 * chunk they need less than a fifth of the dataset's memory, which the memory estimate of a method
 * includes (tests/cli/memory.bats). */
#define BATCH_DIVISOR 16

/* Layout as of h5_dataset_layout: a chunk is contiguous in memory, cut along one axis, or it holds
 * one component of the vectors in such a range. */
struct runs {
  const char *data;
  /* Bytes of a number; components that are stored in chunks of their own. */
  size_t item, components;
  size_t row; /* bytes of one step along the axis that is cut */
  /* Steps along that axis: of the dataset, of a chunk; number of chunks along it. */
  size_t length, step, count;
  size_t bytes; /* of a chunk */
  int axis;
};

/* Buffers of a chunk being compressed. */
struct packed {
  unsigned char *plain, *shuffled, *bytes;
  uLong size; /* compressed; 0 if memory was insufficient */
};

/* Byte k of all values, then byte k + 1: the shuffle filter of HDF5. */
static void shuffle(const unsigned char *in, size_t n, size_t item, unsigned char *out) {
  for (size_t k = 0; k < item; k++)
    for (size_t i = 0; i < n; i++) out[k * n + i] = in[i * item + k];
}

/* Whether bytes are incompressible: all values about equally frequent, and few equal to their
 * neighbour. */
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

/* Compresses into one zlib stream in which incompressible bytes are stored and the others are only
 * run-length encoded. For measured or computed numbers the size is nearly the same as with full
 * deflate, in half the time. The stream carries a checksum of everything (Adler-32); chunks written
 * without the deflate filter would have none, so that damage would go unnoticed. */
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

/* Extracts one component of vectors of `components` numbers, up to `bytes` of output. */
static inline void take_component(size_t item, const char *from, size_t component,
                                  size_t components, size_t bytes, unsigned char *to) {
  for (size_t i = 0; i < bytes / item; i++)
    memcpy(to + i * item, from + (i * components + component) * item, item);
}

/* Compresses a chunk. `by_runs`: with deflate_runs if the result fits, else as the filter of HDF5
 * does. */
static void pack(const struct runs *runs, size_t chunk, size_t capacity, bool by_runs,
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
  packed->size = capacity;
  if (by_runs && deflate_runs(stored, runs->item, bytes / runs->item, packed->bytes, &packed->size))
    return;
  packed->size = capacity;
  if (compress2(packed->bytes, &packed->size, stored, bytes, H5_DEFLATE) != Z_OK) packed->size = 0;
}

/* Whether run-length encoding compresses nearly as well as full deflate, tested on the middle chunk
 * of each component. */
static bool runs_suffice(const struct runs *runs, size_t chunks, size_t capacity,
                         struct packed *packed) {
  const size_t middle = chunks / 2 / runs->components * runs->components;
  uLong deflated = 0, by_runs = 0;
  if (runs->item == 1) return false;
  for (size_t c = 0; c < runs->components; c++) {
    pack(runs, middle + c, capacity, false, packed);
    deflated += packed->size;
    pack(runs, middle + c, capacity, true, packed);
    by_runs += packed->size;
  }
  return by_runs < deflated + deflated / 32;
}

enum status h5_write_chunks(hid_t set, enum h5_type type, int rank, const size_t *dims,
                            const hsize_t *chunk, const void *data, bool *written) {
  enum status status = STATUS_OK;
  struct runs runs = {.data = data, .item = h5_type_size(type), .row = h5_type_size(type)};
  const int axes = h5_chunk_axes(rank, dims, chunk);
  size_t batch = 2 * (size_t)omp_get_max_threads();
  struct packed *packed = NULL;
  size_t chunks = 1, allocated = 0;
  runs.components = axes < rank ? dims[rank - 1] : 1;
  for (int i = 0; i < axes; i++) /* axes before the last one that is cut have chunks of length 1 */
    if (chunk[i] < dims[i]) runs.axis = i;
  for (int i = 0; i < runs.axis; i++) chunks *= dims[i];
  for (int i = runs.axis + 1; i < rank; i++) runs.row *= dims[i];
  runs.length = dims[runs.axis];
  runs.step = chunk[runs.axis];
  runs.count = (runs.length + runs.step - 1) / runs.step;
  runs.bytes = runs.step * runs.row / runs.components;
  chunks *= runs.count * runs.components;
  if (batch > chunks / BATCH_DIVISOR) batch = chunks / BATCH_DIVISOR;
  if (batch < 1) {
    *written = H5Dwrite(set, h5_memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
    return STATUS_OK;
  }
  const size_t bytes = runs.bytes, capacity = compressBound(bytes);
  TRY(memory_allocate(&packed, batch, sizeof *packed, "chunks"));
  for (; allocated < batch; allocated++) {
    TRY(memory_allocate(&packed[allocated].plain, 2 * bytes + capacity, 1, "chunks"));
    packed[allocated].shuffled = packed[allocated].plain + bytes;
    packed[allocated].bytes = packed[allocated].shuffled + bytes;
  }
  *written = true;
  const bool by_runs = runs_suffice(&runs, chunks, capacity, &packed[0]);
  for (size_t first = 0; first < chunks && *written; first += batch) {
    const size_t n = chunks - first < batch ? chunks - first : batch;
    if (h5_leaves_on_signal()) TRY(interrupt_look());
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) pack(&runs, first + i, capacity, by_runs, &packed[i]);
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
  for (size_t i = 0; i < allocated; i++) memory_free(&packed[i].plain);
  memory_free(&packed);
  return status;
}
