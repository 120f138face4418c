#include "sphsolve/darcy/retention.h"

#include <math.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/darcy/constants.h"

/* ln(1 + e^t), exact for large t of either sign. */
static double softplus(double t) {
  return t > 0 ? t + log1p(exp(-t)) : log1p(exp(t));
}

/* S, k and dk/d ln(alpha |h|) from t = n ln(alpha |h|), avoiding differences of nearly equal
 * numbers: (1 - S^(1/m))^m = (1 + (alpha |h|)^-n)^-m. */
static void at_suction(const struct retention *soil, double t, double *s, double *k, double *dk) {
  const double ln_s = -soil->m * softplus(t), ln_rest = -soil->m * softplus(-t);
  const double g = -expm1(ln_rest), power = exp(soil->l * ln_s);
  const double wet = 1 / (1 + exp(t)), dry = 1 / (1 + exp(-t));
  *s = exp(ln_s);
  if (soil->k_n > 0) {
    const double u = soil->k_n * (t / soil->n + log(soil->k_alpha / soil->alpha));
    *k = 1 / (1 + exp(u));
    *dk = -soil->k_n * *k / (1 + exp(-u));
    return;
  }
  *k = power * g * g;
  *dk = soil->n * soil->m * (-soil->l * dry * *k - 2 * power * g * exp(ln_rest) * wet);
}

static double k_times_suction(const struct retention *soil, double x) {
  double s, k, dk;
  at_suction(soil, soil->n * x, &s, &k, &dk);
  return k * exp(x) / soil->alpha;
}

/* Integrates F from the dry end, by four-point Gauss-Legendre quadrature in each step. Beyond that
 * end k falls as |h|^-p with p = n l m + 2 n, so that the rest of the integral is |h| k / (p - 1).
 */
enum status retention_make(const struct region *region, struct retention *soil) {
  const double point[4] = {-GAUSS_OUTER, -GAUSS_INNER, GAUSS_INNER, GAUSS_OUTER};
  const double weight[4] = {GAUSS_OUTER_WEIGHT, GAUSS_INNER_WEIGHT, GAUSS_INNER_WEIGHT,
                            GAUSS_OUTER_WEIGHT};
  enum status status = STATUS_OK;
  const struct retention_curve *given = &region->retention;
  *soil = (struct retention){.alpha = given->alpha,
                             .n = given->n,
                             .m = given->k_n > 0 ? 1 : 1 - 1 / given->n,
                             .k_alpha = given->k_alpha,
                             .k_n = given->k_n,
                             .exponential = given->exponential,
                             .l = given->l,
                             .theta_r = given->theta_r,
                             .theta_s = region->porosity};
  for (int a = 0; a < 3; a++) {
    static const int diagonal[3] = {0, 3, 5};
    soil->conductivity[a] =
        region->permeability * (region->anisotropic ? region->anisotropy[diagonal[a]] : 1);
  }
  if (soil->exponential) {
    soil->n = 2; /* what darcy/step.c does for n < 2 is not wanted */
    soil->driest = log(DRIEST_SATURATION) / soil->alpha;
    soil->full = 1 / soil->alpha;
    return STATUS_OK;
  }
  const double dry = fmin(log(DRIEST_SUCTION), -log(DRIEST_SATURATION) / (soil->n * soil->m));
  soil->driest = -exp(dry) / soil->alpha;
  soil->first = log(RETENTION_STRAIGHT);
  soil->step = 1 / (STEPS_PER_TURN * fmax(soil->n, soil->k_n));
  soil->count = (size_t)ceil((dry - soil->first) / soil->step) + 1;
  TRY(memory_allocate(&soil->table, soil->count, sizeof *soil->table, "Kirchhoff's transform"));
  const double p = soil->k_n > 0 ? soil->k_n : soil->n * soil->l * soil->m + 2 * soil->n;
  double sum = 0, saturation, slope;
  at_suction(soil, soil->n * soil->first, &saturation, &soil->fall, &slope);
  soil->fall = 1 - soil->fall;
  double missing = RETENTION_STRAIGHT / soil->alpha * (1 - 0.5 * soil->fall);
  for (size_t i = soil->count; i-- > 0;) {
    const double x = soil->first + (double)i * soil->step, here = k_times_suction(soil, x);
    double part = i + 1 == soil->count ? here / (p - 1) : 0;
    for (int q = 0; q < 4 && i + 1 < soil->count; q++)
      part += 0.5 * soil->step * weight[q] *
              k_times_suction(soil, x + 0.5 * soil->step * (1 + point[q]));
    sum += part;
    soil->table[i][0] = log(sum);
    soil->table[i][1] = -here / sum;
    soil->table[i][2] = part;
    soil->table[i][3] = here;
  }
  soil->full = sum + missing;
  for (size_t i = 0; i < soil->count; i++) {
    const double part = soil->table[i][2];
    soil->table[i][2] = log(missing);
    soil->table[i][3] /= missing;
    missing += part;
  }
cleanup:
  return status;
}

/* The drag of Morimoto et al. 2015, eqs. 9c and 9d: g i = a v + b v |v|. */
bool retention_full(const struct region *region, double nu, struct retention *soil) {
  const double e = region->porosity, d = region->grain_size, cube = e * e * e;
  const double a = region->alpha * nu * (1 - e) * (1 - e) / (cube * d * d);
  const double *shape = region->anisotropy, k = GRAVITY_STANDARD / a;
  const bool beds = region->anisotropic;
  *soil = (struct retention){
      .theta_s = e,
      .conductivity = {beds ? k * shape[0] : k, beds ? k * shape[3] : k, beds ? k * shape[5] : k},
      .shear = beds ? k * shape[2] : 0,
      .forchheimer = region->beta * (1 - e) / (cube * d * GRAVITY_STANDARD),
      .driest = -INFINITY};
  return a > 0;
}

void retention_free(struct retention *soil) {
  memory_free(&soil->table);
}

bool retention_is_same(const struct retention *a, const struct retention *b) {
  bool same = a->alpha == b->alpha && a->n == b->n && a->l == b->l && a->k_alpha == b->k_alpha &&
              a->k_n == b->k_n && a->exponential == b->exponential && a->theta_r == b->theta_r &&
              a->theta_s == b->theta_s && a->shear == b->shear && a->forchheimer == b->forchheimer;
  for (int i = 0; i < 3; i++) same = same && a->conductivity[i] == b->conductivity[i];
  return same;
}

/* F, or with `column` 2 the difference F(0) - F, at x = ln(alpha |h|). */
static double potential_at(const struct retention *soil, int column, double x) {
  const double at = (x - soil->first) / soil->step;
  const size_t i = at < (double)(soil->count - 2) ? (size_t)at : soil->count - 2;
  const double f = at - (double)i, *a = soil->table[i] + column, *b = soil->table[i + 1] + column;
  const double rise = b[0] - a[0], left = a[1] * soil->step - rise,
               right = rise - b[1] * soil->step;
  return exp(a[0] + f * (rise + (1 - f) * (left * (1 - f) + right * f)));
}

void retention_at(const struct retention *soil, double h, struct retention_state *state) {
  const double range = soil->theta_s - soil->theta_r;
  *state = (struct retention_state){.h = h, .theta = soil->theta_s, .saturation = 1, .k = 1};
  if (h >= 0) {
    state->potential = soil->full + h;
    state->missing = -h;
    return;
  }
  if (soil->exponential) {
    const double k = exp(soil->alpha * h);
    *state = (struct retention_state){.h = h,
                                      .theta = soil->theta_r + range * k,
                                      .capacity = range * soil->alpha * k,
                                      .saturation = k,
                                      .k = k,
                                      .slope = soil->alpha * k,
                                      .potential = k / soil->alpha,
                                      .missing = -expm1(soil->alpha * h) / soil->alpha};
    return;
  }
  const double x = log(-soil->alpha * h);
  double s, dk;
  at_suction(soil, soil->n * x, &s, &state->k, &dk);
  state->theta = soil->theta_r + range * s;
  state->saturation = s;
  state->capacity = range * soil->m * soil->n * s / (1 + exp(-soil->n * x)) / -h;
  if (x < soil->first) {
    state->slope = soil->fall * soil->alpha / RETENTION_STRAIGHT;
    state->k = 1 + state->slope * h;
    state->missing = -h * (1 + 0.5 * state->slope * h);
    state->potential = soil->full - state->missing;
    return;
  }
  state->slope = dk / h;
  state->potential = potential_at(soil, 0, x);
  state->missing = potential_at(soil, 2, x);
}

double retention_head(const struct retention *soil, double saturation) {
  if (soil->exponential) return fmax(log(saturation) / soil->alpha, soil->driest);
  const double rest = -log(saturation) / soil->m;
  /* (e^rest - 1)^(1/n), also if e^rest overflows */
  const double ln = rest > 30 ? rest : log(expm1(rest));
  return fmax(-exp(ln / soil->n) / soil->alpha, soil->driest);
}
