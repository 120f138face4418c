/* The flow that carries a solute, in finite volumes, from a finished run of method stokes. Walls
 * cut cells and faces by the signed distance. The volume fluxes through faces are those of the
 * run's velocities with the smallest change that makes them divergence-free (a projection: Chorin
 * 1968), so that no solute accumulates and none crosses a wall.
 *
 * The box is periodic along x, y and z. Cell (i, j, k) has the index (k * n[1] + j) * n[0] + i; the
 * face at the low side of the first cell along an axis is the one at the high side of the last. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_VOLUMES_H
#define TOSUI_SPHSOLVE_SOLUTE_VOLUMES_H

#include <stdbool.h>
#include <stddef.h>

struct solute_flow {
  int n[3];           /* cells along x, y, z; 1 along y in two dimensions */
  size_t count;       /* product of n */
  int dimensions;     /* 2: nothing varies along y */
  double spacing[3];  /* m, of cells along x, y, z */
  double origin[3];   /* m, centre of the first cell */
  float *distance;    /* [nz][ny][nx], m, wall distance of cell centres, positive in the pore; exact
                         within some spacings of the wall */
  float *volume;      /* [nz][ny][nx], fluid fraction of each cell, 0..1 */
  float *aperture[3]; /* fluid fraction of the face at the low side of each cell along x, y, z */
  float *velocity[3]; /* volume flux through that face per area of the whole face, m/s, positive
                         along the axis; 0 where the aperture is 0; divergence-free in each cell up
                         to rounding */
  double mean_velocity[3]; /* m/s, pore velocity along x, y, z, without isolated pores */
  double speed;            /* m/s, its magnitude */
  double porosity;         /* without isolated pores */
  double isolated;         /* fraction of the pore volume without flow; its cells are closed */
  double grain_size;       /* m, 6 grain volume / grain surface: the diameter of equal spheres */
  bool image[3];           /* the box is its own mirror image along x, y, z */
  bool mirrored;     /* the same along the main direction of the flow: creeping flow then brings
                        every streamline back to its place */
  bool thin_walls;   /* some are thinner than the spacing: the distances do not show them */
  double correction; /* change by the projection: rms over faces, relative to the rms flux */
  double viscosity, density; /* of the run; NAN where unknown */
};

#endif
