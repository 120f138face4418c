/* Reads a closed surface of triangles from an STL file, binary or ASCII. */
#ifndef TOSUI_SPHSOLVE_SCENE_STL_H
#define TOSUI_SPHSOLVE_SCENE_STL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Triangles by the columns along an axis that they reach into, `width` wide along the other two. */
struct stl_columns {
  double width;
  size_t size[2];     /* along the next axis, and the one after */
  size_t *start;      /* [size[0] * size[1] + 1] */
  uint32_t *triangle; /* those of column c are start[c] to start[c + 1] */
};

struct stl {
  size_t count;           /* triangles */
  double (*corner)[3][3]; /* m */
  double extent[6];       /* x0 y0 z0 x1 y1 z1, m */
  struct stl_columns columns[3];
};

/* `unit`: metres per unit of length in the file, which STL does not define. The file may contain
 * any bytes: STATUS_INPUT with the reason if it is no STL file, contains invalid numbers, or does
 * not enclose a volume because an edge belongs to an odd number of triangles. The orientation of
 * the triangles does not matter. Free with stl_free, also after a failure. */
enum status stl_read(const char *path, double unit, struct stl *stl);
void stl_free(struct stl *stl);

/* The section of a triangle by the plane where coordinate `up` is v, in the coordinates `run` and
 * `across`; false if it has none. Triangles that share an edge have the same end there, to the last
 * bit. */
bool stl_section(double corner[3][3], int run, int across, int up, double v, double end[2][2]);
/* Sorts triangles for stl_scan, into columns of this width, m, or less: as many columns as
 * triangles, about. */
enum status stl_sort(struct stl *stl, double width);
/* Where the line through x along an axis crosses the surface, `most` times at most, sorted; returns
 * how often. */
size_t stl_scan(const struct stl *stl, int axis, const double x[3], double *at, size_t most);
/* Whether any triangle may be in the box from..to, m: false only if none is. */
bool stl_may_meet(const struct stl *stl, const double from[3], const double to[3]);

#endif
