/* How wrong k will be, expected from the geometry alone before anything is solved. */
#ifndef TOSUI_SPHSOLVE_PLAN_ERROR_FORECAST_H
#define TOSUI_SPHSOLVE_PLAN_ERROR_FORECAST_H

#include <stdbool.h>

#include "sphsolve/plan/effect.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"

/* Lengths in spacings; infinite, and slope 0, without walls. */
struct pore_shape {
  double width;  /* mean pore, 4 V / S of the pores */
  double open;   /* of what soil below the voxel leaves of the pores, within the walls' surface */
  double grain;  /* mean thickness, 2 V / S of the grains; infinite between boxes */
  double slope;  /* d ln k if all walls recede by one spacing, after Kozeny and Carman */
  double outer;  /* the wall sites next to fluid lie so far behind the surface, on the average */
  double middle; /* and the middle between them and their fluid sites so far (or before it: < 0) */
  bool sharp;    /* walls are boxes or voxel faces */
  bool straight; /* and hardly any edge stands out: ducts */
  bool flat;     /* and all of one direction: slits */
};

/* From kinds, distances and faces of the lattice. */
void pore_shape_find(const struct scene *scene, const struct lattice *lattice,
                     struct pore_shape *shape);

/* |k/k_exact - 1| to expect. Where two parts of unlike sign may cancel, `error` is the root of the
 * sum of their squares and `least` what may be left of them, 0 where they are of one size: the
 * error passes through zero there, and only the range says something. Else both are the same. */
struct error_forecast {
  double error, least; /* NAN: no walls */
  char why[EFFECT_WHY];
};

/* With the spacing divided by `refined`. */
struct error_forecast error_forecast_of(const struct pore_shape *shape, const struct method *method,
                                        enum wall_scheme wall, double refined);

#endif
