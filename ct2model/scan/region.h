/* The part of a stack that is used, as greys with bright grain: cropped, scaled, and negated if the
 * grain is dark. It is read in batches by several threads. */
#ifndef TOSUI_CT2MODEL_SCAN_REGION_H
#define TOSUI_CT2MODEL_SCAN_REGION_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/scan/denoise.h"
#include "ct2model/readers/stack.h"

/* Correction of the greys of a slice as it is read (survey.h). */
struct survey;
struct region;
struct correction {
  enum status (*apply)(const struct region *region, float *slice); /* in place */
  const struct survey *survey;
  bool beam, rings; /* beam: make both phases uniform over the radius; rings: remove rings */
};

struct region {
  const struct stack *stack;
  size_t origin[3], size[3]; /* x, y, z */
  double voxel[3];           /* m */
  double scale;              /* grey = scale * stored value; negative for dark grains */
  const void *held; /* [z][y][x] where the whole region is in memory (region_turn, coarse) */
  enum pixel_type held_type;
  double axis[2];                      /* axis of rotation, in pixels of the whole slice */
  const struct correction *correction; /* NULL: greys as stored */
  enum denoise denoise;
};

/* Whether the greys are integers of few levels: each file stores them so, and no correction is
 * applied. */
bool region_has_levels(const struct region *region);
/* Reads slice z in the cheapest form, for use by one thread. `rows` points into `buffer`, which has
 * region_buffer_size bytes, or into the memory that the region holds. */
size_t region_buffer_size(const struct region *region);
enum status region_read_rows(const struct region *region, size_t z, void *buffer,
                             struct pixel_rows *rows);
/* Number of slices that are read at a time (bounded memory). */
size_t region_batch(const struct region *region);
/* Reads slices numbers[0 .. n-1] of the region into out[n][size y][size x]. */
enum status region_read(const struct region *region, const size_t *numbers, size_t n, float *out);

/* Reads a box of the region, from voxel `first` on, into out[z * pitch[1] + y * pitch[0] + x]. */
enum status region_read_box(const struct region *region, const size_t first[3],
                            const size_t size[3], const size_t pitch[2], float *out);

/* Turns the region so that `axis` (0 x, 1 y, 2 z: no change of order) of the scan becomes its z, by
 * a cyclic permutation of the axes; size and voxel follow. The whole region is then held in *store
 * (memory_free after the last read). */
enum status region_turn(struct region *region, int axis, float **store);

#endif
