/* What a few slices show before the scan is read: phases and noise, radial trend (beam hardening),
 * rings; and the correction of the latter two. Greys are those of the region, with bright grain. */
#ifndef TOSUI_CT2MODEL_SCAN_SURVEY_H
#define TOSUI_CT2MODEL_SCAN_SURVEY_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

struct survey {
  size_t count, pixels; /* number of slices sampled, and of their pixels in all */
  float *sample;        /* [count][y][x] */
  struct grey_phases phases;
  double porosity, mean; /* porosity as given (NAN: unknown); mean grey of the sample */
  /* Radii are from the axis of rotation, in pixels. */
  size_t radii;
  double pore_trend[2], grain_trend[2]; /* a + b rho^2, rho = r / radii */
  double beam;         /* grain at the rim minus grain at the middle, over the contrast; or NAN */
  double beam_error;   /* 95 % half width of `beam`, rings and single grains included */
  double rings;        /* standard deviation between rings, over the contrast; NAN: unknown */
  bool rings_stay;     /* the rings are the same in all slices */
  float *ring_profile; /* [radii], mean over the sampled slices */
};

/* Samples the region. `porosity` helps to separate the phases; NAN if unknown. Without `all`, only
 * about a million pixels are used for trend and rings. Free with survey_end. */
enum status survey_take(const struct region *region, double porosity, bool all,
                        struct survey *survey);
/* Contrast by the mean grey. Pores or grains narrower than the blur do not show their own grey:
 * their peak is shifted towards the other one. But blur does not change the mean, n pore + (1 - n)
 * grain: if the porosity n is known, the contrast follows from the grey of the phase with the
 * larger volume. NAN if n is unknown, or too little of a phase exists. */
double survey_contrast_by_mean(const struct survey *survey, double mean, double pore, double grain);
/* If this contrast is larger than grain - pore by more than a tenth, sets the grey of the phase
 * with the smaller volume accordingly and returns true. */
bool survey_levels_by_mean(const struct survey *survey, double *pore, double *grain);
/* Fraction of the sampled greys in the middle half of the range between those of pore and grain. */
double survey_between(const struct survey *survey, double pore, double grain);
void survey_end(struct survey *survey);

/* The `apply` of a region's correction: corrects the radial trend, removes rings, and denoises as
 * the region requests. */
enum status survey_correct(const struct region *region, float *slice);

#endif
