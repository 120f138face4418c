#include "ct2model/model/sides.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Where voxel i of the model comes from. */
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
  for (size_t z = to[2]; z-- > 0;) { /* from the end, so that nothing is written over unread */
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

/* The way from a voxel's centre to the nearer side. */
static double room(size_t i, size_t n, double spacing) {
  return spacing * ((double)(i < n - 1 - i ? i : n - 1 - i) + 0.5);
}

/* Of the neighbours within the sample that are of the other phase and know their own distance. */
static float between(const size_t n[3], const double spacing[3], const float *distance,
                     const size_t at[3]) {
  const size_t step[3] = {1, n[0], n[0] * n[1]};
  const size_t i = at[0] + at[1] * step[1] + at[2] * step[2];
  const float own = distance[i];
  float least = INFINITY;
  for (int a = 0; a < 3; a++)
    for (int side = -1; side <= 1; side += 2) {
      if (side < 0 ? at[a] == 0 : at[a] + 1 == n[a]) continue;
      const float other = distance[side < 0 ? i - step[a] : i + step[a]];
      if ((other < 0.0f) == (own < 0.0f)) continue;
      const double left = spacing[a] - fabs((double)other);
      least = fminf(least, (float)fmax(left, 0.05 * spacing[a]));
    }
  return own < 0.0f ? -least : least;
}

void sides_forget(const size_t n[3], const double spacing[3], float *distance) {
  const size_t plane = n[0] * n[1];
  /* First what is next to the other phase, from distances that are still all there. */
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < plane * n[2]; i++) {
      const size_t at[3] = {i % n[0], i / n[0] % n[1], i / plane};
      const double reach = fmin(room(at[0], n[0], spacing[0]), room(at[1], n[1], spacing[1]));
      if (!isfinite(distance[i]) || fabs((double)distance[i]) <= reach) continue;
      const float near = between(n, spacing, distance, at);
      if (pass == 0 && isfinite(near) && fabsf(near) > fabsf(distance[i])) distance[i] = near;
      if (pass == 1 && !isfinite(near)) distance[i] = INFINITY;
    }
}
