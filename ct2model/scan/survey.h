/* What a few slices tell before the scan is read: phases and noise, radial trend (beam hardening),
 * rings; and the correction of the latter two. Greys are those of the region, bright grain. */
#ifndef TOSUI_CT2MODEL_SCAN_SURVEY_H
#define TOSUI_CT2MODEL_SCAN_SURVEY_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

struct survey {
  size_t count, pixels; /* slices looked at, and their greys in all */
  float *sample;        /* [count][y][x] */
  struct grey_phases phases;
  double porosity, mean; /* as given, NAN: unknown; mean grey */
  /* Radii are from the axis of rotation, in pixels. */
  size_t radii;
  double pore_trend[2], grain_trend[2]; /* a + b rho^2, rho = r / radii */
  double beam; /* grain at the rim less grain at the middle, share of the contrast; NAN: unknown */
  double beam_error; /* what it may be off, from the two halves of the slices */
  double rings;      /* standard deviation from ring to ring, share of the contrast; NAN: unknown */
  bool rings_stay;   /* the same in all slices */
  float *ring_profile; /* [radii], mean over the slices looked at */
};

/* `porosity` helps to tell the phases apart; NAN if unknown. Without `all`, about a million pixels
 * are enough for trend and rings. Free with survey_end. */
enum status survey_take(const struct region *region, double porosity, bool all,
                        struct survey *survey);
/* Pores or grains narrower than the blur show no grey of their own: their peak lies nearer the
 * other than their grey does. No blur changes the mean, n pore + (1 - n) grain: where the porosity
 * n is measured, the contrast follows from the grey of the greater phase. NAN where n is not known,
 * or a phase too little. */
double survey_contrast_by_mean(const struct survey *survey, double mean, double pore,
                               double grain);
/* Sets the grey of the lesser phase to it, and is true, where the contrast is larger so by a tenth.
 */
bool survey_levels_by_mean(const struct survey *survey, double *pore, double *grain);
/* Share of the greys looked at that lie in the middle half between those of pore and grain. */
double survey_between(const struct survey *survey, double pore, double grain);
void survey_end(struct survey *survey);

/* The `apply` of a region's correction: levels, takes rings out, and denoises as the region asks.
 */
enum status survey_correct(const struct region *region, float *slice);

#endif
