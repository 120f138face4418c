/* Uncertainty of the dispersion coefficients due to the size of the sample: by how much another
 * sample of the same soil, or a larger one, may differ. Estimated from the solved closure problem
 * of this sample alone. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_SAMPLE_SIZE_H
#define TOSUI_SPHSOLVE_SOLUTE_SAMPLE_SIZE_H

#include "sphsolve/solute/closure.h"

/* Relative, longitudinal and transverse; NAN if the flow is not along an axis of the box, or the
 * box is too small to be divided into parts. */
struct solute_sample {
  double error[2];   /* 95 %: statistical (two standard deviations), periodicity, and sides */
  double repeats[2]; /* of it, the excess because the sample repeats periodically */
};

/* To be called right after `closure` was solved at `diffusion`. `images`: whether the box is its
 * own mirror image along x, y, z; `correlation`: correlation length of the velocity across the
 * flow, m. */
enum status solute_sample_size(const struct solute_closure *closure, double diffusion,
                               const struct solute_dispersion *dispersion, const bool images[3],
                               double correlation, struct solute_sample *sample);

/* Correlation lengths of the velocity component along the flow: integrals of its autocorrelation
 * (grains count as water at rest) over the distance along the flow and across it, m, up to its
 * first zero or half the box. */
void solute_correlation_lengths(const struct solute_flow *flow, double length[2]);

#endif
