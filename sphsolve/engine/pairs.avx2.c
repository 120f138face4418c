/* The pair loops for avx2. */
#include "sphsolve/engine/pairs_body.h"
