#ifndef TOSUI_CT2MODEL_READERS_IMAGE_META_H
#define TOSUI_CT2MODEL_READERS_IMAGE_META_H

#include "ct2model/readers/image.h"

extern const struct image_reader image_meta_reader;

#endif
