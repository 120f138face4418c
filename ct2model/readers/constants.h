/* The numbers of constants.def, by their names. */
#ifndef TOSUI_CT2MODEL_READERS_CONSTANTS_H
#define TOSUI_CT2MODEL_READERS_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#include "ct2model/readers/constants.def"
#undef CONSTANT

#endif
