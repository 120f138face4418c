#ifndef TOSUI_CT2MODEL_IMAGE_NRRD_H
#define TOSUI_CT2MODEL_IMAGE_NRRD_H

#include "ct2model/image.h"

extern const struct image_reader image_nrrd_reader;

#endif
