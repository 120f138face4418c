/* Which points a wall hides from each other. */
#ifndef TOSUI_SPHSOLVE_ISPH_SIGHT_H
#define TOSUI_SPHSOLVE_ISPH_SIGHT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/state.h"

/* Most walls near a group of particles; of polygons and bodies each row of sites is one. */
#define SCREENS_MOST 1024

/* Walls that may be between some particles, as seen from there. */
struct isph_screens {
  size_t count;
  struct isph_screen {
    struct isph_box box; /* grown by a trace, so that walls that touch leave nothing between them */
    const struct isph_wall_box *wall;
    const struct isph_image *image;
  } of[SCREENS_MOST];
};

/* Finds the walls nearer than `reach` to the box low..high. False if there are too many. */
bool isph_screens_find(const struct isph *s, const double low[3], const double high[3],
                       double reach, struct isph_screens *screens);
/* Whether one of them is between x and y, and the way around one edge of it is longer than `reach`
 * or meets another wall; the same to the bit for y and x. An outline hides nothing if x and y are
 * nearer to each other than `clear`. */
bool isph_is_hidden(const struct isph *s, const struct isph_screens *screens, const double x[3],
                    const double y[3], double reach, double clear);
/* The same for particle i, near whose group the walls are, and the neighbour of a pair entry; from
 * both it is the same to the bit, or the pressure matrix would not be symmetric. */
bool isph_pair_is_hidden(const struct isph *s, const struct isph_screens *screens, size_t i,
                         uint32_t entry, double reach, double clear);

#endif
