#include "sphsolve/wcsph/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant wcsph_constants[] = {
#include "sphsolve/wcsph/constants.def"
    {0}};
