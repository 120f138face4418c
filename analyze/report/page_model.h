/* What a run's model file says of itself: the only source of what the page says of the specimen. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_MODEL_H
#define TOSUI_ANALYZE_REPORT_PAGE_MODEL_H

#include <stdbool.h>

#include "analyze/run_file.h"

/* How the grey threshold of a scan came about. */
enum threshold_rule {
  RULE_NONE,    /* no scan, or a model that does not say */
  RULE_MATCHED, /* so that the model has the measured void ratio */
  RULE_OTSU,
  RULE_GIVEN, /* a number of the user's */
  RULE_LABELS /* a segmented image */
};

/* NAN where the file does not say. */
struct page_model {
  bool named, found; /* the run names a model; its file could be read */
  bool other;        /* the file of that name is not the one that was run */
  bool scanned;      /* ct2model made it from slices */
  enum threshold_rule rule;
  bool wall_distance, grain_fraction, soil; /* soil: with pores below the voxel */
  double threshold, void_ratio, void_ratio_measured;
  double void_ratio_walls; /* within the walls, where that is what was matched */
  double voxel_scanned;              /* m */
  double smoothing, smoothing_even;  /* m: standard deviations, of labels; where walls are even */
  double blur;                       /* m: standard deviation, as measured on the scan */
  bool blur_removed;                 /* from the surface */
  double porosity, specific_surface; /* 1/m of bulk volume, at the scan's resolution */
  char mirror_axis[8];               /* "x", "y", "z", "none", "": unknown */
  char sides[16];                    /* "periodic", "closed", "mirrored", "": unknown */
  char path[8200];
};

/* Never fails: what cannot be read is unknown. */
void page_model_read(const struct run *run, struct page_model *model);

#endif
