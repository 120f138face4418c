#include "analyze/pdf.h"

#include <math.h>

#include "common/memory.h"
#include "common/statistics.h"

enum status pdf_estimate(const double *values, size_t n, struct pdf *pdf) {
  enum status status = STATUS_OK;
  double low = INFINITY, high = -INFINITY;
  *pdf = (struct pdf){0};
  for (size_t i = 0; i < n; i++) {
    low = fmin(low, values[i]);
    high = fmax(high, values[i]);
  }
  if (n == 0 || !isfinite(low) || !isfinite(high))
    TRY_FAIL(STATUS_INPUT, "no finite velocity to make a density of");
  /* a single value gets a bin around it. */
  if (!(high - low > 1e-12 * fmax(fabs(low), fabs(high)))) {
    double half = fmax(fabs(low), 1e-30) * 1e-3;
    low -= half;
    high += half;
  }
  double width = 2.0 * (quantile(values, n, 0.75) - quantile(values, n, 0.25)) / cbrt((double)n);
  double wanted = width > 0 ? ceil((high - low) / width) : 200.0;
  pdf->bins = (size_t)(wanted < 10.0 ? 10.0 : wanted > 200.0 ? 200.0 : wanted);
  TRY(memory_allocate(&pdf->edges, pdf->bins + 1, sizeof *pdf->edges, "histogram"));
  TRY(memory_allocate(&pdf->density, pdf->bins, sizeof *pdf->density, "histogram"));
  double bin = (high - low) / (double)pdf->bins;
  for (size_t b = 0; b < pdf->bins; b++) pdf->edges[b] = low + bin * (double)b;
  pdf->edges[pdf->bins] = high;
  histogram(values, n, low, high, pdf->bins, pdf->density);
  for (size_t b = 0; b < pdf->bins; b++) pdf->density[b] /= (double)n * bin;
cleanup:
  if (status != STATUS_OK) pdf_free(pdf);
  return status;
}

void pdf_free(struct pdf *pdf) {
  memory_free(&pdf->edges);
  memory_free(&pdf->density);
  pdf->bins = 0;
}

void moments_of(const double *values, size_t n, struct moments *moments) {
  double mean = sum_compensated(values, n) / (double)n, m2 = 0.0, m3 = 0.0, m4 = 0.0;
  for (size_t i = 0; i < n; i++) {
    double d = values[i] - mean;
    m2 += d * d;
    m3 += d * d * d;
    m4 += d * d * d * d;
  }
  m2 /= (double)n;
  m3 /= (double)n;
  m4 /= (double)n;
  *moments = (struct moments){mean, sqrt(m2), m3 / (m2 * sqrt(m2)), m4 / (m2 * m2) - 3.0};
}

double pdf_slit(double s) {
  return s >= 0.0 && s < 1.5 ? 1.0 / (3.0 * sqrt(1.0 - s / 1.5)) : 0.0;
}

double pdf_tube(double s) {
  return s >= 0.0 && s <= 2.0 ? 0.5 : 0.0;
}

double pdf_exponential(double s) {
  return s >= 0.0 ? exp(-s) : 0.0;
}

/* Log-likelihood per value of p(s) = gamma / (sigma Gamma(1/gamma)) exp(-(s/sigma)^gamma), s > 0,
 * at the best sigma for a given gamma: sigma^gamma = gamma <s^gamma>. */
static double profile_likelihood(const double *values, size_t n, double gamma, double *sigma) {
  double sum = 0.0;
  size_t count = 0;
  for (size_t i = 0; i < n; i++) {
    if (!(values[i] > 0.0)) continue;
    sum += pow(values[i], gamma);
    count++;
  }
  *sigma = pow(gamma * sum / (double)count, 1.0 / gamma);
  return log(gamma / *sigma) - lgamma(1.0 / gamma) - 1.0 / gamma;
}

void pdf_fit_power_exponential(const double *values, size_t n, double *sigma, double *gamma) {
  const double golden = 0.6180339887498949;
  double low = 0.3, high = 4.0;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = profile_likelihood(values, n, a, sigma);
  double at_b = profile_likelihood(values, n, b, sigma);
  while (high - low > 1e-3) {
    if (at_a > at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = profile_likelihood(values, n, a, sigma);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = profile_likelihood(values, n, b, sigma);
    }
  }
  *gamma = 0.5 * (low + high);
  profile_likelihood(values, n, *gamma, sigma);
}
