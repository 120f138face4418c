/* Gaussian filters and Laplacians of volumes of greys in memory, [z][y][x], repeated by reflection
 * at their ends. Each voxel is summed in one order: the same bits on any number of threads. */
#ifndef TOSUI_CT2MODEL_SCANNER_GAUSSIAN_H
#define TOSUI_CT2MODEL_SCANNER_GAUSSIAN_H

#include <stddef.h>

enum { GAUSSIAN_MOST = 64 };

/* sigma in voxels by axis (x, y, z); axes under 0.1 stay. `in` and `out` may be the same; `work` is
 * as large. */
void gaussian_filter(const float *in, const size_t size[3], const double sigma[3], float *work,
                     float *out);
/* out = in - sum over axes of weight[axis] times the second difference. */
void laplacian_subtract(const float *in, const size_t size[3], const double weight[3], float *out);
/* One row of that, y + ny z, into `out`. */
void laplacian_subtract_row(const float *in, const size_t size[3], const double weight[3],
                            size_t row, float *out);
/* The voxel of a row of n that stands at `at`, before, in or after the row. */
size_t gaussian_reflect(long at, size_t n);

#endif
