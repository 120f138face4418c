/* Histograms of greys and the threshold between pore and grain: that which gives the measured void
 * ratio, and those that the histogram itself suggests.
 *
 * Grain is bright throughout; a scan with dark grains is negated before. Void ratio e = pore volume
 * / grain volume; porosity n = e / (1 + e). */
#ifndef TOSUI_CT2MODEL_CALIBRATE_CALIBRATE_H
#define TOSUI_CT2MODEL_CALIBRATE_CALIBRATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Bin i counts greys in [low + i width, low + (i + 1) width). A level of an integer image lies in
 * the middle of its bin and represents all greys of that bin. */
struct grey_histogram {
  double low, width;
  size_t bins;
  uint64_t *counts;
  uint64_t total;
};

/* Starts a histogram of `bins` empty bins from grey `low` on. Free with grey_histogram_end. */
enum status grey_histogram_start(double low, double width, size_t bins,
                                 struct grey_histogram *histogram);
void grey_histogram_end(struct grey_histogram *histogram);
/* Adds n values; those outside the range are counted in the end bins. */
void grey_histogram_add(struct grey_histogram *histogram, const float *values, size_t n);

/* Fraction of the volume at or below the grey `threshold`, linear within a bin. */
double grey_histogram_porosity(const struct grey_histogram *histogram, double threshold);
/* The inverse: the grey below which the fraction `porosity` lies. */
double grey_histogram_quantile(const struct grey_histogram *histogram, double porosity);
/* Derivative dT/de of the threshold with respect to the void ratio, at porosity n, from the
 * quantiles at n +- 0.005. */
double grey_histogram_slope(const struct grey_histogram *histogram, double porosity);
/* Otsu's threshold (Otsu 1979). NAN for an image of one grey. */
double grey_histogram_otsu(const struct grey_histogram *histogram);

/* The two phases as the histogram shows them: its highest peaks on both sides of `threshold`. */
struct grey_phases {
  double pore_peak, grain_peak;   /* modes */
  double valley;                  /* the least frequent grey between them */
  double valley_low, valley_high; /* its floor: the range of greys hardly more frequent */
  double noise;                   /* standard deviation of the pore peak, from its outer flank */
  double contrast_to_noise;       /* (grain - pore) / noise */
  double valley_depth; /* count at the valley / the lower of the two peaks; 1: no valley */
  size_t levels;       /* number of greys that occur; 2 for a segmented image */
};
void grey_histogram_phases(const struct grey_histogram *histogram, double threshold,
                           struct grey_phases *phases);

/* Axes of a volume that are mirrored in the model: there all layers but the last occur twice. */
struct mirroring {
  size_t size[3];
  bool mirrored[3];
};
/* Number of times that layer i along axis d occurs. */
static inline unsigned mirroring_count(const struct mirroring *mirroring, int d, size_t i) {
  return mirroring->mirrored[d] && i + 1 < mirroring->size[d] ? 2 : 1;
}

/* The threshold at or below which lies exactly the fraction `porosity` of the mirrored volume
 * (size[2] layers of size[1] rows of size[0] values, each counted as often as it occurs). Solid is
 * grey > threshold. */
enum status volume_threshold(const float *volume, const struct mirroring *mirroring,
                             double porosity, double *threshold);

#endif
