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

/* A ball in an STL file of meridians and parallels, of radius r m round (.05, .05, .05) m; returns
 * its volume over that of the box of .1 m. */
static double write_ball(const char *path, double r) {
  enum { N = 24 };
  FILE *file = fopen(path, "w");
  double at[N + 1][2 * N][3], volume = 0;
  if (file == NULL) exit(1);
  fprintf(file, "solid ball\n");
  for (int k = 0; k <= N; k++)
    for (int i = 0; i < 2 * N; i++) {
      const double flat = k % N == 0 ? 0 : r * sin(M_PI * k / N);
      at[k][i][0] = flat * cos(M_PI * i / N), at[k][i][1] = flat * sin(M_PI * i / N);
      at[k][i][2] = r * cos(M_PI * k / N);
    }
  for (int t = 0; t < 4 * N * N; t++) {
    const int k = t / (4 * N), i = t / 2 % (2 * N), j = (i + 1) % (2 * N), low = t % 2;
    const double *c[3] = {at[k][low ? j : i], at[k + 1][i], low ? at[k + 1][j] : at[k][j]};
    if (low ? k == N - 1 : k == 0) continue;
    fprintf(file, "facet normal 0 0 0\nouter loop\n");
    for (int m = 0; m < 3; m++)
      fprintf(file, "vertex %.17g %.17g %.17g\n", .05 + c[m][0], .05 + c[m][1], .05 + c[m][2]);
    fprintf(file, "endloop\nendfacet\n");
    for (int a = 0; a < 3; a++)
      volume += c[0][a] / 6 *
                (c[1][(a + 1) % 3] * c[2][(a + 2) % 3] - c[1][(a + 2) % 3] * c[2][(a + 1) % 3]);
  }
  fprintf(file, "endsolid ball\n");
  fclose(file);
  return fabs(volume) / 1e-3;
}

/* Balls in a cubic lattice, s times as permeable as what is between (Rayleigh 1892, Phil. Mag. 34,
 * 481, with Runge's 1.569): k = k_1 [ 1 + 3 phi / ((s + 2)/(s - 1) - phi - 1.569 (s - 1)/(s + 4/3)
 * phi^(10/3)) ] */
static void balls(void) {
  char path[] = "/tmp/verify_ball_XXXXXX";
  const int handle = mkstemp(path);
  if (handle < 0) exit(1);
  close(handle);
  const double phi = write_ball(path, .04), s = 5;
  const double exact =
      1e-4 *
      (1 +
       3 * phi / ((s + 2) / (s - 1) - phi - 1.569 * (s - 1) / (s + 4. / 3) * pow(phi, 10. / 3)));
  for (int fine = 0; fine < 2; fine++) {
    const double started = clock_seconds(), dx = fine ? .005 : .01;
    struct run run = {0};
    double v[3];
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
          "domain = { size = [\"0.1 m\", \"0.1 m\", \"0.1 m\"]; spacing = \"%g m\"; periodic = "
          "[true, true, true]; };\n"
          "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0\", \"0.1 m\", \"0.1 m\", "
          "\"0.1 m\"]; porosity = 0.4; permeability = \"1e-4 m/s\"; },\n"
          "{ type = \"porous\"; stl = \"%s\"; stl_unit = \"1 m\"; porosity = 0.4; permeability = "
          "\"5e-4 m/s\"; } );\n"
          "force = { body_acceleration = [\"9.80665 m/s^2\", \"0\", \"0\"]; };\n",
          dx, path);
    advance(&run, 0.02);
    isph_darcy_velocity(&run.s, v);
    snprintf(name, sizeof name, "balls from an STL file in a cubic lattice, %g mm", 1e3 * dx);
    report(name, exact, v[0], (fine ? .008 : .02) * exact, started);
    finish(&run);
  }
  unlink(path);
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {
      {"layers", layers}, {"discs", discs}, {"balls", balls}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
