/* Eigenvalues of the discrete operators on a regular particle lattice, which determine the limits
 * of the time step. */
#ifndef TOSUI_SPHSOLVE_WCSPH_MODES_H
#define TOSUI_SPHSOLVE_WCSPH_MODES_H

#include <stdbool.h>

#include "common/kernel.h"

#define MODE_WAVES 9 /* wave numbers per axis, 0 to pi over the spacing */

struct lattice_modes {
  double sum;       /* sum V W: density of the undisturbed lattice / rho_0 */
  double gradient;  /* 1/m: largest |G(k)| of the gradient; omega = c |G| with the gauge pressure */
  double laplacian; /* 1/m^2: largest eigenvalue of Morris' viscous operator / nu */
  double absolute;  /* 1/m: like gradient, with the absolute pressure c^2 rho */
  double moment;    /* sum V r . grad W / dimensions: 1 if the gradient is exact */
  /* 1/m^2: largest eigenvalue of the derivative of sum V grad W with respect to displacement. */
  double shifting_stiffness;
  double weights; /* 1/m^2: sum of 2 V (-dW/dr)/r */
  int neighbours; /* within the support of a site */
  int count;
  double wave[MODE_WAVES * MODE_WAVES * MODE_WAVES][3]; /* gradient, absolute, laplacian of each */
};

/* The spacing may be anisotropic; dimensions 2 (x, z) or 3. */
struct lattice_modes lattice_modes_find(enum kernel kernel, int dimensions, const double spacing[3],
                                        double smoothing_length);

/* Largest stable step, s, from the stability of each wave (the wave with the largest sound
 * frequency is not the most viscous one). A step changes velocity and pressure of a wave by
 *
 * v' = (1 - a) v - s p, p' = (1 - b) p + q s v', a = dt nu l, s = dt c g, q = 1/(1 + dt D w), b = q
 * dt D l
 *
 * with the pressure diffusion D of effects/pressure_diffusion.h and w the sum of its weights:
 * stable if q s^2 < (2 - a) (2 - b) (Jury's criterion). */
double lattice_modes_dt(const struct lattice_modes *modes, bool absolute, double sound_speed,
                        double kinematic_viscosity, double diffusion);

#endif
