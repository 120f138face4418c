/* Detects a width of headerless pixels that is wrong by a few pixels, and a wrong height. */
#ifndef TOSUI_CT2MODEL_READERS_ROW_ENDS_H
#define TOSUI_CT2MODEL_READERS_ROW_ENDS_H

#include "ct2model/readers/image.h"

/* `width`: on entry a width at which rows are more alike than at that of `image`, or 0. On return
 * the width of the rows in the file, if that is this one or differs from that of `image` by up to
 * four; 0 if nothing contradicts `image`. In a body that repeats along its rows nothing does. */
enum status row_ends_judge(const struct image *image, size_t *width);
/* The number of rows of a slice, where it is clearly another than that of `image`: of rows that
 * follow one another, those at the ends of slices lie at opposite sides of the body. 0 if nothing
 * contradicts `image`, as in a body that repeats along y, or in one slice. */
enum status row_ends_height(const struct image *image, size_t *height);

#endif
