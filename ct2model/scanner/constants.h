/* The numbers of constants.def, by their names, and how weights and minima follow from numbers. */
#ifndef TOSUI_CT2MODEL_SCANNER_CONSTANTS_H
#define TOSUI_CT2MODEL_SCANNER_CONSTANTS_H

#include <math.h>

#include "common/constant.h"

#define CONSTANT CONSTANT_VALUE
#define WHOLE CONSTANT_WHOLE
#include "ct2model/scanner/constants.def"
#undef CONSTANT
#undef WHOLE

/* A weight: 0 up to `from`, 1 from `to` on, linear between; 0 where `value` is not finite. */
static inline double ramp(double value, double from, double to) {
  return isfinite(value) ? fmin(fmax((value - from) / (to - from), 0.0), 1.0) : 0.0;
}

/* Where the parabola through three values, a step apart, has its minimum: steps from the middle. */
static inline double parabola_minimum(double last, double middle, double next) {
  return 0.5 * (last - next) / (last - middle + next - middle);
}

#endif
