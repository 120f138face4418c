/* Slices that no scanner makes twice: copies of the one before, and slices of one grey. */
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
  bool *constant; /* whether it is of one grey */
};

/* For `count` slices; free with slice_check_end. */
enum status slice_check_start(size_t count, struct slice_check *check);
/* Slice z as it was read, size[1] rows of size[0] pixels; each slice by one thread. */
void slice_check_add(struct slice_check *check, size_t z, const struct pixel_rows *rows,
                     const size_t size[2]);
/* Warns of copies and of slices of one grey, all slices being there. Labels and bodies drawn by a
 * program do have such slices: it warns only where neighbouring pixels of these slices, or of the
 * slices beside them, differ as noise makes them. */
enum status slice_check_warn(const struct slice_check *check, const struct region *region);
void slice_check_end(struct slice_check *check);

#endif
