/* Segmented images: which labels are pore, and the labels smoothed, so that walls are surfaces and
 * not stairs. */
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

/* What --segmented says. */
struct label_rules {
  bool given;
  size_t count; /* 0: to be found out */
  double value[LABELS_MOST];
  bool pore[LABELS_MOST];
  bool soily[LABELS_MOST];       /* has pores of its own: */
  struct soil soil[LABELS_MOST]; /* these */
  bool rest_is_grain;            /* one label alone is named, which is pore */
};

/* "", "0" (this label is pore, the rest grain) or "0=pore,1=grain,2=soil(0.35, 1.8e-15 m^2),...";
 * usage errors. */
enum status labels_parse(const char *text, struct label_rules *rules);

struct labels {
  bool on;
  size_t count;
  double value[LABELS_MOST]; /* labels seen, rising */
  bool pore[LABELS_MOST];
  bool soily[LABELS_MOST];
  struct soil soil[LABELS_MOST];
  struct micro micro;    /* what is soil */
  double noisy;          /* of greys: share of the voxels that noise put into another phase */
  double voids;          /* share of the volume: pores and what soil has of them */
  double porosity;       /* share of voxels that are not grain */
  double model_porosity; /* the same of the mirrored model, where the last layers count once */
  double sharp_porosity; /* that the surface halfway between unsmoothed labels would give */
  double volume_error;   /* standard error of the grains' share (label_volume.h); 0: not asked */
  double threshold;      /* the grey at which the smoothed surface encloses the pores' volume */
  uint8_t *smooth;       /* [z][y][x] of the region */
};

/* Whether the region is segmented: by `rules`, or because it holds two values only; and then
 * smooths it and makes `region` read that. `reflect`: axes of the scan that will be mirrored; the
 * others are periodic. `dark`: of two labels found, the lower is grain. Free with labels_end after
 * the last read. */
enum status labels_take(struct region *region, const struct label_rules *rules, bool dark,
                        const bool reflect[3], struct labels *labels);
void labels_end(struct labels *labels);

/* The last part of it: walls of grain[z][y][x], 1 grain and 0 all else, of which labels->porosity
 * is the share of 0; fills what `labels` says of walls. */
enum status labels_smooth(struct region *region, const uint8_t *grain, const bool reflect[3],
                          struct labels *labels);

/* Change of k by the smoothing, relative: that of the pores' volume within the walls, by Kozeny and
 * Carman, k ~ n^3 / (1 - n)^2. */
double labels_effect_on_k(const struct labels *labels);

/* 95 % half width of the void ratio by the labels' own voxels. */
double labels_void_ratio_error(const struct labels *labels);

#endif
