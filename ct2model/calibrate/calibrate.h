/* Which grey separates pore from grain: histograms, the threshold that gives the measured void
 * ratio, and what the histogram itself would say.
 *
 * Greys are "bright is grain" throughout; a scan with dark grains is negated before it comes here.
 * Void ratio e = pore volume / grain volume; porosity n = e / (1 + e). */
#ifndef TOSUI_CT2MODEL_CALIBRATE_CALIBRATE_H
#define TOSUI_CT2MODEL_CALIBRATE_CALIBRATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Bin i counts greys in [low + i width, low + (i + 1) width); a level of an integer image lies in
 * the middle of its bin and stands for all greys of that bin. */
struct grey_histogram {
  double low, width;
  size_t bins;
  uint64_t *counts;
  uint64_t total;
};

/* `bins` empty bins from grey `low` on. Free with grey_histogram_end. */
enum status grey_histogram_start(double low, double width, size_t bins,
                                 struct grey_histogram *histogram);
void grey_histogram_end(struct grey_histogram *histogram);
/* Values outside are counted in the end bins. */
void grey_histogram_add(struct grey_histogram *histogram, const float *values, size_t n);

/* Share of the volume at or under grey `threshold`, linear within a bin. */
double grey_histogram_porosity(const struct grey_histogram *histogram, double threshold);
/* The inverse: the grey under which lies the share `porosity`. */
double grey_histogram_quantile(const struct grey_histogram *histogram, double porosity);
/* dT/de at porosity n, from the quantiles at n +- 0.005. */
double grey_histogram_slope(const struct grey_histogram *histogram, double porosity);
/* Otsu's threshold (Otsu 1979). NAN for an image of one grey. */
double grey_histogram_otsu(const struct grey_histogram *histogram);

/* The two phases as the histogram shows them: its highest peaks on both sides of `threshold`. */
struct grey_phases {
  double pore_peak, grain_peak;   /* modes */
  double valley;                  /* the least frequent grey between them */
  double valley_low, valley_high; /* its floor: greys hardly more frequent */
  double noise;                   /* standard deviation of the pore peak, from its outer flank */
  double contrast_to_noise;       /* (grain - pore) / noise */
  double valley_depth; /* count at the valley / the lower of the two peaks; 1: no valley */
  size_t levels;       /* greys that occur; 2 for a segmented image */
};
void grey_histogram_phases(const struct grey_histogram *histogram, double threshold,
                           struct grey_phases *phases);

/* Which axes of a volume are mirrored in the model: there all layers but the last occur twice. */
struct mirroring {
  size_t size[3];
  bool mirrored[3];
};
/* How often layer i along axis d occurs. */
static inline unsigned mirroring_count(const struct mirroring *mirroring, int d, size_t i) {
  return mirroring->mirrored[d] && i + 1 < mirroring->size[d] ? 2 : 1;
}

/* The threshold at which a share `porosity` of the mirrored volume (size[2] layers of size[1] rows
 * of size[0] values, each as often as it occurs) lies at or under it, exactly. Solid is grey >
 * threshold. */
enum status volume_threshold(const float *volume, const struct mirroring *mirroring,
                             double porosity, double *threshold);

#endif
