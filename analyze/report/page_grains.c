/* Grain sizes: the share of the grains by the largest ball that fits there (Hildebrand, Ruegsegger
 * 1997), as pores have their widths, in a window in the middle of the model. */
#include <math.h>
#include <stdlib.h>

#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"

enum { SIDE = 128 /* largest side of the window, in voxels */, POINTS = 40 /* of the curve */ };

struct window {
  size_t size[3];
  float *depth, *width; /* spacings: of a voxel below the wall; radius of the largest ball there */
  float deepest;
};

static enum status take_window(const struct voxel_model *model, struct window *window) {
  enum status status = STATUS_OK;
  size_t from[3], n = 1;
  for (int d = 0; d < 3; d++) {
    window->size[d] = model->size[d] < SIDE ? model->size[d] : SIDE;
    from[d] = (model->size[d] - window->size[d]) / 2;
    n *= window->size[d];
  }
  TRY(memory_allocate(&window->depth, n, sizeof *window->depth, "grain sizes"));
  TRY(memory_allocate(&window->width, n, sizeof *window->width, "grain sizes"));
  for (size_t z = 0, i = 0; z < window->size[2]; z++)
    for (size_t y = 0; y < window->size[1]; y++)
      for (size_t x = 0; x < window->size[0]; x++, i++) {
        const size_t row = (z + from[2]) * model->size[1] + y + from[1];
        const double inside = -(double)model->wall_distance[row * model->size[0] + x + from[0]];
        window->depth[i] = (float)fmax(inside / model->spacing[0], 0.0);
        window->deepest = fmaxf(window->deepest, window->depth[i]);
      }
cleanup:
  return status;
}

/* Whether the ball about a voxel lies within that about a neighbour, to a twentieth of a voxel. */
static bool is_within(const struct window *window, size_t x, size_t y, size_t z, float depth) {
  for (int k = 0; k < 27; k++) {
    const size_t a = x + (size_t)(k % 3), b = y + (size_t)(k / 3 % 3), c = z + (size_t)(k / 9);
    if (k == 13 || a < 1 || b < 1 || c < 1 || a > window->size[0] || b > window->size[1] ||
        c > window->size[2])
      continue;
    const size_t other = ((c - 1) * window->size[1] + b - 1) * window->size[0] + a - 1;
    const int apart = abs(k % 3 - 1) + abs(k / 3 % 3 - 1) + abs(k / 9 - 1);
    if (window->depth[other] + 0.05f >= depth + sqrtf((float)apart)) return true;
  }
  return false;
}

/* Widens all voxels in the ball of so many voxels about a place to its radius. */
static void paint(const struct window *window, size_t x, size_t y, size_t z, float radius) {
  const long at[3] = {(long)x, (long)y, (long)z};
  long low[3], high[3];
  for (int d = 0; d < 3; d++) {
    low[d] = at[d] > (long)radius ? at[d] - (long)radius : 0;
    high[d] = at[d] + (long)radius;
    if (high[d] >= (long)window->size[d]) high[d] = (long)window->size[d] - 1;
  }
  for (long c = low[2]; c <= high[2]; c++)
    for (long b = low[1]; b <= high[1]; b++)
      for (long a = low[0]; a <= high[0]; a++) {
        const long off[3] = {a - at[0], b - at[1], c - at[2]};
        float *width =
            &window->width[((size_t)c * window->size[1] + (size_t)b) * window->size[0] + (size_t)a];
        if ((float)(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) <= radius * radius)
          *width = fmaxf(*width, radius);
      }
}

enum status grain_sizes(const struct voxel_model *model, json_t *data) {
  enum status status = STATUS_OK;
  struct window window = {0};
  double diameters[POINTS], finer[POINTS], all = 0.0;
  if (model->wall_distance == NULL) return STATUS_OK;
  TRY(take_window(model, &window));
  if (window.deepest < 2.0f) goto cleanup; /* grains of a voxel or two have no size here */
  for (size_t z = 0, i = 0; z < window.size[2]; z++)
    for (size_t y = 0; y < window.size[1]; y++)
      for (size_t x = 0; x < window.size[0]; x++, i++)
        if (window.depth[i] > 0.0f && !is_within(&window, x, y, z, window.depth[i]))
          paint(&window, x, y, z, window.depth[i]);
  const double least = log(1.0), most = log(1.02 * (double)window.deepest);
  for (int p = 0; p < POINTS; p++) {
    diameters[p] = 2.0 * model->spacing[0] * exp(least + (most - least) * p / (POINTS - 1.0));
    finer[p] = 0.0;
  }
  for (size_t i = 0; i < window.size[0] * window.size[1] * window.size[2]; i++) {
    if (!(window.depth[i] > 0.0f)) continue;
    const double width = 2.0 * model->spacing[0] * (double)fmaxf(window.width[i], window.depth[i]);
    all += 1.0;
    for (int p = POINTS - 1; p >= 0 && width <= diameters[p]; p--) finer[p] += 1.0;
  }
  for (int p = 0; p < POINTS; p++) finer[p] /= all;
  json_object_set_new(data, "grain_sizes",
                      json_pack("{s:o,s:o}", "diameter_m", json_numbers(diameters, POINTS), "finer",
                                json_numbers(finer, POINTS)));
cleanup:
  memory_free(&window.depth);
  memory_free(&window.width);
  return status;
}
