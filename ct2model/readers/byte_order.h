/* Checks whether pixels were read with a wrong byte order, sign, number of bytes, or width of rows:
 * by whether neighbours are alike. */
#ifndef TOSUI_CT2MODEL_READERS_BYTE_ORDER_H
#define TOSUI_CT2MODEL_READERS_BYTE_ORDER_H

#include "common/error.h"
#include "ct2model/readers/image.h"

/* Warns if on the middle page of `image` neighbouring pixels are much more alike with the bytes of
 * each pixel reversed, with another sign, or at another width, if pixels are pairs of narrower
 * ones, alternate in turns, go round at the ends of their range, or are noise. */
enum status byte_order_check(const struct image *image);

#endif
