#include "sphsolve/solute/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant solute_constants[] = {
#include "sphsolve/solute/constants.def"
    {0}};
