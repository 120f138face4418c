/* Cells, by which points near a place are found. */
#ifndef TOSUI_SPHSOLVE_ISPH_CELLS_H
#define TOSUI_SPHSOLVE_ISPH_CELLS_H

#include "sphsolve/isph/state.h"

#define ISPH_CANDIDATES 16384 /* most candidates for the neighbours of a particle */
#define ISPH_STRETCHES 4096   /* most stretches of rows that they lie in */

/* Divides the domain, `margin` (m) wider, into cells. */
enum status isph_cells_shape(const struct isph *s, double margin, struct isph_cells *cells);
uint32_t isph_cell_of(const struct isph_cells *cells, const double x[3]);
/* Stable counting sort by cell: fills `order` with the old index of each new place. */
void isph_cells_sort(const struct isph_cells *cells, size_t n, const uint32_t *cell,
                     uint32_t *order);
/* Boundary particles keep their initial order, so that a resumed run adds up in the same order;
 * only the index of the cells is rebuilt when walls move. */
enum status isph_sort_walls(struct isph *s);
/* Points begin .. end of the order by cell, as seen in the image `code`. */
struct isph_stretch {
  uint32_t begin, end, code;
};
/* Collects the stretches of all points of `cells` that may lie closer than `reach` to the box low
 * .. high, and of some that do not: fewer than ISPH_STRETCHES, unless these or more than
 * ISPH_CANDIDATES points would not fit. */
size_t isph_cells_collect(const struct isph *s, const struct isph_cells *cells, const double low[3],
                          const double high[3], double reach, struct isph_stretch *found);
/* Kernel sum of water at a point within a support, and the mean velocity of that water. */
enum status isph_probe(const struct isph *s, const double x[3], double support, double *kernel_sum,
                       double velocity[3]);

#endif
