/* Reads a closed surface of triangles from an STL file, binary or ASCII. */
#ifndef TOSUI_SPHSOLVE_SCENE_STL_H
#define TOSUI_SPHSOLVE_SCENE_STL_H

#include <stddef.h>

#include "common/error.h"

struct stl {
  size_t count;           /* triangles */
  double (*corner)[3][3]; /* m */
  double extent[6];       /* x0 y0 z0 x1 y1 z1, m */
};

/* `unit`: metres per unit of length in the file, which STL does not define. The file may contain
 * any bytes: STATUS_INPUT with the reason if it is no STL file, contains invalid numbers, or does
 * not enclose a volume because an edge belongs to an odd number of triangles. The orientation of
 * the triangles does not matter. Free with stl_free, also after a failure. */
enum status stl_read(const char *path, double unit, struct stl *stl);
void stl_free(struct stl *stl);

#endif
