/* Water in soil that is not full, written once more, plainly: the soil's curves (van Genuchten 1980
 * with Mualem 1976, or Haverkamp et al. 1977) and a column by finite volumes, implicit Euler and
 * modified Picard iterations (Celia, Bouloutas, Zarba 1990), with arithmetic means of K. */
#ifndef TOSUI_TESTS_VERIFY_RICHARDS_REFERENCE_H
#define TOSUI_TESTS_VERIFY_RICHARDS_REFERENCE_H

#include <math.h>
#include <stdlib.h>

#include "tests/unit/richards_scene.h"

struct soil {
  double theta_r, theta_s, alpha, n, k, k_alpha,
      k_n; /* the last two: of Haverkamp's curves; n 0: Gardner's */
};
static inline double saturation_of(const struct soil *s, double h) {
  if (s->n == 0) return exp(s->alpha * fmin(0, h));
  if (s->k_n > 0 && h < 0) return 1 / (1 + pow(s->alpha * -h, s->n));
  return h >= 0 ? 1 : pow(1 + pow(s->alpha * -h, s->n), 1 / s->n - 1);
}
static inline double theta_of(const struct soil *s, double h) {
  return s->theta_r + (s->theta_s - s->theta_r) * saturation_of(s, h);
}
static inline double k_of(const struct soil *s, double h) {
  const double e = saturation_of(s, h), m = 1 - 1 / s->n;
  if (h >= 0) return s->k;
  if (s->n == 0) return s->k * exp(s->alpha * h);
  if (s->k_n > 0) return s->k / (1 + pow(s->k_alpha * -h, s->k_n));
  const double g = 1 - pow(1 - pow(e, 1 / m), m);
  return s->k * sqrt(e) * g * g;
}
static inline double capacity_of(const struct soil *s, double h) {
  const double d = 1e-6 * fmax(1e-3, fabs(h));
  return h >= -d ? 0 : (theta_of(s, h + d) - theta_of(s, h - d)) / (2 * d);
}

struct reference {
  int n;
  double dz, *h, infiltrated; /* cells from the foot; m */
};

/* A column whose upper part above `interface` is another soil. *top m held above, or falling by
 * what goes in if `falls`; `foot` below unless NAN: closed. */
static inline void refer_below(const struct soil *lower, const struct soil *upper, double interface,
                               double length, int n, double start_head, double *water, bool falls,
                               double foot, double time, double dt, struct reference *r) {
  double *h = malloc((size_t)n * sizeof *h), *old = malloc((size_t)n * sizeof *h),
         *k = malloc((size_t)n * sizeof *h), *a = malloc((size_t)n * sizeof *h),
         *b = malloc((size_t)n * sizeof *h);
  const double dz = length / n;
  *r = (struct reference){n, dz, h, 0};
  for (int i = 0; i < n; i++) h[i] = start_head;
  const int steps = (int)ceil(time / dt);
  dt = time / steps;
#define SOIL(i) (((i) + .5) * dz > interface ? upper : lower)
  for (int step = 0; step < steps; step++) {
    const double top = *water;
    double in = 0;
    for (int i = 0; i < n; i++) old[i] = theta_of(SOIL(i), h[i]);
    for (int round = 0; round < 200; round++) {
      double most = 0;
      for (int i = 0; i < n; i++) k[i] = k_of(SOIL(i), h[i]);
      /* Thomas's algorithm for the changes, eliminated upwards. */
      for (int i = 0; i < n; i++) {
        const bool foot_face = i == 0, top_face = i == n - 1;
        const double low = foot_face ? (isnan(foot) ? 0 : .5 * (k[0] + k_of(lower, foot)))
                                     : .5 * (k[i] + k[i - 1]),
                     high = top_face ? .5 * (k[i] + k_of(upper, top)) : .5 * (k[i] + k[i + 1]);
        const double below = foot_face ? (isnan(foot) ? 0 : low * 2 / dz) : low / dz,
                     above = top_face ? high * 2 / dz : high / dz;
        const double h_low = foot_face ? foot : h[i - 1], h_high = top_face ? top : h[i + 1];
        const double q_low = below > 0 ? below * (h[i] - h_low) + low : 0,
                     q_high = above * (h_high - h[i]) + high; /* downwards */
        if (top_face) in = q_high;
        double diagonal = capacity_of(SOIL(i), h[i]) / dt + (below + above) / dz;
        double right = (q_high - q_low) / dz - (theta_of(SOIL(i), h[i]) - old[i]) / dt;
        if (!foot_face) {
          const double f = below / dz * a[i - 1];
          diagonal -= f, right += below / dz * b[i - 1];
        }
        a[i] = top_face ? 0 : above / dz / diagonal;
        b[i] = right / diagonal;
      }
      for (int i = n - 1; i >= 0; i--) {
        if (i < n - 1) b[i] += a[i] * b[i + 1];
        most = fmax(most, fabs(b[i]) / fmax(1, fabs(h[i])));
      }
      for (int i = 0; i < n; i++) h[i] += b[i];
      if (most < 1e-7) break;
    }
    r->infiltrated += in * dt;
    if (falls) *water -= in * dt;
  }
  free(old), free(k), free(a), free(b);
}
static inline void refer(const struct soil *lower, const struct soil *upper, double interface,
                         double length, int n, double start_head, double top, double foot,
                         double time, double dt, struct reference *r) {
  refer_below(lower, upper, interface, length, n, start_head, &top, false, foot, time, dt, r);
}

/* Rms of the water content against it, by the mean of its cells in each site. */
static inline double apart(const struct run *run, const struct reference *r,
                           const struct soil *lower, const struct soil *upper, double interface) {
  const int each = r->n / (int)run->s.count;
  double square = 0;
  for (size_t i = 0; i < run->s.count; i++) {
    double mean = 0;
    for (int j = 0; j < each; j++) {
      const int at = (int)i * each + j;
      mean += theta_of((at + .5) * r->dz > interface ? upper : lower, r->h[at]) / each;
    }
    square += pow(run->s.now[i].theta - mean, 2) / (double)run->s.count;
  }
  return sqrt(square);
}

#endif
