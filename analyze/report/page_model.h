/* Description of a run's model by the attributes of its file, which is the only source for what the
 * page says about the specimen. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_MODEL_H
#define TOSUI_ANALYZE_REPORT_PAGE_MODEL_H

#include <jansson.h>
#include <stdbool.h>

#include "analyze/run_file.h"

/* How the grey threshold of a scan was chosen. */
enum threshold_rule {
  RULE_NONE,    /* no scan, or not described by the file */
  RULE_MATCHED, /* to match the measured void ratio */
  RULE_OTSU,
  RULE_GIVEN, /* given by the user */
  RULE_LABELS /* a segmented image */
};

/* Numbers are NAN if the file does not give them. */
struct page_model {
  bool named, found; /* the run names a model; its file could be read */
  bool other;        /* the file with that name is not the model that was run */
  bool scanned;      /* ct2model made it from slices */
  enum threshold_rule rule;
  /* Present in the file; soil: with pores below the voxel size. */
  bool wall_distance, grain_fraction, soil;
  double threshold, void_ratio, void_ratio_measured;
  double void_ratio_walls; /* void ratio within the walls, if that was matched */
  double voxel_scanned;    /* m */
  /* m: standard deviations of the smoothing, for labels; the second for even walls. */
  double smoothing, smoothing_even;
  double blur;       /* m: standard deviation, as estimated from the scan */
  bool blur_removed; /* the effect of the blur on the surface was corrected */
  /* porosity; specific surface in 1/m of bulk volume, at the resolution of the scan. */
  double porosity, specific_surface;
  char mirror_axis[8]; /* "x", "y", "z", "none", "": unknown */
  char sides[16];      /* "periodic", "closed", "mirrored", "": unknown */
  char origin[256];    /* what the scan is, as its own description says; "" unknown */
  char path[8200];
};

/* Never fails: what cannot be read is unknown. */
void page_model_read(const struct run *run, struct page_model *model);

/* {"state": "none", "missing", "changed" (not the one that was run) or "found", "path", "rule":
 * "matched", "otsu", "given", "labels" or "", "void_ratio_walls", "origin"}; a new object. */
json_t *page_model_json(const struct page_model *model);

#endif
