#ifndef TOSUI_CT2MODEL_IMAGE_PNG_H
#define TOSUI_CT2MODEL_IMAGE_PNG_H

#include "ct2model/image.h"

extern const struct image_reader image_png_reader;

#endif
