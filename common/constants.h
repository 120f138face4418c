/* The numbers of constants.def, by their names. */
#ifndef TOSUI_COMMON_CONSTANTS_H
#define TOSUI_COMMON_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#define WHOLE CONSTANT_WHOLE
#include "common/constants.def"
#undef CONSTANT
#undef WHOLE

extern const struct constant common_constants[]; /* ended by a row without a name */

#endif
