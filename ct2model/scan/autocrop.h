/* --crop auto: the largest box inside the specimen. */
#ifndef TOSUI_CT2MODEL_SCAN_AUTOCROP_H
#define TOSUI_CT2MODEL_SCAN_AUTOCROP_H

#include <stddef.h>

#include "common/error.h"
#include "ct2model/scan/region.h"

/* Shrinks `region` (the whole stack) in x and y to the largest box that holds none of the
 * surroundings, in any of the slices looked at. Surroundings are what the four corners hold, if
 * that is smooth and unlike the middle, as far as it is joined to the edge by no narrow pores; a
 * stack without them stays whole. */
enum status autocrop(struct region *region);

#endif
