/* The pair loops for avx2. */
#include "sphsolve/wcsph/engine/pairs_body.h"
