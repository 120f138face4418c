/* Segmented images: identifies the labels that are pore, and smooths the labels so that walls are
 * surfaces and not stairs. */
#ifndef TOSUI_CT2MODEL_SCAN_LABELS_H
#define TOSUI_CT2MODEL_SCAN_LABELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "ct2model/scan/label_walls.h"
#include "ct2model/scan/micro.h"
#include "ct2model/scan/region.h"

enum { LABELS_MOST = 32 };

/* The option --segmented. */
struct label_rules {
  bool given;
  size_t count; /* 0: found automatically */
  double value[LABELS_MOST];
  bool pore[LABELS_MOST];
  bool is_soil[LABELS_MOST];     /* this label is soil, with pores of its own */
  struct soil soil[LABELS_MOST]; /* its properties */
  bool rest_is_grain;            /* only one label is named, and it is pore */
};

/* Parses "", "0" (this label is pore, the rest grain) or "0=pore,1=grain,2=soil(0.35, 1.8e-15
 * m^2),..."; usage errors. */
enum status labels_parse(const char *text, struct label_rules *rules);

struct labels {
  bool on;
  size_t count;
  double value[LABELS_MOST]; /* labels found, in rising order */
  bool pore[LABELS_MOST];
  bool is_soil[LABELS_MOST];
  struct soil soil[LABELS_MOST];
  struct micro micro;    /* kind of each voxel, if there is soil */
  double noisy;          /* with --micro: fraction of the voxels whose phase noise had changed */
  double voids;          /* volume fraction of pores and of the pores in soil */
  double porosity;       /* fraction of voxels that are not grain */
  double model_porosity; /* the same in the mirrored model, where the last layers count once */
  double sharp_porosity; /* of the surface halfway between unsmoothed labels */
  double volume_error;   /* standard error of the grains' volume fraction; 0: not computed */
  double threshold;      /* grey at which the smoothed surface encloses the volume of the pores */
  uint8_t *smooth;       /* smoothed walls [z][y][x] of the region */
};

/* Finds out whether the region is segmented, by `rules` or because it holds two values only. If so
 * it is smoothed, and `region` reads the smoothed walls from then on. `reflect`: axes of the scan
 * that will be mirrored; the others are periodic. `dark`: of two labels found, the lower one is
 * grain. Free with labels_end after the last read. */
enum status labels_take(struct region *region, const struct label_rules *rules, bool dark,
                        const bool reflect[3], struct labels *labels);
void labels_end(struct labels *labels);

/* Smooths the walls of grain[z][y][x] (1 grain, 0 all else), where labels->porosity is the fraction
 * of zeros; sets the members of `labels` that describe walls. */
enum status labels_smooth(struct region *region, const uint8_t *grain, const bool reflect[3],
                          struct labels *labels);

/* Relative change of k by the smoothing, from that of the pore volume within the walls by Kozeny
 * and Carman, k ~ n^3 / (1 - n)^2. */
double labels_effect_on_k(const struct labels *labels);

/* 95 % half width of the void ratio due to the finite size of voxels. */
double labels_void_ratio_error(const struct labels *labels);

#endif
