/* The conservation budget of a run: particles, mass, momentum and energy at the start, what came
 * and went, what is left, and by how much the sum does not close. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_CONSERVATION_H
#define TOSUI_SPHSOLVE_OUTPUT_CONSERVATION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

#define CONSERVATION_LOSSES 256 /* kept one by one; all are counted */

/* What momentum and energy come from and go to: X(symbol, name, words, numerical). Each is summed
 * where its effect is computed, from the forces that effect applies; nothing is found as what is
 * left over. A scene has only the terms of its own effects. `numerical`: the equations have no such
 * term, the method does. An effect with a `force` (struct effect) needs no line here. */
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
      BUDGET_OWN, /* of effects that bring a force of their own (struct effect), and their name */
  BUDGET_TERMS = BUDGET_OWN + 4
};

struct budget_sums {
  double impulse[BUDGET_TERMS][3]; /* kg m/s, given to the water */
  double work[BUDGET_TERMS];       /* J, given to the water */
};

/* Momentum and energy that the equations keep, and all that changed them. Potential energy is what
 * the driving force has not given yet: its work is BUDGET_FORCE's. */
struct budget {
  uint32_t on;                      /* 1u << term */
  double momentum[2][3], energy[2]; /* at the start and at the end */
  struct budget_sums sums;
  /* What sums at intervals may miss of their integrals over time, of all terms; 0: each step is
   * summed. */
  double momentum_error, energy_error;
  char own[BUDGET_TERMS - BUDGET_OWN][32]; /* names of those from BUDGET_OWN on */
};

/* Water that came, left and was lost, kg. `rounded` is what rounding took from entered - left -
 * lost: with it the balance closes to a rounding of the water that is there, however much went
 * through. */
struct conservation_passed {
  double entered, left, lost, rounded;
};

/* Filled by a method; mass in kg. `known` is false where particles do not move (stokes); `steady`
 * is true there, and the balance is that of a flow that does not change. */
struct conservation {
  bool known, steady;
  bool no_particles; /* known: water moves between sites that stay */
  double flux_open;  /* steady: rms over the planes across the flow of flux / mean flux - 1 */
  double force_open; /* steady: what walls and pressure leave of the driving force, relative */
  double power_open; /* steady: what they leave of its work, relative */
  uint64_t start, entered, left, lost, end; /* particles */
  struct conservation_passed passed;
  /* Each of the first losses: particle, time (s), x, y, z (m), mass (kg). */
  double losses[CONSERVATION_LOSSES][6];
  /* From the history, by conservation_integrate: */
  double mass[2], momentum[2][3], kinetic_energy[2]; /* at the start and at the end */
  double impulse[3];    /* kg m/s: of gravity and other body forces, integral of m a dt */
  double work;          /* J: of the same, integral of momentum . a dt */
  struct budget budget; /* on == 0: none is kept */
};

/* One row of the history as the budget needs it. */
struct conservation_row {
  double time, mass, momentum[3], kinetic_energy;
};

/* Fills what is from the history, whose rows are in the order of time; integrals by the trapezium
 * rule between rows. */
void conservation_integrate(struct conservation *conservation, size_t rows,
                            const struct conservation_row *row, const double acceleration[3]);
/* start + entered - left - lost - end: 0 when no particle is unaccounted for. */
int64_t conservation_particles_open(const struct conservation *conservation);
/* The same of the mass, kg. */
double conservation_mass_open(const struct conservation *conservation);
static inline bool budget_is_on(const struct budget *budget, int term) {
  return budget->on >> term & 1;
}
const char *budget_name(const struct budget *budget, int term);
/* How far a budget does not close: end - start - sum of the terms; as a vector and over the
 * largest of the terms and of the change, 0 where all are 0. */
double budget_momentum_open(const struct budget *budget, double open[3]);
double budget_energy_open(const struct budget *budget, double *open);
void budget_add(struct budget_sums *to, const struct budget_sums *sums);
/* A running budget in a checkpoint, as dataset `name`: `bytes` of it and of the doubles that
 * follow it in the same struct. `on` is the scene's and stays. */
enum status budget_write(const struct budget *budget, size_t bytes, struct h5_file *file,
                         const char *name);
enum status budget_read(struct budget *budget, size_t bytes, struct h5_file *file,
                        const char *name);
/* /run/ledger. */
enum status conservation_write(const struct conservation *conservation, struct h5_file *file);
/* A few lines on stdout. */
void conservation_print(const struct conservation *conservation);

#endif
