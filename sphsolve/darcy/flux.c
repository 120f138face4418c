#include "sphsolve/darcy/flux.h"

#include <math.h>
#include <stdbool.h>

#include "sphsolve/darcy/constants.h"

/* w(P) and its derivative. */
static void gravity_weight(double p, double *w, double *slope) {
  if (fabs(p) < SERIES_PECLET) {
    const double square = p * p;
    *w = 0.5 + p * (1.0 / 12 - square / 720);
    *slope = 1.0 / 12 - square / 240;
    return;
  }
  const double half = sinh(fmin(fabs(0.5 * p), 300));
  *w = -1 / expm1(-p) - 1 / p;
  *slope = 1 / (p * p) - 0.25 / (half * half);
}

/* B(P) (Bernoulli function) for P >= 0, and its derivative. B(-P) is B(P) + P. */
static void bernoulli(double p, double *b, double *slope) {
  if (p < SERIES_PECLET) {
    const double square = p * p;
    *b = 1 - 0.5 * p + square * (1.0 / 12 - square / 720);
    *slope = -0.5 + p * (1.0 / 6 - square / 180);
    return;
  }
  const double more = expm1(fmin(p, 600));
  *b = p / more;
  *slope = (1 - *b - p) / more;
}

/* k_m from the difference of F; or for nearly equal heads by the Euler-Maclaurin formula. The two
 * go over smoothly, since Newton's method is sensitive to any jump. */
static double mean_conductivity(const struct retention_state *i, const struct retention_state *j,
                                double dh, double df, double apart) {
  const double s = fmin(fmax((apart - HEADS_NEAR) / (HEADS_FAR - HEADS_NEAR), 0), 1),
               far = s * s * (3 - 2 * s);
  const double near = 0.5 * (i->k + j->k) - dh / 12 * (i->slope - j->slope);
  return far > 0 ? far * df / dh + (1 - far) * near : near;
}

/* Bounds of the steady flux through any soil whose k increases with h. It is that by suction and
 * pull times a mean of k along the path, which lies between the k of both ends. And it is on that
 * side of pull times k to which suction drives, at the upper end as all along: h would not fall or
 * rise to the other end otherwise. An exponential k oversteps them where k is far from one, as at
 * the edge of saturation for n < 2. Against gravity the second bound is left out: on it the flux
 * would not depend on the lower head. */
static void hold_within_bounds(double conductivity, double distance, double pull, double suction,
                               const struct retention_state *i, const struct retention_state *j,
                               struct flux *flux, double *by_distance) {
  const double sign = i->h > j->h ? 1 : -1, by_i = conductivity / distance * i->k,
               by_j = -conductivity / distance * j->k, weight = conductivity * pull;
  const struct flux at_i = {weight * i->k, weight * i->slope, 0},
                    at_j = {weight * j->k, 0, weight * j->slope};
  const struct flux alone = pull > 0 ? at_i : at_j, under = pull > 0 ? at_j : at_i,
                    most = {suction + alone.q, by_i + alone.di, by_j + alone.dj},
                    least = {suction + under.q, by_i + under.di, by_j + under.dj};
  const bool steep = sign * pull > 0 && sign * alone.q > sign * least.q;
  if (sign * flux->q > sign * most.q)
    *flux = most, *by_distance = -suction / distance;
  else if (!(sign * flux->q < sign * (steep ? alone.q : least.q)))
    return;
  else if (steep) {
    *flux = alone, *by_distance = 0;
    /* as of water that stands on it */
    if (i->h >= 0) flux->di += by_i;
    if (j->h >= 0) flux->dj += by_j;
  } else
    *flux = least, *by_distance = -suction / distance;
}

/* Flux along a path that is saturated all along, or nowhere; *by_distance: its derivative by the
 * length of the path. */
static void flux_along(bool held, double conductivity, double distance, double pull,
                       const struct retention_state *i, const struct retention_state *j,
                       struct flux *flux, double *by_distance) {
  const double dh = i->h - j->h, dk = i->k - j->k, df = retention_fall(i, j);
  const double size = fmin(fabs(i->h), fabs(j->h)), apart = dh != 0 ? fabs(dh) / size : 0;
  const double mean = mean_conductivity(i, j, dh, df, apart), sum = i->k + j->k;
  const bool differs = fabs(dk) > K_ROUNDING * sum;
  const double rate = differs && apart > 0.1 * HEADS_NEAR ? dk / (mean * dh)
                      : sum > 0                           ? (i->slope + j->slope) / sum
                                                          : 0;
  double mean_i = 0.5 * i->slope, mean_j = 0.5 * j->slope, rate_i = 0, rate_j = 0;
  if (differs && apart > HEADS_FAR) {
    mean_i = (i->k - mean) / dh, mean_j = (mean - j->k) / dh;
    rate_i = (i->slope - rate * i->k) / df, rate_j = (rate * j->k - j->slope) / df;
  }
  /* For dh < 0 the part -r dh of B(r dh) is moved to w, so that no derivative is a difference of
   * large numbers; with heads of -1e4 m it would have no correct digit. k_i - k_j is k_m r dh: at
   * rest the flux is exactly zero. */
  double along, rest, along_slope, rest_slope;
  gravity_weight(pull * distance * rate, &along, &along_slope);
  bernoulli(fabs(rate * dh), &rest, &rest_slope);
  if (dh < 0) along -= 1, rest_slope = -rest_slope;
  const double w = pull * along, turn = pull * pull * distance * dk * along_slope;
  flux->q = conductivity * mean * (dh / distance + pull * (rest + rate * dh * along));
  flux->di = conductivity * (i->k / distance + w * i->slope + turn * rate_i +
                             pull * (mean_i * rest + mean * rest_slope * (rate + dh * rate_i)));
  flux->dj = conductivity * (-j->k / distance - w * j->slope + turn * rate_j +
                             pull * (mean_j * rest + mean * rest_slope * (dh * rate_j - rate)));
  *by_distance = conductivity * mean * dh *
                 (pull * rate * pull * rate * along_slope - 1 / (distance * distance));
  if (held && pull != 0)
    hold_within_bounds(conductivity, distance, pull, conductivity * mean * dh / distance, i, j,
                       flux, by_distance);
}

/* Flux along a path in one soil, `held` if it is half of one between two. Where the path is
 * saturated at its lower end only, and if held at either, the length s of its saturated part is
 * that at which both parts carry the same flux; the difference of the two is monotonic in s. */
static void flux_on_path(bool held, double conductivity, double distance, double pull,
                         const struct retention_state *i, const struct retention_state *j,
                         struct flux *flux) {
  const struct retention_state *wet = i->h > j->h ? i : j, *dry = i->h > j->h ? j : i;
  const double sign = wet == j ? 1 : -1;
  const struct retention_state table = {.k = 1, .potential = wet->potential - wet->h};
  double low = 0, high = distance, last = distance, before = distance, by_distance, in_wet, fall;
  struct flux rest;
  /* without gravity it is this; within rounding of an end, there is one part only */
  double s = distance * wet->h / (wet->h + retention_fall(&table, dry));
  if (!(wet->h > 0 && dry->h < 0 && (held ? pull != 0 : sign * pull > 0) && s > low && s < high)) {
    flux_along(held, conductivity, distance, pull, i, j, flux, &by_distance);
    return;
  }
  for (int round = 0;; round++) {
    flux_along(held, conductivity, distance - s, pull, wet == j ? i : &table, wet == j ? &table : j,
               &rest, &by_distance);
    in_wet = conductivity * (pull - sign * wet->h / s);
    const double open = sign * (in_wet - rest.q);
    if (open < 0)
      low = s;
    else
      high = s;
    fall = conductivity * wet->h + sign * by_distance * s * s;
    double next = s - open * s * s / fall;
    if (!(next > low && next < high && fabs(next - s) < 0.5 * before)) next = 0.5 * (low + high);
    if (fabs(open) <= TABLE_ROUNDING * fabs(in_wet) || fabs(next - s) <= TABLE_ROUNDING * s ||
        round == FACE_ITERATIONS_MAX)
      break;
    before = last, last = fabs(next - s), s = next;
  }
  const double by_dry = wet == j ? rest.di : rest.dj, part = conductivity * wet->h / fall;
  const double dq_dry = part * by_dry, dq_wet = -conductivity * s * by_distance / fall;
  flux->q = part * rest.q + (1 - part) * in_wet;
  flux->di = wet == j ? dq_dry : dq_wet;
  flux->dj = wet == j ? dq_wet : dq_dry;
}

void flux_in_soil(double conductivity, double distance, double pull,
                  const struct retention_state *i, const struct retention_state *j,
                  struct flux *flux) {
  flux_on_path(false, conductivity, distance, pull, i, j, flux);
}

void flux_between_soils(const struct retention *soil_i, const struct retention *soil_j, int axis,
                        double distance, double pull, const struct retention_state *i,
                        const struct retention_state *j, struct flux *flux) {
  const double half = 0.5 * distance;
  struct retention_state at_i, at_j;
  struct flux one, two;
  /* The interface gains water for heads below `low`, and loses water above `high`. */
  double low = fmin(i->h, j->h) - distance * fabs(pull),
         high = fmax(i->h, j->h) + distance * fabs(pull), h = i->h > j->h ? i->h : j->h,
         last = high - low, before = last;
  for (int round = 0; round < FACE_ITERATIONS_MAX; round++) {
    retention_at(soil_i, h, &at_i);
    retention_at(soil_j, h, &at_j);
    flux_on_path(true, soil_i->conductivity[axis], half, pull, i, &at_i, &one);
    flux_on_path(true, soil_j->conductivity[axis], half, pull, &at_j, j, &two);
    const double open = one.q - two.q, fall = one.dj - two.di;
    if (open > 0)
      low = h;
    else
      high = h;
    double next = fall < 0 ? h - open / fall : NAN;
    /* Bisect where Newton's method leaves the bracket, or goes to and fro in it. */
    if (!(next > low && next < high && fabs(next - h) < 0.5 * before)) {
      /* Between -1e4 m and 0 bisect the logarithms. */
      next = low < -1e-6 && high < -1e-12 ? -sqrt(low * high) : 0.5 * (low + high);
    }
    if (fabs(next - h) <= 1e-14 * fmax(fabs(h), 1e-6) || open == 0) break;
    before = last, last = fabs(next - h), h = next;
  }
  const double fall = one.dj - two.di;
  flux->q = one.q;
  flux->di = fall < 0 ? -one.di * two.di / fall : 0;
  flux->dj = fall < 0 ? two.dj * one.dj / fall : 0;
}
