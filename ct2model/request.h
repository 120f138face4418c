/* What the command line asks for. */
#ifndef TOSUI_CT2MODEL_REQUEST_H
#define TOSUI_CT2MODEL_REQUEST_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/options.h"
#include "ct2model/scan/denoise.h"
#include "ct2model/scan/labels.h"
#include "ct2model/scan/grey_soil.h"
#include "ct2model/readers/image.h"
#include "ct2model/resample/resample.h"
#include "ct2model/scan/roi.h"

enum threshold_rule { THRESHOLD_AUTO, THRESHOLD_VALUE, THRESHOLD_OTSU };

/* What lies beyond the faces along the flow: the sample again, a wall, or its mirror image. */
enum sides { SIDES_PERIODIC, SIDES_CLOSED, SIDES_MIRRORED };

#define VOID_RATIOS_MOST 32

struct request {
  struct raw_layout raw;
  double voxel[3];         /* m; x, y, z of the scan; NAN: the file's own */
  bool has_slice_distance; /* of slices, given beside that of pixels */
  bool crop_given, crop_auto, size_given, grain_given, fill_islands, mirror;
  enum sides sides;
  int mirror_axis; /* of the model; 2 where nothing is mirrored */
  size_t crop[6];  /* x0, y0, z0, nx, ny, nz */
  size_t size[3];
  struct roi roi;
  int flow_axis; /* of the scan, 0 x .. 2 z: the model's z */
  enum filter filter;
  enum denoise denoise;
  bool correct_beam, correct_rings, keep_blur;
  double axis[2];                      /* of rotation, pixels; NAN: the middle */
  double void_ratio, void_ratio_error; /* NAN if not given */
  /* All of --void-ratio, in the order given; the first is that above. */
  size_t void_ratio_count;
  double void_ratios[VOID_RATIOS_MOST], void_ratio_errors[VOID_RATIOS_MOST];
  enum threshold_rule rule;
  double threshold; /* of THRESHOLD_VALUE, in reported greys */
  bool dark_grains;
  struct label_rules labels;
  struct micro_rules micro;
  double scale_peak;  /* NAN: greys as stored */
  const char *output; /* with its ending */
  char named[PATH_MAX];
  int levels; /* models to build: that of `size` and coarser ones */
};

extern const struct option_table ct2model_options;

/* Usage errors name the option. Texts of the request point into `options`, which must outlive it.
 */
enum status request_parse(const struct options *options, struct request *request);

#endif
