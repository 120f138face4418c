/* Measures of whether the model is fine and large enough: pore widths, correlation length,
 * representative volume. */
#ifndef TOSUI_CT2MODEL_MODEL_MORPHOLOGY_H
#define TOSUI_CT2MODEL_MODEL_MORPHOLOGY_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/model_file.h"

enum { THICKNESS_BINS = 64, WINDOW_SIZES = 8 };

struct morphology {
  double touching; /* fraction of the pore voxels with grain at one of the six faces */
  /* m: integral of the normalised two-point covariance, mean over x, y, z. */
  double correlation_length;
  /* Local thickness of the pores (Hildebrand, Rueegsegger 1997): diameter of the largest ball in
   * the pores that contains the voxel; NAN if the model is too large to compute it. */
  double thickness_median;                    /* voxels */
  double thickness_histogram[THICKNESS_BINS]; /* fraction of pore voxels, in bins of one voxel */
  double critical_width;                      /* voxels; 0: no path along z */
  /* Expected relative error of k by the resolution: 1 / (2 N^2) with N the critical width, at most
   * 1; NAN if there is no path. */
  double expected_error;
  /* Void ratio in cubic windows: mean and standard deviation over all windows of a size. */
  size_t window_count;
  size_t window[WINDOW_SIZES], window_places[WINDOW_SIZES]; /* side in voxels; number of windows */
  double window_mean[WINDOW_SIZES], window_deviation[WINDOW_SIZES];
};

/* Local thickness of the first `layers` of the model, in quarters of a voxel (of spacing[0]), in
 * newly allocated memory; NULL if the model is too large. */
enum status morphology_widths(const struct voxel_model *model, size_t layers, uint8_t **width);

/* Measures the first `layers` of the model (those before mirroring), but the correlation length
 * over all of it. */
enum status morphology_measure(const struct voxel_model *model, size_t layers,
                               struct morphology *morphology);

#endif
