/* The pair loops for any x86-64. */
#include "sphsolve/wcsph/engine/pairs_body.h"
