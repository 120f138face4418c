/* The flux through a plane is a mean over the kernel's width,
 *   Q = sum V v w,   w = W_1(x - x_plane, h),
 * with W_1 the kernel in one dimension. Where water fills its room that is
 *   Q = A sum V v w / sum V w,   A = A_0 sum_water w / sum_all w,
 * with A_0 the area of the domain's section, and sums over all sites of the lattice and over those
 * of water, with the supports of particles there: beside edges of soil supports differ, and the
 * volumes of particles overlap or leave gaps, by some tenths of a particle. With sum V w as it is a
 * plane in soil of porosity .07, three particles thick, counts .8 of what passes. */
#include "sphsolve/isph/section.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/wall.h"

/* Distance of x from a plane, m. */
static double from_plane(const struct isph *s, const double x[3], const struct flux_plane *plane) {
  const int a = plane->axis;
  const double r = x[a] - plane->position, length = s->high[a] - s->low[a];
  return s->periodic[a] ? r - length * round(r / length) : r;
}

/* Weight, 1/m, with which water at x counts at a plane. The part of the kernel beyond a side of the
 * domain is compensated for by normalisation. */
static double weight(const struct isph *s, const double x[3], double support,
                     const struct flux_plane *plane) {
  const int a = plane->axis;
  const double r = fabs(from_plane(s, x, plane)), h = 0.5 * support;
  double within = 1;
  if (!(r < support)) return 0;
  if (!s->periodic[a])
    within = kernel_integral((s->high[a] - plane->position) / h) -
             kernel_integral((s->low[a] - plane->position) / h);
  return kernel_w(KERNEL_CUBIC, 1, r, h) / fmax(within, 0.5);
}

/* Whether there is a wall where water at x would cross a plane: beside a thin wall it comes within
 * the kernel's reach of a plane in it, but cannot pass. */
static bool is_walled_off(const struct isph *s, const double x[3], const struct flux_plane *plane) {
  double crossing[3] = {x[0], x[1], x[2]};
  crossing[plane->axis] = plane->position;
  return isph_wall_holds(s, crossing);
}

/* The weight of water at x, where nothing is known of its particles. */
static double weight_at(const struct isph *s, const double x[3], const struct flux_plane *plane) {
  struct soil_point soil;
  if (!(fabs(from_plane(s, x, plane)) < s->support_max)) return 0;
  isph_soil_at(s, x, 0, &soil);
  const double size = isph_size_of(s, s->wall_volume * s->mass_ratio / soil.porosity);
  return weight(s, x, fmin(s->support_max, s->scene->isph.support_ratio * size), plane);
}

enum status isph_sections_begin(struct isph *s) {
  return memory_allocate(&s->section_room, s->scene->plane_count, sizeof *s->section_room,
                         "planes");
}

void isph_sections_add(struct isph *s, const double x[3], double volume) {
  for (size_t k = 0; k < s->scene->plane_count; k++) {
    const struct flux_plane *plane = &s->scene->planes[k];
    const double w = weight_at(s, x, plane);
    if (w > 0 && !is_walled_off(s, x, plane)) s->section_room[k] += volume * w;
  }
}

void isph_sections_end(struct isph *s, const struct lattice *lattice) {
  for (size_t n = 0; n < s->scene->plane_count; n++) {
    const struct flux_plane *plane = &s->scene->planes[n];
    double all = 0, area = 1, volume = 1;
    for (int a = 0; a < 3; a++) {
      if (!isph_uses_axis(s, a)) continue;
      volume *= lattice->spacing[a];
      if (a != plane->axis) area *= s->high[a] - s->low[a];
    }
    for (size_t k = 0; k < lattice->size[2]; k++)
      for (size_t j = 0; j < lattice->size[1]; j++)
        for (size_t i = 0; i < lattice->size[0]; i++) {
          const double x[3] = {lattice->origin[0] + (double)i * lattice->spacing[0],
                               lattice->origin[1] + (double)j * lattice->spacing[1],
                               lattice->origin[2] + (double)k * lattice->spacing[2]};
          all += volume * weight_at(s, x, plane);
        }
    if (all > 0) s->section_room[n] *= area / all;
  }
}

double isph_section_flux(const struct isph *s, const struct flux_plane *plane, double room) {
  double total[2];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double flux = 0, covered = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double w = weight(s, s->position[i], s->support[i], plane);
      if (!(w > 0) || is_walled_off(s, s->position[i], plane)) continue;
      flux += s->volume[i] * w * s->velocity[i][plane->axis], covered += s->volume[i] * w;
    }
    s->sums[c][0] = flux, s->sums[c][1] = covered;
  }
  isph_sum_chunks(s, 2, total);
  if (room > 0 && total[1] > 0) total[0] *= room / total[1];
  return total[0] * s->thickness;
}
