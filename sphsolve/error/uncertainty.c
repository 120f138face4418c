#include "sphsolve/error/uncertainty.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "common/hdf5_table.h"
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
  const size_t count = (size_t)u->level_count;
  struct uncertainty copy = *u;
  struct error_level *l = copy.levels;
  const struct h5_column columns[] = {{"spacing", H5_F64, 1, &l->spacing},
                                      {"k", H5_F64, 1, &l->permeability},
                                      {"estimate", H5_F64, 1, &l->estimate},
                                      {"low", H5_F64, 1, &l->low},
                                      {"high", H5_F64, 1, &l->high},
                                      {"sites", H5_F64, 1, &l->sites},
                                      {"iterations", H5_F64, 1, &l->iterations}};
  /* What differs from run to run is stored with the timings. */
  const struct h5_column seconds = {"seconds", H5_F64, 1, &l->seconds};
  if (count == 0) return STATUS_OK;
  for (size_t i = 0; i < count; i++) l[i].permeability *= to_speed, l[i].estimate *= to_speed;
  TRY(h5_write_columns(file, "/run/levels", count, sizeof *l, 7, columns));
  TRY(h5_write_columns(file, "/run/timing/levels", count, sizeof *l, 1, &seconds));
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
