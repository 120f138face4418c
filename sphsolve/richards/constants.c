#include "sphsolve/richards/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant richards_constants[] = {
#include "sphsolve/richards/constants.def"
    {0}};
