#include "ct2model/readers/length_unit.h"

#include <math.h>
#include <stddef.h>
#include <strings.h>

double length_unit(const char *unit) {
  static const struct {
    const char *name;
    double metres;
  } UNITS[] = {
      {"micron", 1e-6},
      {"microns", 1e-6},
      {"um", 1e-6},
      {"\\u00B5m", 1e-6},
      {"\xC2\xB5m", 1e-6},
      {"\xCE\xBCm", 1e-6},
      {"\xB5m", 1e-6},
      {"&#181;m", 1e-6},
      {"&#xB5;m", 1e-6},
      {"micrometer", 1e-6},
      {"micrometers", 1e-6},
      {"micrometre", 1e-6},
      {"micrometres", 1e-6},
      {"nm", 1e-9},
      {"nanometer", 1e-9},
      {"nanometre", 1e-9},
      {"mm", 1e-3},
      {"millimeter", 1e-3},
      {"millimetre", 1e-3},
      {"millimeters", 1e-3},
      {"millimetres", 1e-3},
      {"cm", 1e-2},
      {"centimeter", 1e-2},
      {"centimetre", 1e-2},
      {"m", 1.0},
      {"meter", 1.0},
      {"metre", 1.0},
      {"meters", 1.0},
      {"metres", 1.0},
      {"inch", 0.0254},
      {"inches", 0.0254},
      {"in", 0.0254},
  };
  for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++) {
    /* "Mm" and "M" are no millimetre and metre. */
    if (strcasecmp(unit, UNITS[i].name) == 0 &&
        (unit[0] != 'M' || unit[1] == 'i' || unit[1] == 'e'))
      return UNITS[i].metres;
  }
  return NAN;
}
