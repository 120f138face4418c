/* Soil in beds, whose permeability is a tensor, by method isph against exact solutions and finite
 * elements. Usage: verify_anisotropy RESULTS.json [CASE...]     all cases, or those whose names
 * start with CASE */
#include "sphsolve/isph/permeameter.h"
#include "tests/verify/isph_rig.h"

#define GRAVITY 9.80665
#define ALONG 1e-3 /* m/s, along the beds */

/* K of beds that fall by `angle` towards +x: xx, xz, zz. */
static void tensor(double angle, double across, double k[3]) {
  const double c = cos(angle), s = -sin(angle);
  k[0] = ALONG * c * c + across * s * s, k[1] = (ALONG - across) * c * s;
  k[2] = ALONG * s * s + across * c * c;
}

static const char *beds(double angle, double across) {
  static char text[200];
  snprintf(text, sizeof text,
           "porosity = 0.4; permeability = [\"%.9g m/s\", \"%.9g m/s\"]; bedding = [%.9f, %.9f];",
           ALONG, across, cos(angle), -sin(angle));
  return text;
}

/* Between two walls the flow is along them, whatever the beds would: k = 1/(1/K)_xx. */
static void between_walls(void) {
  static const struct {
    double degrees, ratio, dx, bound;
  } table[] = {{26.565, 10, .01, .005}, {26.565, 10, .005, .003}, {26.565, 10, .0025, .002},
               {10, 10, .01, .01},      {45, 10, .01, .01},       {75, 10, .01, .01},
               {22.5, 30, .01, .05},    {60, 30, .01, .05},       {75, 30, .01, .05}};
  for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
    const double angle = table[n].degrees * M_PI / 180, across = ALONG / table[n].ratio;
    const double started = clock_seconds(), s = sin(angle);
    const double exact = 1 / ((1 - s * s) / ALONG + s * s / across);
    struct run run = {0};
    double v[3];
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
          "domain = { size = [\"0.3 m\", \"0.2 m\"]; spacing = \"%g m\"; periodic = [true, false]; "
          "};\n"
          "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.3 m\", \"0.2 m\"]; %s } );\n"
          "force = { body_acceleration = [\"9.80665 m/s^2\", \"0\"]; };\n"
          "isph = { wall = { slip = true; }; };\n",
          table[n].dx, beds(angle, across));
    advance(&run, 0.2);
    isph_darcy_velocity(&run.s, v);
    snprintf(name, sizeof name, "beds at %.3g degrees, %g : 1, between walls, %g mm",
             table[n].degrees, table[n].ratio, 1e3 * table[n].dx);
    report(name, exact, v[0], table[n].bound * exact, started);
    finish(&run);
  }
}

/* Layers of beds and of soil of one permeability, equally thick: they share the gradient along the
 * interface and the flux across it,
 *   across 1/<1/K_zz>, and with it along x <K_xz/K_zz> times that. */
static void layers(void) {
  const double angle = 26.565 * M_PI / 180, other = 5e-4;
  for (int fine = 0; fine < 2; fine++)
    for (int along = 0; along < 2; along++) {
      const double started = clock_seconds(), dx = fine ? .005 : .01;
      double k[3], v[3];
      struct run run = {0};
      char name[96];
      tensor(angle, ALONG / 10, k);
      const double across = 2 / (1 / other + 1 / k[2]), turn = .5 * k[1] / k[2];
      const double flat = .5 * other + .5 * (k[0] - k[1] * k[1] / k[2]) + turn * turn * across;
      start(&run,
            "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
            "domain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = \"%g m\"; periodic = [true, "
            "true]; };\n"
            "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.2 m\"]; porosity "
            "= 0.4; permeability = \"%g m/s\"; },\n"
            "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; %s } );\n"
            "force = { body_acceleration = [\"%g m/s^2\", \"%g m/s^2\"]; };\n",
            dx, other, beds(angle, ALONG / 10), along ? GRAVITY : 0, along ? 0 : GRAVITY);
      advance(&run, 0.3);
      isph_darcy_velocity(&run.s, v);
      snprintf(name, sizeof name, "layers, one of beds at 27 degrees: %s, %g mm",
               along ? "v along" : "v across", 1e3 * dx);
      report(name, along ? flat : across, along ? v[0] : v[2], .01 * (along ? flat : across),
             started);
      snprintf(name, sizeof name, "layers, one of beds at 27 degrees: %s, %g mm",
               along ? "v across, driven along" : "v along, driven across", 1e3 * dx);
      report(name, turn * across, along ? v[2] : v[0], .02 * fabs(turn * across), started);
      finish(&run);
    }
}

/* The ground under a sheet pile: .6 m wide, .2 m deep, the pile .04 m thick and .1 m deep. Bilinear
 * finite elements of side .01/n m between heads .1 m apart; returns the flow per width by its
 * energy, integral of grad h.K.grad h / .1, m^2/s. */
static double elements(int n, const double k[3]) {
  const int nx = 60 * n, nz = 20 * n, nodes = (nx + 1) * (nz + 1);
  static const double gauss[2] = {.21132486540518712, .78867513459481288};
  double stiff[4][4] = {{0}}, *x = calloc(4 * (size_t)nodes, sizeof *x), rr = 0, energy = 0;
  double *r = x + nodes, *p = r + nodes, *q = p + nodes;
  for (int g = 0; g < 4; g++) {
    const double u = gauss[g % 2], w = gauss[g / 2];
    const double dx[4] = {w - 1, 1 - w, -w, w}, dz[4] = {u - 1, -u, 1 - u, u};
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++)
        stiff[a][b] += .25 * (k[0] * dx[a] * dx[b] + k[1] * (dx[a] * dz[b] + dz[a] * dx[b]) +
                              k[2] * dz[a] * dz[b]);
  }
  for (int i = 0; i < 28 * n + 1; i++) x[nz * (nx + 1) + i] = .1;
  for (int round = 0; round < 20000; round++) {
    double *from = round == 0 ? x : p, pq = 0, next = 0;
    memset(q, 0, (size_t)nodes * sizeof *q);
    for (int e = 0; e < nx * nz; e++) {
      const int i = e % nx, j = e / nx, low = j * (nx + 1) + i;
      const int node[4] = {low, low + 1, low + nx + 1, low + nx + 2};
      if (i >= 28 * n && i < 32 * n && j >= 10 * n) continue;
      for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++) q[node[a]] += stiff[a][b] * from[node[b]];
    }
    if (round > 0)
      for (int m = 0; m < nz * (nx + 1); m++) pq += p[m] * q[m];
    for (int m = 0; m < nz * (nx + 1); m++) { /* the last row of nodes is given */
      if (round == 0)
        r[m] = -q[m], p[m] = r[m];
      else
        x[m] += rr / pq * p[m], r[m] -= rr / pq * q[m];
      next += r[m] * r[m];
    }
    if (round > 0)
      for (int m = 0; m < nz * (nx + 1); m++) p[m] = r[m] + next / rr * p[m];
    rr = next;
    if (!(rr > 1e-30)) break;
  }
  memset(q, 0, (size_t)nodes * sizeof *q);
  for (int e = 0; e < nx * nz; e++) {
    const int i = e % nx, j = e / nx, low = j * (nx + 1) + i;
    const int node[4] = {low, low + 1, low + nx + 1, low + nx + 2};
    if (i >= 28 * n && i < 32 * n && j >= 10 * n) continue;
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++) energy += stiff[a][b] * x[node[a]] * x[node[b]];
  }
  free(x);
  return energy / .1;
}

/* Flow under the pile. With level beds it is that of soil of one permeability, the depth stretched
 * by the root of the ratio. */
static void pile(void) {
  static const double angles[] = {0, 30, -60};
  for (int n = 0; n < 9; n++) {
    const double dx = n / 3 == 0   ? .01
                      : n / 3 == 1 ? .005
                                   : .0025,
                 angle = angles[n % 3] * M_PI / 180;
    const double started = clock_seconds();
    struct run run = {0};
    double k[3], flux = 0;
    char name[96];
    tensor(angle, ALONG / 10, k);
    /* The error at corners of 270 degrees fades with h^(4/3). */
    const double coarse = elements(2, k), finer = elements(4, k);
    const double exact = finer + (finer - coarse) / (pow(2, 4. / 3) - 1);
    start(
        &run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"0.6 m\", \"0.3 m\"]; spacing = \"%g m\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.6 m\", \"0.3 m\"]; },\n"
        "{ type = \"porous\"; box = [\"0\", \"0\", \"0.6 m\", \"0.2 m\"]; %s },\n"
        "{ type = \"wall\"; box = [\"0.28 m\", \"0.1 m\", \"0.32 m\", \"0.3 m\"]; slip = true; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"%g m\", \"0.28 m\", \"0.3 m\"]; head = \"0.5 m\"; "
        "},\n"
        "{ type = \"inflow\"; box = [\"0.32 m\", \"%g m\", \"0.6 m\", \"0.3 m\"]; head = \"0.4 "
        "m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n"
        "isph = { wall = { slip = true; }; };\n",
        dx, beds(angle, ALONG / 10), .3 - dx, .3 - dx);
    advance(&run, .5); /* at the finest spacing flow goes on to rise by 1 % for .4 s */
    for (int m = 1; m <= 10; m++) {
      advance(&run, .5 + .02 * m);
      flux += .1 * isph_plane_flux(&run.s, 0, .3) / run.scene.spacing;
    }
    snprintf(name, sizeof name, "sheet pile in beds at %g degrees, 10 : 1, %g mm", angles[n % 3],
             1e3 * dx);
    report(name, exact, flux, (n < 3 ? .12 : .03) * exact, started);
    finish(&run);
  }
}

/* A dam with upright faces: k_x (h1^2 - h2^2)/(2 L) (Charny 1951) asks for no k_z, as the flow
 * through any upright section is k_x times the integral of dh/dx over it. */
static void dam(void) {
  static const double up[] = {1e-2, 1e-1, 1};
  for (int n = 0; n < 3; n++) {
    const double started = clock_seconds(), exact = .1 * (1 - .16) / 2;
    struct run run = {0};
    double flux = 0;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"40 s\"; };\n"
          "domain = { size = [\"2 m\", \"1.2 m\"]; spacing = \"5 cm\"; periodic = [false, false]; "
          "};\n"
          "regions = ( { type = \"porous\"; box = [\"0.5 m\", \"0\", \"1.5 m\", \"1.2 m\"]; "
          "porosity = 0.4; permeability = [\"0.1 m/s\", \"%g m/s\"]; },\n"
          "{ type = \"water\"; box = [\"0\", \"0\", \"0.5 m\", \"1 m\"]; }, { type = \"water\"; "
          "box = [\"0.5 m\", \"0\", \"1.5 m\", \"0.75 m\"]; },\n"
          "{ type = \"water\"; box = [\"1.5 m\", \"0\", \"2 m\", \"0.4 m\"]; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"5 cm\", \"1.2 m\"]; head = \"1 m\"; },\n"
          "{ type = \"inflow\"; box = [\"1.95 m\", \"0\", \"2 m\", \"1.2 m\"]; head = \"0.4 m\"; } "
          ");\n"
          "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n",
          up[n]);
    advance(&run, 15);
    for (int m = 1; m <= 200; m++) {
      advance(&run, 15 + .1 * m);
      flux += .005 * isph_plane_flux(&run.s, 0, 1) / run.scene.spacing;
    }
    snprintf(name, sizeof name, "dam with upright faces, k_x/k_z %g: flow, 50 mm", .1 / up[n]);
    report(name, exact, flux, .05 * exact, started);
    finish(&run);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {
      {"walls", between_walls}, {"layers", layers}, {"pile", pile}, {"dam", dam}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
