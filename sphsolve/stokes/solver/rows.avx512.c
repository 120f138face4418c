#include "sphsolve/stokes/solver/rows.h"

#define STOKES_ROWS_TABLE stokes_rows_avx512
#define STOKES_ROWS_NAME "avx512"
#include "sphsolve/stokes/solver/rows_body.h"
