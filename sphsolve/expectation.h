/* How wrong k will be, expected from the geometry alone before anything is solved. */
#ifndef TOSUI_SPHSOLVE_EXPECTATION_H
#define TOSUI_SPHSOLVE_EXPECTATION_H

#include <stdbool.h>

#include "sphsolve/effect.h"
#include "sphsolve/lattice.h"
#include "sphsolve/scene.h"

/* Lengths in spacings; infinite without walls. */
struct pore_shape {
  double width; /* mean pore: 4 V / S of the pores, S the faces less their excess of 3/2 */
  double bend;  /* sqrt(width 3 V / S of the grains): pore and grain must both be resolved */
  bool straight; /* walls are those of boxes */
  bool flat;     /* and all of one direction: slits */
  bool faces;    /* walls lie on voxel faces */
};

void pore_shape_find(const struct scene *scene, const struct lattice *lattice,
                     struct pore_shape *shape);

/* Relative error of k with the spacing divided by `refined`. */
double expect_error(const struct pore_shape *shape, enum method method, enum wall_scheme wall,
                    double refined, char why[EFFECT_WHY]);

#endif
