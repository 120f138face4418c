#ifndef TOSUI_CT2MODEL_READERS_IMAGE_NPY_H
#define TOSUI_CT2MODEL_READERS_IMAGE_NPY_H

#include "ct2model/readers/image.h"

extern const struct image_reader image_npy_reader;

#endif
