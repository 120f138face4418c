#include "sphsolve/isph/interface.h"
#include "sphsolve/isph/constants.h"

#include <math.h>
#include <string.h>

/* Soil fractions are smoothed, so that near an interface both soils are present. Across it the same
 * water flows through both and resistances add; along it both have the same gradient and flows add:
 *   across   a = sum w a,     b = sum w b
 *   along    1/a = sum w / a, 1/sqrt(b) = sum w / sqrt(b)    (exact for a alone and for b alone)
 * (Wiener 1912). The normal is the principal direction of
 *   T = grad M grad M + HESSIAN_WEIGHT h^2 H H,   M = sum w ln a / sum w,
 * with H the second derivatives of M. T has rank one at a plane interface, and in a thin layer, in
 * whose middle grad M is 0 but H is not. At a corner T has two principal directions; q = (l1 -
 * l2)/(l1 + l2) of its eigenvalues goes to 0, and both means go to the geometric one, which is that
 * of a checkerboard (Keller 1964). */

/* Bound on the change of the mean mobility along an interface, in units of the finer soil's
 * mobility. Soils whose mobilities differ by less than a factor 9 are not affected. */
#define MEAN_CHANGE_MAX 4.0
/* Lower bound of the relative weight of neighbours along an edge, over that without an edge. */
#define WEIGHT_MIN 0.25

void isph_fraction_add(struct isph_fraction *to, double scale, const struct isph_fraction *share) {
  to->value += scale * share->value;
  for (int a = 0; a < 3; a++) to->gradient[a] += scale * share->gradient[a];
  for (int k = 0; k < 6; k++) to->hessian[k] += scale * share->hessian[k];
}

static void add_mobility(struct isph_mobilities *to, double w, double mobility) {
  to->sum += w * mobility;
  to->least = fmin(to->least, mobility), to->most = fmax(to->most, mobility);
}

static bool differ(const struct isph_mobilities *m) {
  return m->most > m->least * (1 + 1e-9);
}

/* Mean mobility along an interface. As fractions are smoothed, a trace of a soil that is far more
 * permeable than the other would dominate the mean. Water in the fine soil would then move along
 * the interface by the disorder in the steep pressure gradient normal to it, times the mobility of
 * the coarse soil, of which the pressure equation, whose pairs see the fine soil, knows nothing
 * (ratio 1e4: ten times the seepage velocity). So where less than half is coarse, the coarse soil
 * adds at most MEAN_CHANGE_MAX times the fine one's mobility; and where more than half is coarse,
 * the fine soil reduces the mean by at most that. As much is taken on one side of the interface as
 * is given on the other, and layers carry as much as before. */
static double mean_along(const struct isph_mobilities *m, double w) {
  const double mean = m->sum / w, low = m->least, high = m->most;
  if (!isfinite(mean) || high <= low * (1 + 2 * MEAN_CHANGE_MAX)) return mean;
  if (2 * mean < low + high) return fmin(mean, low * (1 + MEAN_CHANGE_MAX));
  return fmax(mean, high - low * MEAN_CHANGE_MAX);
}

void isph_soil_mix_add(struct isph_soil_mix *m, const struct isph_fraction *w, double a, double b) {
  const double drag = a > 0 ? a : b;
  if (!(drag > 0)) return;
  add_mobility(&m->linear, w->value, 1 / a);
  add_mobility(&m->forchheimer, w->value, 1 / sqrt(b));
  isph_fraction_add(&m->sum, 1, w);
  isph_fraction_add(&m->level, log(drag), w);
}

static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/* The tensor T of M = level / sum. */
static void find_tensor(const struct isph_soil_mix *m, double h, double tensor[6]) {
  const struct isph_fraction *l = &m->level, *s = &m->sum;
  const double mean = l->value / s->value;
  double g[3], hessian[6] = {0};
  for (int a = 0; a < 3; a++) g[a] = (l->gradient[a] - mean * s->gradient[a]) / s->value;
  for (int a = 0; a < 3; a++)
    for (int b = a; b < 3; b++)
      hessian[at[a][b]] = (l->hessian[at[a][b]] - mean * s->hessian[at[a][b]] -
                           g[a] * s->gradient[b] - g[b] * s->gradient[a]) /
                          s->value;
  for (int a = 0; a < 3; a++)
    for (int b = a; b < 3; b++) {
      tensor[at[a][b]] = g[a] * g[b];
      for (int c = 0; c < 3; c++)
        tensor[at[a][b]] += HESSIAN_WEIGHT * h * h * hessian[at[a][c]] * hessian[at[c][b]];
    }
}

/* Principal direction of a positive semi-definite tensor, by power iteration. Returns its
 * eigenvalue less the sum of the others, over the sum of all. */
static double principal(const double t[6], double n[3]) {
  const double trace = t[0] + t[3] + t[5];
  int first = 0;
  if (!(trace > 0)) return 0;
  for (int a = 1; a < 3; a++)
    if (t[at[a][a]] > t[at[first][first]]) first = a;
  for (int a = 0; a < 3; a++) n[a] = t[at[first][a]] / trace;
  for (int round = 0; round < 20; round++) {
    double next[3], square = 0;
    for (int a = 0; a < 3; a++) {
      next[a] = (t[at[a][0]] * n[0] + t[at[a][1]] * n[1] + t[at[a][2]] * n[2]) / trace;
      square += next[a] * next[a];
    }
    for (int a = 0; a < 3; a++) n[a] = next[a] / sqrt(square);
  }
  double value = 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) value += n[a] * t[at[a][b]] * n[b];
  return fmax(0, 2 * value / trace - 1);
}

/* Moves both means towards their geometric mean, as q goes from 1 to 0. */
static void turn(double q, double *across, double *along) {
  if (!(*along > 0) || !(*across > 0)) return;
  const double factor = pow(*across / *along, 0.5 * (1 - q));
  *across /= factor, *along *= factor;
}

void isph_soil_mix_split(const struct isph_soil_mix *m, double smoothing, struct soil_point *soil) {
  const double w = m->sum.value;
  double tensor[6];
  soil->along_a = soil->a, soil->along_b = soil->b, soil->plane = 1;
  memset(soil->normal, 0, sizeof soil->normal);
  if (!(w > 0) || !(differ(&m->linear) || differ(&m->forchheimer))) return;
  find_tensor(m, smoothing, tensor);
  const double q = principal(tensor, soil->normal);
  if (!(tensor[0] + tensor[3] + tensor[5] > 0)) return;
  soil->plane = q;
  soil->along_a = w / mean_along(&m->linear, w);
  soil->along_b = w / pow(mean_along(&m->forchheimer, w), 2);
  turn(q, &soil->a, &soil->along_a);
  turn(q, &soil->b, &soil->along_b);
}

static double along(const double moment[6], const double n[3]) {
  double sum = moment[0] + moment[3] + moment[5];
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) sum -= n[a] * moment[at[a][b]] * n[b];
  return sum;
}

/* Unit normal of an edge: that of the interface if there is one, or else the direction in which ln
 * k changes. Returns false if there is none. */
static bool edge_normal(const struct isph_edge *edge, const double interface[3], double normal[3]) {
  const double mean = edge->weight > 0 ? edge->level / edge->weight : 0;
  double g[3];
  for (int a = 0; a < 3; a++) g[a] = edge->normal[a] - mean * edge->middle[a];
  if (interface != NULL && (interface[0] != 0 || interface[1] != 0 || interface[2] != 0))
    memcpy(g, interface, sizeof g);
  const double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int a = 0; a < 3; a++) normal[a] = size > 0 ? g[a] / size : 0;
  return size > 0;
}

/* Across an edge of mobility, along n = grad ln k, the gradient is taken from the flux between
 * particles, sum V_j (k_ij/k_i) slope (q_i - q_j) r, with the k_ij of the pressure matrix: the flux
 * is then the same on both sides, which k_i times the plain gradient is not. Along the edge a
 * neighbour is weighted by k_ij as well, but so that the gradient is exact for linear fields. */
void isph_edge_find(const struct isph_edge *edge, const double interface[3],
                    struct isph_edge_frame *frame) {
  frame->share = 0;
  if (!edge_normal(edge, interface, frame->normal)) return;
  const double share = along(edge->weighted, frame->normal) / along(edge->even, frame->normal);
  frame->share = fmax(WEIGHT_MIN, share);
}

void isph_edge_turn(const struct isph_edge_frame *frame, const double flux[3], double gradient[3]) {
  const double *n = frame->normal;
  double across = 0;
  if (frame->share == 0) return;
  for (int a = 0; a < 3; a++) across += n[a] * flux[a];
  for (int a = 0; a < 3; a++)
    gradient[a] = n[a] * across + (flux[a] - n[a] * across) / frame->share;
}
