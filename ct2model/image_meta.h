#ifndef TOSUI_CT2MODEL_IMAGE_META_H
#define TOSUI_CT2MODEL_IMAGE_META_H

#include "ct2model/image.h"

extern const struct image_reader image_meta_reader;

#endif
