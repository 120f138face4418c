#include <omp.h>
#include <string.h>
#include <zlib.h>

#include "common/hdf5_internal.h"
#include "common/memory.h"

/* Chunks on their way, three times a chunk each, take no more than a fifth of what is written: a
 * method's memory has room for that, see tests/cli/memory.bats. */
#define SHARE_UNDER_WAY 16

/* What h5_dataset_layout makes: chunks are runs of memory, cut along one axis. */
struct runs {
  const char *data;
  size_t item, row;           /* bytes of a value; of one step along the axis that is cut */
  size_t length, step, count; /* of that axis, of a chunk along it, chunks along it */
  int axis;
};

/* A chunk on its way. */
struct packed {
  unsigned char *plain, *shuffled, *bytes;
  uLong size;
  uint32_t skipped; /* filters that were not applied, a bit each */
};

/* Byte k of every value together, then byte k + 1: HDF5's shuffle. */
static void shuffle(const unsigned char *in, size_t n, size_t item, unsigned char *out) {
  for (size_t k = 0; k < item; k++)
    for (size_t i = 0; i < n; i++) out[k * n + i] = in[i * item + k];
}

static void pack(const struct runs *runs, size_t chunk, size_t room, struct packed *packed) {
  const size_t part = chunk % runs->count, first = part * runs->step,
               bytes = runs->step * runs->row;
  const size_t steps = runs->length - first < runs->step ? runs->length - first : runs->step;
  const char *from = runs->data + (chunk / runs->count * runs->length + first) * runs->row;
  memcpy(packed->plain, from, steps * runs->row);
  memset(packed->plain + steps * runs->row, 0, bytes - steps * runs->row);
  const unsigned char *stored = packed->plain;
  if (runs->item > 1) {
    shuffle(packed->plain, bytes / runs->item, runs->item, packed->shuffled);
    stored = packed->shuffled;
  }
  packed->size = room;
  packed->skipped = 0;
  if (compress2(packed->bytes, &packed->size, stored, bytes, H5_DEFLATE) == Z_OK) return;
  memcpy(packed->bytes, stored, bytes);
  packed->size = bytes;
  packed->skipped = 2; /* the second filter */
}

enum status h5_write_chunks(hid_t set, enum h5_type type, int rank, const size_t *dims,
                            const hsize_t *chunk, const void *data, bool *written) {
  enum status status = STATUS_OK;
  struct runs runs = {.data = data, .item = h5_type_size(type), .row = h5_type_size(type)};
  size_t batch = 2 * (size_t)omp_get_max_threads();
  struct packed *packed = NULL;
  size_t chunks = 1, made = 0;
  for (int i = 0; i < rank; i++)
    if (chunk[i] < dims[i]) runs.axis = i; /* what lies before it is cut into single steps */
  for (int i = 0; i < runs.axis; i++) chunks *= dims[i];
  for (int i = runs.axis + 1; i < rank; i++) runs.row *= dims[i];
  runs.length = dims[runs.axis];
  runs.step = chunk[runs.axis];
  runs.count = (runs.length + runs.step - 1) / runs.step;
  chunks *= runs.count;
  if (batch > chunks / SHARE_UNDER_WAY) batch = chunks / SHARE_UNDER_WAY;
  if (batch < 2) {
    *written = H5Dwrite(set, h5_memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
    return STATUS_OK;
  }
  const size_t bytes = runs.step * runs.row, room = compressBound(bytes);
  TRY(memory_allocate(&packed, batch, sizeof *packed, "chunks"));
  for (; made < batch; made++) {
    TRY(memory_allocate(&packed[made].plain, 2 * bytes + room, 1, "chunks"));
    packed[made].shuffled = packed[made].plain + bytes;
    packed[made].bytes = packed[made].shuffled + bytes;
  }
  *written = true;
  for (size_t first = 0; first < chunks && *written; first += batch) {
    const size_t n = chunks - first < batch ? chunks - first : batch;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) pack(&runs, first + i, room, &packed[i]);
    for (size_t i = 0; i < n && *written; i++) {
      hsize_t at[H5S_MAX_RANK] = {0};
      size_t before = (first + i) / runs.count;
      at[runs.axis] = (first + i) % runs.count * runs.step;
      for (int d = runs.axis; d-- > 0; before /= dims[d]) at[d] = before % dims[d];
      *written = H5Dwrite_chunk(set, H5P_DEFAULT, packed[i].skipped, at, packed[i].size,
                                packed[i].bytes) >= 0;
    }
  }
cleanup:
  for (size_t i = 0; i < made; i++) memory_free(&packed[i].plain);
  memory_free(&packed);
  return status;
}
