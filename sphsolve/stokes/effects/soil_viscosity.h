/* The viscosity of water in soil of porosity n is 1/n times that of free water, where the velocity
 * is the superficial one and the stress that on the fluid (Whitaker 1999, ch. 4; Ochoa-Tapia,
 * Whitaker 1995, without a stress jump): velocity and stress are continuous at the surface of the
 * soil.
 *
 * A link between two sites of soil has a mean of both viscosities. A link between pore and soil,
 * whose surface is half-way, consists of two halves in series. Beneath the surface the velocity in
 * soil falls to that of Darcy's law over the length sqrt(k / n), which may be far less than a
 * spacing: for the flow in the pore the surface then has a slip length (Beavers, Joseph 1967;
 * Neale, Nader 1974) L = sqrt(k n). The sites beneath the surface resolve the part 1/X of L,
 * X^2 = X / k + 1 / (n k), and the viscosity W of the link provides the rest: 1/W = 1/2 + L - 1/X.
 * For k -> 0 this is a wall half-way, for k -> infinity 1/W = (1 + n) / 2, the two in series. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_VISCOSITY_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_VISCOSITY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/stokes/effects/soil_drag.h"

/* Slip length L = sqrt(k n), in spacings; k in spacing^2. */
static inline double stokes_soil_slip(double porosity, double permeability) {
  return sqrt(porosity * permeability);
}

/* Viscosity W of a link between soil and pore, over that of free water. */
static inline double stokes_soil_viscosity_to_pore(double porosity, double permeability) {
  const double resolved = 2.0 * permeability / (1.0 + sqrt(1.0 + 4.0 * permeability / porosity));
  return 1.0 / (0.5 + stokes_soil_slip(porosity, permeability) - resolved);
}

/* Term of the momentum equation's parabola (wall_subvoxel.h) for the half link above soil: 1/4 at a
 * wall, less where the surface slips. `slip`: L, spacings. */
static inline double stokes_soil_parabola(double slip) {
  return 0.25 / (1.0 + 2.0 * slip);
}

static inline bool stokes_soil_viscosity_wanted(const struct effect_context *context,
                                                char why[EFFECT_WHY]) {
  const bool on = stokes_soil_wanted(context);
  snprintf(why, EFFECT_WHY, on ? "stress and slip at the surface of soil" : "no point is soil");
  return on;
}

#endif

EFFECT(stokes_soil_viscosity, .model = "viscosity 1/n in soil; its surface slips over sqrt(k n)",
       .citation = "Whitaker 1999, ch. 4; Beavers, Joseph 1967; Neale, Nader 1974",
       .wanted = stokes_soil_viscosity_wanted)
