/* Water in soil that is not full, on the fixed sites of a lattice (Richards 1931), kept in the form
 * that conserves mass (Celia, Bouloutas, Zarba 1990):
 *   d theta(h)/dt = div K(h) (grad h - p)        p: gravity over 9.80665 m/s^2, as a vector
 * Sites that lie in no soil take no part. On sites that never move the sum over neighbours that
 * Brookshaw (1985) and Cleary and Monaghan (1999) write for div K grad is, with the six nearest
 * ones, a sum of fluxes through the faces between sites (flux.h): what leaves one site enters the
 * next, to the last bit. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_STATE_H
#define TOSUI_SPHSOLVE_RICHARDS_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/richards/flux.h"
#include "sphsolve/richards/rows.h"

#define SITE_NONE UINT32_MAX
#define RICHARDS_ALONE 1000 /* so few sites are one thread's work */

/* Between two sites, i the lower along its axis. */
struct richards_face {
  uint32_t i, j;
  uint8_t axis;
  bool soils_differ;
  size_t ij, ji; /* entries of the matrix */
};

enum richards_edge_kind {
  EDGE_AIR,      /* lets water out where it would be under pressure, and rain in */
  EDGE_HEAD,     /* water of a level outside, air above it */
  EDGE_PRESSURE, /* a pressure head that is held */
  EDGE_FLUX,     /* a flux inwards, below 0 as much of it as the soil can give */
  EDGE_WELL,     /* within a well: its share of the rate, as far as pressure brings it */
  EDGE_DRAIN     /* within a drain: what holds its head, and none inwards */
};

/* A face of a site to the outside; or, in a well or a drain, one within it, across no axis. */
struct richards_edge {
  uint32_t site;
  uint8_t axis;
  bool low; /* at the low side of its site */
  enum richards_edge_kind kind;
  const struct region *region; /* inflow that stands there, or rain that falls; NULL: neither */
  double share;                /* of the face that it covers; of a well's rate */
  double z;                    /* m, of its middle */
};

struct richards {
  const struct scene *scene;
  const struct lattice *lattice;
  double spacing, pull[3]; /* m; gravity over 9.80665 m/s^2 */
  size_t count, face_count, edge_count, soil_count;
  struct retention *soils;
  uint32_t *site;   /* [count] of the lattice */
  uint32_t *number; /* [lattice->count] of a site here, or SITE_NONE */
  uint16_t *soil;   /* [count] */
  struct richards_face *faces;
  struct richards_edge *edges;

  double *h, *water; /* [count] m; what each site holds by all that has come and gone, m^3/m^3 */
  double time, next_dt;
  int64_t step;
  /* 1/s: largest change of a water content, over that between dry and full, in the last step, in
   * any, and what full soil's flux by gravity could do to a site. */
  double rate, rate_most, fastest;

  struct retention_state *now;  /* [count] at h */
  struct retention_state *from; /* [count] where a round of Newton's method begins */
  struct flux *face_flux;       /* [faces] m/s along the axis */
  struct flux *edge_flux;       /* [edges] m/s inwards; di: by h of the site */
  double *before, *wanted; /* [count] of a step: h at its start; water content a stage leads from */
  double *first, *second;  /* [count] d theta/dt of its stages by the fluxes, 1/s */
  double *edge_first;      /* [edges] m/s inwards in the first stage */
  double *open, *size;     /* [count] what Newton's method has left; terms that make it up */
  struct rows rows;        /* the matrix of Newton's method */
  double *change;          /* [count] */
  int iterations;          /* of Newton's method, of the last step */
  int64_t iterations_total, linear_total, refused, crawled; /* crawled: short steps on end */
  double tolerance;                                         /* of a step, in water content */

  /* m^3 since the start; a 2-D scene is one spacing thick. */
  double start;             /* of water in the soil */
  double *entered;          /* [regions] through inflows */
  double *rained, *ran_off; /* [regions] of rain; what the soil did not take */
  double seeped;            /* out to the air */
  double in, out;           /* all that came through faces inwards, and outwards */
};

enum status richards_create(const struct scene *scene, const struct lattice *lattice,
                            struct richards *s);
void richards_free(struct richards *s);
/* Centre of a site, m. */
void richards_place(const struct richards *s, size_t i, double x[3]);
/* edges.c: fluxes through the faces to the outside at a time, from the states of the sites. */
void richards_edge_fluxes(struct richards *s, double time);
/* Shares out the rates of wells, for a step: evenly over their sites under pressure. */
void richards_share_wells(struct richards *s);
/* Whether it is a face through which water leaves or enters along its axis. */
static inline bool richards_is_face(const struct richards_edge *edge) {
  return edge->kind != EDGE_WELL && edge->kind != EDGE_DRAIN;
}
/* What rain brings to such a face, m/s; 0 where none falls. */
double richards_rain_at(const struct richards_edge *edge, double time);

/* What a well takes there at most, m/s. */
double richards_well_at(const struct richards *s, const struct richards_edge *edge, double time);

/* step.c: states and all fluxes at a time, for the heads as they are. */
void richards_evaluate(struct richards *s, double time);
/* One step, not beyond `until`; `dt` is what it was. STATUS_NUMERIC where none can be taken. */
enum status richards_advance(struct richards *s, double until, double *dt);
/* m^3 of water in the soil, by its heads; and what has come since the start less what has gone. */
double richards_water(const struct richards *s);
double richards_came(const struct richards *s);

#endif
