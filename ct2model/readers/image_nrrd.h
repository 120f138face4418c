#ifndef TOSUI_CT2MODEL_READERS_IMAGE_NRRD_H
#define TOSUI_CT2MODEL_READERS_IMAGE_NRRD_H

#include "ct2model/readers/image.h"

extern const struct image_reader image_nrrd_reader;

#endif
