#include "ct2model/segment.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/constants.h"

/* Fewer voxels are no image of pores. */
#define VOXELS_LEAST 512

/* Error without a void ratio: either it is missing, or the image has nothing to divide. */
static enum status fail_without_void_ratio(const struct region *region) {
  enum status status = STATUS_OK;
  const size_t *n = region->size, count = n[0] * n[1];
  const char *path = region->stack->files[0].path;
  float *slice = NULL, low = INFINITY, high = -INFINITY;
  if (count * n[2] < VOXELS_LEAST)
    TRY_FAIL(STATUS_INPUT, "%s: %zu x %zu x %zu voxels are too few to tell pores from grains", path,
             n[0], n[1], n[2]);
  TRY(memory_allocate(&slice, count, sizeof *slice, "a slice"));
  for (size_t z = 0; z < n[2] && !(high > low); z++) {
    TRY(region_read(region, &z, 1, slice));
    for (size_t i = 0; i < count; i++) low = fminf(low, slice[i]), high = fmaxf(high, slice[i]);
  }
  if (!(high > low))
    TRY_FAIL(STATUS_INPUT,
             "%s: all voxels of the region have one value, %g: no pores are to be seen", path,
             region->scale * (double)low);
  TRY_FAIL(STATUS_USAGE,
           "--void-ratio is missing: give the measured one, --threshold VALUE or otsu, "
           "or --segmented for an image of labels");
cleanup:
  memory_free(&slice);
  return status;
}

enum status segment_take(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct request *request = pipeline->request;
  const bool plain = request->rule == THRESHOLD_AUTO && request->roi.kind == ROI_NONE &&
                     request->denoise == DENOISE_NONE && !request->correct_beam &&
                     !request->correct_rings && isnan(request->scale_peak);
  bool reflect[3] = {false, false, false};
  const int mirrored = (request->flow_axis + 1 + request->mirror_axis) % 3;
  for (int a = 0; a < 3; a++)
    reflect[a] = a == mirrored ? request->mirror : request->sides != SIDES_PERIODIC;
  if (request->micro.given) {
    TRY(micro_take(&pipeline->region, &request->micro, request->void_ratio,
                   request->void_ratio_error, reflect, &pipeline->labels, &pipeline->micro));
    if (fabs(pipeline->micro.shift) >
        MICRO_SHIFT_MOST * (pipeline->micro.high - pipeline->micro.low))
      log_warning("the greys of soil had to be moved by %+.3g, to %.4g..%.4g, to meet the void "
                  "ratio: check --micro against the histogram (ct2model sweep)",
                  pipeline->micro.shift, pipeline->micro.low, pipeline->micro.high);
    if (pipeline->labels.noisy > NOISY_MOST)
      log_warning(
          "noise puts %.0f %% of the voxels into another phase than those about them have; "
          "what of it is taken out makes the volumes of pore, soil and grain unsure: take noise "
          "out of the slices first",
          100.0 * pipeline->labels.noisy);
  } else if (request->labels.given || (plain && pipeline->distances))
    TRY(labels_take(&pipeline->region, &request->labels, request->dark_grains, reflect,
                    &pipeline->labels));
  /* With a measured void ratio the error of the labels' volume is known. */
  if (isfinite(request->void_ratio)) pipeline->labels.volume_error = 0.0;
  if (pipeline->labels.on && !pipeline->distances)
    TRY_FAIL(STATUS_INPUT,
             "%s: is segmented: there is no threshold to sweep; build takes it as it is",
             pipeline->stack.files[0].path);
  if (request->rule == THRESHOLD_AUTO && isnan(request->void_ratio) && !pipeline->labels.on)
    TRY(fail_without_void_ratio(&pipeline->region));
cleanup:
  return status;
}
