/* The pair loops for avx512. */
#include "sphsolve/wcsph/engine/pairs_body.h"
