#include "sphsolve/scene/time_table.h"

#include <math.h>

double time_table_at(const struct time_table *table, double time, int c) {
  const double *t = table->time;
  size_t k = 0;
  if (time <= t[0]) return table->value[0][c];
  if (time >= t[table->count - 1]) return table->value[table->count - 1][c];
  while (time >= t[k + 1]) k++;
  const double share = (time - t[k]) / (t[k + 1] - t[k]);
  return table->value[k][c] + share * (table->value[k + 1][c] - table->value[k][c]);
}

double time_table_integral(const struct time_table *table, double from, double to, int c) {
  double sum = 0, at = from;
  for (size_t k = 0; k <= table->count && at < to; k++) { /* trapezoids, exact for linear pieces */
    const double end = k < table->count ? fmin(table->time[k], to) : to;
    if (end <= at) continue;
    sum += 0.5 * (end - at) * (time_table_at(table, at, c) + time_table_at(table, end, c));
    at = end;
  }
  return sum;
}

double time_table_extreme(const struct time_table *table, int c) {
  double most = table->value[0][c];
  for (size_t k = 1; k < table->count; k++)
    if (fabs(table->value[k][c]) > fabs(most)) most = table->value[k][c];
  return most;
}
