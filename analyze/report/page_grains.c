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

struct centre {
  float depth;
  uint32_t at;
};

static int deeper(const void *a, const void *b) {
  const struct centre *x = a, *y = b;
  if (x->depth != y->depth) return x->depth < y->depth ? 1 : -1;
  return x->at < y->at ? -1 : 1;
}

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

static void paint(const struct window *window, struct centre centre) {
  const size_t nx = window->size[0], ny = window->size[1];
  const long at[3] = {(long)(centre.at % nx), (long)(centre.at / nx % ny),
                      (long)(centre.at / (nx * ny))};
  const long reach = (long)centre.depth;
  for (long c = -reach; c <= reach; c++)
    for (long b = -reach; b <= reach; b++)
      for (long a = -reach; a <= reach; a++) {
        const long x = at[0] + a, y = at[1] + b, z = at[2] + c;
        if ((float)(a * a + b * b + c * c) > centre.depth * centre.depth || x < 0 || y < 0 ||
            z < 0 || x >= (long)nx || y >= (long)ny || z >= (long)window->size[2])
          continue;
        float *width = &window->width[((size_t)z * ny + (size_t)y) * nx + (size_t)x];
        if (!(*width > 0.0f)) *width = centre.depth; /* the largest comes first */
      }
}

static enum status find_widths(struct window *window) {
  enum status status = STATUS_OK;
  const size_t n = window->size[0] * window->size[1] * window->size[2];
  struct centre *centres = NULL;
  size_t count = 0, i = 0;
  TRY(memory_allocate(&centres, n, sizeof *centres, "grain sizes"));
  for (size_t z = 0; z < window->size[2]; z++)
    for (size_t y = 0; y < window->size[1]; y++)
      for (size_t x = 0; x < window->size[0]; x++, i++)
        if (window->depth[i] > 0.0f && !is_within(window, x, y, z, window->depth[i]))
          centres[count++] = (struct centre){window->depth[i], (uint32_t)i};
  qsort(centres, count, sizeof *centres, deeper);
  for (size_t c = 0; c < count; c++) paint(window, centres[c]);
cleanup:
  memory_free(&centres);
  return status;
}

enum status grain_sizes(const struct voxel_model *model, json_t *data) {
  enum status status = STATUS_OK;
  struct window window = {0};
  double diameters[POINTS], finer[POINTS], all = 0.0;
  if (model->wall_distance == NULL) return STATUS_OK;
  TRY(take_window(model, &window));
  if (window.deepest < 2.0f) goto cleanup; /* grains of a voxel or two have no size here */
  TRY(find_widths(&window));
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
