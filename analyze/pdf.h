/* Probability density of the pore velocity along the driving force. */
#ifndef TOSUI_ANALYZE_PDF_H
#define TOSUI_ANALYZE_PDF_H

#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"

/* A probability density on `bins` equal bins: edges [bins + 1], density [bins]; integrates to 1. */
struct pdf {
  size_t bins;
  double *edges, *density;
};

/* Estimates the density over the whole range of `values`, with the bin width of Freedman, Diaconis
 * (1981), limited to 10 to 200 bins. Free with pdf_free. */
enum status pdf_estimate(const double *values, size_t n, struct pdf *pdf);
void pdf_free(struct pdf *pdf);

struct moments {
  double mean, standard_deviation, skewness, excess_kurtosis;
};
/* Moments of n >= 1 values with equal weights. */
void moments_of(const double *values, size_t n, struct moments *moments);

/* Reference densities of the normalised velocity s = v / mean: slit, (1/3)/sqrt(1 - 2s/3) on [0,
 * 1.5); tube, 1/2 on [0, 2]; exp(-s) as in bead packs (Datta et al. 2013, PRL 111, 064501). */
double pdf_slit(double s);
double pdf_tube(double s);
double pdf_exponential(double s);

/* Fits the power-exponential density exp(-(s/sigma)^gamma) (Matyka et al. 2016, PRE 94, 013118,
 * with u0 = 0) to the positive values by maximum likelihood; gamma within [0.3, 4]. */
void pdf_fit_power_exponential(const double *values, size_t n, double *sigma, double *gamma);

#endif
