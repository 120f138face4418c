#include "sphsolve/isph/isph_state.h"

#include <math.h>

/* Soil is a property of space: eps = 1 - sum (1 - eps0) s with s the share of soil in a kernel of
 * the support of free water around a point (M15 section 4 with soil markers in the limit of many;
 * for a box the kernel sum is an integral that is known). Boxes that touch a closed side go on
 * beyond it, so that walls see no thinner soil. */

/* Integral of the one-dimensional cubic kernel from -infinity to t = x/h. */
static double kernel_integral(double t) {
  double s = fabs(t), half;
  if (s >= 2)
    half = 0.5;
  else if (s <= 1)
    half = 2.0 / 3 * (s - s * s * s / 2 + 3 * s * s * s * s / 16);
  else
    half = 11.0 / 24 + (1 - pow(2 - s, 4)) / 24;
  return t < 0 ? 0.5 - half : 0.5 + half;
}

static double share_of_box(const struct isph *s, const struct region *region,
                           const double offset[3], const double x[3]) {
  double h = 0.25 * s->scene->isph.support_ratio * s->spacing, share = 1;
  double near = 1e-6 * s->spacing;
  for (int a = 0; a < 3; a++) {
    if (s->dimensions == 2 && a == 1) continue;
    double low = region->box[a], high = region->box[a + 3];
    bool open_low = low <= s->low[a] + near, open_high = high >= s->high[a] - near;
    if (open_low && open_high) continue;
    low += offset[a], high += offset[a];
    double at = x[a];
    if (s->periodic[a]) {
      double length = s->high[a] - s->low[a], middle = 0.5 * (low + high);
      at -= length * round((at - middle) / length);
      open_low = open_high = false;
    }
    double below = open_low ? 1 : kernel_integral((at - low) / h);
    double above = open_high ? 0 : kernel_integral((at - high) / h);
    share *= below - above;
  }
  return share;
}

void isph_soil_at(const struct isph *s, const double position[3], struct soil_point *soil) {
  const struct scene *scene = s->scene;
  double solid = 0, share = 0, a = 0, b = 0, velocity[3] = {0}, paper = 1;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    if (region->type != REGION_POROUS) continue;
    double w = share_of_box(s, region, s->soil_offset[k], position);
    if (w <= 0) continue;
    /* A later soil takes the place of an earlier one. */
    double keep = 1 - w, d = region->grain_size;
    solid = keep * solid + w * (1 - region->porosity);
    share = keep * share + w;
    a = keep * a + w * region->alpha * s->viscosity / (d * d);
    b = keep * b + w * region->beta / d;
    for (int c = 0; c < 3; c++) velocity[c] = keep * velocity[c] + w * region->soil_velocity[c];
    paper = fmin(paper, fmax(fmin(1, 2 - 2 * w), region->porosity)); /* M15 eq. 32 */
  }
  double eps = scene->isph.porosity_paper ? paper : 1 - solid;
  double cubed = eps * eps * eps, weight = share > 0 ? 1 / share : 0;
  soil->porosity = eps;
  soil->solid = share;
  soil->a = a * weight * (1 - eps) * (1 - eps) / cubed; /* M15 eq. 9c */
  soil->b = b * weight * (1 - eps) / cubed;             /* M15 eq. 9d */
  for (int c = 0; c < 3; c++) soil->velocity[c] = velocity[c] * weight;
}

double isph_soil_minimum(const struct scene *scene) {
  double least = 1;
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_POROUS) least = fmin(least, scene->regions[k].porosity);
  return least;
}
