/* Is the model fine and large enough? Pore widths, correlation length, representative volume. */
#ifndef TOSUI_CT2MODEL_MODEL_MORPHOLOGY_H
#define TOSUI_CT2MODEL_MODEL_MORPHOLOGY_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/model_file.h"

enum { THICKNESS_BINS = 64, WINDOW_SIZES = 8 };

struct morphology {
  double touching; /* share of the pore voxels with a grain at one of six faces */
  double
      correlation_length; /* m; integral of the normalised two-point covariance, mean of x, y, z */
  /* Local thickness of the pores (Hildebrand, Rueegsegger 1997): diameter of the largest ball in
   * the pore that holds the voxel; NAN where the model is too large to compute it. */
  double thickness_median;                    /* voxels */
  double thickness_histogram[THICKNESS_BINS]; /* share of pore voxels, one bin a voxel width */
  double critical_width;                      /* voxels (critical_width.h); 0: no way along z */
  /* Of k by the resolution, relative: 1 / (2 N^2), N the critical width, 1 at most; NAN: no way. */
  double expected_error;
  /* Void ratio in cubic windows: mean and standard deviation over those that fit. */
  size_t window_count;
  size_t window[WINDOW_SIZES], window_places[WINDOW_SIZES]; /* voxels; how many windows */
  double window_mean[WINDOW_SIZES], window_deviation[WINDOW_SIZES];
};

/* Local thickness of the first `layers` of the model, in quarters of a voxel (of spacing[0]), in
 * new memory; NULL where the model is too large for it. */
enum status morphology_widths(const struct voxel_model *model, size_t layers, uint8_t **width);

/* `layers` of the model are counted (those before mirroring). */
enum status morphology_measure(const struct voxel_model *model, size_t layers,
                               struct morphology *morphology);

#endif
