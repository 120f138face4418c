/* The flux through a plane is a mean over the kernel's width,
 *   Q = sum V v w,   w = W_1(x - x_plane, h),
 * with W_1 the kernel in one dimension. Where water fills its room and no wall is within reach, it
 * is the mean velocity times the area A of the domain's section, Q = A sum V v w / sum V w: beside
 * edges of soil the volumes of particles overlap or leave gaps, by some tenths of a particle, and
 * the first sum counts .8 of what passes soil of porosity .07, three particles thick. */
#include "sphsolve/isph/section.h"

#include <math.h>

#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/wall.h"

/* Distance from a plane along its axis, m. */
static double from_plane(const struct isph *s, double x, const struct flux_plane *plane) {
  const int a = plane->axis;
  const double r = x - plane->position, length = s->high[a] - s->low[a];
  return s->periodic[a] ? r - length * round(r / length) : r;
}

/* Weight of a particle, 1/m. The part of the kernel beyond a side of the domain is compensated for
 * by normalisation. Water beside a thin wall comes within reach of a plane in it, but cannot pass:
 * it does not count where a wall is between. */
static double weight(const struct isph *s, size_t i, const struct flux_plane *plane) {
  const int a = plane->axis;
  const double r = fabs(from_plane(s, s->position[i][a], plane)), h = 0.5 * s->support[i];
  double within = 1, crossing[3] = {s->position[i][0], s->position[i][1], s->position[i][2]};
  if (!(r < s->support[i])) return 0;
  crossing[a] = plane->position;
  if (isph_wall_holds(s, crossing)) return 0;
  if (!s->periodic[a])
    within = kernel_integral((s->high[a] - plane->position) / h) -
             kernel_integral((s->low[a] - plane->position) / h);
  return kernel_w(KERNEL_CUBIC, 1, r, h) / fmax(within, 0.5);
}

static bool is_beside_wall(const struct isph *s, const struct flux_plane *plane) {
  const int a = plane->axis;
  for (size_t b = 1; b < s->wall_box_count; b++) {
    const struct isph_wall_box *box = &s->wall_boxes[b];
    const double middle = 0.5 * (box->low[a] + box->high[a]);
    if (fabs(from_plane(s, middle, plane)) < box->high[a] - middle + s->support_max) return true;
  }
  return false;
}

/* Area of the domain's section, m^2, or its width in 2-D, m. */
static double section_area(const struct isph *s, const struct flux_plane *plane) {
  double area = 1;
  for (int a = 0; a < 3; a++)
    if (a != plane->axis && isph_uses_axis(s, a)) area *= s->high[a] - s->low[a];
  return area;
}

double isph_section_flux(const struct isph *s, const struct flux_plane *plane) {
  double total[2];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double flux = 0, covered = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double share = s->volume[i] * weight(s, i, plane);
      flux += share * s->velocity[i][plane->axis], covered += share;
    }
    s->sums[c][0] = flux, s->sums[c][1] = covered;
  }
  isph_sum_chunks(s, 2, total);
  if (isph_fills_room(s) && !is_beside_wall(s, plane) && total[1] > 0)
    total[0] *= section_area(s, plane) / total[1];
  return total[0] * s->thickness;
}
