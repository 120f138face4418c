/* A sparse matrix by rows, and the solution of its equations by BiCGStab (van der Vorst 1992)
 * before an incomplete factorisation without fill-in (Meijerink, van der Vorst 1977). What has no
 * place in it goes to the diagonal of its column, all but 2 % (modified ILU(0), Gustafsson 1978):
 * a column's sum is how much water a change of its head takes, and is kept so. Without that,
 * iterations grow as 1/spacing, with it as its root. Of the three diagonals of a column of soil it
 * is exact. The pattern is symmetric. All in one order: the bits do not depend on the number of
 * threads. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_ROWS_H
#define TOSUI_SPHSOLVE_RICHARDS_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct rows {
  size_t count;
  size_t *start;     /* [count + 1] of each row among the entries */
  size_t *diagonal;  /* [count] */
  uint32_t *column;  /* rising in each row */
  double *value;     /* of the matrix */
  double *factor;    /* L below the diagonal, which is 1, else U */
  double *vector[7]; /* [count] */
};

/* Room for `count` rows with `entries` in all; start, diagonal and column are for the caller to
 * fill. */
enum status rows_allocate(size_t count, size_t entries, struct rows *rows);
void rows_free(struct rows *rows);
/* x of A x = b until the residual is `tolerance` of b; iterations are added up. False where it is
 * not found. */
bool rows_solve(struct rows *rows, const double *b, double tolerance, double *x,
                int64_t *iterations);

#endif
