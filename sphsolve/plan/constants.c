#include "sphsolve/plan/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant plan_constants[] = {
#include "sphsolve/plan/constants.def"
    {0}};
