#include "ct2model/readers/image_shape.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool image_choose_axes(const size_t *n, int count, int axis[3]) {
  int kept[AXES_MOST], left = count;
  if (count < 2 || count > AXES_MOST) return false;
  for (int a = 0; a < count; a++) kept[a] = a;
  /* Leading and trailing axes first: those of channels and times are there, as in T C Z Y X or in
   * Z Y X C. */
  while (left > 3) {
    int drop = left - 1;
    if (n[kept[drop]] != 1) drop = 0;
    while (drop < left && n[kept[drop]] != 1) drop++;
    if (drop == left) return false;
    left--;
    for (int a = drop; a < left; a++) kept[a] = kept[a + 1];
  }
  for (int a = 0; a < 3; a++) axis[a] = a < left ? kept[a] : -1;
  return true;
}

bool image_names_other_order(const char *text, bool fastest_first, char order[4]) {
  static const char BETWEEN[] = " :,;[](){}\"'";
  size_t count = 0;
  for (const char *at = text; *at != '\0'; at += strspn(at, BETWEEN)) {
    const size_t length = strcspn(at, BETWEEN), known = strspn(at, "xyzXYZ");
    for (size_t k = 0; k < length && known == length && count < 3; k++)
      order[count++] = (char)tolower((unsigned char)at[k]);
    at += length;
  }
  order[count] = '\0';
  const char *usual = fastest_first ? "xyz" : count == 2 ? "yx" : "zyx";
  return count > 1 && strncmp(order, usual, count) != 0;
}

bool image_is_turn(const char *matrix, int dimensions) {
  for (int i = 0; i < dimensions * dimensions; i++) {
    char *end;
    const double value = strtod(matrix, &end);
    if (end == matrix) return false;
    if (fabs(value - (i % (dimensions + 1) == 0 ? 1.0 : 0.0)) > 1e-6) return true;
    matrix = end;
  }
  return false;
}
