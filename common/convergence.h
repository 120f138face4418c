/* A value against spacing: extrapolation, observed order, grid convergence index. */
#ifndef TOSUI_COMMON_CONVERGENCE_H
#define TOSUI_COMMON_CONVERGENCE_H

#include <stdbool.h>
#include <stddef.h>

struct convergence {
  double order;      /* observed; NAN with two spacings or without monotone convergence */
  double order_used; /* of the extrapolation */
  bool monotone;     /* differences keep their sign from the coarsest to the finest */
  bool credible;     /* monotone, and the observed order within half the formal one of it */
  bool far; /* extrapolation would move k by more than half, or the order is under .5: not done */
  bool near; /* spacings too near each other to tell anything: not done either, and index is 1 */
  double value, slope; /* f = value + slope h^order_used through the data */
  double safety;       /* 1.25, or 3 where the order was not observed close to the formal one */
  double index;        /* relative grid convergence index of the finest value */
};

/* f [n] at spacings h [n], finest first, n >= 2. With three spacings the order follows exactly from
 * f = f0 + C h^p, with more by least squares (Eca, Hoekstra 2014, JCP 262, 104). Two spacings take
 * the formal order. Index after Roache (1994) in the form of ASME V&V 20 (Celik et al. 2008, JFE
 * 130, 078001), with the safety factor and the order's limits of Oberkampf, Roy (2010, sec. 8.6):
 * 1.25 where the observed order is within 10 % of the formal one, else 3 and the order held between
 * 0.5 and the formal one. Spacings within 1.3 of each other (Celik et al.) differ by where the
 * sites lie more than by the resolution. Without monotone convergence the value is the finest one
 * and the index three times the range; where the extrapolation would move the value by more than
 * half, three times the difference of the two finest. */
void converge_extrapolate(const double *h, const double *f, size_t n, double formal_order,
                          struct convergence *result);

/* The error of k that a model's own voxels leave, over the change of k from it to the same model in
 * voxels twice as long. An error C h^p changes by C (2^p - 1) h^p: the share is 1 / (2^p - 1), 1 at
 * first order and 1/3 at second. 0.7 is that of p = 1.3. */
#define CONVERGE_MODEL_SHARE 0.7

struct limit_estimate {
  double value;     /* at spacing 0 */
  double low, high; /* relative: the truth lies in value (1 - low) .. value (1 + high), 95 % */
  double order;     /* of the fits, by their weight; NAN where there is none */
};

/* The limit of f [n] > 0 at spacings h [n], finest first, n >= 1, from the four finest: with n = 1
 * the value itself and no error (NAN). `scale`: the spacing with 1.6 sites across a mean pore,
 * where the value depends by some per cent on where the sites happen to lie; `across`: the body's
 * length in mean pores. */
void converge_limit(const double *h, const double *f, size_t n, double scale, double across,
                    struct limit_estimate *limit);

#endif
