/* What a lattice of particles does to the steepest wave it can carry: the eigenvalues behind the
 * limits of the time step. */
#ifndef TOSUI_SPHSOLVE_WCSPH_MODES_H
#define TOSUI_SPHSOLVE_WCSPH_MODES_H

#include <stdbool.h>

#include "common/kernel.h"

#define MODE_WAVES 9 /* wave numbers per axis, 0 to pi over the spacing */

struct lattice_modes {
  double sum;       /* sum V W: density of the undisturbed lattice over rho_0 */
  double gradient;  /* 1/m: largest |G(k)| of the gradient; omega = c |G| with the gauge pressure */
  double laplacian; /* 1/m^2: largest eigenvalue of Morris' viscous operator over nu */
  double absolute;  /* 1/m: as gradient, with the absolute pressure c^2 rho */
  double moment;    /* sum V r . grad W / dimensions: 1 for a gradient that is exact */
  double shifting_stiffness; /* 1/m^2: largest eigenvalue of sum V grad W, by displacement */
  double weights;            /* 1/m^2: sum of 2 V (-dW/dr)/r */
  int neighbours;            /* within reach of a site */
  int count;
  double wave[MODE_WAVES * MODE_WAVES * MODE_WAVES][3]; /* gradient, absolute, laplacian of each */
};

/* Anisotropic spacing allowed; dimensions 2 (x, z) or 3. */
struct lattice_modes lattice_modes_find(enum kernel kernel, int dimensions, const double spacing[3],
                                        double smoothing_length);

/* Largest stable step, s, for each wave by itself (the wave that sound moves fastest is not the one
 * that viscosity damps most). A step takes velocity and pressure of a wave by
 *   v' = (1 - a) v - s p,  p' = (1 - b) p + q s v',  a = dt nu l,  s = dt c g,
 *   q = 1/(1 + dt D w),  b = q dt D l
 * with the pressure diffusion D of effects/pressure_diffusion.h, w the sum of its weights: stable
 * while q s^2 < (2 - a) (2 - b) (Jury's criterion). */
double lattice_modes_dt(const struct lattice_modes *modes, bool absolute, double sound_speed,
                        double kinematic_viscosity, double diffusion);

#endif
