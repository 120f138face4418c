/* What the size of the sample leaves open in its dispersion coefficients: by how much another
 * sample of the same soil, or a larger one, may differ. Found from the solved closure problem of
 * this one alone. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_SAMPLE_SIZE_H
#define TOSUI_SPHSOLVE_SOLUTE_SAMPLE_SIZE_H

#include "sphsolve/solute/closure.h"

/* Relative, longitudinal and transverse; NAN where the flow goes along no axis of the box, or the
 * box is too small to be cut into parts. */
struct solute_sample {
  double error[2];   /* 95 %: of chance (twice the standard deviation), repeating, and sides */
  double repeats[2]; /* of it, by how much it is too large because the sample repeats for ever */
};

/* Right after `closure` was solved at `diffusion`. `images`: whether the box is its own mirror
 * image along x, y, z; `correlation`: of the velocity across the flow, m. */
enum status solute_sample_size(const struct solute_closure *closure, double diffusion,
                               const struct solute_dispersion *dispersion, const bool images[3],
                               double correlation, struct solute_sample *sample);

/* Integral of the correlation of the velocity along the flow with itself, grains as water at rest,
 * over the distance along the flow and across it, m, up to where it is 0 or to half the box. */
void solute_correlation_lengths(const struct solute_flow *flow, double length[2]);

#endif
