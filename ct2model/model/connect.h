/* Connected parts of one phase of a voxel image, by runs along x and union-find; neighbours share a
 * face.
 *
 * In a periodic direction the ends are neighbours. A part percolates along a direction if a path in
 * it leads to its own image one period further (periodic), or from one end to the other (not
 * periodic). The union-find stores the displacement of each run from its root in periods. */
#ifndef TOSUI_CT2MODEL_MODEL_CONNECT_H
#define TOSUI_CT2MODEL_MODEL_CONNECT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct part {
  size_t voxels;
  bool percolates[3]; /* x, y, z */
  bool at_border;     /* touches an end of a direction that is not periodic */
};

struct run {
  uint32_t x0, x1; /* x0 <= x < x1 */
  uint32_t part;
};

struct parts {
  size_t size[3];
  size_t run_count;
  struct run *runs;
  size_t *row_first; /* first run of row z * ny + y; ny * nz + 1 values */
  size_t count;
  struct part *parts;
};

/* Finds the parts of the voxels of image[z][y][x] equal to `value`. Free with parts_end. */
enum status parts_find(const uint8_t *image, const size_t size[3], const bool periodic[3],
                       uint8_t value, struct parts *parts);
void parts_end(struct parts *parts);
/* Sets the voxels of all parts for which choose(part, context) holds to `value`; returns their
 * number. */
size_t parts_paint(const struct parts *parts, bool (*choose)(const struct part *, const void *),
                   const void *context, uint8_t value, uint8_t *image);

#endif
