/* The balance at the end of a run: what there was, what came and went, what is left, and by how
 * much the account does not close. */
#ifndef TOSUI_SPHSOLVE_LEDGER_H
#define TOSUI_SPHSOLVE_LEDGER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

#define LEDGER_LOSSES 256 /* kept one by one; all are counted */

/* Filled by a method; mass in kg. `known` is false where particles do not move (stokes); `steady`
 * is true there, and the balance is that of a flow that does not change. */
struct ledger {
  bool known, steady;
  double flux_open;  /* steady: rms over the planes across the flow of flux / mean flux - 1 */
  double force_open; /* steady: what walls and pressure leave of the driving force, relative */
  uint64_t start, entered, left, lost, end;  /* particles */
  double entered_mass, left_mass, lost_mass; /* kg */
  /* Each of the first losses: particle, time (s), x, y, z (m), mass (kg). */
  double losses[LEDGER_LOSSES][6];
  /* From the history, by ledger_account: */
  double mass[2], momentum[2][3], kinetic_energy[2]; /* at the start and at the end */
  double impulse[3]; /* kg m/s: of gravity and other body forces, integral of m a dt */
  double work;       /* J: of the same, integral of momentum . a dt */
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
/* /run/ledger. */
enum status ledger_write(const struct ledger *ledger, struct h5_file *file);
/* A few lines on stdout. */
void ledger_print(const struct ledger *ledger);

#endif
