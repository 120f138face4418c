/* Budget of momentum and energy (conservation.h): the contribution of each effect to the momentum
 * and energy of the water, summed in the step in which it acts. */
#ifndef TOSUI_SPHSOLVE_ISPH_BUDGET_H
#define TOSUI_SPHSOLVE_ISPH_BUDGET_H

#include "sphsolve/isph/state.h"

/* Sets the terms that the scene has, and the momentum and energy at the start; needs a fresh state.
 */
void isph_budget_begin(struct isph *s);
/* Drag of soil on particle i, m/s^2: the linear part at v, and Forchheimer's part linearised about
 * the velocity `before`. With before = v it is the exact drag of a steady velocity. */
void isph_budget_drag(const struct isph *s, size_t i, const double v[3], const double before[3],
                      double linear[3], double forchheimer[3]);
/* Adds the forces of the step; after the correction, before the particles move. */
void isph_budget_forces(struct isph *s, double dt);
/* Books the change of particle i's velocity from `from` by an effect that is not a force of the
 * equation of motion. `sums` are those of the particle's chunk. */
void isph_budget_change(const struct isph *s, struct budget_sums *sums, enum budget_term term,
                        size_t i, const double from[3]);
/* Books the work of the driving force on a `displacement` of particle i beyond what its velocity
 * gives. */
void isph_budget_displacement(const struct isph *s, struct budget_sums *sums, enum budget_term term,
                              size_t i, const double displacement[3]);
/* Adds up the chunks' budgets and, with soil, stores momentum and energy before porosity and
 * inertia are updated. */
void isph_budget_moved(struct isph *s);
/* A particle that leaves, with the inertia and porosity at its last place. */
struct isph_removed {
  double position[3], velocity[3], mass, volume, inertia, porosity;
  uint64_t id;
  bool pumped; /* by a well */
};
void isph_budget_removed(struct isph *s, enum budget_term term, const struct isph_removed *gone);
/* Books a particle that enters. */
void isph_budget_entered(struct isph *s, const double position[3], const double velocity[3],
                         double mass);
/* At the end of the step, from a fresh state: books the change by entry into other soil. */
void isph_budget_settled(struct isph *s);
/* Stores the present momentum and energy as those at the end of the budget. */
void isph_budget_end(struct isph *s);

#endif
