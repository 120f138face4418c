/* The pair loops for avx512. */
#include "sphsolve/engine/pairs_body.h"
