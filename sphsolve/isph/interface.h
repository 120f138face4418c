/* Where different soils touch, what resists flow across their interface and along it. */
#ifndef TOSUI_SPHSOLVE_ISPH_INTERFACE_H
#define TOSUI_SPHSOLVE_ISPH_INTERFACE_H

#include <math.h>
#include <stdbool.h>

#include "sphsolve/isph/state.h"

/* The fraction of a soil at a place, smoothed, its gradient (1/m) and second derivatives (xx xy xz
 * yy yz zz, 1/m^2). */
struct isph_fraction {
  double value, gradient[3], hessian[6];
};
/* to += scale * fraction */
void isph_fraction_add(struct isph_fraction *to, double scale, const struct isph_fraction *share);

/* Of the soils at a place: mobilities 1/a or 1/sqrt(b), mean times the sum of w. */
struct isph_mobilities {
  double sum, least, most;
};
/* Sums over the soils at a place; start from ISPH_SOIL_MIX. */
struct isph_soil_mix {
  struct isph_mobilities linear, forchheimer;
  struct isph_fraction sum, level; /* sum of w, w ln a */
};
#define ISPH_SOIL_MIX                                                                              \
  { .linear.least = INFINITY, .forchheimer.least = INFINITY }
/* A soil of linear drag a, 1/s, and Forchheimer's b, 1/m, with its fraction w here. */
void isph_soil_mix_add(struct isph_soil_mix *mix, const struct isph_fraction *w, double a,
                       double b);
/* From soil->a and b, the means across an interface: the means along it, and its normal (0 where
 * there is none). `smoothing`: h of the fractions, m. */
void isph_soil_mix_split(const struct isph_soil_mix *mix, double smoothing,
                         struct soil_point *soil);

/* The gradient of the pressure at a particle whose neighbours have other mobilities. */
struct isph_edge {
  double normal[3], even[6], weighted[6];
  double level, weight, middle[3]; /* sums of w ln k_ij, w, w r */
};
/* A neighbour of i, kij the mobility between over that of i: weight V_j slope, r from j to i. */
static inline void isph_edge_add(struct isph_edge *edge, double kij, double weight,
                                 const double r[3]) {
  const double more = weight * kij, steep = kij == 1 ? 0 : weight * log(kij);
  edge->level += steep, edge->weight += weight;
  for (int a = 0, k = 0; a < 3; a++) {
    edge->normal[a] += steep * r[a], edge->middle[a] += weight * r[a];
    for (int b = a; b < 3; b++, k++)
      edge->even[k] += weight * r[a] * r[b], edge->weighted[k] += more * r[a] * r[b];
  }
}
/* Its normal is that of the interface where it has one, else along the edge's. */
void isph_edge_find(const struct isph_edge *edge, const double interface[3],
                    struct isph_edge_frame *frame);
/* The gradient by the flux, sum of weight kij fall r with the fall of q = P - rho f.x from i to j;
 * left alone where there is no edge. */
void isph_edge_turn(const struct isph_edge_frame *frame, const double flux[3], double gradient[3]);

#endif
