#include "sphsolve/monitor.h"

#include <math.h>

#include "common/memory.h"
#include "common/statistics.h"

enum status monitor_add(struct monitor *monitor, const double value[MONITOR_COMPONENTS]) {
  enum status status = STATUS_OK;
  if (monitor->count == monitor->capacity) {
    size_t capacity = monitor->capacity == 0 ? 256 : 2 * monitor->capacity;
    TRY(memory_resize(&monitor->rows, capacity, sizeof *monitor->rows, "steadiness record"));
    monitor->capacity = capacity;
  }
  for (int a = 0; a < MONITOR_COMPONENTS; a++) monitor->rows[monitor->count][a] = value[a];
  monitor->count++;
cleanup:
  return status;
}

void monitor_free(struct monitor *monitor) {
  memory_free(&monitor->rows);
  monitor->count = monitor->capacity = 0;
}

static double mean_of(const struct monitor *monitor, size_t begin, size_t end, int component) {
  double sum = 0;
  for (size_t i = begin; i < end; i++) sum += monitor->rows[i][component];
  return sum / (double)(end - begin);
}

/* Standard error of the mean of rows [begin, end) about their own line, from 8 batches: the trend
 * is drift's part. */
static double noise_of(const struct monitor *monitor, size_t begin, size_t end) {
  enum { BATCHES = 8 };
  double x[BATCHES], y[BATCHES];
  size_t n = end - begin;
  for (size_t b = 0; b < BATCHES; b++) {
    x[b] = (double)b;
    y[b] = mean_of(monitor, begin + b * n / BATCHES, begin + (b + 1) * n / BATCHES, 0);
  }
  struct linear_fit fit;
  if (fit_linear(x, y, BATCHES, 0, &fit) != STATUS_OK) return INFINITY;
  double square = 0;
  for (size_t b = 0; b < BATCHES; b++) {
    double d = y[b] - fit.intercept - fit.slope * x[b];
    square += d * d;
  }
  return sqrt(square / (BATCHES - 2) / BATCHES);
}

struct monitor_verdict monitor_judge(const struct monitor *monitor, double tolerance,
                                     size_t least) {
  struct monitor_verdict verdict = {.error = INFINITY, .drift = INFINITY};
  size_t n = monitor->count;
  for (int a = 0; a < MONITOR_COMPONENTS; a++)
    verdict.mean[a] = n > 0 ? monitor->rows[n - 1][a] : 0;
  if (n < 64 || n < least) return verdict;

  /* Means of the last three quarters: their two changes tell how fast the change dies. */
  size_t q = n / 4;
  double m[3];
  for (size_t i = 0; i < 3; i++) m[i] = mean_of(monitor, n - (3 - i) * q, n - (2 - i) * q, 0);
  double before = m[1] - m[0], now = m[2] - m[1];
  double noise = noise_of(monitor, n - q, n);
  double ratio = fabs(now) / fmax(fabs(before), 1e-300);
  /* What is still to come if it goes on dying so; the last quarter's mean lags by half a
   * quarter, which `now` itself covers. A change that does not die is counted four times. */
  double to_come = fabs(now) * (ratio < 0.75 ? 1 / (1 - ratio) : 4);
  for (int a = 0; a < MONITOR_COMPONENTS; a++) verdict.mean[a] = mean_of(monitor, n - q, n, a);
  double scale = fmax(fabs(verdict.mean[0]), 1e-300);
  verdict.drift = to_come / scale;
  verdict.error = sqrt(4 * noise * noise + to_come * to_come) / scale;
  verdict.steady = verdict.error < tolerance;
  return verdict;
}
