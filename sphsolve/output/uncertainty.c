#include "sphsolve/output/uncertainty.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "common/log.h"

const char *const resolution_needs_names[] = {"lattice", "model", "scan"};

struct uncertainty uncertainty_none(void) {
  return (struct uncertainty){.parts = uncertainty_parts_none(),
                              .resolution_low = NAN,
                              .resolution_high = NAN,
                              .model = NAN,
                              .critical_width = NAN,
                              .order = NAN,
                              .extrapolated = NAN,
                              .finest = NAN,
                              .slope_blur = NAN};
}

void uncertainty_total(const struct uncertainty *u, double *low, double *high) {
  *low = uncertainty_parts_total(&u->parts,
                                 isfinite(u->resolution_low) ? u->resolution_low : u->resolution);
  *high = uncertainty_parts_total(&u->parts, isfinite(u->resolution_high) ? u->resolution_high
                                                                          : u->resolution);
}

void uncertainty_of_image(const struct uncertainty *u, double *low, double *high) {
  struct uncertainty own = *u;
  own.sides = NAN;
  uncertainty_total(&own, low, high);
}

double uncertainty_largest(const struct uncertainty *u) {
  double low, high;
  uncertainty_total(u, &low, &high);
  return fmax(low, high);
}

static enum status write_levels(const struct uncertainty *u, double to_speed,
                                struct h5_file *file) {
  enum status status = STATUS_OK;
  size_t count = (size_t)u->level_count;
  double column[ERROR_LEVELS_MAX];
  static const char *const names[] = {"spacing", "k",     "estimate", "low",
                                      "high",    "sites", "seconds",  "iterations"};
  enum { SECONDS = 6 };
  if (count == 0) return STATUS_OK;
  TRY(h5_make_group(file, "/run/timing/levels"));
  TRY(h5_make_group(file, "/run/levels"));
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    char path[64];
    for (size_t i = 0; i < count; i++) {
      const struct error_level *l = &u->levels[i];
      const double values[] = {
          l->spacing, to_speed * l->permeability, to_speed * l->estimate, l->low, l->high, l->sites,
          l->seconds, (double)l->iterations};
      column[i] = values[n];
    }
    /* Values that differ from run to run are stored with the timings. */
    snprintf(path, sizeof path, "/run/%s/%s", n == SECONDS ? "timing/levels" : "levels", names[n]);
    TRY(h5_write(file, path, H5_F64, 1, &count, column, false));
  }
  TRY(h5_soft_link(file, "/run/timing/levels/seconds", "/run/levels/seconds"));
cleanup:
  return status;
}

enum status uncertainty_write(const struct uncertainty *u, double to_speed, struct h5_file *file) {
  enum status status = STATUS_OK;
  double low, high;
  uncertainty_total(u, &low, &high);
  const struct {
    const char *name;
    double value;
  } more[] = {{"total", fmax(low, high)},
              {"total_low", low},
              {"total_high", high},
              {"resolution_low", u->resolution_low},
              {"resolution_high", u->resolution_high},
              {"model_voxels", u->model},
              {"critical_width", u->critical_width},
              {"observed_order", u->order},
              {"spacings", u->level_count},
              {"extrapolated_permeability", u->extrapolated},
              {"finest_permeability", u->finest},
              {"dlnk_blurred_again", u->slope_blur}};
  TRY(h5_make_group(file, "/run/error"));
  TRY(uncertainty_parts_write(&u->parts, file, "/run/error"));
  for (size_t i = 0; i < sizeof more / sizeof *more; i++)
    TRY(h5_write_attribute(file, "/run/error", more[i].name, H5_F64, 1, &more[i].value));
  TRY(h5_write_attribute_text(file, "/run/error", "resolution_needs",
                              resolution_needs_names[u->needs]));
  TRY(write_levels(u, to_speed, file));
cleanup:
  return status;
}

#define COLUMNS 56
#define BESIDE 30 /* characters before and after the bar */

/* Column of a value on a scale from 0 to `most`, limited to the ends. */
static int column(double value, double most, int columns) {
  return (int)fmin(fmax(floor(columns * value / most), 0.0), columns - 1);
}

void level_bar_draw(const struct uncertainty *u, double to_speed, int columns, char *text,
                    size_t size) {
  const struct error_level *first = &u->levels[0], *last = &u->levels[u->level_count - 1];
  const double most = 1.05 * first->permeability;
  const double low = isfinite(last->low) ? last->low : 0.0;
  const double high = isfinite(last->high) ? last->high : 0.0;
  const int from = column(last->estimate * (1.0 - low), most, columns);
  const int to = column(last->estimate * (1.0 + high), most, columns);
  double seconds = 0.0;
  char bar[COLUMNS + 1];
  for (int i = 0; i < u->level_count; i++) seconds += u->levels[i].seconds;
  memset(bar, ' ', (size_t)columns);
  bar[columns] = '\0';
  for (int i = from; i <= to; i++) bar[i] = '-';
  bar[column(last->estimate, most, columns)] = 'o';
  snprintf(text, size, "%8.2f s |%s| %.4g cm/s", seconds, bar, 100.0 * to_speed * last->estimate);
}

void level_bar_show(const struct uncertainty *u, double to_speed) {
  char text[COLUMNS + 64];
  if (u->level_count < 2 || !isatty(STDERR_FILENO)) return;
  struct winsize terminal = {0};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &terminal) != 0 || terminal.ws_col == 0)
    terminal.ws_col = COLUMNS + BESIDE;
  const int room = (int)terminal.ws_col - BESIDE;
  level_bar_draw(u, to_speed, room < 8 ? 8 : room < COLUMNS ? room : COLUMNS, text, sizeof text);
  log_info("%s", text);
}
