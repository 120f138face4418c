#include "sphsolve/isph/interface.h"

#include <math.h>
#include <string.h>

/* Fractions of soil are smooth: at an interface both soils have one. Across it the same water flows
 * through both and resistances add, along it both feel the same gradient and flows add:
 *   across   a = sum w a,     b = sum w b
 *   along    1/a = sum w / a, 1/sqrt(b) = sum w / sqrt(b)    (exact for a alone and for b alone)
 * (Wiener 1912). The normal is the principal direction of
 *   T = grad M grad M + HESSIAN_WEIGHT h^2 H H,   M = sum w ln a / sum w,  H its second
 * derivatives, rank one at a plane interface and in a thin layer, where grad M is 0 in the middle
 * but H is not. At a corner T has two directions, q = (l1 - l2)/(l1 + l2) of its eigenvalues fades
 * to 0, and both means go to the geometric one: that of a checkerboard (Keller 1964). */

/* Small, so that H speaks only where grad M is silent: boxes that make stairs of an oblique
 * interface roughen H more than grad M (stairs of a spacing at 45 degrees: flux -13 % with 1, -4 %
 * with 0.1). */
#define HESSIAN_WEIGHT 0.02
/* Neighbours' weight along an edge is at least this fraction of that without an edge. */
#define WEIGHT_LEAST 0.25

void isph_fraction_add(struct isph_fraction *to, double scale, const struct isph_fraction *share) {
  to->value += scale * share->value;
  for (int a = 0; a < 3; a++) to->gradient[a] += scale * share->gradient[a];
  for (int k = 0; k < 6; k++) to->hessian[k] += scale * share->hessian[k];
}

void isph_soil_mix_add(struct isph_soil_mix *m, const struct isph_fraction *w, double a, double b) {
  const double drag = a > 0 ? a : b;
  if (!(drag > 0)) return;
  m->least = fmin(m->least, drag), m->most = fmax(m->most, drag);
  m->linear += w->value / a, m->forchheimer += w->value / sqrt(b);
  isph_fraction_add(&m->sum, 1, w);
  isph_fraction_add(&m->level, log(drag), w);
}

static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/* T of M = level / share. */
static void find_tensor(const struct isph_soil_mix *m, double h, double tensor[6]) {
  const struct isph_fraction *l = &m->level, *s = &m->sum;
  const double mean = l->value / s->value;
  double g[3], hessian[6];
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

/* The principal direction of a symmetric tensor without negative eigenvalues, by powers; its
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

/* Both means towards their geometric one, q from 1 to 0. */
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
  if (!(w > 0) || !(m->most > m->least * (1 + 1e-9))) return;
  find_tensor(m, smoothing, tensor);
  const double q = principal(tensor, soil->normal);
  if (!(tensor[0] + tensor[3] + tensor[5] > 0)) return;
  soil->plane = q;
  soil->along_a = w * w / m->linear;
  soil->along_b = w * w * w / (m->forchheimer * m->forchheimer);
  turn(q, &soil->a, &soil->along_a);
  turn(q, &soil->b, &soil->along_b);
}

static double along(const double moment[6], const double n[3]) {
  double sum = moment[0] + moment[3] + moment[5];
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) sum -= n[a] * moment[at[a][b]] * n[b];
  return sum;
}

/* Across an edge of mobility, along n = grad ln k, the gradient is what the flux between particles
 * makes of it, sum V_j (k_ij/k_i) slope (q_i - q_j) r with the k_ij of the pressure's matrix: the
 * flux is then the same on both sides, which k_i times the plain gradient is not. Along it, too, a
 * neighbour counts by k_ij, but the gradient is exact for what is linear. */
void isph_edge_close(const struct isph_edge *edge, double gradient[3]) {
  double n[3], across = 0;
  const double mean = edge->weight > 0 ? edge->level / edge->weight : 0;
  double g[3];
  for (int a = 0; a < 3; a++) g[a] = edge->normal[a] - mean * edge->middle[a];
  const double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (!(size > 0)) return;
  for (int a = 0; a < 3; a++) n[a] = g[a] / size, across += n[a] * edge->flux[a];
  const double share = along(edge->weighted, n) / along(edge->even, n);
  for (int a = 0; a < 3; a++)
    gradient[a] = n[a] * across + (edge->flux[a] - n[a] * across) / fmax(WEIGHT_LEAST, share);
}
