/* What a lattice of particles does to the steepest wave it can carry: the eigenvalues behind the
 * limits of the time step. */
#ifndef TOSUI_METHODS_WCSPH_MODES_H
#define TOSUI_METHODS_WCSPH_MODES_H

struct lattice_modes {
  double sum;       /* sum V W: density of the undisturbed lattice over rho_0 */
  double gradient;  /* 1/m: largest |G(k)| of the gradient; omega = c |G| with the gauge pressure */
  double laplacian; /* 1/m^2: largest eigenvalue of Morris' viscous operator over nu */
  double absolute;  /* 1/m: as gradient, with the absolute pressure c^2 rho */
  double crowding;  /* 1/m^2: largest eigenvalue of sum V grad W, by displacement */
};

/* Quintic kernel; anisotropic spacing allowed; dimensions 2 (x, z) or 3. */
struct lattice_modes lattice_modes_find(int dimensions, const double spacing[3],
                                        double smoothing_length);

#endif
