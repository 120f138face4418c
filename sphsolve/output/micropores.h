/* Effect on k of soil with pores smaller than the sites: its fraction of the flux, the sensitivity
 * of k to its permeability, and k as a function of that permeability. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_MICROPORES_H
#define TOSUI_SPHSOLVE_OUTPUT_MICROPORES_H

#include <jansson.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "sphsolve/scene/scene.h"

/* Result with the permeabilities of all soil multiplied by `factor`; NAN: not computed. */
struct micropores_point {
  double factor;
  double k;         /* m/s */
  double flux;      /* fraction of the flux along the force through soil */
  double connected; /* fraction of the soil sites on a path along the force */
  /* D ln k / d ln k_micro, equal to the fraction of the power dissipated by the drag of soil. */
  double slope;
};

struct micropores {
  double sites;                /* fraction of all sites that are soil; 0: no soil */
  double porosity;             /* mean */
  double permeability;         /* geometric mean, m^2 */
  struct micropores_point own; /* result with the unchanged soil */
  int count;
  /* Ascending factors, including `own`; count 0: none. */
  struct micropores_point curve[MICRO_FACTORS_MOST + 1];
};

/* Inserts a point in the order of the curve. */
void micropores_add(struct micropores *micropores, const struct micropores_point *point);
void micropores_print(const struct micropores *micropores);
json_t *micropores_json(const struct micropores *micropores);
/* Writes /run/micro of an open file. */
enum status micropores_write(const struct micropores *micropores, struct h5_file *file);

#endif
