/* Operators exact for linear fields in soil. */
#ifndef TOSUI_SPHSOLVE_ISPH_MOMENT_H
#define TOSUI_SPHSOLVE_ISPH_MOMENT_H

#include "sphsolve/isph/state.h"

void isph_moment_inverse(int dimensions, const double m[6], double inverse[9]);
/* C of particle i, from its second moment and the one-sidedness of its neighbours (front.h) */
void isph_moment_defect(struct isph *s, size_t i, const double moment[6], double one_sided);
/* Multiplies the slope of each pair by its factor, from the C of both particles. */
void isph_moment_correct(struct isph *s);

#endif
