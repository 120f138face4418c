#include "sphsolve/methods/stokes_rows.h"

#define STOKES_ROWS_TABLE stokes_rows_avx2
#define STOKES_ROWS_NAME "avx2"
#include "sphsolve/methods/stokes_rows_body.h"
