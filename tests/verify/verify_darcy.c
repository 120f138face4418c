/* Soil that stays full of water by method darcy against exact solutions and finite elements. Usage:
 * verify_darcy RESULTS.json [CASE...]: all cases, or those whose names start with CASE. */
#include "tests/unit/richards_scene.h"
#include "tests/verify/rows.h"
#include "tests/verify/soils.h"

#define G 9.80665
#define ALONG 1e-3 /* m/s, along the beds */

/* Mean Darcy velocity along an axis. */
static double mean_velocity(const struct richards *s, int axis) {
  double sum = 0, v[3];
  for (size_t i = 0; i < s->count; i++) richards_flow(s, i, v), sum += v[axis];
  return sum / s->lattice->bulk_count;
}

/* Flow through all sides into the domain, m^2/s for each m along y. */
static double flow_in(const struct richards *s) {
  double sum = 0;
  for (size_t e = 0; e < s->edge_count; e++) sum += fmax(0, s->edge_flux[e].q);
  return sum * s->spacing;
}

/* Soil without ends: v_D = 2 g / (a + sqrt(a^2 + 4 b g)). */
static void columns(void) {
  static const double table[][2] = {{.3, 1e-2}, {.3, 1e-3}, {.3, 1e-4}, {.5, 1e-2}, {.8, 1e-2}};
  for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
    const double started = clock_seconds(), eps = table[k][0], grain = table[k][1];
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"60 s\"; };\ndomain = { size = [\"5 cm\", \"5 cm\", \"8 cm\"]; "
          "spacing = \"1 cm\"; periodic = [true, true, true]; };\nregions = ( { type = \"porous\"; "
          "box = [\"0\", \"0\", \"0\", \"5 cm\", \"5 cm\", \"8 cm\"]; porosity = %g; grain_size = "
          "\"%g m\"; } );\nforce = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\n",
          eps, grain);
    snprintf(name, sizeof name, "column: eps %g, D50 %g mm", eps, 1e3 * grain);
    report(name, through(drag_a(eps, grain), drag_b(eps, grain), 9.81), -mean_velocity(&run.s, 2),
           1e-8, passed(started));
    finish(&run);
  }
}

/* Two soils one after the other between heads, with walls along: the same v_D in both; a_1 v + b_1
 * v^2 and a_2 v + b_2 v^2 share the head. */
static void series(void) {
  struct run run;
  const double started = clock_seconds(), contact[3] = {.2, 0, .05};
  double a[2], b[2], eps[2] = {.4, .3};
  start(&run,
        "scene = { end_time = \"4 s\"; };\ndomain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = "
        "\"0.01 m\"; periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
        "\"0\", \"0.2 m\", \"0.1 m\"]; porosity = 0.4; grain_size = \"5 mm\"; },\n"
        "{ type = \"porous\"; box = [\"0.2 m\", \"0\", \"0.4 m\", \"0.1 m\"]; porosity = 0.3; "
        "grain_size = \"5 mm\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = \"0.4 m\"; },\n"
        "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; } "
        ");\nforce = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  for (int k = 0; k < 2; k++) a[k] = drag_a(eps[k], 5e-3), b[k] = drag_b(eps[k], 5e-3);
  const double v = through(.2 * (a[0] + a[1]), .2 * (b[0] + b[1]), 9.81 * .2);
  report("series: v_D", v, flow_in(&run.s) / .1, 1e-8, passed(started));
  report("series: fall of head to the contact", .2 * (a[0] * v + b[0] * v * v) / 9.81,
         .4 - (richards_head_at(&run.s, contact) * G / 9.81 + .05), 1e-8, passed(started));
  finish(&run);
}

/* Soils side by side, porosity .5 and .3 half each. */
static void soils_side_by_side(void) {
  static const struct {
    const char *name;
    enum side_by_side kind;
    double thick, grain, bound[2];
  } table[] = {{"along", ALONG_LAYERS, .05, 3e-3, {1e-8, 1e-8}},
               {"along, coarse", ALONG_LAYERS, .05, 1e-2, {1e-8, 1e-8}},
               {"across", ACROSS, .05, 3e-3, {1e-8, 1e-8}},
               {"across, coarse", ACROSS, .05, 1e-2, {1e-8, 1e-8}},
               {"at 45 degrees", OBLIQUE, .0707, 5e-4, {.03, .015}},
               {"checkerboard", CHECKERBOARD, .1, 5e-4, {.03, .015}}};
  const double f = 2;
  for (size_t k = 0; k < 2 * sizeof table / sizeof *table; k++) {
    struct run run;
    char name[96], soils[12000];
    const size_t i = k / 2;
    const enum side_by_side kind = table[i].kind;
    const double started = clock_seconds(), dx = k % 2 == 0 ? .01 : .005;
    const double grain = table[i].grain, exact = through_soils(kind, grain, f);
    const double turn = kind == OBLIQUE ? M_SQRT1_2 : 1;
    write_soils(soils, sizeof soils, kind, table[i].thick, dx, grain);
    start(&run,
          "scene = { end_time = \"60 s\"; };\ndomain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = "
          "\"%g m\"; periodic = [true, true]; };\nregions = ( %s );\n"
          "force = { body_acceleration = [\"%.9g m/s^2\", \"%.9g m/s^2\"]; };\n",
          dx, soils, f * turn, kind == OBLIQUE ? f * turn : 0);
    const double v = (mean_velocity(&run.s, 0) + (kind == OBLIQUE ? mean_velocity(&run.s, 2) : 0));
    snprintf(name, sizeof name, "soils side by side: %s, %g mm", table[i].name, 1e3 * dx);
    report(name, exact, v * turn, table[i].bound[k % 2], passed(started));
    finish(&run);
  }
}

/* k between two heads with free water before and behind the soil, whatever its grains. */
static void heads(void) {
  static const double table[][2] = {{.3, 1e-6}, {.3, 3e-6}, {.3, 5e-5}, {.1, 5e-3}, {.9, 5e-3}};
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    const double started = clock_seconds(), eps = table[i][0], grain = table[i][1];
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"60 s\"; };\n"
          "domain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = \"1 cm\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"porous\"; box = [\"0.1 m\", \"0\", \"0.3 m\", \"0.1 m\"]; "
          "porosity = %g; grain_size = \"%g m\"; },\n"
          "{ type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = \"0.3 m\"; },\n"
          "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; "
          "} );\nforce = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          eps, grain);
    snprintf(name, sizeof name, "between heads: eps %g, grains of %g mm", eps, 1e3 * grain);
    report(name, through(drag_a(eps, grain), drag_b(eps, grain), .5 * 9.81), flow_in(&run.s) / .1,
           2e-5, passed(started));
    finish(&run);
  }
}

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
  static const double table[][2] = {{26.565, 10}, {10, 10}, {45, 10}, {75, 10},
                                    {22.5, 30},   {60, 30}, {75, 30}};
  for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
    const double angle = table[n][0] * M_PI / 180, across = ALONG / table[n][1];
    const double started = clock_seconds(), s = sin(angle);
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"1 s\"; };\n"
          "domain = { size = [\"0.3 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [true, false]; "
          "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.3 m\", \"0.2 m\"]; %s } "
          ");\nforce = { body_acceleration = [\"9.80665 m/s^2\", \"0\"]; };\n",
          beds(angle, across));
    snprintf(name, sizeof name, "beds at %.3g degrees, %g : 1, between walls", table[n][0],
             table[n][1]);
    report(name, 1 / ((1 - s * s) / ALONG + s * s / across), mean_velocity(&run.s, 0), 1e-6,
           passed(started));
    finish(&run);
  }
}

/* Layers of beds and of soil of one permeability, equally thick: they share the gradient along the
 * interface and the flux across it,
 *   across 1/<1/K_zz>, and with it along x <K_xz/K_zz> times that. */
static void layers(void) {
  const double angle = 26.565 * M_PI / 180, other = 5e-4;
  for (int along = 0; along < 2; along++) {
    const double started = clock_seconds();
    double k[3];
    struct run run;
    tensor(angle, ALONG / 10, k);
    const double across = 2 / (1 / other + 1 / k[2]), turn = .5 * k[1] / k[2];
    const double flat = .5 * other + .5 * (k[0] - k[1] * k[1] / k[2]) + turn * turn * across;
    start(
        &run,
        "scene = { end_time = \"1 s\"; };\n"
        "domain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [true, true]; "
        "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.2 m\"]; porosity "
        "= 0.4; permeability = \"%g m/s\"; },\n"
        "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; %s } );\n"
        "force = { body_acceleration = [\"%g m/s^2\", \"%g m/s^2\"]; };\n",
        other, beds(angle, ALONG / 10), along ? G : 0, along ? 0 : G);
    report(along ? "layers, one of beds: v along" : "layers, one of beds: v across",
           along ? flat : across, mean_velocity(&run.s, along ? 0 : 2), 1e-6, passed(started));
    report(along ? "layers, one of beds: v across, driven along"
                 : "layers, one of beds: v along, driven across",
           turn * across, mean_velocity(&run.s, along ? 2 : 0), 1e-6, passed(started));
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
  static const double angles[] = {0, 30, -60}, bounds[] = {.05, .03, .015};
  for (int n = 0; n < 9; n++) {
    const double dx = ldexp(.01, -(n / 3)), angle = angles[n % 3] * M_PI / 180;
    struct run run;
    double k[3];
    char name[96];
    tensor(angle, ALONG / 10, k);
    /* The error at corners of 270 degrees fades with h^(4/3). */
    const double coarse = elements(2, k), finer = elements(4, k);
    const double exact = finer + (finer - coarse) / (pow(2, 4. / 3) - 1), started = clock_seconds();
    start(&run,
          "scene = { end_time = \"1 s\"; };\n"
          "domain = { size = [\"0.6 m\", \"0.3 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.6 m\", \"0.3 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"0.6 m\", \"0.2 m\"]; %s },\n"
          "{ type = \"wall\"; box = [\"0.28 m\", \"0.1 m\", \"0.32 m\", \"0.3 m\"]; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"%g m\", \"0.28 m\", \"0.3 m\"]; head = \"0.5 m\"; "
          "},\n"
          "{ type = \"inflow\"; box = [\"0.32 m\", \"%g m\", \"0.6 m\", \"0.3 m\"]; head = \"0.4 "
          "m\"; } );\n"
          "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n",
          dx, beds(angle, ALONG / 10), .3 - dx, .3 - dx);
    snprintf(name, sizeof name, "sheet pile in beds at %g degrees, 10 : 1, %g mm", angles[n % 3],
             1e3 * dx);
    report(name, exact, flow_in(&run.s), bounds[n / 3], passed(started));
    finish(&run);
  }
}

/* Complete elliptic integral of the first kind by the arithmetic-geometric mean (Gauss 1799). */
static double elliptic(double modulus) {
  double a = 1, b = sqrt(1 - modulus * modulus);
  for (int i = 0; i < 30; i++) {
    const double mean = .5 * (a + b);
    b = sqrt(a * b), a = mean;
  }
  return M_PI / (2 * a);
}

/* A thin wall 1 m deep in 2 m of soil, and a floor 2 m wide on it: k h K'/(2 K) with the modulus
 * sin(pi s / 2 T), or tanh(pi b / 2 T) with b half the floor's width (Harr 1962, by conformal
 * maps). The soil is 20 m long in place of infinitely long. */
static void maps(void) {
  for (int n = 0; n < 6; n++) {
    const bool floor_ = n >= 3;
    const double started = clock_seconds(), dx = ldexp(.2, -(n % 3)), k = 1e-4, h = 1;
    const double modulus = floor_ ? tanh(M_PI / 4) : sin(M_PI / 4);
    const double exact = k * h * elliptic(sqrt(1 - modulus * modulus)) / (2 * elliptic(modulus));
    struct run run;
    char name[96], wall[200];
    if (floor_)
      snprintf(wall, sizeof wall, "\"9 m\", \"2 m\", \"11 m\", \"2.4 m\"");
    else
      snprintf(wall, sizeof wall, "\"%g m\", \"1 m\", \"%g m\", \"2.4 m\"", 10 - .002 * dx,
               10 + .002 * dx);
    start(&run,
          "scene = { end_time = \"1 h\"; };\n"
          "domain = { size = [\"20 m\", \"2.4 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\nregions = ( { type = \"water\"; box = [\"0\", \"0\", \"20 m\", \"2.4 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"20 m\", \"2 m\"]; porosity = 0.4; "
          "permeability = \"%g m/s\"; },\n{ type = \"wall\"; box = [%s]; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"%g m\", \"8.9 m\", \"2.4 m\"]; head = \"4 m\"; },\n"
          "{ type = \"inflow\"; box = [\"11 m\", \"%g m\", \"20 m\", \"2.4 m\"]; head = \"3 m\"; } "
          ");\nforce = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n",
          dx, k, wall, 2.4 - dx, 2.4 - dx);
    snprintf(name, sizeof name, "%s, %g m", floor_ ? "floor on the soil" : "thin sheet pile", dx);
    report(name, exact, flow_in(&run.s), ldexp(.06, -(n % 3)), passed(started));
    finish(&run);
  }
}

/* A drain of radius .12 m in a strip 1 m high between heads .3 m above its own, 1 m away on both
 * sides: 2 pi k d/(pi + ln(1/(2 pi r))) by its images up and down; and a well of the same rate. */
static void drains(void) {
  for (int n = 0; n < 3; n++) {
    const double started = clock_seconds(), dx = ldexp(.04, -n);
    const double exact = 2 * M_PI * 1e-2 * .3 / (M_PI + log(1 / (2 * M_PI * .12)));
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"1 h\"; };\n"
          "domain = { size = [\"2 m\", \"1 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"2 m\", \"1 m\"]; porosity = "
          "0.4; permeability = \"1 cm/s\"; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"1 m\"]; head = \"1.5 m\"; },\n"
          "{ type = \"inflow\"; box = [\"1.99 m\", \"0\", \"2 m\", \"1 m\"]; head = \"1.5 m\"; },\n"
          "{ type = \"drain\"; name = \"pipe\"; centre = [\"1 m\", \"0.5 m\"]; radius = \"12 cm\"; "
          "head = \"1.2 m\"; } );\nforce = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n",
          dx);
    snprintf(name, sizeof name, "drain in a strip, %g mm", 1e3 * dx);
    report(name, exact, flow_in(&run.s), ldexp(.02, -n), passed(started));
    finish(&run);
  }
}

/* A drain of 1 to 4 spacings across in a square of side w between four heads, its centre anywhere
 * on the lattice: 2 pi k H/ln(1.0787 w/(2 r)) (Balcerzak, Raynor 1961), which half a spacing off
 * the middle changes by under .1 %. */
static void narrow_drains(void) {
  static const struct {
    double dx, wide, off[2], bound;
  } cases[] = {{.02, 4, {0, 0}, .01},     {.01, 4, {0, 0}, .01},     {.02, 4, {.5, .5}, .01},
               {.01, 4, {.5, .5}, .01},   {.02, 4, {.5, 0}, .01},    {.01, 4, {.5, 0}, .01},
               {.02, 4, {.25, .25}, .01}, {.01, 4, {.25, .25}, .01}, {.02, 4, {.4, .1}, .01},
               {.01, 4, {.4, .1}, .01},   {.02, 4, {.07, .31}, .01}, {.01, 4, {.07, .31}, .01},
               {.01, 2, {0, 0}, .02},     {.01, 2, {.5, .5}, .02},   {.01, 2, {.25, .25}, .02},
               {.01, 2, {.07, .31}, .02}, {.01, 1, {.5, .5}, .05},   {.01, 1, {.4, .1}, .05},
               {.01, 1, {.25, .25}, .05}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    const double started = clock_seconds(), dx = cases[n].dx, wide = cases[n].wide;
    const double *off = cases[n].off, exact = 2 * M_PI * 1e-3 * .5 / log(1.0787 * .5 / (wide * dx));
    struct run run;
    char name[96];
    start(
        &run,
        "scene = { end_time = \"1 h\"; };\n"
        "domain = { size = [\"0.5 m\", \"0.5 m\"]; spacing = \"%g m\"; periodic = [false, "
        "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.5 m\", \"0.5 "
        "m\"]; porosity = 0.4; permeability = \"1 mm/s\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"10 mm\", \"0.5 m\"]; head = \"0.5 m\"; },\n"
        "{ type = \"inflow\"; box = [\".49 m\", \"0\", \".5 m\", \"0.5 m\"]; head = \"0.5 m\"; "
        "},\n{ type = \"inflow\"; box = [\"10 mm\", \"0\", \".49 m\", \"10 mm\"]; head = \"0.5 "
        "m\"; },\n{ type = \"inflow\"; box = [\"10 mm\", \".49 m\", \".49 m\", \"0.5 m\"]; head = "
        "\"0.5 m\"; },\n{ type = \"drain\"; name = \"pipe\"; centre = [\"%.9g m\", \"%.9g m\"]; "
        "radius = \"%g m\"; } );\n",
        dx, .25 + off[0] * dx, .25 + off[1] * dx, .5 * wide * dx);
    snprintf(name, sizeof name, "drain of %g spacings, %g mm, centre off by (%g, %g)", wide,
             1e3 * dx, off[0], off[1]);
    report(name, exact, flow_in(&run.s), cases[n].bound, passed(started));
    finish(&run);
  }
}

/* A dam with upright faces and a water table: k_x (h1^2 - h2^2)/(2 L) (Charny 1951) asks for no
 * k_z, as the flow through any upright section is k_x times the integral of dh/dx over it. By
 * method richards; soil above the water table holds little. */
static void dam(void) {
  static const double up[] = {1e-2, 1e-1, 1};
  for (int n = 0; n < 3; n++) {
    const double started = clock_seconds(), exact = .1 * (1 - .16) / 2;
    struct run run;
    double flux = 0;
    char name[96];
    start(
        &run,
        "scene = { end_time = \"1 h\"; };\n"
        "domain = { size = [\"1 m\", \"1.2 m\"]; spacing = \"5 cm\"; periodic = [false, false]; "
        "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"1 m\", \"1.2 m\"]; porosity = "
        "0.4; permeability = [\"0.1 m/s\", \"%g m/s\"]; van_genuchten = { alpha = \"40 1/m\"; n = "
        "4.0; theta_r = 0.02; }; head = \"0.75 m\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"5 cm\", \"1.2 m\"]; head = \"1 m\"; },\n"
        "{ type = \"inflow\"; box = [\"0.95 m\", \"0\", \"1 m\", \"1.2 m\"]; head = \"0.4 m\"; } "
        ");\nforce = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n",
        up[n]);
    advance(&run, 600);
    for (size_t f = 0; f < run.s.face_count; f++)
      if (run.s.faces[f].axis == 0 && run.s.site[run.s.faces[f].i] % 20 == 9)
        flux += run.s.face_flux[f].q * run.s.spacing;
    snprintf(name, sizeof name, "dam with upright faces, k_x/k_z %g: flow, 50 mm", .1 / up[n]);
    report(name, exact, flux, .05, passed(started));
    finish(&run);
  }
}

/* Conductivity of soil with a square array of impermeable cylinders, over that of the soil; f:
 * their share of the area (Perrins, McKenzie, McPhedran 1979, Proc. R. Soc. A 369, with T = 1). */
static double around_cylinders(double f) {
  const double f4 = f * f * f * f, f8 = f4 * f4;
  return 1 - 2 * f / (1 + f - .305827 * f4 / (1 - 1.402958 * f8) - .013362 * f8);
}

/* Wall cylinders of 3 to 10 spacings across, anywhere on the lattice, three or one and a half
 * diameters apart. */
static void cylinders(void) {
  static const double sizes[][3] = {{3, 9, .012},   {4, 12, .006}, {5.5, 16, .004}, {7, 21, .002},
                                    {10, 30, .001}, {4, 6, .02},   {8, 12, .006}};
  static const double offsets[][2] = {{0, 0}, {.5, .5}, {.13, .37}, {.4, .1}, {.07, .31}};
  for (size_t n = 0; n < 5 * sizeof sizes / sizeof *sizes; n++) {
    const double started = clock_seconds(), *size = sizes[n / 5], *off = offsets[n % 5];
    const double middle = floor(.5 * size[1]);
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"1 s\"; };\ndomain = { size = [\"%g m\", \"%g m\"]; spacing = "
          "\"1 m\"; periodic = [true, true]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
          "\"0\", \"%g m\", \"%g m\"]; porosity = 0.4; permeability = \"1 cm/s\"; },\n"
          "{ type = \"wall\"; centre = [\"%.9g m\", \"%.9g m\"]; radius = \"%g m\"; } );\n"
          "force = { body_acceleration = [\"9.80665 m/s^2\", \"0\"]; };\n",
          size[1], size[1], size[1], size[1], middle + off[0], middle + off[1], .5 * size[0]);
    snprintf(name, sizeof name, "cylinders of %g spacings every %g, off by (%g, %g)", size[0],
             size[1], off[0], off[1]);
    report(name, 1e-2 * around_cylinders(.25 * M_PI * size[0] * size[0] / (size[1] * size[1])),
           mean_velocity(&run.s, 0), size[2], passed(started));
    finish(&run);
  }
}

/* Soil between plates at a slope to the lattice, `thick` spacings high in x = const, and anywhere
 * on it: along them k times what is open, and nothing across. A cell that a plate thinner than its
 * diagonal divides counts on one side alone. The box of 40 x `rise` spacings
 * repeats along both axes. */
static void plates(void) {
  static const struct {
    double rise, thick, at, bound;
  } cases[] = {{7, 2, 1.2, 1e-3},  {10, 3, 2.4, 1e-3},    {16, 3.3, 5.17, 1e-3},
               {24, 4, 7.4, 1e-3}, {33, 6.1, 9.05, 1e-3}, {16, 1.6, 5.17, 1e-3},
               {16, 1.2, 3, .01},  {33, 1.4, 9.05, .01},  {24, .9, 7.4, .01}};
  for (size_t n = 0; n < 2 * sizeof cases / sizeof *cases; n++) {
    const double started = clock_seconds(), rise = cases[n / 2].rise, thick = cases[n / 2].thick;
    const double at = cases[n / 2].at, first = (rise - at - thick) / rise * 40,
                 last = (rise - at) / rise * 40, slope = atan2(rise, 40), c = cos(slope),
                 z = sin(slope);
    const bool across = n % 2;
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"1 s\"; };\ndomain = { size = [\"40 m\", \"%g m\"]; spacing = "
          "\"1 m\"; periodic = [true, true]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
          "\"0\", \"40 m\", \"%g m\"]; porosity = 0.4; permeability = \"1 cm/s\"; },\n"
          "{ type = \"wall\"; corners = [\"0\", \"%.12g m\", \"%.12g m\", \"%g m\", \"%.12g m\", "
          "\"%g m\", \"0\", \"%.12g m\"]; },\n"
          "{ type = \"wall\"; corners = [\"%.12g m\", \"0\", \"40 m\", \"%.12g m\", \"40 m\", "
          "\"%.12g m\", \"%.12g m\", \"0\"]; } );\n"
          "force = { body_acceleration = [\"%.12g m/s^2\", \"%.12g m/s^2\"]; };\n",
          rise, rise, at, last, rise, first, rise, at + thick, last, at, at + thick, first,
          G * (across ? -z : c), G * (across ? c : z));
    const double x = mean_velocity(&run.s, 0), y = mean_velocity(&run.s, 2);
    snprintf(name, sizeof name, "plates at %.3g degrees, %g spacings: %s", slope * 180 / M_PI,
             thick * c, across ? "1 + flow across" : "flow along");
    if (across)
      report(name, 1, 1 + (c * y - z * x) / 1e-2, 1e-9, passed(started));
    else
      report(name, 1e-2 * (1 - thick / rise), c * x + z * y, cases[n / 2].bound, passed(started));
    finish(&run);
  }
}

/* Writes a ball as triangles between circles of latitude, with the volume of one of that radius. */
enum { LATITUDES = 24, LONGITUDES = 48 };
static void ball_corner(int i, int j, double radius, const double middle[3], double x[3]) {
  const double theta = M_PI * i / LATITUDES, phi = 2 * M_PI * (j % LONGITUDES) / LONGITUDES;
  const bool pole = i == 0 || i == LATITUDES;
  x[0] = middle[0] + (pole ? 0 : radius * sin(theta) * cos(phi));
  x[1] = middle[1] + (pole ? 0 : radius * sin(theta) * sin(phi));
  x[2] = middle[2] + (i == 0 ? radius : pole ? -radius : radius * cos(theta));
}
static void write_ball(const char *path, double radius, const double middle[3]) {
  FILE *file = fopen(path, "w");
  double volume = 0; /* of the unit ball's triangles, cut at their latitudes */
  if (file == NULL) must(FAIL(STATUS_INPUT, "cannot write %s", path));
  for (int i = 0; i < LATITUDES; i++) {
    const double low = M_PI * i / LATITUDES, high = low + M_PI / LATITUDES, a = sin(low),
                 b = sin(high);
    volume += .5 * LONGITUDES * sin(2 * M_PI / LONGITUDES) * (a * a + a * b + b * b) / 3 *
              (cos(low) - cos(high));
  }
  radius *= cbrt(4 * M_PI / 3 / volume);
  fprintf(file, "solid ball\n");
  for (int n = 0; n < 2 * LATITUDES * LONGITUDES; n++) {
    const int i = n / 2 / LONGITUDES, j = n / 2 % LONGITUDES;
    const int at[3][2] = {{i + n % 2, j}, {i + 1, n % 2 ? j + 1 : j}, {i, j + 1}};
    if (n % 2 ? i + 1 == LATITUDES : i == 0) continue;
    fprintf(file, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < 3; k++) {
      double x[3];
      ball_corner(at[k][0], at[k][1], radius, middle, x);
      fprintf(file, "vertex %.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    fprintf(file, "endloop\nendfacet\n");
  }
  fprintf(file, "endsolid ball\n");
  fclose(file);
}

/* Balls of triangles in a cubic array, anywhere on the lattice: (1 - f)/(1 + f/2) (Maxwell 1873; at
 * f below .07 the higher multipoles of McPhedran, McKenzie 1978 change it by 1e-5). */
static void balls(void) {
  static const double sizes[][3] = {
      {3, 9, .003}, {4, 8, .004}, {4, 12, .0015}, {7, 14, .0015}, {8, 16, .001}};
  static const double offsets[][3] = {{0, 0, 0}, {.13, .37, .21}, {.07, .31, .45}};
  for (size_t n = 0; n < 3 * sizeof sizes / sizeof *sizes; n++) {
    const double started = clock_seconds(), *size = sizes[n / 3], *off = offsets[n % 3];
    const double at = floor(.5 * size[1]), middle[3] = {at + off[0], at + off[1], at + off[2]};
    const double f = M_PI / 6 * pow(size[0] / size[1], 3);
    struct run run;
    char name[128], path[] = "/tmp/verify_darcy_XXXXXX";
    close(mkstemp(path));
    write_ball(path, .5 * size[0], middle);
    start(&run,
          "scene = { end_time = \"1 s\"; };\ndomain = { size = [\"%g m\", \"%g m\", \"%g m\"]; "
          "spacing = \"1 m\"; periodic = [true, true, true]; };\nregions = ( { type = \"porous\"; "
          "box = [\"0\", \"0\", \"0\", \"%g m\", \"%g m\", \"%g m\"]; porosity = 0.4; permeability "
          "= \"1 cm/s\"; },\n{ type = \"wall\"; stl = \"%s\"; stl_unit = \"1 m\"; } );\n"
          "force = { body_acceleration = [\"9.80665 m/s^2\", \"0\", \"0\"]; };\n",
          size[1], size[1], size[1], size[1], size[1], size[1], path);
    unlink(path);
    snprintf(name, sizeof name, "balls of %g spacings every %g, off by (%g, %g, %g)", size[0],
             size[1], off[0], off[1], off[2]);
    report(name, 1e-2 * (1 - f) / (1 + .5 * f), mean_velocity(&run.s, 0), size[2], passed(started));
    finish(&run);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"column", columns},
                                             {"series", series},
                                             {"soils", soils_side_by_side},
                                             {"heads", heads},
                                             {"beds", between_walls},
                                             {"layers", layers},
                                             {"pile", pile},
                                             {"maps", maps},
                                             {"drains", drains},
                                             {"narrow", narrow_drains},
                                             {"dam", dam},
                                             {"cylinders", cylinders},
                                             {"plates", plates},
                                             {"balls", balls}};
  return rows_of_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
