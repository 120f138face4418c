/* On the way from a site of soil to one in a well or a drain, only the part t up to the face of the
 * hole resists, and not half of a spacing: k/(t d) between the site's head and the hole's (Gibou,
 * Fedkiw, Cheng, Kang 2002, J. Comput. Phys. 176: second order, and symmetric). With half a
 * spacing, a drain is as wide as the sites in it, and one of 4 spacings takes 9 % too little to 3 %
 * too much, as its centre lies between them.
 *
 * In soil that need not be full the face of a drain is one of seepage (Neuman 1973): water goes
 * into the drain where its pressure is above that of the drain, and none comes back. The site in it
 * takes that, and what comes from outside of the soil, such as rain, and gives it to the drain.
 * Wells take their rate from their sites. */
#include "sphsolve/darcy/hole.h"

#include <math.h>

#include "common/memory.h"
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

/* The well or drain of each site, 1 + its edge; 0: none. */
static enum status find_holes(const struct richards *s, uint32_t **hole) {
  const enum status status = memory_allocate(hole, s->count, sizeof **hole, "wells");
  for (size_t e = 0; e < s->edge_count && status == STATUS_OK; e++)
    if (!richards_is_face(&s->edges[e]) && (s->full || s->edges[e].kind == EDGE_DRAIN))
      (*hole)[s->edges[e].site] = (uint32_t)e + 1;
  return status;
}

/* Whether face f leads from soil into a hole. The way is looked at from the site in the hole, as
 * the sides may be periodic. */
static bool cut_at(const struct richards *s, const uint32_t *hole, size_t f,
                   struct richards_cut *cut) {
  const struct richards_face *face = &s->faces[f];
  const bool high = hole[face->i] == 0;
  const uint32_t i = high ? face->i : face->j, j = high ? face->j : face->i;
  double x[3];
  if (hole[j] == 0 || hole[i] > 0) return false;
  if (s->full && s->soil[i] + 1U == s->soil_count) return false; /* free water */
  *cut = (struct richards_cut){.face = (uint32_t)f, .edge = hole[j] - 1, .high = high};
  domain_place(s->lattice, s->site[j], x);
  const double step = high ? s->spacing : -s->spacing;
  x[face->axis] -= step;
  cut->part = part_outside(s, s->edges[cut->edge].region, x, face->axis, step);
  cut->z = x[2] + (face->axis == 2 ? cut->part * step : 0);
  return true;
}

static enum status find_outside(struct richards *s, const uint32_t *hole) {
  const enum status status =
      memory_allocate(&s->outside, 6 * s->count, sizeof *s->outside, "faces of wells");
  struct richards_cut cut;
  for (size_t n = 0; n < 6 * s->count && status == STATUS_OK; n++) s->outside[n] = 0.5F;
  for (size_t f = 0; f < s->face_count && status == STATUS_OK; f++)
    if (cut_at(s, hole, f, &cut))
      s->outside[6 * (size_t)(cut.high ? s->faces[f].i : s->faces[f].j) +
                 2 * (size_t)s->faces[f].axis + cut.high] = (float)cut.part;
  return status;
}

static enum status find_cuts(struct richards *s, const uint32_t *hole) {
  struct richards_cut cut;
  for (size_t f = 0; f < s->face_count; f++) s->cut_count += cut_at(s, hole, f, &cut);
  const enum status status =
      memory_allocate(&s->cuts, s->cut_count, sizeof *s->cuts, "faces of drains");
  s->cut_count = 0;
  for (size_t f = 0; f < s->face_count && status == STATUS_OK; f++)
    if (cut_at(s, hole, f, &cut)) s->cuts[s->cut_count++] = cut;
  return status;
}

enum status richards_holes_create(struct richards *s) {
  enum status status = STATUS_OK;
  uint32_t *hole = NULL;
  bool any = false;
  for (size_t e = 0; e < s->edge_count; e++) any = any || !richards_is_face(&s->edges[e]);
  if (!any) return status;
  TRY(find_holes(s, &hole));
  TRY(s->full ? find_outside(s, hole) : find_cuts(s, hole));
cleanup:
  memory_free(&hole);
  return status;
}

/* The flux through the face of a drain: from the site i in the soil, through the part of the way up
 * to there, where water stands at the drain's pressure or, above its level, in the air. */
static void flux_to_drain(const struct richards *s, const struct richards_cut *cut, double time,
                          struct flux *flux) {
  const struct richards_face *face = &s->faces[cut->face];
  const uint32_t i = cut->high ? face->i : face->j;
  const struct retention *soil = &s->soils[s->soil[i]];
  struct richards_edge edge = s->edges[cut->edge];
  struct retention_state at_face;
  edge.z = cut->z;
  retention_at(soil, richards_law_at(s, &edge, time).head, &at_face);
  flux_in_soil(soil->conductivity[face->axis], cut->part * s->spacing,
               cut->high ? s->pull[face->axis] : -s->pull[face->axis], &s->now[i], &at_face, flux);
  flux_scale(flux, wall_cuts_face(&s->walls, s->site[face->i], face->axis, true));
  if (!(flux->q > 0)) *flux = (struct flux){0};
}

void richards_holes_flux(struct richards *s, double time) {
  for (size_t n = 0; n < s->cut_count; n++) {
    struct flux out;
    flux_to_drain(s, &s->cuts[n], time, &out);
    s->face_flux[s->cuts[n].face] =
        s->cuts[n].high ? (struct flux){out.q, out.di, 0} : (struct flux){-out.q, 0, -out.di};
  }
}
