#include "analyze/averaging.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/statistics.h"

static const double drift_allowed = 0.05;

/* Linear interpolation at n evenly spaced times. Times must not decrease. */
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
  double shift = values[n - 1]; /* subtracted against cancellation in the running variance */
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

enum status average_record(const double *times, const double *values, size_t n,
                           struct average *average) {
  enum status status = STATUS_OK;
  double *even = NULL;
  memset(average, 0, sizeof *average);
  if (n < 5) {
    average->first = n - 1;
    average->rows = 1;
    average->from_time = times[n - 1];
    average->mean = values[n - 1];
    average->standard_error = average->error95 = NAN;
    average->drift = n > 1 ? values[n - 1] - values[n - 2] : NAN;
    average->without_drift = n > 1 && fabs(average->drift) <= drift_allowed * fabs(average->mean);
    return STATUS_OK;
  }
  TRY(memory_allocate(&even, n, sizeof *even, "history"));
  resample(times, values, n, even);
  average->first = truncation_point(even, n);
  average->rows = n - average->first;
  average->from_time =
      times[0] + (times[n - 1] - times[0]) * (double)average->first / (double)(n - 1);
  batch_means(even + average->first, average->rows, &average->mean, &average->standard_error);
  size_t half = average->rows / 2;
  average->drift = mean_of(even + n - half, half) - mean_of(even + average->first, half);
  double batches = floor(sqrt((double)average->rows));
  double sampling = student_t95(batches - 1.0) * average->standard_error;
  average->error95 = fmax(sampling, fabs(average->drift));
  average->without_drift = fabs(average->drift) <= drift_allowed * fabs(average->mean);
cleanup:
  memory_free(&even);
  return status;
}

enum status average_darcy(const struct run *run, struct average *average) {
  enum status status = STATUS_OK;
  size_t rows = 0;
  double *times = NULL, *values = NULL;
  /* If no pore leads through the water is at rest. */
  if (strcmp(run->status, "blocked") == 0) {
    *average = (struct average){.rows = 1, .standard_error = NAN, .without_drift = true};
    return STATUS_OK;
  }
  if ((strcmp(run->method, "stokes") == 0 || strcmp(run->method, "darcy") == 0) &&
      isfinite(run->darcy_velocity[0])) {
    memset(average, 0, sizeof *average);
    average->rows = 1;
    for (int d = 0; d < 3; d++) average->mean += run->darcy_velocity[d] * run->direction[d];
    average->standard_error = NAN;
    average->error95 = run->k_error * fabs(average->mean);
    average->without_drift = !(run->k_error > drift_allowed);
    return STATUS_OK;
  }
  TRY(run_darcy_series(run, &rows, &times, &values));
  TRY(average_record(times, values, rows, average));
cleanup:
  memory_free(&times);
  memory_free(&values);
  return status;
}
