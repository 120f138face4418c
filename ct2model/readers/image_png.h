#ifndef TOSUI_CT2MODEL_READERS_IMAGE_PNG_H
#define TOSUI_CT2MODEL_READERS_IMAGE_PNG_H

#include "ct2model/readers/image.h"

extern const struct image_reader image_png_reader;

#endif
