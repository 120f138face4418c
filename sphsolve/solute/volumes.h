/* The flow that carries a solute, in finite volumes: what a finished run of stokes leaves, made
 * exact where a solute needs it. Walls cut cells and faces by the signed distance; the volume
 * fluxes through faces are those of the run's velocities, changed as little as makes what flows
 * into a cell flow out of it (a projection: Chorin 1968), so that nothing gathers and nothing
 * crosses a wall.
 *
 * The box repeats along x, y and z. Cell (i, j, k) stands at index (k * n[1] + j) * n[0] + i; the
 * face at the low side of the first cell along an axis is the one at the high side of the last. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_VOLUMES_H
#define TOSUI_SPHSOLVE_SOLUTE_VOLUMES_H

#include <stdbool.h>
#include <stddef.h>

struct solute_flow {
  int n[3];          /* cells along x, y, z; 1 along y in two dimensions */
  size_t count;      /* product of n */
  int dimensions;    /* 2: nothing varies along y */
  double spacing[3]; /* m, of cells along x, y, z */
  double origin[3];  /* m, centre of the first cell */
  float *distance; /* [nz][ny][nx], m, cell centres to the wall, positive in the pore; exact within
                      some spacings of it */
  float *volume;   /* [nz][ny][nx], fluid share of each cell, 0..1 */
  float *aperture[3]; /* fluid share of the face at the low side of each cell along x, y, z, 0..1 */
  float *velocity[3]; /* volume flux through that face per area of the whole face, m/s, positive
                         along the axis; 0 where the aperture is 0; what flows into a cell flows
                         out, to rounding */
  double mean_velocity[3]; /* m/s, of the water in the pores that are kept, along x, y, z */
  double speed;            /* m/s, its magnitude */
  double porosity;         /* pores that are kept over the whole box */
  double isolated;         /* share of the pore volume that no flow passes; its cells are closed */
  double grain_size;       /* m, 6 grain volume / grain surface: the diameter of equal spheres */
  bool image[3];           /* the box is its own mirror image along x, y, z */
  bool mirrored;     /* along the axis that the flow goes along most: creeping flow then brings
                        every streamline back to its place */
  double correction; /* what the projection changed: rms over faces, over the rms flux */
  double viscosity, density; /* of the run; NAN where none is known */
};

#endif
