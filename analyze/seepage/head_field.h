/* Head and velocity of a 2-D run of isph on the cells of its lattice, as means over snapshots. */
#ifndef TOSUI_ANALYZE_SEEPAGE_HEAD_FIELD_H
#define TOSUI_ANALYZE_SEEPAGE_HEAD_FIELD_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analyze/run_file.h"

#define REGION_NONE UINT16_MAX

struct head_region {
  char *type;             /* "water", "porous", "wall", "inflow", "empty" */
  char *name;             /* of walls, wells and drains that have one; else "", or NULL: not kept */
  size_t number;          /* in the scene; boxes that one of its shapes is cut into have the same */
  double low[2], high[2]; /* m: x, z */
  double head;            /* m: of an inflow or a drain; NAN: none, it changes, it is not kept */
  double porosity;        /* of soil, else NAN */
  double permeability;    /* of soil, m/s by linear drag, of beds the mean; else NAN */
  double conductivity[2]; /* of soil, m/s along x and z by linear drag; NAN: Darcy's law does not
                             give its steady flow along axes, or it is not kept */
  double forchheimer;     /* s^2/m^2: b of i = v / K + b v^2 */
};

/* Cells [nz][nx] between 0 and the domain's size, x fastest. */
struct head_field {
  size_t nx, nz;
  double dx, dz;           /* m */
  double thickness;        /* m, along y */
  double gravity, density; /* m/s^2, downwards along z; kg/m^3 */
  size_t region_count;
  struct head_region *regions;
  size_t snapshots;      /* in the mean */
  double *speed;         /* [snapshots] m/s: mean size of the Darcy velocity in wet soil */
  double from, to;       /* s: of these */
  uint16_t *soil, *wall; /* region that the cell is in, REGION_NONE */
  double *head;          /* m, z + P/(rho g); NAN where there is no water */
  double *velocity[2];   /* Darcy velocity, m/s: x, z */
};

/* Water comes in or goes out of such a region inside the soil or over its top. */
bool head_region_is_source(const struct head_region *region);
bool head_region_is_sink(const struct head_region *region); /* wells, drains */

/* Whether a place (m) lies in a window. */
bool head_field_is_open(const struct head_field *field, double x, double z);

/* Means over the snapshots of the run's second half, at least the last. An input error for runs
 * that have no such field: other methods, 3-D, no gravity along -z. */
enum status head_field_read(const struct run *run, struct head_field *field);
void head_field_free(struct head_field *field);

/* Whether a cell is wet soil; not beyond the last. */
static inline bool head_field_is_soil(const struct head_field *f, size_t i, size_t k) {
  return i < f->nx && k < f->nz && f->soil[k * f->nx + i] != REGION_NONE &&
         !isnan(f->head[k * f->nx + i]);
}

/* A cell's centre, m; z is the elevation. */
static inline double head_field_x(const struct head_field *f, size_t i) {
  return ((double)i + 0.5) * f->dx;
}
static inline double head_field_z(const struct head_field *f, size_t k) {
  return ((double)k + 0.5) * f->dz;
}

#endif
