/* The balance at the end of a run: what there was, what came and went, what is left, and by how
 * much the account does not close. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_LEDGER_H
#define TOSUI_SPHSOLVE_OUTPUT_LEDGER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

#define LEDGER_LOSSES 256 /* kept one by one; all are counted */

/* What momentum and energy come from and go to: X(symbol, name, words, numerical). Each is summed
 * where its effect is computed, from the forces that effect applies; nothing is found as what is
 * left over. A scene has only the terms of its own effects. `numerical`: the equations have no such
 * term, the method does. An effect with a `force` (struct effect) needs no line here. */
#define LEDGER_LIST                                                                                \
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
enum ledger_term {
#define X(symbol, name, words, numerical) LEDGER_##symbol,
  LEDGER_LIST
#undef X
      LEDGER_OWN, /* of effects that bring a force of their own (struct effect), and their name */
  LEDGER_TERMS = LEDGER_OWN + 4
};

struct ledger_sums {
  double impulse[LEDGER_TERMS][3]; /* kg m/s, given to the water */
  double work[LEDGER_TERMS];       /* J, given to the water */
};

/* Momentum and energy that the equations keep, and all that changed them. Potential energy is what
 * the driving force has not given yet: its work is LEDGER_FORCE's. */
struct ledger_account {
  uint32_t on;                      /* 1u << term */
  double momentum[2][3], energy[2]; /* at the start and at the end */
  struct ledger_sums sums;
  /* What sums at intervals may miss of their integrals over time, of all terms; 0: each step is
   * summed. */
  double momentum_error, energy_error;
  char own[LEDGER_TERMS - LEDGER_OWN][32]; /* names of those from LEDGER_OWN on */
};

/* Filled by a method; mass in kg. `known` is false where particles do not move (stokes); `steady`
 * is true there, and the balance is that of a flow that does not change. */
struct ledger {
  bool known, steady;
  double flux_open;  /* steady: rms over the planes across the flow of flux / mean flux - 1 */
  double force_open; /* steady: what walls and pressure leave of the driving force, relative */
  double power_open; /* steady: what they leave of its work, relative */
  uint64_t start, entered, left, lost, end;  /* particles */
  double entered_mass, left_mass, lost_mass; /* kg */
  /* Each of the first losses: particle, time (s), x, y, z (m), mass (kg). */
  double losses[LEDGER_LOSSES][6];
  /* From the history, by ledger_account: */
  double mass[2], momentum[2][3], kinetic_energy[2]; /* at the start and at the end */
  double impulse[3];             /* kg m/s: of gravity and other body forces, integral of m a dt */
  double work;                   /* J: of the same, integral of momentum . a dt */
  struct ledger_account account; /* on == 0: none is kept */
};

/* One row of the history as the account needs it. */
struct ledger_row {
  double time, mass, momentum[3], kinetic_energy;
};

/* Goes through the rows in the order of time; The integrals are
 * by the trapezium rule between rows. */
void ledger_account(struct ledger *ledger, size_t rows, const struct ledger_row *row,
                    const double acceleration[3]);
/* start + entered - left - lost - end: 0 when no particle is unaccounted for. */
int64_t ledger_particles_open(const struct ledger *ledger);
/* The same of the mass, kg. */
double ledger_mass_open(const struct ledger *ledger);
static inline bool ledger_is_on(const struct ledger_account *account, int term) {
  return account->on >> term & 1;
}
const char *ledger_name(const struct ledger_account *account, int term);
/* How far an account does not close: end - start - sum of the terms; as a vector and over the
 * largest of the terms and of the change, 0 where all are 0. */
double ledger_momentum_open(const struct ledger_account *account, double open[3]);
double ledger_energy_open(const struct ledger_account *account, double *open);
void ledger_add(struct ledger_sums *to, const struct ledger_sums *sums);
/* A running account in a checkpoint, as dataset `name`: `bytes` of it and of the doubles that
 * follow it in the same struct. `on` is the scene's and stays. */
enum status ledger_account_write(const struct ledger_account *account, size_t bytes,
                                 struct h5_file *file, const char *name);
enum status ledger_account_read(struct ledger_account *account, size_t bytes, struct h5_file *file,
                                const char *name);
/* /run/ledger. */
enum status ledger_write(const struct ledger *ledger, struct h5_file *file);
/* A few lines on stdout. */
void ledger_print(const struct ledger *ledger);

#endif
