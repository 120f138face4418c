/* A width of headerless pixels that is off by a few. */
#ifndef TOSUI_CT2MODEL_READERS_ROW_ENDS_H
#define TOSUI_CT2MODEL_READERS_ROW_ENDS_H

#include "ct2model/readers/image.h"

/* `width`: on entry one at which rows are more alike than at that of `image`, or 0; on return the
 * width of the rows which the pixels have, where it is that one or up to four off the one of
 * `image`; 0 where nothing tells against what `image` has. In a body that repeats along its rows
 * nothing does. */
enum status row_ends_judge(const struct image *image, size_t *width);

#endif
