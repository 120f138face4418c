/* Drag of the soil on the water, implicit (M15 eqs. 8, 9, 19; Akbari 2014):
 *   (C_r/eps) Dv_D/Dt = G (f - grad P/rho) ... - a v_D - b |v_D| v_D,   G = 1 (Akbari) or 1/eps
 * (M15) linearised about v^n after Newton, |v| v -> 2 |v^n| v - |v^n| v^n, so that with T = eps G
 * dt / C_r v* = B [ v^n + T ( ... + b/G |v^n| v^n ) ],   B = 1 / (1 + T (a + 2 b |v^n|) / G). The
 * same B stands in the mobility k of the pressure, hence in matrix and corrector. v is counted from
 * the soil's own motion, eps v_soil. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_DRAG_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_DRAG_H

/* Inertia coefficient (M15 eq. 9a). */
static inline double inertia_coefficient(double eps) {
  return 1 + 0.34 * (1 - eps) / eps;
}

static inline double drag_factor(double t, double a, double b, double speed) {
  return 1 / (1 + t * (a + 2 * b * speed));
}

#endif
