/* The budget of momentum and energy that a run keeps (conservation.h): what each effect of a step
 * gives the water, summed in that step. */
#ifndef TOSUI_SPHSOLVE_ISPH_BUDGET_H
#define TOSUI_SPHSOLVE_ISPH_BUDGET_H

#include "sphsolve/isph/state.h"

/* Which terms the scene has, and what there is at the start; from a fresh state. */
void isph_budget_begin(struct isph *s);
/* The drag of soil on particle i, m/s^2: linear in v, and Forchheimer's, linearised about the
 * velocity `before`; for one that does not change, with v = before, the drag itself. */
void isph_budget_drag(const struct isph *s, size_t i, const double v[3], const double before[3],
                      double linear[3], double forchheimer[3]);
/* After the correction, before particles move: all forces of the step. */
void isph_budget_forces(struct isph *s, double relaxation_time, double dt);
/* Velocity of particle i, in a chunk of its own, changed from `from` by an effect that is no force
 * of the equation. */
void isph_budget_change(const struct isph *s, struct budget_sums *sums, enum budget_term term,
                        size_t i, const double from[3]);
/* Particle i went `displacement` further by an effect than its velocity carries it. */
void isph_budget_displacement(const struct isph *s, struct budget_sums *sums, enum budget_term term,
                              size_t i, const double displacement[3]);
/* Sums the chunks and, in soil, what there is before the particles' soil is found anew. */
void isph_budget_moved(struct isph *s);
/* A particle, still with the soil it had, leaves. */
struct isph_removed {
  double position[3], velocity[3], mass, volume, inertia, porosity;
  uint64_t id;
  bool pumped; /* by a well */
};
void isph_budget_removed(struct isph *s, enum budget_term term, const struct isph_removed *gone);
/* A particle comes in. */
void isph_budget_entered(struct isph *s, const double position[3], const double velocity[3],
                         double mass);
/* From a fresh state: the end of the step. */
void isph_budget_settled(struct isph *s);
/* What there is now, as the budget's end. */
void isph_budget_end(struct isph *s);

#endif
