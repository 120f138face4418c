/* Soil with pores below the site spacing resists in proportion to the superficial velocity v:
 *   0 = F - grad p + (1/n) laplace v - v / k        (nu = rho = 1; n porosity, k permeability)
 * This is the steady, slow form of the unified equation of Morimoto, Akbari et al. (2015), where
 * water has n = 1 and 1/k = 0 (Darcy, Brinkman, Stokes; Whitaker 1999, ch. 4). p is the pressure in
 * the pores. Where k jumps, flux and pressure are continuous but the gradient of p is not (Whitaker
 * 1999, ch. 4). Sites therefore have mobilities M, links between them the harmonic mean M_ab, and
 *   (G p)_a = (1/M_a) sum over b of M_ab (p_b - p_a) g_ab
 * is the gradient on the side of site a. The divergence is minus its transpose; the stabilisation
 * uses gamma M in place of gamma, and M_ab in L. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_DRAG_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_DRAG_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/stokes/constants.h"

/* Mobility of soil over that of a pore: M = 1 / (1 / STOKES_SOIL_PORE + 1 / k), k in spacing^2. The
 * drag of layers in series is exact for any STOKES_SOIL_PORE. */
static inline double stokes_soil_mobility(double permeability) {
  return permeability / (permeability + STOKES_SOIL_PORE);
}

/* The inverse: k in spacing^2 from the mobility over that of a pore. */
static inline double stokes_soil_permeability(double mobility) {
  return STOKES_SOIL_PORE * mobility / (1.0 - mobility);
}

/* Harmonic mean of the mobilities of soil and pore, over that of a pore. */
static inline double stokes_soil_mobility_to_pore(double mobility) {
  return 2.0 * mobility / (1.0 + mobility);
}

static inline bool stokes_soil_wanted(const struct effect_context *context) {
  return context->lattice->micro_porosity != NULL;
}

static inline bool stokes_soil_drag_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  const bool on = stokes_soil_wanted(context);
  snprintf(why, EFFECT_WHY,
           on ? "points of the model are soil with pores below the voxel" : "no point is soil");
  return on;
}

#endif

EFFECT(stokes_soil_drag, .model = "drag v / k where a site is soil; Darcy's law in its depth",
       .citation = "Morimoto, Akbari et al. 2015, steady and slow; Whitaker 1999, ch. 4",
       .wanted = stokes_soil_drag_wanted)
