/* What the stages of ct2model work on, from the slices to the model. */
#ifndef TOSUI_CT2MODEL_STATE_H
#define TOSUI_CT2MODEL_STATE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/model_file.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/surface/coarse.h"
#include "ct2model/scan/denoising.h"
#include "ct2model/model/morphology.h"
#include "ct2model/scan/labels.h"
#include "ct2model/scan/region.h"
#include "ct2model/request.h"
#include "ct2model/readers/stack.h"
#include "ct2model/surface/surface_sample.h"
#include "ct2model/scan/survey.h"
#include "ct2model/scanner/restored.h"
#include "ct2model/scanner/scanner.h"
#include "ct2model/calibrate/sweep_table.h"

struct quality {
  bool percolates[3];
  double porosity, connected_porosity; /* connected: on a path along z */
  size_t isolated_pores, isolated_voxels, floating_grains, floating_voxels;
  double surface_original, surface_model; /* 1/m: grain surface per bulk volume */
  double surface_error; /* of surface_original, 95 %: of windows that stand for the whole, or of a
                           restored scan; else NAN */
};

/* What the walls are measured on. */
struct wall_level {
  struct region region;       /* the scan, restored or averaged where it is */
  double threshold, contrast; /* of its greys */
  size_t step;                /* voxels of the scan a side of one of its */
  bool averaged;              /* for that alone: its surface is not the scan's */
  double void_ratio;          /* within the walls; NAN: of labels, or not asked for */
};

/* Greys inside are region.scale times stored ones; pipeline_grey gives what is reported. */
struct pipeline {
  const struct request *request;
  const struct pipeline *finer; /* of the same scan and void ratio; NULL where this is the first */
  bool distances; /* a model is wanted, not a sweep alone */
  bool unsized;   /* a sweep of voxels of no known size: no length is told */
  struct stack stack;
  struct region region;
  struct region as_read;             /* the same in the scan's axes, which the scanner is told in */
  struct labels labels;              /* of a segmented image: `region` reads them smoothed */
  struct grey_soil micro;            /* what --micro made of greys */
  struct survey survey;              /* of the greys as stored, in the scan's axes */
  size_t survey_size[2];             /* of its slices */
  struct scanner scanner;            /* of the greys that are used */
  struct correction correction;      /* what region applies, if asked */
  struct denoise_effect denoised;    /* if asked */
  float *turned;                     /* the scan with other axes (--flow); NULL if z stays z */
  struct grey_histogram histogram;   /* of the region */
  struct grey_histogram calibration; /* of the region of interest; without --roi the same greys */
  /* Inside, z is the axis that is mirrored; axis a of the model is `place[a]` here. The model
   * itself is turned last. */
  int place[3];
  size_t size[3];    /* after resampling, before mirroring */
  bool resampled;    /* false where a sweep leaves a huge scan alone */
  float *volume;     /* greys after resampling, until the model and the table are made of them */
  float *middle;     /* the middle slice of the region, full resolution */
  double grey_scale; /* reported = stored * grey_scale */
  struct surface_sample sample; /* where the scan is not read again */
  struct coarse coarse;         /* likewise, of a build; until the walls are measured */
  struct restored restored;     /* the scan without blur and noise */
  bool restoring;               /* whether that is tried */
  bool blur_removed;            /* and whether it was done, */
  size_t averaged;              /* out of means of so many voxels a side; 1: of every voxel */
  struct wall_level walls;
  struct sweep_table table;
  double threshold_original, threshold;             /* full resolution; model */
  double solid_threshold;                           /* of `volume`, which may be restored */
  double threshold_slope, threshold_slope_original; /* dT/de, reported greys */
  double void_ratio_original;                       /* of the region at threshold_original */
  double otsu;
  struct grey_phases phases;
  struct voxel_model model;
  struct quality quality;
  struct morphology morphology;
  size_t specks, disagreeing;
};

/* Frees all that the stages have made. */
void pipeline_end(struct pipeline *pipeline);

/* How the volume becomes the model. */
struct mirroring pipeline_mirroring(const struct pipeline *pipeline);

/* A grey of the region, as it is reported: of the scan as stored. */
double pipeline_grey(const struct pipeline *pipeline, double internal);
/* Whether what the model's walls enclose is known: on the scan's own voxels, whose centres,
 * counted, do not quite tell it. */
bool pipeline_walls_enclose(const struct pipeline *pipeline);
/* The void ratio that the model's walls leave: within them where that is known, or of its voxels.
 */
double pipeline_void_ratio(const struct pipeline *pipeline);
/* Grain less pore, greys of the region; of one peak, all that its greys span. */
double pipeline_contrast(const struct pipeline *pipeline);
/* Uncertainty of the threshold from that of the measured void ratio; NAN if none is given. */
double pipeline_threshold_error(const struct pipeline *pipeline);

/* The --size (model's axes) at which the expected error of k would be `aim`, no finer than the
 * scan; false where the model is fine enough or nothing is known. *enough: whether the scan can
 * give it. */
bool pipeline_finer_size(const struct pipeline *pipeline, double aim, size_t size[3], bool *enough);

#endif
