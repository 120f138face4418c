/* Checks whether headerless pixels were read with a wrong byte order, sign, number of bytes, or
 * width of rows. */
#ifndef TOSUI_CT2MODEL_READERS_BYTE_ORDER_H
#define TOSUI_CT2MODEL_READERS_BYTE_ORDER_H

#include "common/error.h"
#include "ct2model/readers/image.h"

/* Warns if on the middle page of `image`, which --raw describes, neighbouring pixels are much more
 * alike with the bytes of each pixel reversed, without a sign, or at another width, or if pixels
 * are pairs of narrower ones, or alternate in turns. */
enum status byte_order_check(const struct image *image);
/* The same of the sign and of the order of two bytes, for files that describe themselves. */
enum status byte_order_check_sign(const struct image *image);

#endif
