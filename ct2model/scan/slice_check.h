/* Checks for slices that no scanner produces: copies of an earlier slice, slices of a single grey,
 * slices whose greys were stretched each in its own way, slices that do not go on where the one
 * before ends, means of the slices beside, and
 * slices of several scans in turns. */
#ifndef TOSUI_CT2MODEL_SCAN_SLICE_CHECK_H
#define TOSUI_CT2MODEL_SCAN_SLICE_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "ct2model/scan/region.h"

struct slice_check {
  size_t count;
  uint64_t *hash; /* of each slice of the region */
  bool *constant; /* whether it has a single grey */
  float *greys;   /* a few hundred of each */
};

/* Starts a check of `count` slices; free with slice_check_end. */
enum status slice_check_start(size_t count, struct slice_check *check);
/* Adds slice z as it was read, size[1] rows of size[0] pixels; each slice by one thread. */
void slice_check_add(struct slice_check *check, size_t z, const struct pixel_rows *rows,
                     const size_t size[2]);
/* Warns of such slices, once all have been added. Labels and synthetic images do have them: a
 * warning is given only if neighbouring pixels of these slices, or of adjacent ones, differ as by
 * noise. */
enum status slice_check_warn(const struct slice_check *check, const struct region *region);
void slice_check_end(struct slice_check *check);

#endif
