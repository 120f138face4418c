/* The request of the command line. */
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

/* Continuation beyond the faces along the flow: periodic, a wall, or the mirror image. */
enum sides { SIDES_PERIODIC, SIDES_CLOSED, SIDES_MIRRORED };

#define VOID_RATIOS_MOST 32

struct request {
  struct raw_layout raw;
  double voxel[3];         /* m; x, y, z of the scan; NAN: as in the files */
  bool has_slice_distance; /* the distance of slices was given besides the size of pixels */
  bool survey;             /* the greys alone, no model */
  bool crop_given, crop_auto, size_given, grain_given, fill_islands, mirror;
  enum sides sides;
  bool sides_stated; /* the user says that the image is periodic */
  int mirror_axis;   /* axis of the model; 2 if nothing is mirrored */
  size_t crop[6];    /* x0, y0, z0, nx, ny, nz */
  size_t size[3];
  struct roi roi;
  int flow_axis; /* axis of the scan, 0 x .. 2 z, that becomes the model's z */
  enum filter filter;
  enum denoise denoise;
  bool correct_beam, correct_rings, keep_blur;
  double axis[2];                      /* axis of rotation in pixels; NAN: the middle */
  double void_ratio, void_ratio_error; /* NAN: not given */
  /* All values of --void-ratio in the order given; the first one is that above. */
  size_t void_ratio_count;
  double void_ratios[VOID_RATIOS_MOST], void_ratio_errors[VOID_RATIOS_MOST];
  enum threshold_rule rule;
  double threshold; /* for THRESHOLD_VALUE, in reported greys */
  bool dark_grains;
  struct label_rules labels;
  struct micro_rules micro;
  double scale_peak;  /* NAN: greys as stored */
  const char *output; /* with its extension */
  char named[PATH_MAX];
  int levels; /* number of models to build: that of `size` and coarser ones */
};

extern const struct option_table ct2model_options;

/* Parses the options; usage errors name the option. Strings in the request point into `options`,
 * which must outlive it. */
enum status request_parse(const struct options *options, struct request *request);

#endif
