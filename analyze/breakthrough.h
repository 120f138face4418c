/* Breakthrough curves of a solute: when walkers first pass planes across the flow, and what the
 * advection-dispersion equation makes of them. */
#ifndef TOSUI_ANALYZE_BREAKTHROUGH_H
#define TOSUI_ANALYZE_BREAKTHROUGH_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"

/* Share that has passed a plane at the distance 1 by the time t, first passages of a front that
 * moves at v and spreads with D (Ogata, Banks 1961, eq. 10; the inverse Gaussian distribution):
 *   F = erfc((1 - v t) / sqrt(4 D t)) / 2 + exp(v / D) erfc((1 + v t) / sqrt(4 D t)) / 2 */
double breakthrough_share(double v, double d, double t);
/* When that share (0 < share < 1) has passed. */
double breakthrough_time(double v, double d, double share);
/* v and D by least squares of the shares F(t[i]) - share[i]; the t[i] that are finite. False where
 * there are fewer than ten. *misfit: the largest difference. */
bool breakthrough_fit(const double *t, const double *share, size_t n, double *v, double *d,
                      double *misfit);

#endif
