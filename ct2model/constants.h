/* The numbers of constants.def, by their names. */
#ifndef TOSUI_CT2MODEL_CONSTANTS_H
#define TOSUI_CT2MODEL_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#include "ct2model/constants.def"
#undef CONSTANT

#endif
