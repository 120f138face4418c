#include "sphsolve/output/level_bar.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "common/log.h"

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
