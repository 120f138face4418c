/* The numbers of constants.def, by their names. */
#ifndef TOSUI_CT2MODEL_SCAN_CONSTANTS_H
#define TOSUI_CT2MODEL_SCAN_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#include "ct2model/scan/constants.def"
#undef CONSTANT

#endif
