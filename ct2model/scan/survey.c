#include "ct2model/scan/survey.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

/* Slices that are sampled; radii on each side in the average of rings; bins of a histogram. */
enum { SLICES = 8, RING_AVERAGE = 8, BINS = 4096 };
/* Smallest number of radii: within fewer pixels of the axis a few grains look like rings and like
 * beam hardening. */
enum { RADII_LEAST = 48 };
/* Annuli over whose residuals the uncertainty of the trend is found, wider than rings; and
 * Student's t for 95 % with two degrees of freedom less. */
enum { ANNULI = 8 };
static const double STUDENT = 2.45;
/* Pixels that suffice for the radial trend; a correction uses all. */
static const double PIXELS_FOR_TREND = 1e6;

/* Position of the slices: pixel x, y of the region is at radius |(x, y) + shift|. */
struct frame {
  double shift[2];
  size_t size[2], radii;
  size_t step; /* only every `step`th row is used */
};

static struct frame frame_of(const struct region *region) {
  struct frame frame = {.radii = 2, .step = 1};
  double square = 0.0;
  for (int d = 0; d < 2; d++) {
    double whole = (double)region->stack->size[d];
    frame.size[d] = region->size[d];
    frame.shift[d] = (double)region->origin[d] + 0.5 - region->axis[d];
    square += pow(fmax(region->axis[d], whole - region->axis[d]), 2.0);
  }
  frame.radii += (size_t)sqrt(square);
  return frame;
}

static size_t radius_of(const struct frame *frame, size_t x, size_t y) {
  double dx = (double)x + frame->shift[0], dy = (double)y + frame->shift[1];
  return (size_t)sqrt(dx * dx + dy * dy);
}

static double trend_at(const double trend[2], double rho) {
  return trend[0] + rho * rho * trend[1];
}

/* Greys of both phases at each radius, [2][radii]: pore, grain. */
static void phase_greys(const struct survey *survey, float *greys) {
  for (size_t r = 0; r < survey->radii; r++) {
    double rho = ((double)r + 0.5) / (double)survey->radii;
    greys[r] = (float)trend_at(survey->pore_trend, rho);
    greys[survey->radii + r] = (float)trend_at(survey->grain_trend, rho);
  }
}

/* Adds up the deviations of pixels inside one phase from its grey: sum and number by phase and by
 * half of the slice, [4][radii]. Pixels at a boundary, which hold both phases, and bright minerals
 * are left out. */
static void add_deviations(const struct frame *frame, const float *greys, const float *slice,
                           double *sum, double *number) {
  const float *pore = greys, *grain = greys + frame->radii;
  size_t nx = frame->size[0];
  for (size_t y = 1; y + 1 < frame->size[1]; y += frame->step) {
    for (size_t x = 1; x + 1 < nx; x++) {
      const float *at = slice + y * nx + x;
      size_t r = radius_of(frame, x, y);
      float middle = 0.5f * (pore[r] + grain[r]), half = 0.5f * (grain[r] - pore[r]);
      bool is_grain = at[0] > middle;
      if ((at[1] > middle) != is_grain || (at[-1] > middle) != is_grain ||
          (at[nx] > middle) != is_grain || (*(at - nx) > middle) != is_grain)
        continue;
      float off = at[0] - (is_grain ? grain[r] : pore[r]);
      if (fabsf(off) > half) continue;
      size_t side = (double)x + frame->shift[0] < 0.0 ? 0u : 1u;
      size_t i = ((is_grain ? 2u : 0u) + side) * frame->radii + r;
      sum[i] += (double)off;
      number[i] += 1.0;
    }
  }
}

/* Weighted least squares of a + b rho^2 to the deviations of one phase in the halves `first` to
 * `last` - 1, added to `trend`; false if there are too few pixels. */
static bool fit_trend(const double *sum, const double *number, size_t radii, size_t first,
                      size_t last, double trend[2]) {
  double n = 0.0, s = 0.0, q = 0.0, qq = 0.0, sq = 0.0;
  for (size_t i = first * radii; i < last * radii; i++) {
    // NOLINTNEXTLINE: there are two radii at least
    double square = pow(((double)(i % radii) + 0.5) / (double)radii, 2.0);
    n += number[i];
    s += sum[i];
    q += number[i] * square;
    qq += number[i] * square * square;
    sq += sum[i] * square;
  }
  double determinant = n * qq - q * q;
  if (n < 500.0 || !(determinant > 0.0)) return false;
  trend[0] += (s * qq - sq * q) / determinant;
  trend[1] += (n * sq - s * q) / determinant;
  return true;
}

/* Standard error of the slope that fit_trend adds for the halves 0 and 1 together, robust against
 * correlation within annuli (Liang and Zeger 1986, Biometrika 73: 13): a ring is the same in both
 * halves and in all slices, so that neither these nor the pixels are independent, and a grain
 * counts once. */
static double trend_error(const double *sum, const double *number, size_t radii,
                          const double trend[2]) {
  double n = 0.0, q = 0.0, qq = 0.0, score[ANNULI] = {0}, square = 0.0;
  for (size_t i = 0; i < 2 * radii; i++) {
    // NOLINTNEXTLINE: there are two radii at least
    const double x = pow(((double)(i % radii) + 0.5) / (double)radii, 2.0);
    n += number[i];
    q += number[i] * x;
    qq += number[i] * x * x;
  }
  for (size_t i = 0; i < 2 * radii; i++) {
    const double x = pow(((double)(i % radii) + 0.5) / (double)radii, 2.0); // NOLINT
    score[i % radii * ANNULI / radii] +=                                    // NOLINT
        (x - q / n) * (sum[i] - number[i] * (trend[0] + trend[1] * x));
  }
  for (int a = 0; a < ANNULI; a++) square += score[a] * score[a];
  return sqrt(square * ANNULI / (ANNULI - 2.0)) / (qq - q * q / n);
}

/* Radial profiles of the two halves minus their running mean over the radius, [2][radii]; NAN where
 * there are too few pixels. */
static void ring_deviations(const double *sum, const double *number, size_t radii, double *ring) {
  const double least = 8.0;
  for (size_t side = 0; side < 2; side++) {
    const double *s[2] = {sum + side * radii, sum + (2 + side) * radii};
    const double *n[2] = {number + side * radii, number + (2 + side) * radii};
    for (size_t r = 0; r < radii; r++) {
      double total = 0.0, weight = 0.0, count_here = n[0][r] + n[1][r];
      for (size_t k = r > RING_AVERAGE ? r - RING_AVERAGE : 0; k <= r + RING_AVERAGE && k < radii;
           k++) {
        total += s[0][k] + s[1][k];
        weight += n[0][k] + n[1][k];
      }
      ring[side * radii + r] =
          count_here < least ? NAN : (s[0][r] + s[1][r]) / count_here - total / weight;
    }
  }
}

/* Rings are complete circles, noise and grains are not: the covariance of the two halves is the
 * variance of the rings. */
static double ring_covariance(const double *a, const double *b, size_t radii) {
  double sum = 0.0, n = 0.0;
  for (size_t r = 0; r < radii; r++) {
    if (isnan(a[r]) || isnan(b[r])) continue;
    sum += a[r] * b[r] * (double)(r + 1); /* weighted by the number of pixels */
    n += (double)(r + 1);
  }
  return n > 0.0 ? sum / n : NAN;
}

/* The profile of the rings: the mean of both halves, times the fraction of its variance that is not
 * noise. */
static void ring_estimate(const double *ring, size_t radii, double variance, float *profile) {
  for (size_t r = 0; r < radii; r++) {
    double noise = 0.0, n = 0.0;
    for (size_t k = r > 2 * RING_AVERAGE ? r - 2 * RING_AVERAGE : 0;
         k <= r + 2 * RING_AVERAGE && k < radii; k++) {
      double gap = ring[k] - ring[radii + k];
      if (isnan(gap)) continue;
      noise += 0.25 * gap * gap;
      n += 1.0;
    }
    double mean = 0.5 * (ring[r] + ring[radii + r]);
    profile[r] = isnan(mean) || n < 4.0 ? 0.0f : (float)(mean * variance / (variance + noise / n));
  }
}

static int by_value(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* Contrast and noise where noise hides the valley of the histogram. The noise follows from the
 * differences of pixels two apart, most of which lie within a phase; the contrast from the
 * remainder of the total variance, n (1 - n) contrast^2 + noise^2. */
static enum status phases_by_moments(const struct region *region, double porosity,
                                     struct survey *survey) {
  enum status status = STATUS_OK;
  size_t n = survey->count * region->size[0] * region->size[1], m = n < 200000 ? n : 200000;
  double n_pore = isnan(porosity) ? 0.5 : porosity, squares = 0.0;
  float *gaps = NULL;
  TRY(memory_allocate(&gaps, m, sizeof *gaps, "grey differences"));
  for (size_t i = 0; i < n; i++) squares += pow((double)survey->sample[i] - survey->mean, 2.0);
  for (size_t i = 0; i < m; i++) {
    size_t at = (size_t)((double)(n - 2) * (double)i / (double)m);
    gaps[i] = fabsf(survey->sample[at] - survey->sample[at + 2]);
  }
  qsort(gaps, m, sizeof *gaps, by_value);
  struct grey_phases *phases = &survey->phases;
  /* Of normal noise the median of |x| is 0.6745 sigma, and a difference has sigma sqrt(2). */
  phases->noise = (double)gaps[m / 2] / (0.6745 * sqrt(2.0));
  double rest = squares / (double)n - phases->noise * phases->noise;
  double contrast =
      sqrt(fmax(rest, 1e-4 * phases->noise * phases->noise) / (n_pore * (1 - n_pore)));
  phases->pore_peak = survey->mean - (1.0 - n_pore) * contrast;
  phases->grain_peak = phases->pore_peak + contrast;
  phases->contrast_to_noise = contrast / phases->noise;
cleanup:
  memory_free(&gaps);
  return status;
}

double survey_contrast_by_mean(const struct survey *survey, double mean, double pore,
                               double grain) {
  static const double LEAST = 0.02;
  const double n = survey->porosity;
  if (!(n > LEAST && n < 1.0 - LEAST)) return NAN;
  return n < 0.5 ? (grain - mean) / n : (mean - pore) / (1.0 - n);
}

bool survey_levels_by_mean(const struct survey *survey, double *pore, double *grain) {
  static const double MORE = 1.1;
  const double contrast = survey_contrast_by_mean(survey, survey->mean, *pore, *grain);
  if (!(contrast > MORE * (*grain - *pore))) return false;
  if (survey->porosity < 0.5)
    *pore = *grain - contrast;
  else
    *grain = *pore + contrast;
  return true;
}

double survey_between(const struct survey *survey, double pore, double grain) {
  const double quarter = 0.25 * (grain - pore);
  size_t between = 0;
  for (size_t i = 0; i < survey->pixels; i++) {
    const double grey = (double)survey->sample[i];
    between += grey > pore + quarter && grey < grain - quarter;
  }
  return (double)between / (double)survey->pixels;
}

static enum status survey_phases(const struct region *region, double porosity,
                                 struct survey *survey) {
  enum status status = STATUS_OK;
  struct grey_histogram histogram = {0};
  size_t n = survey->count * region->size[0] * region->size[1];
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    if ((double)survey->sample[i] < low) low = (double)survey->sample[i];
    if ((double)survey->sample[i] > high) high = (double)survey->sample[i];
  }
  survey->phases.contrast_to_noise = NAN;
  if (!(high > low)) return STATUS_OK;
  const enum pixel_type type = region->stack->type;
  const double step = fmax(fabs(low), fabs(high)) * (double)FLT_EPSILON;
  if ((type == PIXEL_U32 || type == PIXEL_I32 || type == PIXEL_F64) && step > (high - low) / BINS)
    log_warning("greys of %.10g to %.10g are kept in steps of %g (24 bits): subtract %.10g from "
                "them before they are saved",
                low, high, step, low);
  double sum = 0.0;
  for (size_t i = 0; i < n; i++) sum += (double)survey->sample[i];
  survey->mean = sum / (double)n;
  TRY(grey_histogram_start(low, (high - low) * 1.000001 / BINS, BINS, &histogram));
  grey_histogram_add(&histogram, survey->sample, n);
  grey_histogram_phases(&histogram,
                        isnan(porosity) ? grey_histogram_otsu(&histogram)
                                        : grey_histogram_quantile(&histogram, porosity),
                        &survey->phases);
  if (survey->phases.levels <= 2)
    survey->phases.contrast_to_noise = NAN;
  else if (survey->phases.valley_depth > 0.9)
    TRY(phases_by_moments(region, porosity, survey));
cleanup:
  grey_histogram_end(&histogram);
  return status;
}

static enum status survey_trend(const struct frame *frame, struct survey *survey) {
  enum status status = STATUS_OK;
  size_t radii = survey->radii, plane = frame->size[0] * frame->size[1], each = 8 * radii;
  double *sum = NULL, *number = NULL,
         contrast = survey->phases.grain_peak - survey->phases.pore_peak;
  float *greys = NULL;
  TRY(memory_allocate(&sum, survey->count * each, sizeof *sum, "radial means"));
  TRY(memory_allocate(&greys, 2 * radii, sizeof *greys, "radial means"));
  number = sum + 4 * radii;
  survey->pore_trend[0] = survey->phases.pore_peak;
  survey->grain_trend[0] = survey->phases.grain_peak;
  for (int pass = 0; pass < 6; pass++) {
    memset(sum, 0, survey->count * each * sizeof *sum);
    phase_greys(survey, greys);
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < survey->count; i++)
      add_deviations(frame, greys, survey->sample + i * plane, sum + i * each,
                     sum + i * each + each / 2);
    for (size_t i = each; i < survey->count * each; i++)
      sum[i % each] += sum[i]; // NOLINT: there are two radii at least
    /* The uncertainty of the trend of the grain, for 95 %: by the difference between the two
     * halves, and by what the fit leaves in each annulus. */
    double halves[2][2] = {{0}}, step[2] = {0};
    for (size_t i = 0; i < 2; i++)
      if (!fit_trend(sum + 2 * radii, number + 2 * radii, radii, i, i + 1, halves[i])) goto cleanup;
    if (!fit_trend(sum, number, radii, 0, 2, survey->pore_trend) ||
        !fit_trend(sum + 2 * radii, number + 2 * radii, radii, 0, 2, survey->grain_trend))
      goto cleanup;
    fit_trend(sum + 2 * radii, number + 2 * radii, radii, 0, 2, step);
    survey->beam_error = STUDENT *
                         hypot(0.5 * (halves[0][1] - halves[1][1]),
                               trend_error(sum + 2 * radii, number + 2 * radii, radii, step)) /
                         contrast;
  }
  size_t first = 0, last = radii - 1; /* range of radii with grain */
  while (first < last && number[2 * radii + first] + number[3 * radii + first] == 0.0) first++;
  while (first < last && number[2 * radii + last] + number[3 * radii + last] == 0.0) last--;
  double squares = pow(((double)last + 0.5) / (double)radii, 2.0) -
                   pow(((double)first + 0.5) / (double)radii, 2.0);
  survey->beam = survey->grain_trend[1] * squares / contrast;
  survey->beam_error *= squares;
cleanup:
  MEMORY_FREE(&sum, &greys);
  return status;
}

static enum status survey_rings(const struct frame *frame, struct survey *survey) {
  enum status status = STATUS_OK;
  size_t radii = survey->radii, plane = frame->size[0] * frame->size[1];
  double *sum = NULL, *ring = NULL, each = 0.0, together = 0.0;
  double contrast = survey->phases.grain_peak - survey->phases.pore_peak;
  float *greys = NULL;
  TRY(memory_allocate(&sum, 16 * radii, sizeof *sum, "rings"));
  TRY(memory_allocate(&ring, 2 * radii, sizeof *ring, "rings"));
  TRY(memory_allocate(&greys, 2 * radii, sizeof *greys, "radial means"));
  TRY(memory_allocate(&survey->ring_profile, radii, sizeof *survey->ring_profile, "rings"));
  double *number = sum + 4 * radii, *all = sum + 8 * radii;
  phase_greys(survey, greys);
  for (size_t i = 0; i < survey->count; i++) {
    memset(sum, 0, 8 * radii * sizeof *sum);
    add_deviations(frame, greys, survey->sample + i * plane, sum, number);
    for (size_t k = 0; k < 8 * radii; k++) all[k] += sum[k];
    ring_deviations(sum, number, radii, ring);
    each += ring_covariance(ring, ring + radii, radii) / (double)survey->count;
  }
  ring_deviations(all, all + 4 * radii, radii, ring);
  together = ring_covariance(ring, ring + radii, radii);
  if (isnan(each) || isnan(together)) goto cleanup;
  survey->rings = sqrt(fmax(0.0, fmax(each, together))) / contrast;
  survey->rings_stay = together > 0.5 * each;
  ring_estimate(ring, radii, fmax(together, 0.0) + 1e-30, survey->ring_profile);
cleanup:
  MEMORY_FREE(&sum, &ring, &greys);
  return status;
}

enum status survey_take(const struct region *region, double porosity, bool all,
                        struct survey *survey) {
  enum status status = STATUS_OK;
  struct frame frame = frame_of(region);
  size_t plane = region->size[0] * region->size[1], nz = region->size[2], numbers[SLICES];
  size_t most = region_batch(region) < SLICES ? region_batch(region) : SLICES;
  *survey = (struct survey){
      .count = nz < most ? nz : most, .porosity = porosity, .mean = NAN, .beam = NAN, .rings = NAN};
  survey->pixels = survey->count * plane;
  survey->radii = frame.radii;
  if (!all) frame.step += (size_t)((double)(survey->count * plane) / PIXELS_FOR_TREND);
  for (size_t i = 0; i < survey->count; i++)
    numbers[i] = survey->count > 1 ? i * (nz - 1) / (survey->count - 1) : 0;
  TRY(memory_allocate(&survey->sample, survey->count * plane, sizeof *survey->sample, "slices"));
  TRY(region_read(region, numbers, survey->count, survey->sample));
  TRY(survey_phases(region, porosity, survey));
  if (!(survey->phases.contrast_to_noise > 0.0)) goto cleanup; /* segmented or of one grey */
  if (frame.radii < RADII_LEAST) goto cleanup;
  TRY(survey_trend(&frame, survey));
  if (!isnan(survey->beam)) TRY(survey_rings(&frame, survey));
cleanup:
  return status;
}

void survey_end(struct survey *survey) {
  MEMORY_FREE(&survey->sample, &survey->ring_profile);
}

static enum status level(const struct region *region, float *slice) {
  enum status status = STATUS_OK;
  const struct correction *correction = region->correction;
  const struct survey *survey = correction->survey;
  const size_t *size = region->size;
  struct frame frame = frame_of(region);
  size_t radii = survey->radii;
  float *greys = NULL, *slice_rings = NULL;
  double *sum = NULL;
  const float *rings = correction->rings ? survey->ring_profile : NULL;
  if (!correction->beam && !correction->rings) return STATUS_OK;
  double contrast = survey->phases.grain_peak - survey->phases.pore_peak;
  TRY(memory_allocate(&greys, 2 * radii, sizeof *greys, "radial means"));
  phase_greys(survey, greys);
  if (correction->rings && !survey->rings_stay) { /* rings of this slice alone */
    double variance = pow(survey->rings * contrast, 2.0) + 1e-30;
    TRY(memory_allocate(&sum, 10 * radii, sizeof *sum, "rings"));
    TRY(memory_allocate(&slice_rings, radii, sizeof *slice_rings, "rings"));
    add_deviations(&frame, greys, slice, sum, sum + 4 * radii);
    ring_deviations(sum, sum + 4 * radii, radii, sum + 8 * radii);
    ring_estimate(sum + 8 * radii, radii, variance, slice_rings);
    rings = slice_rings;
  }
  for (size_t y = 0; y < size[1]; y++) {
    for (size_t x = 0; x < size[0]; x++) {
      float *at = slice + y * size[0] + x;
      size_t r = radius_of(&frame, x, y);
      if (rings != NULL) *at -= rings[r];
      if (correction->beam)
        *at = (float)(survey->phases.pore_peak + ((double)*at - (double)greys[r]) * contrast /
                                                     ((double)greys[radii + r] - (double)greys[r]));
    }
  }
cleanup:
  MEMORY_FREE(&sum, &slice_rings, &greys);
  return status;
}

enum status survey_correct(const struct region *region, float *slice) {
  const enum status status = level(region, slice);
  if (status != STATUS_OK || region->denoise == DENOISE_NONE) return status;
  return denoise_slice(region->denoise, &region->correction->survey->phases, region->size, slice);
}
