/* The viscosity of water in soil of porosity n is 1/n times water's, where the velocity is the
 * superficial one and the stress that on the fluid (Whitaker 1999, ch. 4; Ochoa-Tapia, Whitaker
 * 1995, without a jump of stress): velocity and stress are continuous at the surface of soil.
 *
 * Of a link between two sites of soil it is a mean of the two; between pore and soil, whose surface
 * is half-way, the two halves are in series. Beneath its surface the velocity in soil falls to that
 * of Darcy over sqrt(k / n), which may be far less than a site: the surface then slips over
 * L = sqrt(k n) (Beavers, Joseph 1967; Neale, Nader 1974). What the sites beneath give of L by
 * themselves is 1/X, X^2 = X / k + 1 / (n k); the half link has the rest:
 *   1/W = 1/2 + L - 1/X
 * k -> 0: a wall half-way; k -> infinity: (1 + n) / 2, the harmonic mean. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_VISCOSITY_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_VISCOSITY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/stokes/effects/soil_drag.h"

/* In spacings; k in spacing^2. */
static inline double stokes_soil_slip(double porosity, double permeability) {
  return sqrt(porosity * permeability);
}

/* W: viscosity of a link to a pore, over water's. */
static inline double stokes_soil_viscosity_to_pore(double porosity, double permeability) {
  const double resolved = 2.0 * permeability / (1.0 + sqrt(1.0 + 4.0 * permeability / porosity));
  return 1.0 / (0.5 + stokes_soil_slip(porosity, permeability) - resolved);
}

/* Half of the last link above soil is bent as the momentum equation says (wall_subvoxel.h): what is
 * left of a wall's quarter. */
static inline double stokes_soil_parabola(double slip) {
  return 0.25 / (1.0 + 2.0 * slip);
}

static inline bool stokes_soil_viscosity_wanted(const struct effect_context *context,
                                                char why[EFFECT_WHY]) {
  const bool on = stokes_soil_wanted(context);
  snprintf(why, EFFECT_WHY, on ? "stress and slip at the surface of soil" : "no site is soil");
  return on;
}

#endif

EFFECT(stokes_soil_viscosity, .model = "viscosity 1/n in soil; its surface slips over sqrt(k n)",
       .citation = "Whitaker 1999, ch. 4; Beavers, Joseph 1967; Neale, Nader 1974",
       .wanted = stokes_soil_viscosity_wanted)
