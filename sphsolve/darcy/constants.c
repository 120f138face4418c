#include "sphsolve/darcy/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant richards_constants[] = {
#include "sphsolve/darcy/constants.def"
    {0}};
