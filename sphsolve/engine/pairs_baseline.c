/* The pair loops for any x86-64. */
#include "sphsolve/engine/pairs_body.h"
