#include "analyze/steady.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/statistics.h"

static const double steady_drift = 0.05;

/* Linear interpolation onto n even instants. Times must not fall. */
static void resample(const double *times, const double *values, size_t n, double *even) {
  double span = times[n - 1] - times[0];
  size_t j = 0;
  for (size_t i = 0; i < n; i++) {
    double t = times[0] + span * (double)i / (double)(n - 1);
    while (j + 2 < n && times[j + 1] < t) j++;
    double width = times[j + 1] - times[j];
    double part = width > 0 ? (t - times[j]) / width : 0.0;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    even[i] = values[j] + part * (values[j + 1] - values[j]);
  }
}

static size_t truncation_point(const double *values, size_t n) {
  size_t keep = n / 10 > 5 ? n / 10 : 5;
  double sum = 0.0, square = 0.0, least = INFINITY;
  double shift = values[n - 1]; /* against cancellation in the running variance */
  size_t best = 0;
  for (size_t d = n; d-- > 0;) {
    double v = values[d] - shift;
    sum += v;
    square += v * v;
    double m = (double)(n - d);
    if (n - d < keep) continue;
    double marginal = (square - sum * sum / m) / (m * m);
    if (marginal <= least) {
      least = marginal;
      best = d;
    }
  }
  return best;
}

static double mean_of(const double *values, size_t n) {
  return sum_compensated(values, n) / (double)n;
}

enum status steady_find(const double *times, const double *values, size_t n,
                        struct steady *steady) {
  enum status status = STATUS_OK;
  double *even = NULL;
  memset(steady, 0, sizeof *steady);
  if (n < 5) {
    steady->first = n - 1;
    steady->rows = 1;
    steady->from_time = times[n - 1];
    steady->mean = values[n - 1];
    steady->standard_error = steady->error95 = NAN;
    steady->drift = n > 1 ? values[n - 1] - values[n - 2] : NAN;
    steady->is_steady = n > 1 && fabs(steady->drift) <= steady_drift * fabs(steady->mean);
    return STATUS_OK;
  }
  TRY(memory_allocate(&even, n, sizeof *even, "history"));
  resample(times, values, n, even);
  steady->first = truncation_point(even, n);
  steady->rows = n - steady->first;
  steady->from_time =
      times[0] + (times[n - 1] - times[0]) * (double)steady->first / (double)(n - 1);
  batch_means(even + steady->first, steady->rows, &steady->mean, &steady->standard_error);
  size_t half = steady->rows / 2;
  steady->drift = mean_of(even + n - half, half) - mean_of(even + steady->first, half);
  double batches = floor(sqrt((double)steady->rows));
  double sampling = student_t95(batches - 1.0) * steady->standard_error;
  steady->error95 = fmax(sampling, fabs(steady->drift));
  steady->is_steady = fabs(steady->drift) <= steady_drift * fabs(steady->mean);
cleanup:
  memory_free(&even);
  return status;
}

enum status steady_darcy(const struct run *run, struct steady *steady) {
  enum status status = STATUS_OK;
  size_t rows = 0;
  double *times = NULL, *values = NULL;
  if (strcmp(run->method, "stokes") == 0 && isfinite(run->darcy_velocity[0])) {
    memset(steady, 0, sizeof *steady);
    steady->rows = 1;
    for (int d = 0; d < 3; d++) steady->mean += run->darcy_velocity[d] * run->direction[d];
    steady->standard_error = NAN;
    steady->error95 = run->k_error * fabs(steady->mean);
    steady->is_steady = !(run->k_error > steady_drift);
    return STATUS_OK;
  }
  TRY(run_darcy_series(run, &rows, &times, &values));
  TRY(steady_find(times, values, rows, steady));
cleanup:
  memory_free(&times);
  memory_free(&values);
  return status;
}
