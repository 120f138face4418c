/* --crop auto: the largest box inside the specimen. */
#ifndef TOSUI_CT2MODEL_SCAN_AUTOCROP_H
#define TOSUI_CT2MODEL_SCAN_AUTOCROP_H

#include <stddef.h>

#include "common/error.h"
#include "ct2model/scan/region.h"

/* Shrinks `region` (the whole stack) in x and y to the largest box that contains none of the
 * surroundings, in any of the slices sampled. Surroundings are what fills the four corners, if that
 * is smooth and unlike the middle, as far as it is connected to the edge by more than narrow pores.
 * A stack without surroundings is left unchanged. */
enum status autocrop(struct region *region);

#endif
