/* A window of slices that moves once through a region, from first to last slice. It holds greys as
 * 16-bit distances from the threshold, without islands that are too small for the model. */
#ifndef TOSUI_CT2MODEL_SURFACE_GREY_WINDOW_H
#define TOSUI_CT2MODEL_SURFACE_GREY_WINDOW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "ct2model/scan/region.h"
#include "ct2model/resample/resample.h"

/* Slices are numbered without wrapping, from `low` to `high` - 1. Beyond the region they repeat the
 * end slices (mirror) or continue periodically. */
struct grey_window {
  const struct region *region;
  double threshold, scale;
  bool mirror;
  size_t speck_limit; /* islands of fewer voxels take the phase around them; below 2: none */
  long low, high;
  long first;         /* number of the slice in field[0] */
  size_t depth, room; /* slices held, and their largest number */
  int16_t *field;     /* [depth][y][x], positive in the grain */
  uint64_t *bits;     /* phases of `field` as from phase_row, [depth][y][words] */
  size_t words;
  char *buffer; /* for each thread: a slice being read, and a row of it */
  size_t buffer_size;
  float *row;
  uint64_t *scratch; /* for removing islands, and for rows of bits */
  size_t specks;     /* voxels changed so far */
};

/* Starts a window of up to `room` slices. `contrast` scales greys. Free with grey_window_end. */
enum status grey_window_start(const struct region *region, double threshold, double contrast,
                              bool mirror, size_t speck_limit, long low, long high, size_t room,
                              struct grey_window *window);
void grey_window_end(struct grey_window *window);
/* Drops the slices before `first` and reads those up to `end` - 1 (both limited to `low` and
 * `high`). */
enum status grey_window_move(struct grey_window *window, long first, long end);
/* Adds the weights (crossing.h) of the changes of phase along x, y, z in the slices z0 <= z < z1,
 * in halves, to crossings[3]. The slices lie in the region, and the next one is held. */
void grey_window_crossings(const struct grey_window *window, size_t z0, size_t z1,
                           uint64_t crossings[3]);
/* Adds the grain volume fractions of the slices z0 <= z < z1, whose neighbours are held, to
 * `volume` through the resampler `area`. */
enum status grey_window_fractions(const struct grey_window *window, size_t z0, size_t z1,
                                  struct resampler *area, float *volume);
/* Whether the trilinear field is grain at a point, in voxels (voxel i has its centre at i + 1/2).
 */
bool grey_window_in_grain(const struct grey_window *window, const double point[3]);

#endif
