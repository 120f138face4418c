/* Water in variably saturated soil on the fixed sites of a lattice (Richards 1931), in the mixed
 * form, which conserves mass (Celia, Bouloutas, Zarba 1990):
 *   d theta(h)/dt = div K(h) (grad h - p)        p: gravity over 9.80665 m/s^2, as a vector
 * Sites without soil take no part. On sites that do not move, the sum over neighbours that
 * Brookshaw (1985) and Cleary and Monaghan (1999) use for div K grad becomes, with the six nearest
 * neighbours, a sum of fluxes through the faces between sites (flux.h): what leaves one site enters
 * the next, exactly. */
#ifndef TOSUI_SPHSOLVE_DARCY_STATE_H
#define TOSUI_SPHSOLVE_DARCY_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/darcy/basin.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/geometry/wall_cuts.h"
#include "sphsolve/darcy/flux.h"
#include "sphsolve/darcy/rows.h"

#define SITE_NONE UINT32_MAX
#define BESIDE_EDGE 0x80000000u
#define RICHARDS_SERIAL_MAX 1000 /* up to so many sites are processed by one thread */

/* A face between two sites, i the lower along its axis. */
struct richards_face {
  uint32_t i, j;
  uint8_t axis;
  bool soils_differ;
  size_t ij, ji; /* the entries of the matrix in rows i and j */
};

enum richards_edge_kind {
  EDGE_AIR,      /* to the air: lets water out that is under pressure, and what is given in */
  EDGE_HEAD,     /* water outside up to a level, the same as to the air above it */
  EDGE_PRESSURE, /* a prescribed pressure head */
  EDGE_POOL,     /* the same with the level of a body of water (darcy/pond.h) */
  EDGE_FLUX,     /* given inward fluxes; if negative, limited by what the soil can give */
  EDGE_WELL,     /* in a well: its share of the rate, as far as the pressure yields it */
  EDGE_DRAIN     /* in a drain: the outflow that holds its head, and no inflow */
};

/* Rain or a given flux on a part of a boundary face. */
struct richards_source {
  const struct region *region;
  double share; /* of the face that the region covers */
};

/* A boundary face of a site; or, in a well or a drain, its exchange with the site, normal to no
 * axis. */
struct richards_edge {
  uint32_t site;
  uint8_t axis;
  bool low;    /* on the low side of its site */
  double open; /* share of the face that no wall covers; in a well or drain 1 */
  enum richards_edge_kind kind;
  const struct region *region;   /* what holds a head there, its well or drain; NULL: none */
  uint32_t source, source_count; /* what is given there: the first of them, and their number */
  uint32_t pool;                 /* 1 + the number of its free water; 0: none */
  double share;                  /* of the rate of a well */
  double z;                      /* m, of its centre */
};

/* A face that leads from soil into a drain (darcy/hole.c). */
struct richards_cut {
  uint32_t face, edge; /* that of the site in the drain */
  bool high;           /* it is that at the face's high end */
  double part, z; /* of the way between the two sites that lies in soil; m, of the drain's face */
};

/* Free water whose level follows from its balance (darcy/pond.h): what rain leaves on one face, or
 * a body of water. */
struct richards_pool {
  const struct region *region; /* of the body's water; NULL: of a face */
  /* The first of its faces in pool_edges, of the areas of its layers, from the floor up and a
   * spacing high each but the last, in pool_areas, of the heights of its faces in pool_heights, and
   * of what it catches in sources, with areas as shares of a face; their numbers. */
  size_t edge, edge_count, layer, layer_count, height, height_count, source, source_count;
  double floor, most;     /* m; m^3, above which it runs off */
  double *volume, before; /* m^3: now, in pool_volumes, and at the start of the step */
  double from, first;     /* m^3 at the start of the stage; m^3/s in the first stage */
  double level;           /* m */
  double share;           /* of faces at its level that is wet */
  double storage;         /* m^2: change of the volume with the level; INFINITY: it stays */
};

struct richards_pool_edge {
  size_t edge, ij, ji; /* entries of the matrix in the row of its site and in that of the pool */
};

struct richards {
  const struct scene *scene;
  const struct lattice *lattice;
  double spacing, pull[3]; /* m; gravity over 9.80665 m/s^2, along each axis */
  struct wall_cuts walls;  /* what walls leave open of cells */
  size_t count, face_count, edge_count, source_count, soil_count;
  struct retention *soils;
  uint32_t *site;   /* [count]: index in the lattice */
  uint32_t *number; /* [lattice->count]: index of a site here, or SITE_NONE */
  uint16_t *soil;   /* [count]: index of its soil */
  /* [lattice->count]: open_water_find and basin_find; NULL where soil is full */
  uint16_t *open;
  struct basin *basins; /* [regions], likewise */
  struct richards_face *faces;
  struct richards_edge *edges;
  struct richards_source *sources;
  struct richards_cut *cuts; /* in soil that need not be full; NULL without drains */
  size_t cut_count;
  uint32_t *beside; /* [count][3][2]: the face at the low and at the high end of a site along each
                     * axis; or the edge there, with BESIDE_EDGE; or SITE_NONE, which is closed */

  /* [count]: pressure head, m; water content from the balance of fluxes, m^3/m^3 */
  double *h, *water;
  double time, next_dt;
  int64_t step;
  /* Rates of change of a water content over the range between residual and saturated, 1/s: the
   * largest in the last step, the largest in any step, and that by the gravity-driven flux of
   * saturated soil. */
  double rate, rate_most, fastest;

  struct retention_state *now;  /* [count]: states at h */
  struct retention_state *from; /* [count]: states at the start of a Newton iteration */
  struct flux *face_flux;       /* [faces]: m/s along the axis */
  struct flux *edge_flux;       /* [edges]: m/s inwards; di: derivative by h of the site */
  /* [count]: h at the start of a step; water content from which a stage starts */
  double *before, *target;
  double *first, *second; /* [count]: d theta/dt of the two stages by the fluxes, 1/s */
  double *edge_first;     /* [edges]: m/s inwards in the first stage */
  double *residual,
      *term_size;   /* [count]: residual of Newton's method; size of the terms that make it up */
  struct rows rows; /* the matrix of Newton's method, and of soil that is full */
  double *change;   /* [count]: Newton step */
  /* Soil that is full of water and stays so (darcy/saturated.h), else not allocated. */
  /* It is full; a permeability has a component xz; heads, fluxes or rates change in time. */
  bool full, turned, changes;
  size_t corner_count;
  uint32_t (*corners)[2]; /* sites that share an edge along y, and no face, with i < j */
  uint32_t *body;         /* [count]: the least number of a site that is connected to it */
  float *outside;   /* [count][3][2]: part of the way to the next site that lies in soil, where
                     * that is in a well or a drain; else half; NULL without any */
  double *speed;    /* [count]: |v| of Forchheimer's term, m/s */
  uint8_t *limited; /* [edges]: 0, or 1 and 2 where the least or most flux of its law holds */
  int iterations;   /* Newton iterations of the last step */
  /* `short_steps`: number of consecutive very short steps */
  int64_t iterations_total, linear_total, refused, short_steps;
  double tolerance; /* of a step's error in water content */

  /* m^3 since the start; a 2-D scene is one spacing thick. */
  double start;             /* volume of water in the soil at the start */
  double *entered;          /* [regions]: inflow; negative: outflow */
  double *rained, *ran_off; /* [regions]: rain; the part of it that neither went into the soil nor
                               stands on it */
  double seeped;            /* seepage to the air */
  /* Free water with a level of its own (darcy/pond.h); else not allocated. Pool n has row count + n
   * of the matrix, and entries with each of `pool_pairs`: a site and that row. */
  size_t pool_count, pool_edge_count, pool_pair_count;
  struct richards_pool *pools;
  struct richards_pool_edge *pool_edges;
  double *pool_areas, *pool_heights; /* m^2, m */
  double *pool_volumes;              /* [pools] m^3 */
  uint32_t (*pool_pairs)[2];
  double stage;   /* s; length of the stage that is solved, 0 between steps */
  double in, out; /* total inward and total outward flow through boundary faces */
};

/* What walls leave open of the cell of a site, over the cell. */
static inline double richards_volume(const struct richards *s, size_t i) {
  return wall_cuts_volume(&s->walls, s->site[i]);
}

#endif
