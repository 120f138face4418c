#include "sphsolve/geometry/distance.h"

#include <math.h>

#include "sphsolve/geometry/distance_internal.h"

long distance_neighbour(const struct grid *grid, const long x[3], const int offset[3]) {
  long at[3];
  for (int a = 0; a < 3; a++) {
    long n = (long)grid->size[a];
    at[a] = x[a] + offset[a];
    if (at[a] < 0 || at[a] >= n) {
      if (!grid->periodic[a]) return -1;
      at[a] = ((at[a] % n) + n) % n;
    }
  }
  return (at[2] * (long)grid->size[1] + at[1]) * (long)grid->size[0] + at[0];
}

int distance_offsets(const double spacing[3], struct offset offsets[OFFSETS]) {
  int n = 0;
  for (int k = -DISTANCE_REACH; k <= DISTANCE_REACH; k++)
    for (int j = -DISTANCE_REACH; j <= DISTANCE_REACH; j++)
      for (int i = -DISTANCE_REACH; i <= DISTANCE_REACH; i++) {
        int by[3] = {i, j, k};
        double square = 0;
        for (int a = 0; a < 3; a++) {
          double gap = (fabs((double)by[a]) - 0.5) * spacing[a];
          if (by[a] != 0) square += gap * gap;
        }
        struct offset new = {{i, j, k}, sqrt(square)};
        int at = n++;
        /* cppcheck-suppress uninitvar ; the first `at` entries were filled by earlier rounds */
        while (at > 0 && offsets[at - 1].face > new.face) {
          offsets[at] = offsets[at - 1];
          at--;
        }
        offsets[at] = new;
      }
  return n;
}

double distance_reach(const double spacing[3]) {
  return DISTANCE_REACH * fmin(fmin(spacing[0], spacing[1]), spacing[2]);
}

void distance_from_faces(const size_t size[3], const double spacing[3], const bool periodic[3],
                         size_t first, size_t end, const uint8_t *solid, float *distance) {
  struct grid grid = {size, spacing, periodic};
  struct offset offsets[OFFSETS];
  int n = distance_offsets(spacing, offsets);
  double limit = distance_reach(spacing);
#pragma omp parallel for schedule(static)
  for (size_t k = first; k < end; k++)
    for (size_t j = 0; j < size[1]; j++)
      for (size_t i = 0; i < size[0]; i++) {
        size_t at = (k * size[1] + j) * size[0] + i;
        long x[3] = {(long)i, (long)j, (long)k};
        double d = limit;
        for (int o = 0; o < n && offsets[o].face < limit; o++) {
          long other = distance_neighbour(&grid, x, offsets[o].by);
          if (other >= 0 && solid[other] != solid[at]) {
            d = offsets[o].face;
            break;
          }
        }
        distance[at] = (float)(solid[at] ? -d : d);
      }
}

/* Signed distance to a box, negative inside; axes with infinite faces do not count. */
static double to_box(const double low[3], const double high[3], const double x[3]) {
  double outside = 0, inside = -INFINITY;
  for (int a = 0; a < 3; a++) {
    double beyond = fmax(low[a] - x[a], x[a] - high[a]);
    inside = fmax(inside, beyond);
    if (beyond > 0) outside += beyond * beyond;
  }
  return outside > 0 ? sqrt(outside) : inside;
}

/* Signed distance to the box of a region and its periodic images. A box that reaches a closed side
 * continues behind it, and one that spans a periodic length has no faces there. */
static double to_region(const struct scene *scene, const struct region *region, const double x[3]) {
  double low[3], high[3], best = INFINITY, slack = 1e-6 * scene->spacing;
  int images[3];
  for (int a = 0; a < 3; a++) {
    double length = scene->domain_size[a];
    bool at_low = region->box[a]<slack, at_high = region->box[a + 3]> length - slack;
    bool unbounded =
        (scene->dimensions == 2 && a == 1) || (scene->periodic[a] && at_low && at_high);
    low[a] = unbounded || (at_low && !scene->periodic[a]) ? -INFINITY : region->box[a];
    high[a] = unbounded || (at_high && !scene->periodic[a]) ? INFINITY : region->box[a + 3];
    images[a] = scene->periodic[a] && !unbounded ? 1 : 0;
  }
  for (int k = -images[2]; k <= images[2]; k++)
    for (int j = -images[1]; j <= images[1]; j++)
      for (int i = -images[0]; i <= images[0]; i++) {
        double shifted[3] = {x[0] + i * scene->domain_size[0], x[1] + j * scene->domain_size[1],
                             x[2] + k * scene->domain_size[2]};
        best = fmin(best, to_box(low, high, shifted));
      }
  return best;
}

double distance_to_boxes(const struct scene *scene, const double x[3]) {
  double d = INFINITY, limit = 2 * DISTANCE_REACH * scene->spacing;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_WALL && region->type != REGION_WATER &&
        region->type != REGION_EMPTY && region->type != REGION_POROUS)
      continue;
    double to = to_region(scene, region, x);
    d = region->type == REGION_WALL ? fmin(d, to) : fmax(d, -to);
  }
  for (int a = 0; a < 3; a++)
    if (!scene->periodic[a]) d = fmin(d, fmin(x[a], scene->domain_size[a] - x[a]));
  return fmax(fmin(d, limit), -limit);
}
