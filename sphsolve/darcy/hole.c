/* On the way from a site of soil to one in a well or a drain, only the part t up to the face of the
 * hole resists, and not half of a spacing: k/(t d) between the site's head and the hole's (Gibou,
 * Fedkiw, Cheng, Kang 2002, J. Comput. Phys. 176: second order, and symmetric). With half a
 * spacing, a drain is as wide as the sites in it, and one of 4 spacings takes 9 % too little to 3 %
 * too much, as its centre lies between them. */
#include "sphsolve/darcy/hole.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/edges.h"

/* The part up to the section of a prism: where the way from x along an axis first crosses it. 0:
 * x itself is in it; 1: the site behind is not, but counts as such. */
static double part_to_section(const struct polygon *p, const double x[3], int axis, double step) {
  const int run = p->plane[0] == axis ? 0 : 1;
  const double v = x[p->plane[1 - run]];
  double least = 1;
  bool inside = false;
  for (size_t n = 0; n < p->count; n++) {
    const double *a = p->corner[n], *b = p->corner[(n + 1) % p->count];
    if ((a[1 - run] > v) == (b[1 - run] > v)) continue;
    const double at = a[run] + (b[run] - a[run]) * (v - a[1 - run]) / (b[1 - run] - a[1 - run]);
    const double part = (at - x[axis]) / step;
    inside = inside != (at > x[axis]);
    if (part > 0) least = fmin(least, part);
  }
  return inside ? 0 : least;
}

/* The part up to a hole that holds the site behind. */
static double part_outside(const struct richards *s, const struct region *hole, const double x[3],
                           int axis, double step) {
  double least = 1, behind[3] = {x[0], x[1], x[2]};
  behind[axis] += step;
  if (hole->polygon != NULL && hole->polygon->axis != axis)
    least = part_to_section(hole->polygon, x, axis, step);
  else
    for (size_t r = hole->first; r < hole->end; r++) {
      const double *box = s->scene->regions[r].box;
      if (domain_holds(s->scene, box, behind))
        least = fmin(least, (box[step > 0 ? axis : axis + 3] - x[axis]) / step);
    }
  return fmax(HOLE_PART_LEAST, least);
}

enum status richards_holes_create(struct richards *s) {
  bool any = false;
  for (size_t e = 0; e < s->edge_count; e++) any = any || !richards_is_face(&s->edges[e]);
  if (!any) return STATUS_OK;
  const enum status status =
      memory_allocate(&s->outside, 6 * s->count, sizeof *s->outside, "faces of wells");
  if (status != STATUS_OK) return status;
  for (size_t n = 0; n < 6 * s->count; n++) s->outside[n] = 0.5F;
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    if (richards_is_face(edge)) continue;
    for (int end = 0; end < 6; end++) {
      const uint32_t j = edge->site, f = s->beside[6 * j + (size_t)end];
      double x[3];
      if (f >= BESIDE_EDGE) continue;
      const size_t i = s->faces[f].i == j ? s->faces[f].j : s->faces[f].i;
      if (s->soil[i] + 1U == s->soil_count) continue; /* in it as well, or in free water */
      richards_place(s, j, x);                        /* from there, as the sides may be periodic */
      const int axis = end / 2;
      const double step = end % 2 ? -s->spacing : s->spacing;
      x[axis] -= step;
      s->outside[6 * i + 2 * (size_t)axis + (step > 0)] =
          (float)part_outside(s, edge->region, x, axis, step);
    }
  }
  return STATUS_OK;
}
