/* The numbers of constants.def, by their names. */
#ifndef TOSUI_CT2MODEL_SCANNER_CONSTANTS_H
#define TOSUI_CT2MODEL_SCANNER_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#define WHOLE CONSTANT_WHOLE
#include "ct2model/scanner/constants.def"
#undef CONSTANT
#undef WHOLE

#endif
