/* Whether headerless pixels were read with their bytes in the wrong order, in pairs, signed, or in
 * rows of a wrong width. */
#ifndef TOSUI_CT2MODEL_READERS_BYTE_ORDER_H
#define TOSUI_CT2MODEL_READERS_BYTE_ORDER_H

#include "common/error.h"
#include "ct2model/readers/image.h"

/* Warns where neighbours on the middle page of `image`, which --raw describes, are much more alike
 * with the bytes of each pixel turned round or without a sign, at another width, or where pixels of
 * 16 bits are two of 8. */
enum status byte_order_check(const struct image *image);

#endif
