#include "ct2model/fragile.h"

#include <math.h>
#include <stdio.h>

#include "common/log.h"
#include "ct2model/scan/denoising.h"
#include "ct2model/constants.h"

/* Text on the effect of denoising, measured on a part of one slice; "" if it has none. */
static void advise_denoising(struct pipeline *pipeline, char *text, size_t size) {
  struct denoise_effect effect;
  double e = pipeline->void_ratio_original;
  text[0] = '\0';
  if (pipeline->region.denoise != DENOISE_NONE) return;
  if (!(pipeline->survey.phases.contrast_to_noise > 0.0)) return;
  if (denoise_effect_measure(&pipeline->survey, pipeline->survey_size, DENOISE_NLM, e / (1.0 + e),
                             1, 512, &effect) != STATUS_OK)
    error_clear();
  else if (effect.surface < DENOISE_KEEPS)
    snprintf(text, size, "; --denoise nlm would take %.0f %% of the surface away as noise",
             100.0 * (1.0 - effect.surface));
}

static void warn_of_contrast(struct pipeline *pipeline, bool near_peak) {
  const struct grey_phases *phases = &pipeline->phases;
  char advice[100];
  bool unimodal = phases->valley_depth > VALLEY_NONE;
  /* A peak at the threshold is due to edges, so that the contrast to the next one means nothing. */
  const bool low = phases->contrast_to_noise < CONTRAST_TO_NOISE_LEAST && !near_peak;
  if (!unimodal && (!low || pipeline->restoring)) return;
  advise_denoising(pipeline, advice, sizeof advice);
  if (unimodal)
    log_warning("the histogram shows no valley between pore and grain: the void ratio fixes how "
                "much is grain, but not where; compare the model with the slices%s",
                advice);
  else
    log_warning("contrast is only %.1f times the noise: at full resolution the grain surface is "
                "rough, so specific surface and wall distances are unsure%s%s",
                phases->contrast_to_noise,
                phases->contrast_to_noise < 3.0 ? ", and many voxels are on the wrong side" : "",
                advice);
}

static void warn_of_sharpness(const struct scanner *scanner) {
  const double blur = scanner->blur / scanner->unit, error = scanner->blur_error / scanner->unit;
  if (scanner->known && blur + 2.0 * error < BLUR_LEAST) /* 95 % sure */
    log_warning("the edges are sharper (%.2g voxels) than a voxel's average: the image was "
                "sharpened, or made of labels; where its surface lies between voxels is lost, and "
                "no part of k's error holds that: give the scan as it was, or the labels",
                blur);
}

/* Peaks less than this apart, in standard deviations of the lower one, belong to one phase. */
#define PEAK_DISTANCE_LEAST 1.5
/* Whether the threshold lies within one phase: it has a peak on either side, as any grey has, but
 * no clear valley, while the histogram has one between pore and grain elsewhere (`by_otsu`). */
static bool is_within_phase(const struct grey_phases *phases, const struct grey_phases *by_otsu,
                            double threshold) {
  return by_otsu->valley_depth < VALLEY_SURE &&
         (threshold < by_otsu->pore_peak || threshold > by_otsu->grain_peak) &&
         (phases->valley_depth > VALLEY_SURE || phases->contrast_to_noise < PEAK_DISTANCE_LEAST);
}

/* The bins of a histogram from grey `low` to `high`; the counts are shared. */
static struct grey_histogram bins_between(const struct grey_histogram *whole, double low,
                                          double high) {
  const double last = (double)whole->bins;
  const size_t first = (size_t)fmin(fmax((low - whole->low) / whole->width, 0.0), last);
  const size_t end = (size_t)fmin(fmax((high - whole->low) / whole->width, 0.0), last);
  struct grey_histogram part = {.low = whole->low + (double)first * whole->width,
                                .width = whole->width,
                                .bins = end > first ? end - first : 0,
                                .counts = whole->counts + first};
  for (size_t i = 0; i < part.bins; i++) part.total += part.counts[i];
  return part;
}

/* Warns of a third phase, as Otsu's threshold separates two. With a bright mineral the darker side
 * is pore and another phase: it has two peaks, with a valley between them and one to the bright
 * mineral. */
static void warn_of_third_phase(struct pipeline *pipeline) {
  const struct grey_histogram *all = &pipeline->calibration;
  /* Without the darkest grey: a scan clipped at black has a peak there that is no phase. */
  const double black = grey_histogram_quantile(all, 0.0) + 1.01 * all->width;
  const struct grey_histogram dark = bins_between(all, black, pipeline->otsu);
  struct grey_phases darker, brighter;
  const double parting = dark.total > 0 ? grey_histogram_otsu(&dark) : NAN;
  if (isnan(parting)) return;
  grey_histogram_phases(&dark, parting, &darker);
  const struct grey_histogram bright = bins_between(all, parting, INFINITY);
  grey_histogram_phases(&bright, pipeline->otsu, &brighter);
  if (darker.valley_depth < VALLEY_SHALLOW && brighter.valley_depth < VALLEY_SHALLOW)
    log_warning(
        "the scan shows three phases (greys %.4g, %.4g, %.4g), and Otsu's threshold takes "
        "the darker two for pore: if the middle one is grain, give the measured "
        "--void-ratio or --threshold %.4g",
        pipeline_grey(pipeline, darker.pore_peak), pipeline_grey(pipeline, brighter.pore_peak),
        pipeline_grey(pipeline, brighter.grain_peak), pipeline_grey(pipeline, darker.valley));
}

void fragile_warn(struct pipeline *pipeline) {
  const struct grey_phases *phases = &pipeline->phases;
  const struct request *request = pipeline->request;
  if (phases->levels <= 2) return;
  double threshold = pipeline->threshold_original, e = pipeline->void_ratio_original;
  double contrast = phases->grain_peak - phases->pore_peak;
  warn_of_sharpness(&pipeline->scanner);
  const double position = (threshold - phases->pore_peak) / contrast;
  const bool near_peak = position < NEAR_PEAK || position > 1.0 - NEAR_PEAK;
  struct grey_phases by_otsu;
  warn_of_contrast(pipeline, near_peak);
  grey_histogram_phases(&pipeline->calibration, pipeline->otsu, &by_otsu);
  if (is_within_phase(phases, &by_otsu, threshold))
    log_warning("the threshold %.4g lies beyond the histogram's two peaks (pore %.4g, grain %.4g), "
                "within one of them: the void ratio or the region is not the specimen's (--crop "
                "auto leaves a container out)",
                pipeline_grey(pipeline, threshold), pipeline_grey(pipeline, by_otsu.pore_peak),
                pipeline_grey(pipeline, by_otsu.grain_peak));
  else if (near_peak)
    log_warning("the threshold %.4g lies near a peak (pore %.4g, grain %.4g), not between them: "
                "pores or grains are so narrow that blur leaves them no grey of their own, or the "
                "void ratio or the region is not the specimen's (--crop auto leaves a container "
                "out)",
                pipeline_grey(pipeline, threshold), pipeline_grey(pipeline, phases->pore_peak),
                pipeline_grey(pipeline, phases->grain_peak));
  if (request->rule == THRESHOLD_OTSU) warn_of_third_phase(pipeline);
  /* A tenth of the contrast moves the surface by about a tenth of the width of an edge. */
  double error =
      isnan(request->void_ratio_error) ? VOID_RATIO_TOLERANCE * e : request->void_ratio_error;
  double shift = fabs(pipeline->threshold_slope_original) * error / contrast;
  if (request->rule == THRESHOLD_AUTO && shift > SHIFT_STEEP)
    log_warning("the match is steep: %.2g in the void ratio moves the threshold by %.0f %% of the "
                "contrast",
                error, 100.0 * shift);
  const double beam = fabs(pipeline->survey.beam), beam_error = pipeline->survey.beam_error;
  if (beam > BEAM_MOST && beam - beam_error > BEAM_LEAST && !pipeline->correction.beam)
    log_warning(
        "the grain is %.0f +- %.0f %% of the contrast %s at the rim than in the middle (beam "
        "hardening?): one threshold does not fit both; --correct beam levels it",
        100.0 * beam, 100.0 * beam_error, pipeline->survey.beam > 0.0 ? "brighter" : "darker");
  if (pipeline->survey.rings > RINGS_MOST && !pipeline->correction.rings)
    log_warning("rings of %.0f %% of the contrast; --correct rings takes them out",
                100.0 * pipeline->survey.rings);
}
