/* Reads a closed surface of triangles from an STL file, binary or ASCII. */
#ifndef TOSUI_SPHSOLVE_SCENE_STL_H
#define TOSUI_SPHSOLVE_SCENE_STL_H

#include <stddef.h>

#include "common/error.h"

struct stl {
  size_t count;           /* of triangles */
  double (*corner)[3][3]; /* m */
  double extent[6];       /* x0 y0 z0 x1 y1 z1, m */
};

/* `unit`: metres for each unit of length in the file, which STL does not tell. Any bytes may stand
 * in the file: what is no STL, has numbers that are none, or whose triangles enclose nothing
 * because some edge belongs to an odd number of them, is STATUS_INPUT with the reason. Which way
 * triangles face does not matter. Free with stl_free, also after a failure. */
enum status stl_read(const char *path, double unit, struct stl *stl);
void stl_free(struct stl *stl);

#endif
