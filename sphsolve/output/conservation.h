/* The conservation budget of a run: particles, mass, momentum and energy at the start, all gains
 * and losses, what remains at the end, and the error of the balance. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_CONSERVATION_H
#define TOSUI_SPHSOLVE_OUTPUT_CONSERVATION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

#define CONSERVATION_LOSSES 256 /* recorded individually; all are counted */

/* Sources and sinks of momentum and energy: X(symbol, name, words, numerical). Each is summed where
 * its effect is computed, from the forces of this effect; none is found as a remainder. A scene has
 * only the terms of its own effects. `numerical`: a term of the method, not of the equations. An
 * effect with a `force` (struct effect) needs no line here. */
#define BUDGET_LIST                                                                                \
  X(FORCE, "force", "driving force", 0)                                                            \
  X(WALL_PRESSURE, "wall_pressure", "pressure of walls", 0)                                        \
  X(WALL_FRICTION, "wall_friction", "friction at walls", 0)                                        \
  X(OPEN_SIDES, "open_sides", "pressure at open sides", 0)                                         \
  X(ENTERED, "entered", "came in", 0)                                                              \
  X(LEFT, "left", "went out", 0)                                                                   \
  X(LOST, "lost", "lost", 0)                                                                       \
  X(SOIL_PRESSURE, "soil_pressure", "pressure of soil", 0)                                         \
  X(SOIL_ENTRY, "soil_entry", "inertia of soil entered or left", 0)                                \
  X(DRAG_LINEAR, "drag_linear", "drag of soil, linear", 0)                                         \
  X(DRAG_FORCHHEIMER, "drag_forchheimer", "drag of soil, Forchheimer", 0)                          \
  X(VISCOSITY, "viscosity", "viscosity", 0)                                                        \
  X(TURBULENCE, "turbulence", "eddy viscosity", 0)                                                 \
  X(RELAXATION, "relaxation", "relaxation of density", 1)                                          \
  X(PROJECTION, "projection", "pressure that nothing returns", 1)                                  \
  X(ARTIFICIAL_VISCOSITY, "artificial_viscosity", "artificial viscosity", 1)                       \
  X(SHIFTING, "shifting", "shifting", 1)                                                           \
  X(ADVECTION, "advection", "advection past resting particles", 1)                                 \
  X(WALL_GUARD, "wall_guard", "guard at walls", 1)                                                 \
  X(STRAIGHTENING, "straightening", "straightening at open sides", 1)                              \
  X(ENERGY_BOUND, "energy_bound", "what keeps energy from rising", 1)                              \
  X(TIME_STEP, "time_step", "time stepping", 1)
enum budget_term {
#define X(symbol, name, words, numerical) BUDGET_##symbol,
  BUDGET_LIST
#undef X
      BUDGET_OWN, /* terms of effects with their own force (struct effect) and name */
  BUDGET_TERMS = BUDGET_OWN + 4
};

struct budget_sums {
  double impulse[BUDGET_TERMS][3]; /* kg m/s, given to the water */
  double work[BUDGET_TERMS];       /* J, given to the water */
};

/* Momentum and energy, and all changes of them. Potential energy is the work that the driving force
 * has not yet done: BUDGET_FORCE counts its work. */
struct budget {
  uint32_t on;                      /* 1u << term */
  double momentum[2][3], energy[2]; /* at the start and at the end */
  struct budget_sums sums;
  /* Estimated errors of the sums of all terms (kg m/s, J) if these are integrated from samples; 0:
   * each step is summed. */
  double momentum_error, energy_error;
  char own[BUDGET_TERMS - BUDGET_OWN][32]; /* names of the terms from BUDGET_OWN on */
};

/* Water that entered, left and was lost, kg. `rounded` is the part of entered - left - lost lost to
 * rounding: with it the balance closes to the rounding error of the present water, however much has
 * passed through. */
struct conservation_passed {
  double entered, left, lost, rounded;
};

/* Set by a method; mass in kg. `known` is false if particles do not move (stokes); `steady` is then
 * true, and the balance is that of a steady flow. */
struct conservation {
  bool known, steady;
  bool no_particles; /* known: water moves between fixed sites */
  double flux_open;  /* steady: rms over the cross-sections of flux / mean flux - 1 */
  double force_open; /* steady: unbalanced part of the driving force, relative */
  double power_open; /* steady: unbalanced part of its power, relative */
  uint64_t start, entered, left, lost, end; /* particles */
  struct conservation_passed passed;
  /* Each of the first losses: particle, time (s), x, y, z (m), mass (kg). */
  double losses[CONSERVATION_LOSSES][6];
  /* From the history, by conservation_integrate: */
  double mass[2], momentum[2][3], kinetic_energy[2]; /* at the start and at the end */
  double impulse[3];    /* kg m/s: of gravity and other body forces, integral of m a dt */
  double work;          /* J: of the same, integral of momentum . a dt */
  struct budget budget; /* on == 0: not available */
};

/* Values of a row of the history that the budget needs. */
struct conservation_row {
  double time, mass, momentum[3], kinetic_energy;
};

/* Sets the members from the history, whose rows are ordered by time; integrals by the trapezoidal
 * rule between rows. */
void conservation_integrate(struct conservation *conservation, size_t rows,
                            const struct conservation_row *row, const double acceleration[3]);
/* start + entered - left - lost - end: 0 if all particles are accounted for. */
int64_t conservation_particles_open(const struct conservation *conservation);
/* The same for the mass, kg. */
double conservation_mass_open(const struct conservation *conservation);
static inline bool budget_is_on(const struct budget *budget, int term) {
  return budget->on >> term & 1;
}
const char *budget_name(const struct budget *budget, int term);
/* Warns where the numerical terms together have given the water more than `share` of the largest
 * work of the others or, if that is more, of `least` (J), and names the largest. Returns whether.
 */
bool budget_warn(const struct budget *budget, double share, double least);
/* Error of the balance: end - start - sum of the terms. Returned relative to the largest of the
 * terms and of the change (0 if all are 0), and as `open` in SI units. */
double budget_momentum_open(const struct budget *budget, double open[3]);
double budget_energy_open(const struct budget *budget, double *open);
void budget_add(struct budget_sums *to, const struct budget_sums *sums);
/* Stores and restores a budget in a checkpoint as dataset `name`: `bytes` of it, which may include
 * the doubles that follow it in the same struct. `on` is set by the scene and not restored. */
enum status budget_write(const struct budget *budget, size_t bytes, struct h5_file *file,
                         const char *name);
enum status budget_read(struct budget *budget, size_t bytes, struct h5_file *file,
                        const char *name);
/* Writes /run/ledger. */
enum status conservation_write(const struct conservation *conservation, struct h5_file *file);
/* Prints a few lines to stdout. */
void conservation_print(const struct conservation *conservation);

#endif
