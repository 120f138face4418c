#include "sphsolve/output/conservation.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"

void conservation_integrate(struct conservation *conservation, size_t rows,
                            const struct conservation_row *row, const double acceleration[3]) {
  for (size_t i = 1; i < rows; i++) {
    double dt = row[i].time - row[i - 1].time;
    for (int a = 0; a < 3; a++) {
      conservation->impulse[a] += 0.5 * dt * (row[i - 1].mass + row[i].mass) * acceleration[a];
      conservation->work +=
          0.5 * dt * (row[i - 1].momentum[a] + row[i].momentum[a]) * acceleration[a];
    }
  }
  for (int end = 0; end < 2 && rows > 0; end++) {
    const struct conservation_row *at = &row[end ? rows - 1 : 0];
    conservation->mass[end] = at->mass;
    conservation->kinetic_energy[end] = at->kinetic_energy;
    memcpy(conservation->momentum[end], at->momentum, sizeof at->momentum);
  }
}

static const struct {
  const char *name, *words;
  bool numerical;
} terms[] = {
#define X(symbol, name, words, numerical) {name, words, numerical},
    BUDGET_LIST
#undef X
};

const char *budget_name(const struct budget *budget, int term) {
  return term < BUDGET_OWN ? terms[term].name : budget->own[term - BUDGET_OWN];
}

static const char *words_of(const struct budget *budget, int term) {
  return term < BUDGET_OWN ? terms[term].words : budget_name(budget, term);
}

static double length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double budget_momentum_open(const struct budget *budget, double open[3]) {
  double largest;
  for (int a = 0; a < 3; a++) open[a] = budget->momentum[1][a] - budget->momentum[0][a];
  largest = length(open);
  for (int t = 0; t < BUDGET_TERMS; t++) {
    if (!budget_is_on(budget, t)) continue;
    for (int a = 0; a < 3; a++) open[a] -= budget->sums.impulse[t][a];
    largest = fmax(largest, length(budget->sums.impulse[t]));
  }
  return largest > 0 ? length(open) / largest : 0;
}

double budget_energy_open(const struct budget *budget, double *open) {
  double largest = fabs(*open = budget->energy[1] - budget->energy[0]);
  for (int t = 0; t < BUDGET_TERMS; t++) {
    if (!budget_is_on(budget, t)) continue;
    *open -= budget->sums.work[t];
    largest = fmax(largest, fabs(budget->sums.work[t]));
  }
  return largest > 0 ? fabs(*open) / largest : 0;
}

bool budget_warn(const struct budget *budget, double share, double least) {
  double given = 0, most = 0;
  int first = -1;
  for (int t = 0; t < BUDGET_TERMS; t++) {
    const double work = budget->sums.work[t];
    if (!budget_is_on(budget, t)) continue;
    if (t >= BUDGET_OWN || !terms[t].numerical) {
      least = fmax(least, fabs(work));
      continue;
    }
    given += work;
    if (work > most) most = work, first = t;
  }
  if (first < 0 || !(given > share * least)) return false;
  char percent[32];
  log_warning(
      "%.2g J, %s %% of the work of forces and walls, came to the water by what no equation "
      "contains, most by %s; use a smaller domain.spacing or time step",
      given, percent_format(given / least, percent), words_of(budget, first));
  return true;
}

void budget_add(struct budget_sums *to, const struct budget_sums *sums) {
  for (int t = 0; t < BUDGET_TERMS; t++) {
    for (int a = 0; a < 3; a++) to->impulse[t][a] += sums->impulse[t][a];
    to->work[t] += sums->work[t];
  }
}

enum status budget_write(const struct budget *budget, size_t bytes, struct h5_file *file,
                         const char *name) {
  enum status status = STATUS_OK;
  size_t count = bytes / sizeof(double);
  double *numbers = NULL;
  TRY(memory_allocate(&numbers, count, sizeof *numbers, "the conservation budget"));
  memcpy(numbers, budget, bytes);
  numbers[0] = budget->on;
  TRY(h5_write(file, name, H5_F64, 1, &count, numbers, false));
cleanup:
  memory_free(&numbers);
  return status;
}

enum status budget_read(struct budget *budget, size_t bytes, struct h5_file *file,
                        const char *name) {
  enum status status = STATUS_OK;
  const uint32_t on = budget->on;
  double *numbers = NULL;
  size_t count = 0;
  TRY(h5_read(file, name, H5_F64, 1, &count, &numbers));
  if (count != bytes / sizeof(double))
    TRY_FAIL(STATUS_INPUT, "%s: %s is not of this version; remove the file to start anew",
             h5_path(file), name);
  memcpy(budget, numbers, bytes);
  budget->on = on;
cleanup:
  memory_free(&numbers);
  return status;
}

int64_t conservation_particles_open(const struct conservation *c) {
  return (int64_t)(c->start + c->entered) - (int64_t)(c->left + c->lost + c->end);
}

double conservation_mass_open(const struct conservation *c) {
  const struct conservation_passed *passed = &c->passed;
  const double gained = passed->entered - passed->left - passed->lost;
  return c->mass[0] - c->mass[1] + gained + passed->rounded;
}

/* Writes /run/ledger/term, impulse, work and numerical: a row for each term of the scene. */
static enum status write_budget(const struct budget *budget, struct h5_file *file) {
  enum status status = STATUS_OK;
  const char *group = "/run/ledger", *names[BUDGET_TERMS], *words[BUDGET_TERMS];
  double impulse[BUDGET_TERMS][3], work[BUDGET_TERMS], open[3] = {0}, energy_open;
  uint8_t numerical[BUDGET_TERMS];
  size_t n = 0;
  for (int t = 0; t < BUDGET_TERMS; t++) {
    if (!budget_is_on(budget, t)) continue;
    memcpy(impulse[n], budget->sums.impulse[t], sizeof *impulse);
    work[n] = budget->sums.work[t];
    numerical[n] = t < BUDGET_OWN && terms[t].numerical;
    words[n] = words_of(budget, t);
    names[n++] = budget_name(budget, t);
  }
  double momentum_share = budget_momentum_open(budget, open);
  double energy_share = budget_energy_open(budget, &energy_open);
  const struct h5_number numbers[] = {
      {"account_momentum_start", H5_F64, 3, budget->momentum[0]},
      {"account_momentum_end", H5_F64, 3, budget->momentum[1]},
      {"momentum_open", H5_F64, 3, open},
      {"momentum_open_share", H5_F64, 1, &momentum_share},
      {"momentum_sampling_error", H5_F64, 1, &budget->momentum_error},
      {"energy_start", H5_F64, 1, &budget->energy[0]},
      {"energy_end", H5_F64, 1, &budget->energy[1]},
      {"energy_open", H5_F64, 1, &energy_open},
      {"energy_open_share", H5_F64, 1, &energy_share},
      {"energy_sampling_error", H5_F64, 1, &budget->energy_error}};
  size_t shape[2] = {n, 3};
  TRY(h5_write_numbers(file, group, sizeof numbers / sizeof *numbers, numbers));
  TRY(h5_write_texts(file, "/run/ledger/term", n, names));
  TRY(h5_write_texts(file, "/run/ledger/words", n, words));
  TRY(h5_write(file, "/run/ledger/impulse", H5_F64, 2, shape, impulse, false));
  TRY(h5_write(file, "/run/ledger/work", H5_F64, 1, &n, work, false));
  TRY(h5_write(file, "/run/ledger/numerical", H5_U8, 1, &n, numerical, false));
  TRY(h5_write_attribute_text(file, "/run/ledger/impulse", "unit", "kg m/s"));
  TRY(h5_write_attribute_text(file, "/run/ledger/work", "unit", "J"));
cleanup:
  return status;
}

enum status conservation_write(const struct conservation *c, struct h5_file *file) {
  enum status status = STATUS_OK;
  const char *group = "/run/ledger";
  if (c->steady) {
    TRY(h5_make_group(file, group));
    TRY(h5_write_attribute(file, group, "flux_open", H5_F64, 1, &c->flux_open));
    TRY(h5_write_attribute(file, group, "force_open", H5_F64, 1, &c->force_open));
    TRY(h5_write_attribute(file, group, "power_open", H5_F64, 1, &c->power_open));
  }
  if (!c->known) return STATUS_OK;
  const struct h5_number counts[] = {{"particles_start", H5_U64, 1, &c->start},
                                     {"particles_entered", H5_U64, 1, &c->entered},
                                     {"particles_left", H5_U64, 1, &c->left},
                                     {"particles_lost", H5_U64, 1, &c->lost},
                                     {"particles_end", H5_U64, 1, &c->end}};
  int64_t open = conservation_particles_open(c);
  double mass_open = conservation_mass_open(c), taken[3];
  for (int a = 0; a < 3; a++) taken[a] = c->impulse[a] + c->momentum[0][a] - c->momentum[1][a];
  double dissipated = c->work + c->kinetic_energy[0] - c->kinetic_energy[1];
  const struct h5_number numbers[] = {{"mass_start", H5_F64, 1, &c->mass[0]},
                                      {"mass_entered", H5_F64, 1, &c->passed.entered},
                                      {"mass_left", H5_F64, 1, &c->passed.left},
                                      {"mass_lost", H5_F64, 1, &c->passed.lost},
                                      {"mass_end", H5_F64, 1, &c->mass[1]},
                                      {"mass_open", H5_F64, 1, &mass_open},
                                      {"momentum_start", H5_F64, 3, c->momentum[0]},
                                      {"momentum_end", H5_F64, 3, c->momentum[1]},
                                      {"impulse_of_force", H5_F64, 3, c->impulse},
                                      {"momentum_taken", H5_F64, 3, taken},
                                      {"kinetic_energy_start", H5_F64, 1, &c->kinetic_energy[0]},
                                      {"kinetic_energy_end", H5_F64, 1, &c->kinetic_energy[1]},
                                      {"work_of_force", H5_F64, 1, &c->work},
                                      {"energy_taken", H5_F64, 1, &dissipated}};
  TRY(h5_make_group(file, group));
  TRY(h5_write_numbers(file, group, sizeof counts / sizeof *counts, counts));
  TRY(h5_write_attribute(file, group, "particles_open", H5_I64, 1, &open));
  TRY(h5_write_numbers(file, group, sizeof numbers / sizeof *numbers, numbers));
  if (c->budget.on != 0) TRY(write_budget(&c->budget, file));
  size_t dims[2] = {c->lost < CONSERVATION_LOSSES ? c->lost : CONSERVATION_LOSSES, 6};
  if (dims[0] > 0) {
    TRY(h5_write(file, "/run/ledger/losses", H5_F64, 2, dims, c->losses, false));
    TRY(h5_write_attribute_text(file, "/run/ledger/losses", "columns",
                                "particle, time (s), x, y, z (m), mass (kg)"));
    TRY(h5_write_attribute_text(file, "/run/ledger/losses", "cause", "went through a wall"));
  }
cleanup:
  return status;
}

/* Terms below this fraction of the largest one are not printed; all are in the file. */
#define PRINTED_MIN 1e-4
#define LINE_MAX_LENGTH 98 /* characters per line */

/* Prints a piece of text, on a new line if the current one would become too long. */
__attribute__((format(printf, 2, 3))) static void print_piece(int *column, const char *format,
                                                              ...) {
  char piece[160];
  va_list list;
  va_start(list, format);
  const int length_of = vsnprintf(piece, sizeof piece, format, list);
  va_end(list);
  if (*column + length_of > LINE_MAX_LENGTH)
    *column = printf("\n             %s", piece) - 1;
  else
    *column += printf(" %s", piece);
}

static void print_budget(const struct budget *budget) {
  char text[32], energy[32];
  double open[3] = {0}, energy_open, largest = 0;
  double momentum_share = budget_momentum_open(budget, open);
  double energy_share = budget_energy_open(budget, &energy_open);
  if (log_level() < LOG_VERBOSE) {
    printf("           momentum, energy: of the largest term %s %%, %s %% are not accounted for "
           "(-v: all terms)\n",
           percent_format(momentum_share, text), percent_format(energy_share, energy));
    return;
  }
  const double(*p)[3] = budget->momentum;
  int column =
      printf("           momentum (kg m/s): (%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g):", p[0][0],
             p[0][1], p[0][2], p[1][0], p[1][1], p[1][2]);
  for (int t = 0; t < BUDGET_TERMS; t++)
    if (budget_is_on(budget, t)) largest = fmax(largest, length(budget->sums.impulse[t]));
  for (int t = 0; t < BUDGET_TERMS; t++) {
    const double *given = budget->sums.impulse[t];
    if (budget_is_on(budget, t) && length(given) > PRINTED_MIN * largest)
      print_piece(&column, "%s (%.4g, %.4g, %.4g),", words_of(budget, t), given[0], given[1],
                  given[2]);
  }
  print_piece(&column, "not accounted for %s %% of the largest%s",
              percent_format(momentum_share, text), budget->momentum_error > 0 ? "," : "");
  if (budget->momentum_error > 0)
    print_piece(&column, "samples may miss %.2g", budget->momentum_error);
  putchar('\n');
  column = printf("           energy (J): %.4g to %.4g:", budget->energy[0], budget->energy[1]);
  largest = 0;
  for (int t = 0; t < BUDGET_TERMS; t++)
    if (budget_is_on(budget, t)) largest = fmax(largest, fabs(budget->sums.work[t]));
  for (int t = 0; t < BUDGET_TERMS; t++)
    if (budget_is_on(budget, t) && fabs(budget->sums.work[t]) > PRINTED_MIN * largest)
      print_piece(&column, "%s %.4g,", words_of(budget, t), budget->sums.work[t]);
  print_piece(&column, "not accounted for %.2g, %s %% of the largest%s", energy_open,
              percent_format(energy_share, text), budget->energy_error > 0 ? "," : "");
  if (budget->energy_error > 0) print_piece(&column, "samples may miss %.2g", budget->energy_error);
  putchar('\n');
}

void conservation_print(const struct conservation *c) {
  char text[32];
  if (c->steady)
    printf("budget     mass: the flux is the same through all planes across the flow to %s %%\n"
           "           momentum: walls and pressure balance what drives the flow to %.2g\n"
           "           energy: friction takes what drives the flow gives, to %.2g\n",
           percent_format(c->flux_open, text), c->force_open, c->power_open);
  if (!c->known) return;
  int64_t open = conservation_particles_open(c);
  double mass_open = conservation_mass_open(c);
  if (c->no_particles) {
    printf("budget     mass: %.6g kg + %.6g in - %.6g out = %.6g, open by %.2g of it\n", c->mass[0],
           c->passed.entered, c->passed.left, c->mass[1],
           fabs(mass_open) / fmax(c->mass[0] + c->passed.entered, 1e-300));
    return;
  }
  printf("budget     particles: %" PRIu64 " + %" PRIu64 " in - %" PRIu64 " out - %" PRIu64
         " lost = %" PRIu64,
         c->start, c->entered, c->left, c->lost, c->end);
  if (open != 0) printf(", and %" PRId64 " unaccounted for", open);
  printf("\n           mass: %.6g kg at the end, ", c->mass[1]);
  if (mass_open == 0)
    printf("closes to the last bit\n");
  else
    printf("open by %.2g of it\n", fabs(mass_open) / fmax(c->mass[0] + c->passed.entered, 1e-300));
  if (c->budget.on != 0) print_budget(&c->budget);
  for (uint64_t i = 0; i < c->lost && i < 3; i++)
    printf("           lost: particle %.0f through a wall at t = %.4g s, (%.4g, %.4g, %.4g) m\n",
           c->losses[i][0], c->losses[i][1], c->losses[i][2], c->losses[i][3], c->losses[i][4]);
  if (c->lost > 3) printf("           and %" PRIu64 " more: /run/ledger/losses\n", c->lost - 3);
}
