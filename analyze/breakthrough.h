/* Breakthrough curves of a solute: the times at which walkers first pass planes across the flow,
 * and their fit by the advection-dispersion equation. */
#ifndef TOSUI_ANALYZE_BREAKTHROUGH_H
#define TOSUI_ANALYZE_BREAKTHROUGH_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"

/* Share that has passed a plane at distance 1 by the time t: first passage of a front with velocity
 * v and dispersion coefficient D (Ogata, Banks 1961, eq. 10; the inverse Gaussian distribution):
 *   F = erfc((1 - v t) / sqrt(4 D t)) / 2 + exp(v / D) erfc((1 + v t) / sqrt(4 D t)) / 2 */
double breakthrough_share(double v, double d, double t);
/* Time at which the share (0 < share < 1) has passed. */
double breakthrough_time(double v, double d, double share);
/* Fits v and D by least squares of F(t[i]) - share[i] over the finite t[i]; false if there are
 * fewer than ten. *misfit is the largest absolute difference. */
bool breakthrough_fit(const double *t, const double *share, size_t n, double *v, double *d,
                      double *misfit);

#endif
