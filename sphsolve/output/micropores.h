/* What soil with pores below the sites does to k: how much of the flux goes through it, how k
 * answers to its permeability, and k over that permeability. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_MICROPORES_H
#define TOSUI_SPHSOLVE_OUTPUT_MICROPORES_H

#include <jansson.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "sphsolve/scene/scene.h"

/* With the permeabilities of all soil times `factor`; NAN: not found. */
struct micropores_point {
  double factor;
  double k;         /* m/s */
  double flux;      /* fraction of the flux along the force that goes through soil */
  double connected; /* share of the soil's sites that lie on a path along the force */
  double slope; /* d ln k / d ln k_micro, which is the share of the force's power that drag takes */
};

struct micropores {
  double sites;                /* share of all sites that are soil; 0: there is none */
  double porosity;             /* mean */
  double permeability;         /* geometric mean, m^2 */
  struct micropores_point own; /* of the soil as it is */
  int count;
  struct micropores_point curve[MICRO_FACTORS_MOST + 1]; /* by factor, with `own`; count 0: none */
};

/* A point in its place in the curve. */
void micropores_add(struct micropores *micropores, const struct micropores_point *point);
void micropores_print(const struct micropores *micropores);
json_t *micropores_json(const struct micropores *micropores);
/* /run/micro of an open file. */
enum status micropores_write(const struct micropores *micropores, struct h5_file *file);

#endif
