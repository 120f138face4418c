/* The numbers of constants.def, by their names. */
#ifndef TOSUI_SPHSOLVE_DARCY_CONSTANTS_H
#define TOSUI_SPHSOLVE_DARCY_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#define WHOLE CONSTANT_WHOLE
#include "sphsolve/darcy/constants.def"
#undef CONSTANT
#undef WHOLE

extern const struct constant richards_constants[]; /* ended by a row without a name */

#endif
