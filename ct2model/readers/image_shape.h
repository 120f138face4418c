/* Which axes of an array are x, y and z. */
#ifndef TOSUI_CT2MODEL_READERS_IMAGE_SHAPE_H
#define TOSUI_CT2MODEL_READERS_IMAGE_SHAPE_H

#include <stdbool.h>
#include <stddef.h>

/* Most axes of an array. */
enum { AXES_MOST = 16 };

/* Chooses those of the `count` axes of n (fastest first) that are x, y and z; axis[2] is -1 for one
 * slice. Axes of one beyond three, of channels or times, are left out, the slowest first. False if
 * fewer than two axes or more than three of several pixels are there. */
bool image_choose_axes(const size_t *n, int count, int axis[3]);

/* Whether a text names axes in another order than z, y, x (fastest_first: x, y, z), as "x:y:z" or
 * "XYZ"; words of other letters are passed over. order: the names, as they stand. */
bool image_names_other_order(const char *text, bool fastest_first, char order[4]);

/* Whether a matrix, a text of numbers row by row, turns or mirrors the axes. */
bool image_is_turn(const char *matrix, int dimensions);

#endif
