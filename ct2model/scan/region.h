/* The part of a stack that is used, as greys with grain bright: cropped, scaled, negated if the
 * grain is dark; read in batches by several threads. */
#ifndef TOSUI_CT2MODEL_SCAN_REGION_H
#define TOSUI_CT2MODEL_SCAN_REGION_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/scan/denoise.h"
#include "ct2model/readers/stack.h"

/* What is done to the greys of a slice as it is read (survey.h). */
struct survey;
struct region;
struct correction {
  enum status (*apply)(const struct region *region, float *slice); /* in place */
  const struct survey *survey;
  bool beam, rings; /* level both phases over the radius; take rings out */
};

struct region {
  const struct stack *stack;
  size_t origin[3], size[3]; /* x, y, z */
  double voxel[3];           /* m */
  double scale;              /* grey = scale * stored value; negative for dark grains */
  const void *held; /* [z][y][x] where the whole region is in memory (region_turn, coarse) */
  enum pixel_type held_type;
  double axis[2];                      /* of rotation, pixels of the whole slice */
  const struct correction *correction; /* NULL: greys as stored */
  enum denoise denoise;
};

/* Whether greys come as whole numbers of few levels: nothing was done to them, and each file stores
 * them so. */
bool region_has_levels(const struct region *region);
/* Slice z in the form that costs least, by one thread; `rows` point into `buffer`, which has
 * region_buffer_size bytes, or into what the region holds. */
size_t region_buffer_size(const struct region *region);
enum status region_read_rows(const struct region *region, size_t z, void *buffer,
                             struct pixel_rows *rows);
/* How many slices are read at a time (bounded memory). */
size_t region_batch(const struct region *region);
/* Slices of the region numbers[0 .. n-1] into out[n][size y][size x]. */
enum status region_read(const struct region *region, const size_t *numbers, size_t n, float *out);

/* Makes `axis` (0 x, 1 y, 2 z as it is) of the scan the z of the region, by a cyclic change of
 * axes; size and voxel follow. The whole region is held in *store (memory_free after the last
 * read). */
enum status region_turn(struct region *region, int axis, float **store);

#endif
