#include "common/constants.h"

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
const struct constant common_constants[] = {
#include "common/constants.def"
    {0}};
