#include "sphsolve/march/monitor.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/statistics.h"

/* Limit of (remaining change / change over one window) for slow decay. */
#define REMAINING_CHANGE_MAX 20.0
/* Largest error, in tolerances, of a noisy series with a constant mean. */
#define NOISE_TOLERANCES_MAX 100.0

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

bool monitor_settled(struct monitor_settling *settling, double tolerance, double time,
                     const double velocity[3]) {
  double change = 0, size = 0;
  for (int a = 0; a < 3; a++) {
    change = fmax(change, fabs(velocity[a] - settling->reference[a]));
    size = fmax(size, fabs(velocity[a]));
  }
  if (time > 0 && change <= tolerance * size) return time - settling->since > 0.1 * time;
  memcpy(settling->reference, velocity, sizeof settling->reference);
  settling->since = time;
  return false;
}

/* Noise: standard deviation of 8 batch means of rows [begin, end) about their regression line (the
 * trend counts as remaining change). It is not divided by the square root of their number, since a
 * slow oscillation, which a longer run would not average out, looks the same. */
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
  return sqrt(square / (BATCHES - 2));
}

struct monitor_verdict monitor_judge(const struct monitor *monitor, double tolerance,
                                     size_t least) {
  struct monitor_verdict verdict = {.error = INFINITY, .drift = INFINITY};
  size_t n = monitor->count;
  for (int a = 0; a < MONITOR_COMPONENTS; a++)
    verdict.mean[a] = n > 0 ? monitor->rows[n - 1][a] : 0;
  if (n < 64 || n < least) return verdict;

  /* Means of the last three fifths: the ratio of their two differences gives the decay of the
   * change, as a geometric series. */
  size_t window = n / 5;
  double m[3];
  for (size_t i = 0; i < 3; i++)
    m[i] = mean_of(monitor, n - (3 - i) * window, n - (2 - i) * window, 0);
  double before = fabs(m[1] - m[0]), now = fabs(m[2] - m[1]);
  double noise = 2 * noise_of(monitor, n - 2 * window, n);
  /* Remaining change: the sum of that series. If the last difference is within the noise, the
   * slowest decay compatible with the noise is used; if both differences are, twice the spread of
   * the windows. */
  double remaining = 2 * fmax(fmax(before, now), fabs(m[2] - m[0]));
  if (now > noise)
    remaining = now * (before > now ? fmin(1 / (1 - now / before), REMAINING_CHANGE_MAX)
                                    : REMAINING_CHANGE_MAX);
  else if (before > now + 2 * noise)
    remaining = (now + noise) / (1 - (now + noise) / (before - noise));
  for (int a = 0; a < MONITOR_COMPONENTS; a++) verdict.mean[a] = mean_of(monitor, n - window, n, a);
  double scale = fmax(fabs(verdict.mean[0]), 1e-300);
  verdict.drift = remaining / scale;
  verdict.error = sqrt(noise * noise + remaining * remaining) / scale;
  /* The error counts as noise only if none of the last three fifths differs: a slow wave is also
   * flat at its crest. */
  double flat = noise + before + now;
  verdict.steady =
      verdict.error < tolerance ||
      (now <= noise && fmax(flat / scale, verdict.error) < NOISE_TOLERANCES_MAX * tolerance);
  return verdict;
}
