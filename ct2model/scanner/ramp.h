/* A weight that rises linearly between two values. */
#ifndef TOSUI_CT2MODEL_SCANNER_RAMP_H
#define TOSUI_CT2MODEL_SCANNER_RAMP_H

#include <math.h>

/* 0 up to `from`, 1 from `to` on; 0 where `value` is not finite. */
static inline double ramp(double value, double from, double to) {
  return isfinite(value) ? fmin(fmax((value - from) / (to - from), 0.0), 1.0) : 0.0;
}

#endif
