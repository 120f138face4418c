/* Convergence of a value with the lattice spacing: Richardson extrapolation, observed order, grid
 * convergence index. */
#ifndef TOSUI_COMMON_CONVERGENCE_H
#define TOSUI_COMMON_CONVERGENCE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/constants.h"

struct convergence {
  double order;      /* observed; NAN with two spacings or without monotone convergence */
  double order_used; /* order of the extrapolation */
  bool monotone;     /* differences keep their sign from the coarsest to the finest */
  /* Monotone, and the observed order differs from the formal one by at most half of it. */
  bool credible;
  /* Not extrapolated: it would change the value by more than half, or the order is below 0.5. */
  bool far;
  bool near;           /* not extrapolated: the spacings are too similar; the index is then 1 */
  double value, slope; /* f = value + slope h^order_used through the data */
  double safety;       /* 1.25, or 3 where the order was not observed close to the formal one */
  double index;        /* relative grid convergence index of the finest value */
};

/* Extrapolates f[n] at spacings h[n] (finest first, n >= 2) to spacing 0. With three spacings the
 * order follows exactly from f = f0 + C h^p, with more by least squares (Eca, Hoekstra 2014, JCP
 * 262, 104); with two the formal order is used. The index follows Roache (1994) in the form of ASME
 * V&V 20 (Celik et al. 2008, JFE 130, 078001), with the safety factor and the limits of the order
 * of Oberkampf, Roy (2010, sec. 8.6): 1.25 if the observed order is within 10 % of the formal one,
 * else 3 with the order limited to between 0.5 and the formal one. If the spacings are within a
 * factor 1.3 (Celik et al.), the positions of the sites change the values more than the resolution
 * does. Without monotone convergence the value is the finest one and the index three times the
 * range; if the extrapolation would change the value by more than half, the index is three times
 * the difference of the two finest. */
void converge_extrapolate(const double *h, const double *f, size_t n, double formal_order,
                          struct convergence *result);

struct limit_estimate {
  double value;     /* extrapolated to spacing 0 */
  double low, high; /* relative: 95 % interval from value (1 - low) to value (1 + high) */
  double order;     /* mean over the fits, by their weights; NAN if there are none */
};

/* Estimates the limit at spacing 0 of f[n] > 0 at spacings h[n] (finest first, n >= 1) from the
 * four finest. With n = 1 the limit is the value itself and its error is NAN. `scale` (unit of h):
 * the spacing with 1.6 sites across a mean pore, at which the value depends by some per cent on the
 * positions of the sites. `across`: length of the body in mean pores. */
void converge_limit(const double *h, const double *f, size_t n, double scale, double across,
                    struct limit_estimate *limit);

#endif
