/* Head and velocity of a two-dimensional run of isph or darcy on the cells of its lattice, averaged
 * over snapshots. */
#ifndef TOSUI_ANALYZE_SEEPAGE_HEAD_FIELD_H
#define TOSUI_ANALYZE_SEEPAGE_HEAD_FIELD_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analyze/run_file.h"

#define REGION_NONE UINT16_MAX

struct head_region {
  char *type; /* "water", "porous", "wall", "inflow", "empty" */
  /* Of walls, wells and drains with a name; else "", or NULL if the file has none. */
  char *name;
  /* In the scene; the boxes into which a shape is divided have the same number. */
  size_t number;
  double low[2], high[2]; /* m: x, z */
  /* m: of an inflow or a drain; NAN: none, changing in time, or not in the file. */
  double head;
  double porosity;     /* of soil, else NAN */
  double permeability; /* of soil, m/s by linear drag, mean over its layers; else NAN */
  /* Of soil, m/s along x and z by linear drag; NAN: not in the file, or Darcy's law along the axes
   * does not give its steady flow. */
  double conductivity[2];
  double forchheimer; /* s^2/m^2: b of i = v / K + b v^2 */
};

/* Fields on cells [nz][nx] between 0 and the size of the domain, x fastest. */
struct head_field {
  size_t nx, nz;
  double dx, dz;           /* m */
  double thickness;        /* m, along y */
  double gravity, density; /* m/s^2, downwards along z; kg/m^3 */
  size_t region_count;
  struct head_region *regions;
  size_t snapshots;      /* averaged */
  double *speed;         /* [snapshots] m/s: mean magnitude of the Darcy velocity in wet soil */
  double from, to;       /* s: time of the first and last snapshot */
  uint16_t *soil, *wall; /* region of the cell, or REGION_NONE */
  double *head;          /* m, z + P/(rho g); NAN without water */
  double *velocity[2];   /* Darcy velocity, m/s: x, z */
};

/* Whether water enters, or leaves, by such a region within the soil or at its upper face. */
bool head_region_is_source(const struct head_region *region);
bool head_region_is_sink(const struct head_region *region); /* wells, drains */

/* Whether a position (m) is within a window (inflow region). */
bool head_field_is_open(const struct head_field *field, double x, double z);

/* Whether a run is of a method that knows soil as such. */
bool head_field_is_seepage(const struct run *run);

/* Averages the snapshots of the second half of the run, at least the last one. An input error for
 * runs without such a field: other methods, 3-D, gravity not along -z. */
enum status head_field_read(const struct run *run, struct head_field *field);
void head_field_free(struct head_field *field);

/* Whether a cell is wet soil; false outside of the grid. */
static inline bool head_field_is_soil(const struct head_field *f, size_t i, size_t k) {
  return i < f->nx && k < f->nz && f->soil[k * f->nx + i] != REGION_NONE &&
         !isnan(f->head[k * f->nx + i]);
}

/* Centre of a cell, m; z is the elevation. */
static inline double head_field_x(const struct head_field *f, size_t i) {
  return ((double)i + 0.5) * f->dx;
}
static inline double head_field_z(const struct head_field *f, size_t k) {
  return ((double)k + 0.5) * f->dz;
}

/* The heads that the windows and drains in the scene of a seepage run prescribe. */

struct asked_heads {
  /* [nz][nx] m: heads of the run, except for still water before a window and for drains, which have
   * the prescribed ones. */
  double *head;
  bool reached;             /* the water of the run is at the prescribed heads; if not: */
  size_t window;            /* number of the inflow region whose water deviates most */
  double found, prescribed; /* m, its head in the run and the prescribed one */
};

/* For a field read by head_field_read. Heads that the run file does not contain, or that change in
 * time, are taken from the run. Free with asked_heads_free, also after a failure. */
enum status asked_heads_find(const struct head_field *field, struct asked_heads *asked);
void asked_heads_free(struct asked_heads *asked);

#endif
