#include "sphsolve/darcy/domain.h"

#include <math.h>

#include "sphsolve/darcy/constants.h"

bool domain_is_full(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].retention.given) return false;
  return true;
}

bool domain_holds(const struct scene *scene, const double box[6], const double x[3]) {
  bool inside = true;
  for (int a = 0; a < 3; a++)
    if (!(scene->dimensions == 2 && a == 1)) inside = inside && x[a] >= box[a] && x[a] < box[a + 3];
  return inside;
}

size_t domain_soil_at(const struct scene *scene, const double x[3]) {
  for (size_t r = scene->region_count; r-- > 0;)
    if (scene->regions[r].type == REGION_POROUS && domain_holds(scene, scene->regions[r].box, x))
      return r;
  return scene->region_count;
}

size_t domain_beyond(const struct scene *scene, const struct lattice *l, size_t at, int axis,
                     bool low) {
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  const size_t n = l->size[axis], here = at / stride[axis] % n;
  if (low ? here > 0 : here + 1 < n) return low ? at - stride[axis] : at + stride[axis];
  if (!scene->periodic[axis] || n == 1) return l->count;
  return low ? at + (n - 1) * stride[axis] : at - (n - 1) * stride[axis];
}

double domain_share(const struct lattice *l, const double x[3], int axis, const double box[6]) {
  double share = 1;
  for (int a = 0; a < 3; a++) {
    if (a == axis || (l->dimensions == 2 && a == 1)) continue;
    const double low = fmax(x[a] - 0.5 * l->spacing[0], box[a]),
                 high = fmin(x[a] + 0.5 * l->spacing[0], box[a + 3]);
    share *= fmax(0, high - low) / l->spacing[0];
  }
  return share;
}

const struct region *domain_inflow_at(const struct scene *scene, const struct lattice *lattice,
                                      const double x[3], int axis, bool low, double *share) {
  const struct region *found = NULL;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    bool at_low;
    if (region->type != REGION_INFLOW || scene_inflow_axis(scene, region, &at_low) != axis ||
        at_low != low)
      continue;
    const double covered = domain_share(lattice, x, axis, region->box);
    if (region->boundary == BOUNDARY_FLUX ? !(covered > *share) : covered < COVERED_HALF) continue;
    found = region;
    *share = region->boundary == BOUNDARY_FLUX ? covered : 1;
  }
  return found;
}
