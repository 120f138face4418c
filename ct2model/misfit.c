#include "ct2model/misfit.h"

#include <math.h>
#include <stdio.h>

#include "common/log.h"
#include "ct2model/constants.h"

/* Permeability over that at void ratio `e`, for the same specific surface of the grains: k is
 * proportional to e^3 / (1 + e) (Kozeny 1927, Carman 1937). */
static double permeability_ratio(double model, double e) {
  return pow(model / e, 3.0) * (1.0 + e) / (1.0 + model);
}

/* The reason, and a remedy. */
static const char *reason(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  const bool part = request->crop_given || request->crop_auto;
  if (request->roi.kind != ROI_NONE && !part)
    return "what lies outside --roi is in the model, and a gap beside the specimen conducts more "
           "than all of its pores; --crop auto, or a --crop BOX inside of the --roi, leaves it out";
  if (request->roi.kind != ROI_NONE)
    return "the box of --crop differs from the --roi; check that it lies inside of it";
  if (request->rule != THRESHOLD_AUTO)
    return "--threshold sets the greys, and not the void ratio; --threshold auto matches it";
  if (request->fill_islands)
    return "--islands fill made grain of pores; --islands keep leaves them";
  if (pipeline->phases.levels == 2)
    return "the scan holds two greys, which no threshold moves; segment it anew from its greys";
  return "the scan has too few grey levels near the threshold to come nearer";
}

void misfit_warn(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  const double e = pipeline_void_ratio(pipeline), measured = request->void_ratio;
  const double error = isnan(request->void_ratio_error) ? 0.0 : request->void_ratio_error;
  const double most = request->roi.kind != ROI_NONE ? VOID_RATIO_ELSEWHERE : VOID_RATIO_TOLERANCE;
  if (pipeline->labels.on && !request->fill_islands) return; /* reported with the labels */
  if (isnan(measured) || !(fabs(e - measured) > fmax(most * measured, error))) return;
  char effect[100] = "its k is not that of the specimen";
  if (request->roi.kind == ROI_NONE) /* with --roi the model has other grains, or none */
    snprintf(effect, sizeof effect,
             "its k would be %.3g times that of the specimen (Kozeny, Carman)",
             permeability_ratio(e, measured));
  log_warning("the model's void ratio is %.4g, not the measured %.4g, and %s: %s", e, measured,
              effect, reason(pipeline));
}

double misfit_void_ratio_doubt(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  const struct restored *restored = &pipeline->restored;
  const double off = fabs(pipeline->void_ratio_original - restored->scan_void_ratio);
  if (request->rule != THRESHOLD_AUTO || isnan(off)) return NAN;
  const double error = isnan(request->void_ratio_error) ? 0.0 : request->void_ratio_error;
  return off > hypot(error, restored->scan_void_ratio_error) ? off : 0.0;
}

void misfit_warn_of_doubt(const struct pipeline *pipeline) {
  const double e = pipeline->void_ratio_original, seen = pipeline->restored.scan_void_ratio;
  char error[40] = "";
  if (!(misfit_void_ratio_doubt(pipeline) > 0.0)) return;
  if (pipeline->request->void_ratio_error > 0.0)
    snprintf(error, sizeof error, " +- %.2g", pipeline->request->void_ratio_error);
  log_warning(
      "the edges of the scan give a void ratio of %.3g +- %.2g, not %.4g%s: by that k would "
      "be %.3g times as large (Kozeny, Carman), which its error includes; check the void "
      "ratio, and that the scan shows what it was measured on",
      seen, pipeline->restored.scan_void_ratio_error, e, error, permeability_ratio(seen, e));
}
