/* Interfaces between different soils: effective drag across and along them. */
#ifndef TOSUI_SPHSOLVE_ISPH_INTERFACE_H
#define TOSUI_SPHSOLVE_ISPH_INTERFACE_H

#include <math.h>
#include <stdbool.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/soil.h"

/* The smoothed volume fraction of a soil at a place, its gradient (1/m) and second derivatives (xx
 * xy xz yy yz zz, 1/m^2). */
struct isph_fraction {
  double value, gradient[3], hessian[6];
};
/* to += scale * fraction */
void isph_fraction_add(struct isph_fraction *to, double scale, const struct isph_fraction *share);

/* Mobilities 1/a or 1/sqrt(b) of the soils at a place: their sum weighted by the fractions w, the
 * least and the largest. */
struct isph_mobilities {
  double sum, least, most;
};
/* Sums over the soils at a place; starts from ISPH_SOIL_MIX. */
struct isph_soil_mix {
  struct isph_mobilities linear, forchheimer;
  struct isph_fraction sum, level; /* sums of w and of w ln a */
};
#define ISPH_SOIL_MIX                                                                              \
  { .linear.least = INFINITY, .forchheimer.least = INFINITY }
/* Adds a soil of linear drag a (1/s) and Forchheimer drag b (1/m), with its fraction w here. */
void isph_soil_mix_add(struct isph_soil_mix *mix, const struct isph_fraction *w, double a,
                       double b);
/* From soil->a and soil->b, the means across an interface: finds the means along it and its normal
 * (0 if there is none). `smoothing`: smoothing length h of the fractions, m. */
void isph_soil_mix_split(const struct isph_soil_mix *mix, double smoothing,
                         struct soil_point *soil);

/* Sums for the pressure gradient at a particle whose neighbours have other mobilities. */
struct isph_edge {
  double normal[3], even[6], weighted[6];
  double level, weight, middle[3]; /* sums of w ln k_ij, w, w r */
};
/* Adds a neighbour j of i: kij is the mobility of the pair over that of i, weight is V_j slope, r
 * points from j to i. */
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
/* Finds the frame of an edge. Its normal is that of the interface between soils, if there is one,
 * or else the direction in which ln k changes. */
void isph_edge_find(const struct isph_edge *edge, const double interface[3],
                    struct isph_edge_frame *frame);
/* Sets the gradient from the flux, the sum of weight kij fall r, with the fall of q = P - rho f.x
 * from i to j. Leaves it unchanged where there is no edge. */
void isph_edge_turn(const struct isph_edge_frame *frame, const double flux[3], double gradient[3]);

/* Drag along an interface over drag across it. */
static inline double isph_interface_ratio(double along, double across) {
  return across > 0 ? along / across : 1;
}

/* For an x that was found with the coefficient across an interface: multiplies its part along the
 * interface by `along`. */
static inline void isph_interface_turn(const struct isph_interface *interface, double along,
                                       double x[3]) {
  const double *n = interface->normal;
  double across = x[0] * n[0] + x[1] * n[1] + x[2] * n[2];
  if (n[0] == 0 && n[1] == 0 && n[2] == 0) return;
  for (int a = 0; a < 3; a++) x[a] = along * x[a] + (1 - along) * across * n[a];
}

#endif
