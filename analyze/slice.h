/* Velocity vectors over the grains in a slab across one axis. */
#ifndef TOSUI_ANALYZE_SLICE_H
#define TOSUI_ANALYZE_SLICE_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"

struct slice_request {
  int axis;         /* normal of the plane: 0 x, 1 y, 2 z; -1: x, or y of a 2-D run */
  double position;  /* m, middle of the slab; NAN: middle of the run */
  double thickness; /* m; NAN: one spacing */
  double vectors;   /* most along the longer side; 0: 60 */
  bool zoomed;
  double zoom[4]; /* m: low and high corner in the two other axes, (y, z), (x, z) or (x, y) */
};

/* Vectors are means over cells so that not more than `vectors` stand along an axis. */
enum status slice_analyze(const struct run *run, const struct slice_request *request,
                          struct product *product);

#endif
