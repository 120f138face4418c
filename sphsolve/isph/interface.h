/* Where different soils touch, what resists flow across their interface and along it. */
#ifndef TOSUI_SPHSOLVE_ISPH_INTERFACE_H
#define TOSUI_SPHSOLVE_ISPH_INTERFACE_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"

/* A share of soil, its gradient (1/m) and second derivatives (xx xy xz yy yz zz, 1/m^2). */
struct isph_share {
  double value, slope[3], bend[6];
};
/* to += scale * share */
void isph_share_add(struct isph_share *to, double scale, const struct isph_share *share);

/* Sums over the soils at a place; start from {.least = INFINITY}. */
struct isph_meeting {
  double least, most;              /* drag of the soils here */
  double linear, forchheimer;      /* sum of w/a, w/sqrt(b) */
  struct isph_share share, level;  /* sum of w, w ln a */
};
/* A soil of linear drag a, 1/s, and Forchheimer's b, 1/m, with its share w here. */
void isph_meeting_add(struct isph_meeting *meeting, const struct isph_share *w, double a, double b);
/* From soil->a and b, the means across an interface: the means along it, and its normal (0 where
 * there is none). `smoothing`: h of the shares, m. */
void isph_meeting_split(const struct isph_meeting *meeting, double smoothing,
                        struct soil_point *soil);

#endif
