#include "ct2model/model/sides.h"

#include <string.h>

#include "common/memory.h"

/* The index from which voxel i of the model is copied. */
static size_t source(size_t i, size_t n) {
  return i < n ? i : 2 * n - 2 - i;
}

enum status sides_mirror(const size_t n[3], const struct voxel_model *model, void *data,
                         size_t bytes) {
  enum status status = STATUS_OK;
  const size_t *to = model->size;
  char *layer = NULL, *out = data;
  if (to[0] == n[0] && to[1] == n[1]) return STATUS_OK;
  TRY(memory_allocate(&layer, n[0] * n[1], bytes, "a layer"));
  for (size_t z = to[2]; z-- > 0;) { /* backwards, so that no value is overwritten unread */
    memcpy(layer, out + z * n[0] * n[1] * bytes, n[0] * n[1] * bytes);
    for (size_t y = 0; y < to[1]; y++)
      for (size_t x = 0; x < to[0]; x++)
        memcpy(out + ((z * to[1] + y) * to[0] + x) * bytes,
               layer + (source(y, n[1]) * n[0] + source(x, n[0])) * bytes, bytes);
  }
cleanup:
  memory_free(&layer);
  return status;
}

void sides_repeat(const size_t n[3], const struct voxel_model *model, void *data, size_t bytes) {
  const size_t *to = model->size;
  char *out = data;
  if (to[0] == n[0] && to[1] == n[1]) return;
  for (size_t z = 0; z < to[2]; z++)
    for (size_t y = 0; y < to[1]; y++)
      for (size_t x = 0; x < to[0]; x++) {
        const size_t from = (z * to[1] + source(y, n[1])) * to[0] + source(x, n[0]);
        const size_t at = (z * to[1] + y) * to[0] + x;
        if (from != at) memcpy(out + at * bytes, out + from * bytes, bytes);
      }
}
