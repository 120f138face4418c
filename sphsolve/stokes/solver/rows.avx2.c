#include "sphsolve/stokes/solver/rows.h"

#define STOKES_ROWS_TABLE stokes_rows_avx2
#define STOKES_ROWS_NAME "avx2"
#include "sphsolve/stokes/solver/rows_body.h"
