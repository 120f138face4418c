/* Expected error of k from the geometry alone, before anything is solved. */
#ifndef TOSUI_SPHSOLVE_PLAN_ERROR_FORECAST_H
#define TOSUI_SPHSOLVE_PLAN_ERROR_FORECAST_H

#include <stdbool.h>

#include "sphsolve/plan/effect.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"

/* Lengths are in spacings; without walls they are infinite and the slope is 0. */
struct pore_shape {
  double width; /* mean pore width, 4 V / S of the pores */
  double open;  /* the same without the pore volume filled by soil */
  double
      throat;  /* critical width along the force (geometry/throat_width.h); infinite without one */
  double ways; /* mean pores side by side in a plane across the force */
  int dimensions;
  double grain;  /* mean thickness, 2 V / S of the grains; infinite between boxes */
  double slope;  /* d ln k if all walls recede by one spacing, after Kozeny and Carman */
  double outer;  /* mean depth of the wall sites next to fluid behind the surface */
  double middle; /* mean depth of the midpoint of these pairs of sites (< 0: in the fluid) */
  bool sharp;    /* walls are boxes or voxel faces */
  bool straight; /* and has hardly any edges: ducts */
  bool flat;     /* and all normal to one axis: slits */
};

/* Computed from the kinds, distances and faces of the lattice. */
void pore_shape_find(const struct scene *scene, const struct lattice *lattice,
                     struct pore_shape *shape);

/* Expected |k/k_exact - 1|. Where two parts of opposite sign may cancel, `error` is the root of the
 * sum of their squares, and `least` the smallest possible remainder, or 0 if they have similar
 * size: the error then passes through zero, and only the range is meaningful. Otherwise both are
 * equal. */
struct error_forecast {
  double error, least; /* NAN: no walls */
  double pores;        /* error without the part of the narrowest way */
  char why[EFFECT_WHY];
};

/* Forecast for the spacing divided by `refined`. */
struct error_forecast error_forecast_of(const struct pore_shape *shape, const struct method *method,
                                        enum wall_scheme wall, double refined);

#endif
