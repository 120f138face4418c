/* The data on which the stages of ct2model work, from the slices to the model. */
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
  double surface_error; /* 95 % half width of surface_original, by sample windows or of a restored
                           scan; else NAN */
};

/* The greys on which the walls are measured. */
struct wall_level {
  struct region region;       /* the scan, or the restored or averaged scan */
  double threshold, contrast; /* in its greys */
  size_t step;                /* voxels of the scan per side of a voxel of `region` */
  bool averaged;              /* averaged for the walls alone: not the scan's surface */
  double void_ratio;          /* within the walls; NAN: labels, or not requested */
};

/* Greys inside the pipeline are region.scale times stored ones; pipeline_grey converts them to
 * reported ones. */
struct pipeline {
  const struct request *request;
  const struct pipeline *finer; /* for the same scan and void ratio; NULL if this is the first */
  bool distances;               /* a model is built, not only a sweep */
  bool unsized;                 /* a sweep with unknown voxel size: no lengths are reported */
  struct stack stack;
  struct region region;
  struct region as_read;             /* the same in the axes of the scan, as `scanner` */
  struct labels labels;              /* of a segmented image; `region` reads them smoothed */
  struct grey_soil micro;            /* results of --micro */
  struct survey survey;              /* survey of the greys as stored, in the axes of the scan */
  size_t survey_size[2];             /* size of its slices */
  struct scanner scanner;            /* scanner of the greys that are used */
  struct correction correction;      /* correction that `region` applies, if requested */
  struct denoise_effect denoised;    /* if requested */
  float *turned;                     /* the scan with turned axes (--flow); NULL if z stays z */
  struct grey_histogram histogram;   /* of the region */
  struct grey_histogram calibration; /* of the region of interest; else that of the region */
  /* Inside the pipeline z is the axis that is mirrored; axis a of the model is `place[a]` here. The
   * model itself is turned last. */
  int place[3];
  size_t size[3];               /* after resampling, before mirroring */
  bool resampled;               /* false if a sweep leaves a huge scan at full resolution */
  float *volume;                /* greys after resampling, until model and table are made */
  float *middle;                /* middle slice of the region at full resolution */
  double grey_scale;            /* reported = stored * grey_scale */
  struct surface_sample sample; /* if the scan is not read again */
  struct coarse coarse;         /* likewise, for a build; until the walls are measured */
  struct restored restored;     /* the scan without blur and noise */
  bool restoring;               /* whether this is attempted */
  bool blur_removed;            /* whether it was done */
  struct wall_level walls;
  struct sweep_table table;
  double threshold_original, threshold;             /* at full resolution; of the model */
  double solid_threshold;                           /* for `volume`, which may be restored */
  double threshold_slope, threshold_slope_original; /* derivatives dT/de, reported greys */
  double void_ratio_original;                       /* void ratio of the region at
                                                       threshold_original */
  double otsu;
  struct grey_phases phases;
  struct voxel_model model;
  struct quality quality;
  struct morphology morphology;
  size_t specks, disagreeing;
};

/* Frees all that the stages have allocated. */
void pipeline_end(struct pipeline *pipeline);

/* Which axes of the volume are mirrored in the model. */
struct mirroring pipeline_mirroring(const struct pipeline *pipeline);

/* Converts a grey of the region to a reported one. */
double pipeline_grey(const struct pipeline *pipeline, double internal);
/* Whether the volume enclosed by the model's walls is known: in a model of the scan's own voxels,
 * where counting their centres does not quite give it. */
bool pipeline_walls_enclose(const struct pipeline *pipeline);
/* The void ratio of the model: within its walls if that is known, otherwise of its voxels. */
double pipeline_void_ratio(const struct pipeline *pipeline);
/* Grey of grain minus that of pore, in greys of the region; with a single peak, the range of all
 * greys. */
double pipeline_contrast(const struct pipeline *pipeline);
/* Uncertainty of the threshold (reported greys) due to that of the void ratio; NAN if that is
 * unknown. */
double pipeline_threshold_error(const struct pipeline *pipeline);

/* The --size (axes of the model) at which the expected error of k would be `aim`, not finer than
 * the scan; false if the model is fine enough or the error is unknown. *enough: whether the scan is
 * fine enough. */
bool pipeline_finer_size(const struct pipeline *pipeline, double aim, size_t size[3], bool *enough);

#endif
