/* Probability density of the pore velocity along the driving force. */
#ifndef TOSUI_ANALYZE_PDF_H
#define TOSUI_ANALYZE_PDF_H

#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"

/* A density of `bins` equal bins: edges [bins + 1], density [bins]; integrates to 1. */
struct pdf {
  size_t bins;
  double *edges, *density;
};

/* Over the whole range of `values`; the width after Freedman, Diaconis (1981), between 10 and 200
 * bins. Free with pdf_free. */
enum status pdf_estimate(const double *values, size_t n, struct pdf *pdf);
void pdf_free(struct pdf *pdf);

struct moments {
  double mean, standard_deviation, skewness, excess_kurtosis;
};
/* Of n >= 1 values, each counted alike. */
void moments_of(const double *values, size_t n, struct moments *moments);

/* Exact densities of normalised velocity s = v / mean: a slit, (1/3)/sqrt(1 - 2s/3) on [0, 1.5); a
 * tube, 1/2 on [0, 2]; exp(-s) as in bead packs (Datta et al. 2013, PRL 111, 064501). */
double pdf_slit(double s);
double pdf_tube(double s);
double pdf_exponential(double s);

/* Power-exponential exp(-(s/sigma)^gamma) (Matyka et al. 2016, PRE 94, 013118, with u0 = 0) of the
 * positive values, by maximum likelihood; gamma within [0.3, 4]. */
void pdf_fit_power_exponential(const double *values, size_t n, double *sigma, double *gamma);

#endif
