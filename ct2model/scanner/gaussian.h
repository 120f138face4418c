/* Gaussian filters and Laplacians of volumes of greys in memory, [z][y][x], extended by reflection
 * at their ends. Each voxel is summed in a fixed order: the result is bit-identical for any number
 * of threads. */
#ifndef TOSUI_CT2MODEL_SCANNER_GAUSSIAN_H
#define TOSUI_CT2MODEL_SCANNER_GAUSSIAN_H

#include <stddef.h>

/* Largest half width of a filter, in voxels. */
enum { GAUSSIAN_MOST = 64 };

/* Filters `in` into `out` with standard deviations `sigma` in voxels along x, y, z; axes with less
 * than 0.1 are not filtered. `in` and `out` may be the same; `work` is as large as these. */
void gaussian_filter(const float *in, const size_t size[3], const double sigma[3], float *work,
                     float *out);
/* out = in - sum over axes of weight[axis] times the second difference along the axis. */
void laplacian_subtract(const float *in, const size_t size[3], const double weight[3], float *out);
/* Both: `in` filtered, then laplacian_subtract, into `out`; `finish` is called with the number
 * y + ny z and the values of each row. `in` is overwritten; `work` is as large. All is done while
 * it is in the cache, as memory bandwidth limits the speed. */
void gaussian_sharpen(float *in, const size_t size[3], const double sigma[3],
                      const double weight[3], float *work, float *out,
                      void (*finish)(const void *context, size_t row, float *out),
                      const void *context);
/* The same as laplacian_subtract for one row, number y + ny z, into out[nx]. */
void laplacian_subtract_row(const float *in, const size_t size[3], const double weight[3],
                            size_t row, float *out);
/* Index of position `at`, which may lie outside, in a row of n voxels extended by reflection. */
size_t gaussian_reflect(long at, size_t n);

#endif
