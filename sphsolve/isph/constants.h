/* The numbers of constants.def, by their names. */
#ifndef TOSUI_SPHSOLVE_ISPH_CONSTANTS_H
#define TOSUI_SPHSOLVE_ISPH_CONSTANTS_H

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#define WHOLE CONSTANT_WHOLE
#include "sphsolve/isph/constants.def"
#undef CONSTANT
#undef WHOLE

extern const struct constant isph_constants[]; /* ended by a row without a name */

#endif
