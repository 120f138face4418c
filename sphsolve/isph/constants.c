#include "sphsolve/isph/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant isph_constants[] = {
#include "sphsolve/isph/constants.def"
    {0}};
