/* A sparse matrix in compressed rows, and the solution of its equations by BiCGStab (van der Vorst
 * 1992) with an incomplete factorisation without fill-in as preconditioner (Meijerink, van der
 * Vorst 1977). Dropped fill-in is added to the diagonal of its column, all but 2 % (modified
 * ILU(0), Gustafsson 1978): a column's sum is the water that a change of its head takes, and is
 * preserved in this way. Without that the iterations grow as 1/spacing, with it as its square root.
 * The factorisation is exact for the tridiagonal matrix of a column of soil. The pattern is
 * symmetric. Sums have a fixed order: results do not depend on the number of threads. */
#ifndef TOSUI_SPHSOLVE_DARCY_ROWS_H
#define TOSUI_SPHSOLVE_DARCY_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct rows {
  size_t count;
  size_t *start;     /* [count + 1]: first entry of each row */
  size_t *diagonal;  /* [count] */
  uint32_t *column;  /* of each entry, increasing in each row */
  double *value;     /* of the matrix */
  double *factor;    /* L (unit diagonal) below the diagonal, U elsewhere */
  double *vector[7]; /* [count] */
};

/* Allocates `count` rows with `entries` entries in all; start, diagonal and column are to be filled
 * by the caller. Free with rows_free. */
enum status rows_allocate(size_t count, size_t entries, struct rows *rows);
void rows_free(struct rows *rows);
/* Index of the entry of a row and column; the end of the row if there is none. */
size_t rows_entry(const struct rows *rows, size_t row, size_t column);
/* With the given share of dropped fill-in added to the diagonal: solves A x = b to a residual of
 * `tolerance` times the norm of b; adds the number of iterations to *iterations. Returns false if
 * it does not converge. */
bool rows_solve(struct rows *rows, double share, const double *b, double tolerance, double *x,
                int64_t *iterations);

#endif
