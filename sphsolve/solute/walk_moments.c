#include "sphsolve/solute/walk_moments.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/constants.h"

size_t walk_group_start(size_t walkers, int group) {
  return walkers * (size_t)group / WALK_GROUPS;
}

void walk_moments_begin(size_t walkers, const double stretch[3], struct walk_moments *m) {
  memset(m, 0, sizeof *m);
  m->walkers = walkers;
  for (int end = 0; end < 2; end++)
    m->group[end] = WALK_GROUPS * (ranks_own() + end) / ranks_count();
  m->first = walk_group_start(walkers, m->group[0]);
  m->count = walk_group_start(walkers, m->group[1]) - m->first;
  for (int a = 0; a < 3; a++) m->stretch[a] = stretch[a];
}

void walk_moments_free(struct walk_moments *m) {
  memory_free(&m->start);
  for (int k = 0; k < WALK_LAGS; k++) memory_free(&m->from[k]);
}

static void displacement_between(const struct walk_moments *m, const struct walk_spot *from,
                                 const struct walk_spot *to, double displacement[3]) {
  for (int a = 0; a < 3; a++)
    displacement[a] = m->stretch[a] * ((double)(to->cell[a] - from->cell[a]) +
                                       ((double)to->x[a] - (double)from->x[a]));
}

static void add_displacements(struct walk_moments *m, int lag, const struct walk_spot *now) {
  struct walk_spot *from = m->from[lag];
#pragma omp parallel for schedule(static)
  for (int g = m->group[0]; g < m->group[1]; g++) {
    double *sum = m->sums[lag][g];
    const size_t end = walk_group_start(m->walkers, g + 1) - m->first;
    for (size_t w = walk_group_start(m->walkers, g) - m->first; w < end; w++) {
      double displacement[3];
      displacement_between(m, &from[w], &now[w], displacement);
      for (int a = 0; a < 3; a++) {
        sum[WALK_DISPLACEMENT + a] += displacement[a];
        sum[WALK_PRODUCTS + a] += displacement[a] * displacement[a];
        sum[WALK_PRODUCTS + 3 + a] += displacement[a] * displacement[(a + 1) % 3];
      }
      const double u = (double)from[w].along;
      sum[WALK_PAIR] += u * (double)now[w].along;
      sum[WALK_ALONG] += u;
      sum[WALK_ALONG_SQUARE] += u * u;
      from[w] = now[w];
    }
  }
}

enum status walk_moments_add(struct walk_moments *m, const struct walk_spot *now) {
  enum status status = STATUS_OK;
  m->intervals++;
  for (int lag = 0; lag < WALK_LAGS && m->intervals % ((uint64_t)1 << lag) == 0; lag++) {
    if (lag == m->lags) {
      TRY(memory_allocate(&m->from[lag], m->count, sizeof *m->from[lag], "places of walkers"));
      memcpy(m->from[lag], m->start, m->count * sizeof *m->start);
      m->lags++;
    }
    add_displacements(m, lag, now);
  }
cleanup:
  return status;
}

/* Second moments of a group about the overall mean: along the flow, across it, and all six. */
struct moment {
  double along, across, product[6];
};

static double displacements_of_group(const struct walk_moments *m, int lag, int g) {
  const size_t walkers = walk_group_start(m->walkers, g + 1) - walk_group_start(m->walkers, g);
  return (double)walkers * (double)(m->intervals >> lag);
}

static struct moment moment_of(const double *sum, double displacements, const double mean[3],
                               const double e[3], int dimensions) {
  struct moment moment = {0};
  double trace = 0;
  for (int i = 0; i < 6; i++) {
    const int a = i % 3, b = i < 3 ? a : (a + 1) % 3;
    const double p = sum[WALK_PRODUCTS + i] / displacements -
                     mean[a] * (sum[WALK_DISPLACEMENT + b] / displacements) -
                     mean[b] * (sum[WALK_DISPLACEMENT + a] / displacements) + mean[a] * mean[b];
    moment.product[i] = p;
    moment.along += (i < 3 ? 1 : 2) * e[a] * e[b] * p;
    if (i < 3 && (dimensions == 3 || a != 1)) trace += p;
  }
  moment.across = (trace - moment.along) / (dimensions - 1);
  return moment;
}

static void mean_of(const double *values, double *mean, double *error) {
  double sum = 0, square = 0;
  for (int g = 0; g < WALK_GROUPS; g++) sum += values[g];
  *mean = sum / WALK_GROUPS;
  for (int g = 0; g < WALK_GROUPS; g++) square += (values[g] - *mean) * (values[g] - *mean);
  *error = sqrt(square / (WALK_GROUPS * (WALK_GROUPS - 1.0)));
}

static void mean_displacement(const struct walk_moments *m, int lag, double displacement[3]) {
  for (int a = 0; a < 3; a++) {
    displacement[a] = 0;
    for (int g = 0; g < WALK_GROUPS; g++) displacement[a] += m->sums[lag][g][WALK_DISPLACEMENT + a];
    displacement[a] /= (double)m->walkers * (double)(m->intervals >> lag);
  }
}

static void evaluate_lag(const struct walk_moments *m, int k, const double e[3], int dimensions,
                         double diffusion, double interval, struct walk_lag *lag) {
  double along[WALK_GROUPS], across[WALK_GROUPS], product[6][WALK_GROUPS], mean[3], before[3];
  const double span = 2 * diffusion * interval * (double)((uint64_t)1 << k);
  const double share = k > 0 ? 0.5 : 1; /* part of the lag in which the growth is taken */
  mean_displacement(m, k, mean);
  if (k > 0) mean_displacement(m, k - 1, before);
  for (int g = 0; g < WALK_GROUPS; g++) {
    struct moment now =
        moment_of(m->sums[k][g], displacements_of_group(m, k, g), mean, e, dimensions);
    struct moment half = {0};
    if (k > 0)
      half =
          moment_of(m->sums[k - 1][g], displacements_of_group(m, k - 1, g), before, e, dimensions);
    along[g] = (now.along - half.along) / (share * span);
    across[g] = (now.across - half.across) / (share * span);
    for (int i = 0; i < 6; i++) product[i][g] = (now.product[i] - half.product[i]) / (share * span);
  }
  mean_of(along, &lag->longitudinal, &lag->longitudinal_error);
  mean_of(across, &lag->transverse, &lag->transverse_error);
  for (int i = 0; i < 6; i++) mean_of(product[i], &lag->tensor[i], &lag->tensor_error[i]);
}

/* Flights of fixed length damp a wave of number q by <cos(q.flight)> = 1 - x + .3 x^2 in a step,
 * x = D q^2 dt, whereas diffusion damps it by exp(-x). If the velocity of walkers decorrelates by
 * diffusion alone, as between plane walls, each wave contributes 1 / (1 - x + ...) summed over the
 * steps, var(u) (1 / (D q^2) - dt / 5): D_L is too small by dt / 5 times the variance. Adds this
 * term. It is 3 % across a slit of 6 flights, and negligible where advection changes the velocity
 * of walkers. */
static void add_flight_correction(const double e[3], double step, double variance,
                                  struct walk_lag *lag) {
  const double correction = step / 5 * fmax(variance, 0);
  lag->longitudinal += correction;
  for (int i = 0; i < 6; i++) lag->tensor[i] += correction * e[i % 3] * e[i < 3 ? i : (i + 1) % 3];
}

int walk_moments_lags(const struct walk_moments *m, const double e[3], int dimensions,
                      double diffusion, double interval, double carried,
                      struct walk_lag lags[WALK_LAGS]) {
  int count = 0;
  for (int k = 0; k < m->lags && m->intervals >> k >= DISPLACEMENTS_MIN; k++, count++) {
    double displacement[3], pair = 0, along = 0, square = 0;
    struct walk_lag *lag = &lags[k];
    *lag = (struct walk_lag){.time = interval * (double)((uint64_t)1 << k),
                             .displacements = (double)m->walkers * (double)(m->intervals >> k)};
    evaluate_lag(m, k, e, dimensions, diffusion, interval, lag);
    mean_displacement(m, k, displacement);
    lag->velocity =
        (displacement[0] * e[0] + displacement[1] * e[1] + displacement[2] * e[2]) / lag->time;
    for (int g = 0; g < WALK_GROUPS; g++) {
      pair += m->sums[k][g][WALK_PAIR] / lag->displacements;
      along += m->sums[k][g][WALK_ALONG] / lag->displacements;
      square += m->sums[k][g][WALK_ALONG_SQUARE] / lag->displacements;
    }
    const double variance = square - along * along;
    lag->correlation = variance > 0 ? (pair - along * along) / variance : 0;
    add_flight_correction(e, carried, variance / diffusion, lag);
  }
  return count;
}

double walk_error_unit(double coefficient) {
  return fmax(fabs(coefficient), COEFFICIENT_MIN);
}

/* Relative error of the value at `k` among those of all lags: statistical, and by drift, which is
 * the change since the preceding lag, or what longer lags show beyond their own errors. */
static double error_at(const double *value, const double *error, int k, int count,
                       double *statistics, double *drift) {
  double change = fabs(value[k] - value[k - 1]);
  for (int j = k + 1; j < count; j++)
    change = fmax(change, fabs(value[j] - value[k]) - CONFIDENCE * error[j]);
  const double unit = walk_error_unit(value[k]);
  *statistics = CONFIDENCE * error[k] / unit;
  *drift = change / unit;
  return hypot(*statistics, *drift);
}

struct walk_verdict walk_moments_judge(const struct walk_lag *lags, int count, double memory) {
  struct walk_verdict best = {.lag = -1};
  double along[WALK_LAGS], across[WALK_LAGS], along_error[WALK_LAGS], across_error[WALK_LAGS];
  for (int k = 0; k < count; k++) {
    along[k] = lags[k].longitudinal, along_error[k] = lags[k].longitudinal_error;
    across[k] = lags[k].transverse, across_error[k] = lags[k].transverse_error;
  }
  for (int k = 1; k < count; k++) {
    if (lags[k].time * fmax(across[k], SPREAD_MIN) < memory) continue;
    struct walk_verdict v = {.lag = k, .longitudinal = along[k], .transverse = across[k]};
    v.longitudinal_error =
        error_at(along, along_error, k, count, &v.longitudinal_statistics, &v.longitudinal_drift);
    v.transverse_error =
        error_at(across, across_error, k, count, &v.transverse_statistics, &v.transverse_drift);
    const double worst = fmax(v.longitudinal_error, v.transverse_error);
    if (best.lag < 0 || worst < fmax(best.longitudinal_error, best.transverse_error)) best = v;
  }
  return best;
}
