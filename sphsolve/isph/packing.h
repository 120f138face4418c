/* The initial arrangement of the particles under a surface is at rest.
 *
 * The water is placed on lattices, whose sums over neighbours are not those of even water where two
 * lattices meet: at an edge of soil phi = sum V W is .8 to 1.2, the more the lower its porosity,
 * and beside soil, walls or particles of another size the sum that points out of a level surface
 * (effects/surface.h) is 15 degrees off. Taken for a lack of water, for a surface within the water
 * and for a slope, that set still water in motion, by 3 to 9 mm/s, and in soil moved more water for
 * a minute than seeps. But all of the water is in its place at the start. So each particle keeps in
 * `packing`
 *
 *   0  phi - 1 at the start, but not beside a void,
 *
 *   1 to 3  on a level top of the water, the horizontal part of that sum,
 *
 *   4  the depth of its middle under that top, over half of its size, less 1,
 *
 *   5  whether it is on a level top, 0 or 1: there the row of the pressure equation is closed by
 *      what is at rest, whatever its sums lack,
 *
 * and in `submerged` its weight as a surface if there is water or wall all around it. Relaxation
 * and surface subtract these from the present sums, depth and weight. As the particle moves
 * its neighbours change, and what it keeps fades by exp(-distance/(size/4)). */
#ifndef TOSUI_SPHSOLVE_ISPH_PACKING_H
#define TOSUI_SPHSOLVE_ISPH_PACKING_H

#include "sphsolve/isph/state.h"

/* Finds what the particles keep, and as a first pressure the weight of still water up to the
 * highest particle. Collective. */
void isph_packing_begin(struct isph *s);
/* Particle i has moved by `step`, m. */
void isph_packing_fade(struct isph *s, size_t i, const double step[3]);

/* The surface weight, without that of the initial arrangement. */
static inline double isph_packing_surface(const struct isph *s, size_t i) {
  return fmax(0, s->surface[i] - (double)s->submerged[i]);
}

/* 1 - phi, without the part that is that of the initial arrangement. */
static inline double isph_packing_deficit(const struct isph *s, size_t i) {
  return 1 - s->kernel_sum[i] + (s->packing != NULL ? (double)s->packing[i][0] : 0);
}

/* The sum that points into the void, as gradient_sum, without that of the initial arrangement. */
static inline void isph_packing_void(const struct isph *s, size_t i, double sum[3]) {
  for (int a = 0; a < 3; a++)
    sum[a] = s->gradient_sum[i][a] - (s->packing != NULL ? (double)s->packing[i][1 + a] : 0);
}

/* Distance from particle i of a surface to the surface, m. */
static inline double isph_packing_depth(const struct isph *s, size_t i, double size) {
  return 0.5 * size * (1 + (s->packing != NULL ? (double)s->packing[i][4] : 0));
}

#endif
