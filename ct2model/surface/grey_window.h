/* A window of slices that moves through a region once, from its first slice to its last: greys as
 * 16-bit distances from the threshold, without islands too small for the model. */
#ifndef TOSUI_CT2MODEL_SURFACE_GREY_WINDOW_H
#define TOSUI_CT2MODEL_SURFACE_GREY_WINDOW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "ct2model/scan/region.h"
#include "ct2model/resample/resample.h"

/* Slices are counted without wrapping, from `low` to `high` - 1; beyond the region they repeat the
 * end slices (mirror) or continue periodically. */
struct grey_window {
  const struct region *region;
  double threshold, scale;
  bool mirror;
  size_t speck_limit; /* islands under so many voxels take the phase around them; below 2: none */
  long low, high;
  long first;         /* slice of field[0] */
  size_t depth, room; /* slices held, and at most */
  int16_t *field;     /* [depth][y][x], positive in the grain */
  uint64_t *bits;     /* the same as phase_row makes them, [depth][y][words] */
  size_t words;
  char *buffer; /* slices being read, and a row of each, by thread */
  size_t buffer_size;
  float *row;
  uint64_t *scratch; /* for islands, then for rows of bits */
  size_t specks;     /* voxels changed so far */
};

/* Window of at most `room` slices. Free with grey_window_end. */
enum status grey_window_start(const struct region *region, double threshold, double contrast,
                              bool mirror, size_t speck_limit, long low, long high, size_t room,
                              struct grey_window *window);
void grey_window_end(struct grey_window *window);
/* Drops slices before `first` and reads up to `end` - 1 (both clamped to low and high). */
enum status grey_window_move(struct grey_window *window, long first, long end);
/* Adds the weights (crossing.h) of the changes of phase along x, y, z in the slices z0 <= z < z1
 * (within the region; the next held) to crossings[3]. */
void grey_window_crossings(const struct grey_window *window, size_t z0, size_t z1,
                           uint64_t crossings[3]);
/* Grain volume fractions of those slices (both neighbours held), added to `volume` by `area`. */
enum status grey_window_fractions(const struct grey_window *window, size_t z0, size_t z1,
                                  struct resampler *area, float *volume);
/* Phase of the trilinear field at a point in voxels (voxel i is centred at i + 1/2). */
bool grey_window_in_grain(const struct grey_window *window, const double point[3]);

#endif
