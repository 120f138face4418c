#include "sphsolve/stokes/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant stokes_constants[] = {
#include "sphsolve/stokes/constants.def"
    {0}};
