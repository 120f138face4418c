/* The numbers of constants.def, by their names. */
#ifndef TOSUI_SPHSOLVE_WCSPH_CONSTANTS_H
#define TOSUI_SPHSOLVE_WCSPH_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#define WHOLE CONSTANT_WHOLE
#include "sphsolve/wcsph/constants.def"
#undef CONSTANT
#undef WHOLE

extern const struct constant wcsph_constants[]; /* ended by a row without a name */

#endif
