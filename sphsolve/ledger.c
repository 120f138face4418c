#include "sphsolve/ledger.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void ledger_account(struct ledger *ledger, size_t rows, const struct ledger_row *row,
                    const double acceleration[3]) {
  for (size_t i = 1; i < rows; i++) {
    double dt = row[i].time - row[i - 1].time;
    for (int a = 0; a < 3; a++) {
      ledger->impulse[a] += 0.5 * dt * (row[i - 1].mass + row[i].mass) * acceleration[a];
      ledger->work += 0.5 * dt * (row[i - 1].momentum[a] + row[i].momentum[a]) * acceleration[a];
    }
  }
  for (int end = 0; end < 2 && rows > 0; end++) {
    const struct ledger_row *at = &row[end ? rows - 1 : 0];
    ledger->mass[end] = at->mass;
    ledger->kinetic_energy[end] = at->kinetic_energy;
    memcpy(ledger->momentum[end], at->momentum, sizeof at->momentum);
  }
}

int64_t ledger_particles_open(const struct ledger *l) {
  return (int64_t)(l->start + l->entered) - (int64_t)(l->left + l->lost + l->end);
}

double ledger_mass_open(const struct ledger *l) {
  return l->mass[0] + l->entered_mass - l->left_mass - l->lost_mass - l->mass[1];
}

enum status ledger_write(const struct ledger *l, struct h5_file *file) {
  enum status status = STATUS_OK;
  const char *group = "/run/ledger";
  if (l->steady) {
    TRY(h5_make_group(file, group));
    TRY(h5_write_attribute(file, group, "flux_open", H5_F64, 1, &l->flux_open));
    TRY(h5_write_attribute(file, group, "force_open", H5_F64, 1, &l->force_open));
  }
  if (!l->known) return STATUS_OK;
  const struct {
    const char *name;
    uint64_t value;
  } counts[] = {{"particles_start", l->start},
                {"particles_entered", l->entered},
                {"particles_left", l->left},
                {"particles_lost", l->lost},
                {"particles_end", l->end}};
  int64_t open = ledger_particles_open(l);
  double mass_open = ledger_mass_open(l), taken[3];
  for (int a = 0; a < 3; a++) taken[a] = l->impulse[a] + l->momentum[0][a] - l->momentum[1][a];
  double dissipated = l->work + l->kinetic_energy[0] - l->kinetic_energy[1];
  const struct {
    const char *name;
    size_t count;
    const double *values;
  } numbers[] = {{"mass_start", 1, &l->mass[0]},
                 {"mass_entered", 1, &l->entered_mass},
                 {"mass_left", 1, &l->left_mass},
                 {"mass_lost", 1, &l->lost_mass},
                 {"mass_end", 1, &l->mass[1]},
                 {"mass_open", 1, &mass_open},
                 {"momentum_start", 3, l->momentum[0]},
                 {"momentum_end", 3, l->momentum[1]},
                 {"impulse_of_force", 3, l->impulse},
                 {"momentum_taken", 3, taken},
                 {"kinetic_energy_start", 1, &l->kinetic_energy[0]},
                 {"kinetic_energy_end", 1, &l->kinetic_energy[1]},
                 {"work_of_force", 1, &l->work},
                 {"energy_taken", 1, &dissipated}};
  TRY(h5_make_group(file, group));
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    TRY(h5_write_attribute(file, group, counts[i].name, H5_U64, 1, &counts[i].value));
  TRY(h5_write_attribute(file, group, "particles_open", H5_I64, 1, &open));
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    TRY(h5_write_attribute(file, group, numbers[i].name, H5_F64, numbers[i].count,
                           numbers[i].values));
  size_t dims[2] = {l->lost < LEDGER_LOSSES ? l->lost : LEDGER_LOSSES, 6};
  if (dims[0] > 0) {
    TRY(h5_write(file, "/run/ledger/losses", H5_F64, 2, dims, l->losses, false));
    TRY(h5_write_attribute_text(file, "/run/ledger/losses", "columns",
                                "particle, time (s), x, y, z (m), mass (kg)"));
    TRY(h5_write_attribute_text(file, "/run/ledger/losses", "cause", "went through a wall"));
  }
cleanup:
  return status;
}

void ledger_print(const struct ledger *l) {
  if (l->steady)
    printf("ledger     flux: the same through all planes across the flow to %.2g %%\n"
           "           force: walls and pressure balance what drives the flow to %.2g\n",
           100 * l->flux_open, l->force_open);
  if (!l->known) return;
  int64_t open = ledger_particles_open(l);
  double mass_open = ledger_mass_open(l);
  printf("ledger     particles: %" PRIu64 " + %" PRIu64 " in - %" PRIu64 " out - %" PRIu64
         " lost = %" PRIu64,
         l->start, l->entered, l->left, l->lost, l->end);
  if (open != 0) printf(", and %" PRId64 " unaccounted for", open);
  printf("\n           mass: %.6g kg at the end, ", l->mass[1]);
  if (mass_open == 0)
    printf("closes to the last bit\n");
  else
    printf("open by %.2g of it\n", fabs(mass_open) / fmax(l->mass[0], 1e-300));
  for (uint64_t i = 0; i < l->lost && i < 3; i++)
    printf("           lost: particle %.0f through a wall at t = %.4g s, (%.4g, %.4g, %.4g) m\n",
           l->losses[i][0], l->losses[i][1], l->losses[i][2], l->losses[i][3], l->losses[i][4]);
  if (l->lost > 3) printf("           and %" PRIu64 " more: /run/ledger/losses\n", l->lost - 3);
}
