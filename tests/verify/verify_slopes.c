/* Regions that are no boxes, by method isph against exact solutions. Usage: verify_slopes
 * RESULTS.json [CASE...]     all cases, or those whose names start with CASE */
#include "tests/verify/isph_rig.h"

/* 1/s of linear drag, alpha = 1000 in water. */
static double drag(double porosity, double grain) {
  return 1e-3 * pow(1 - porosity, 2) / (pow(porosity, 3) * grain * grain);
}

#define GRAIN 5e-4

/* Mean v_D over the second half of 2 s of a periodic box of porosity .5 with `more` regions, driven
 * along x by 2 m/s^2. */
static void flow_through(double width, double height, double dx, const char *more, double mean[3]) {
  struct run run = {0};
  double v[3];
  int n = 0;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"2 s\"; };\n"
      "domain = { size = [\"%g m\", \"%g m\"]; spacing = \"%g m\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"%g m\", \"%g m\"]; porosity = 0.5; "
      "grain_size = \"%g m\"; beta = 0.0; }%s );\n"
      "force = { body_acceleration = [\"2 m/s^2\", \"0\"]; };\n",
      width, height, dx, width, height, GRAIN, more);
  for (int a = 0; a < 3; a++) mean[a] = 0;
  advance(&run, 1);
  for (; n < 10; n++) {
    advance(&run, 1 + 0.1 * (n + 1));
    isph_darcy_velocity(&run.s, v);
    for (int a = 0; a < 3; a++) mean[a] += 0.1 * v[a];
  }
  finish(&run);
}

/* Layers of porosity .5 and .3, equally thick, that rise by 1 in 2: k = k_a t t + k_h n n, along
 * them the mean k_a, across them the harmonic mean k_h (Wiener 1912). The force along x then makes
 * a velocity along z too. */
static void layers(void) {
  const double k5 = 1 / drag(.5, GRAIN), k3 = 1 / drag(.3, GRAIN);
  const double along = .5 * (k5 + k3), across = 2 * k5 * k3 / (k5 + k3);
  const double exact[2] = {2 * (.8 * along + .2 * across), 2 * .4 * (along - across)};
  for (int fine = 0; fine < 2; fine++) {
    const double started = clock_seconds(), dx = fine ? .005 : .01;
    double v[3];
    char more[1000], name[96];
    snprintf(more, sizeof more,
             ", { type = \"porous\"; corners = [\"0\", \"0\", \"0.4 m\", \"0.2 m\", \"0.2 m\", "
             "\"0.2 m\", \"0\", \"0.1 m\"]; porosity = 0.3; grain_size = \"%g m\"; beta = 0.0; },\n"
             "{ type = \"porous\"; corners = [\"0.2 m\", \"0\", \"0.4 m\", \"0\", \"0.4 m\", \"0.1 "
             "m\"]; porosity = 0.3; grain_size = \"%g m\"; beta = 0.0; }",
             GRAIN, GRAIN);
    flow_through(.4, .2, dx, more, v);
    snprintf(name, sizeof name, "layers that rise by 1 in 2: v along the force, spacing %g mm",
             1e3 * dx);
    report(name, exact[0], v[0], (fine ? .015 : .03) * exact[0], started);
    snprintf(name, sizeof name, "layers that rise by 1 in 2: v across the force, spacing %g mm",
             1e3 * dx);
    report(name, exact[1], v[2], (fine ? .015 : .03) * exact[0], started);
  }
}

/* A disc of porosity .3, radius .3 of the box, in porosity .5, repeated on a square lattice:
 * Rayleigh (1892, Phil. Mag. 34, 481), with phi the disc's share and b = (k3 - k5)/(k3 + k5), k =
 * k5 [ 1 + 2 b phi / (1 - b phi - .305827 b^2 phi^4) ] */
static void discs(void) {
  const double k5 = 1 / drag(.5, GRAIN), k3 = 1 / drag(.3, GRAIN);
  const double phi = M_PI * .09, b = (k3 - k5) / (k3 + k5);
  const double exact = 2 * k5 * (1 + 2 * b * phi / (1 - b * phi - .305827 * b * b * pow(phi, 4)));
  for (int fine = 0; fine < 2; fine++) {
    const double started = clock_seconds(), dx = fine ? .005 : .01;
    double v[3];
    char more[500], name[96];
    snprintf(
        more, sizeof more,
        ", { type = \"porous\"; centre = [\"0.1 m\", \"0.1 m\"]; radius = \"0.06 m\"; porosity "
        "= 0.3; grain_size = \"%g m\"; beta = 0.0; }",
        GRAIN);
    flow_through(.2, .2, dx, more, v);
    snprintf(name, sizeof name, "discs on a square lattice, spacing %g mm", 1e3 * dx);
    report(name, exact, v[0], (fine ? .015 : .03) * exact, started);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"layers", layers}, {"discs", discs}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
