/* Soil with pores below the sites resists in proportion to the superficial velocity v:
 *   0 = F - grad p + (1/n) laplace v - v / k        (nu = rho = 1; n porosity, k permeability)
 * the steady slow form of the unified equation of Morimoto, Akbari et al. (2015), where water has
 * n = 1 and 1/k = 0 (Darcy, Brinkman, Stokes; Whitaker 1999, ch. 4). p is the pressure in the
 * pores. Flux and pressure are continuous where k jumps (Whitaker 1999, ch. 4), so that the
 * gradient of the pressure kinks there. With mobilities M of sites, and of links their harmonic
 * mean M_ab, (G p)_a = (1/M_a) sum of M_ab (p_b - p_a) g_ab takes from each link a site's own side
 * of the kink, and minus its transpose is the divergence; the stabilisation is gamma M, L with
 * M_ab. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_DRAG_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_SOIL_DRAG_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"

/* A pore's mobility, spacing^2. The drag of layers in series is exact for any; a small one lets
 * flux pass the surface of soil by the stabilisation, a large one takes that from the depth of
 * soil. Of 0.05, 0.2, 0.4, 1 and 4 layers of 8 sites are off by up to 8, 2, 1, 1.6 and 2 %, after
 * 35, 35, 50, 92 and 250 iterations (verify_micro). */
#define STOKES_SOIL_PORE 0.4

/* Mobility over that of a pore: M = 1 / (1 / STOKES_SOIL_PORE + 1 / k), k in spacing^2. */
static inline double stokes_soil_mobility(double permeability) {
  return permeability / (permeability + STOKES_SOIL_PORE);
}

/* And back. */
static inline double stokes_soil_permeability(double mobility) {
  return STOKES_SOIL_PORE * mobility / (1.0 - mobility);
}

/* Harmonic mean of the mobilities of soil and pore, over a pore's. */
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
           on ? "sites of the model are soil with pores below the voxel" : "no site is soil");
  return on;
}

#endif

EFFECT(stokes_soil_drag, .model = "drag v / k where a site is soil; Darcy's law in its depth",
       .citation = "Morimoto, Akbari et al. 2015, steady and slow; Whitaker 1999, ch. 4",
       .wanted = stokes_soil_drag_wanted)
