/* What verify_darcy and verify_seepage share: Darcy velocities of soil with a grain size, and soils
 * side by side. */
#ifndef TOSUI_TESTS_VERIFY_SOILS_H
#define TOSUI_TESTS_VERIFY_SOILS_H

#include <math.h>
#include <stdio.h>

/* Darcy velocity of soil under a driving acceleration f: a v + b v^2 = f. */
static inline double through(double a, double b, double f) {
  return 2 * f / (a + sqrt(a * a + 4 * b * f));
}
static inline double drag_a(double eps, double grain) {
  return 1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * grain * grain);
}
static inline double drag_b(double eps, double grain) {
  return 1.1 * (1 - eps) / (pow(eps, 3) * grain);
}

enum side_by_side { ALONG_LAYERS, ACROSS, OBLIQUE, CHECKERBOARD };

/* Regions of porosity .5, and .3 over them, in a periodic box of .2 m; layers are `thick` m. */
static inline void write_soils(char *text, size_t room, enum side_by_side kind, double thick,
                               double dx, double grain) {
  int n = snprintf(text, room,
                   "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.2 m\"]; porosity = "
                   "0.5; grain_size = \"%g m\"; }",
                   grain);
  const double rows = kind == OBLIQUE ? round(.2 / dx) : .1 / thick;
  for (int k = 0; k < (kind == CHECKERBOARD ? 2 : (int)round(rows)); k++) {
    double box[4] = {0, 2 * k * thick, .2, (2 * k + 1) * thick}; /* along */
    if (kind == ACROSS) box[0] = box[1], box[2] = box[3], box[1] = 0, box[3] = .2;
    if (kind == CHECKERBOARD) box[0] = box[1] = .1 * k, box[2] = box[3] = .1 * (k + 1);
    /* Stairs of a spacing, at 45 degrees, .1 m long along x: in two parts past the side. */
    if (kind == OBLIQUE)
      box[0] = k * dx, box[1] = k * dx, box[2] = k * dx + .1, box[3] = (k + 1) * dx;
    for (int part = 0; part < 2; part++, box[0] = 0, box[2] -= .2) {
      if (part == 1 && box[2] < 1e-9) break;
      n += snprintf(
          text + n, room - (size_t)n,
          ",\n{ type = \"porous\"; box = [\"%.9g m\", \"%.9g m\", \"%.9g m\", \"%.9g m\"]; "
          "porosity = 0.3; grain_size = \"%g m\"; }",
          box[0], box[1], fmin(box[2], .2), box[3], grain);
    }
  }
}

/* Darcy velocity of these soils under a driving acceleration f: along layers each flows by itself,
 * across them resistances add, at 45 degrees along the layers it is as along, and a checkerboard of
 * linear drag has the geometric mean (Keller 1964). */
static inline double through_soils(enum side_by_side kind, double grain, double f) {
  const double a5 = drag_a(.5, grain), b5 = drag_b(.5, grain);
  const double a3 = drag_a(.3, grain), b3 = drag_b(.3, grain);
  if (kind == ACROSS) return through(.5 * (a5 + a3), .5 * (b5 + b3), f);
  if (kind == CHECKERBOARD) return sqrt(through(a5, b5, f) * through(a3, b3, f));
  return .5 * (through(a5, b5, f) + through(a3, b3, f));
}

#endif
