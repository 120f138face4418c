/* Rain, wells and drains in soil by method isph against exact solutions. Usage: verify_sources
 * RESULTS.json [CASE...]     all cases, or those whose names start with CASE */
#include "sphsolve/isph/effects/rain.h"
#include "sphsolve/isph/well.h"
#include "tests/verify/isph_rig.h"

/* m^2 that a well or a drain has taken. */
static double taken_by(const struct run *run) {
  const struct isph_well *well = &run->s.wells[0];
  return (well->taken + well->pending) / run->s.density;
}

/* Means of a well's flow, m^2/s, from one time to another. */
static double flow_between(struct run *run, double from, double to) {
  advance(run, from);
  const double before = taken_by(run), since = run->s.time;
  advance(run, to);
  return (taken_by(run) - before) / (run->s.time - since);
}

/* Soil of conductivity k between a divide at x = 0 and a ditch of level h at x = L takes rain N:
 * the flow is N x, exact with the free surface too (Charny 1951; Bear 1972, 8.2), and the level
 * follows Dupuit and Hooghoudt, h_0^2 = h^2 + N L^2/k. At the divide the water sinks too, by a
 * velocity that grows as the height, so that the foot bears h_0 (1 - N/2k)/sqrt(1 - 2N/3k). */
static void recharge(void) {
  const double k = .1, rain = 5e-3, length = 2, ditch = .5;
  const double level = sqrt(ditch * ditch + rain * length * length / k);
  const double head = level * (1 - rain / (2 * k)) / sqrt(1 - 2 * rain / (3 * k));
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = fine ? .02 : .04, foot[3] = {.02, 0, 0};
    double flux[3] = {0}, pressure = 0;
    const int rows = 100;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
          "domain = { size = [\"2 m\", \"0.8 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"2 m\", \"0.6 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"2 m\", \"0.72 m\"]; porosity = 0.4; "
          "permeability = \"%g m/s\"; },\n"
          "{ type = \"inflow\"; box = [\"1.99 m\", \"0\", \"2 m\", \"0.72 m\"]; head = \"%g m\"; "
          "},\n"
          "{ type = \"rain\"; box = [\"0\", \"0.78 m\", \"2 m\", \"0.8 m\"]; rate = \"%g m/s\"; } "
          ");\n"
          "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n"
          "isph = { wall = { slip = true; }; };\n",
          dx, k, ditch, rain);
    advance(&run, 25);
    for (int n = 0; n < rows; n++) {
      advance(&run, 25 + 0.2 * (n + 1));
      for (int p = 0; p < 3; p++)
        flux[p] += flux_at(&run.s, .5 * (p + 1)) / (run.s.thickness * rows);
      pressure += pressure_at(&run.s, foot) / rows;
    }
    for (int p = 0; p < 3; p++) {
      snprintf(name, sizeof name, "recharge: flow at %g m, spacing %g mm", .5 * (p + 1), 1e3 * dx);
      report(name, rain * .5 * (p + 1), flux[p], (fine ? .02 : .04) * rain * length, started);
    }
    snprintf(name, sizeof name, "recharge: head at the divide, spacing %g mm", 1e3 * dx);
    report(name, head, pressure / 9806.65, (fine ? .01 : .02) * head, started);
    const double *numbers = isph_own_numbers(&run.s, "rain");
    const double fell = (numbers[RAIN_FALLEN] + numbers[RAIN_PENDING]) / 1000;
    snprintf(name, sizeof name, "recharge: rain over its rate, spacing %g mm", 1e3 * dx);
    report(name, 1, fell / (rain * length * run.s.time), 1e-12, started);
    finish(&run);
  }
}

/* Soil of conductivity k in a square between four windows of head .5 m, without gravity. */
#define CONDUCTIVITY .01
static void start_square(struct run *run, double dx, const char *well) {
  start(run,
        "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
        "domain = { size = [\"1 m\", \"1 m\"]; spacing = \"%g m\"; periodic = [false, false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"1 m\", \"1 m\"]; porosity = 0.4; "
        "permeability = \"%g m/s\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"10 mm\", \"1 m\"]; head = \"0.5 m\"; },\n"
        "{ type = \"inflow\"; box = [\".99 m\", \"0\", \"1 m\", \"1 m\"]; head = \"0.5 m\"; },\n"
        "{ type = \"inflow\"; box = [\"10 mm\", \"0\", \".99 m\", \"10 mm\"]; head = \"0.5 m\"; "
        "},\n"
        "{ type = \"inflow\"; box = [\"10 mm\", \".99 m\", \".99 m\", \"1 m\"]; head = \"0.5 m\"; "
        "},\n{ %s } );\n",
        dx, CONDUCTIVITY, well);
}

/* A drain at the air's pressure: heat that a cylinder of radius r at the middle of a square of side
 * w gives to its sides, 2 pi k H / ln(1.08 w/(2 r)) (Incropera, DeWitt, table 4.1). */
static void drained_square(void) {
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = fine ? .02 : .04;
    const double exact = 2 * M_PI * CONDUCTIVITY * .5 / log(1.08 * .5 / .15);
    char name[96];
    start_square(&run, dx, "type = \"drain\"; centre = [\".5 m\", \".5 m\"]; radius = \".15 m\";");
    const double flow = flow_between(&run, .6, 1.6);
    snprintf(name, sizeof name, "drain in a square: flow, spacing %g mm", 1e3 * dx);
    report(name, exact, flow, (fine ? .04 : .06) * exact, started);
    finish(&run);
  }
}

/* A drain of 4 spacings across at the middle of a square of soil of side w between four heads, 2-D
 * and as a pipe in 3-D, with its centre anywhere on the lattice: 2 pi k H/ln(1.0787 w/(2 r))
 * (Balcerzak, Raynor 1961), which half a spacing off the middle changes by under .1 %. k is so low
 * that inertia takes 1e-5 of the head. */
static void narrow_drain(void) {
  static const double centres[][2] = {{0, 0}, {.25, .25}, {.4, .1}, {.07, .31}};
  for (int n = 0; n < 11; n++) {
    struct run run = {0};
    const bool pipe = n > 7;
    const double started = clock_seconds(), dx = pipe ? (n == 10 ? .0125 : .02) : n % 2 ? .01 : .02;
    const double *off = centres[pipe ? n - 7 : n / 2], deep = pipe ? 6 * dx : 1;
    const double exact = 2 * M_PI * 1e-3 * .5 / log(1.0787 * .25 / (2 * dx));
    char name[96], depth[2][20] = {"", ""}, sides[4][100];
    if (pipe) snprintf(depth[0], 20, "\"0\","), snprintf(depth[1], 20, "\"%g m\",", deep);
    for (int a = 0; a < 4; a++) {
      const double from = a % 2 ? .49 : 0, low[2] = {a < 2 ? from : .01, a < 2 ? 0 : from};
      const double high[2] = {a < 2 ? from + .01 : .49, a < 2 ? .5 : from + .01};
      snprintf(sides[a], sizeof sides[a], "\"%g m\", %s \"%g m\", \"%g m\", %s \"%g m\"", low[0],
               depth[0], low[1], high[0], depth[1], high[1]);
    }
    start(&run,
          "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
          "domain = { size = [\"0.5 m\", %s \"0.5 m\"]; spacing = \"%g m\"; periodic = [false, %s "
          "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", %s \"0\", \"0.5 m\", %s "
          "\"0.5 m\"]; porosity = 0.4; permeability = \"1e-3 m/s\"; },\n"
          "{ type = \"inflow\"; box = [%s]; head = \"0.5 m\"; },\n{ type = \"inflow\"; box = [%s]; "
          "head = \"0.5 m\"; },\n{ type = \"inflow\"; box = [%s]; head = \"0.5 m\"; },\n"
          "{ type = \"inflow\"; box = [%s]; head = \"0.5 m\"; },\n"
          "{ type = \"drain\"; centre = [\"%.9g m\", \"%.9g m\"]; radius = \"%g m\"; } );\n",
          depth[1], dx, pipe ? "true," : "", depth[0], depth[1], sides[0], sides[1], sides[2],
          sides[3], .25 + off[0] * dx, .25 + off[1] * dx, 2 * dx);
    const double flow = flow_between(&run, 2, pipe ? 5 : 10) / deep;
    snprintf(name, sizeof name, "%s of 4 spacings, %g mm, centre off by (%g, %g)",
             pipe ? "3-D drain" : "drain", 1e3 * dx, off[0], off[1]);
    report(name, exact, flow, .03 * exact, started);
    finish(&run);
  }
}

/* The window of `narrow` in the floor. */
static const char *floor_window(char depth[2][20]) {
  static char text[200];
  snprintf(text, sizeof text,
           "{ type = \"inflow\"; box = [\"10 mm\", %s \"0\", \"0.49 m\", %s \"10 mm\"]; head = "
           "\"0.5 m\"; },\n",
           depth[0], depth[1]);
  return text;
}

/* Drains that end at closed sides, which mirror them: a pipe of 4 spacings across between two of
 * them, and half a drain of 8 on the floor; with heads on the other sides, in part of the square of
 * `narrow` and by its formula. */
static void drains_at_sides(void) {
  static const struct {
    int deep; /* spacings between the sides; 0: on the floor */
    double dx, off;
  } cases[] = {{6, .05, 0}, {6, .025, 0}, {4, .025, .3}, {0, .0125, 0}, {0, .0125, .3}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = cases[n].dx, deep = cases[n].deep * dx;
    const bool pipe = deep > 0;
    const double low = pipe ? 0 : .25, radius = (pipe ? 2 : 4) * dx, x = .25 + cases[n].off * dx;
    const double exact = 2 * M_PI * 1e-3 * .5 / log(1.0787 * .25 / radius) * (pipe ? deep : .5);
    char name[96], depth[2][20] = {"", ""}, hole[2000];
    size_t at = 0;
    if (pipe) snprintf(depth[0], 20, "\"0\","), snprintf(depth[1], 20, "\"%g m\",", deep);
    if (pipe)
      snprintf(hole, sizeof hole, "centre = [\"%.9g m\", \"0.25 m\"]; radius = \"%g m\"", x,
               radius);
    for (int c = 0; c <= 32 && !pipe; c++) {
      const double turn = M_PI * c / 32, z = c % 32 == 0 ? 0 : radius * sin(turn);
      at += (size_t)snprintf(hole + at, sizeof hole - at, "%s\"%.9g m\", \"%.9g m\"%s",
                             c == 0 ? "corners = [" : ", ", x + radius * cos(turn), z,
                             c == 32 ? "]" : "");
    }
    start(&run,
          "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
          "domain = { size = [\"0.5 m\", %s \"%g m\"]; spacing = \"%g m\"; periodic = [false, %s "
          "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", %s \"0\", \"0.5 m\", %s "
          "\"%g m\"]; porosity = 0.4; permeability = \"1e-3 m/s\"; },\n"
          "{ type = \"inflow\"; box = [\"0\", %s \"0\", \"10 mm\", %s \"%g m\"]; head = \"0.5 m\"; "
          "},\n"
          "{ type = \"inflow\"; box = [\"0.49 m\", %s \"0\", \"0.5 m\", %s \"%g m\"]; head = \"0.5 "
          "m\"; },\n"
          "{ type = \"inflow\"; box = [\"10 mm\", %s \"%g m\", \"0.49 m\", %s \"%g m\"]; head = "
          "\"0.5 m\"; },\n"
          "%s { type = \"drain\"; %s; } );\nisph = { wall = { slip = true; }; };\n",
          depth[1], .5 - low, dx, pipe ? "false," : "", depth[0], depth[1], .5 - low, depth[0],
          depth[1], .5 - low, depth[0], depth[1], .5 - low, depth[0], .49 - low, depth[1], .5 - low,
          pipe ? floor_window(depth) : "", hole);
    const double flow = flow_between(&run, 4, pipe ? 5 : 8);
    if (pipe)
      snprintf(name, sizeof name,
               "pipe of 4 spacings between closed sides, %d apart, %g mm, off by %g", cases[n].deep,
               1e3 * dx, cases[n].off);
    else
      snprintf(name, sizeof name, "half a drain of 8 spacings on the floor, %g mm, off by %g",
               1e3 * dx, cases[n].off);
    report(name, exact, flow, .02 * exact, started);
    finish(&run);
  }
}

/* A wall of circular section, 4 spacings across, in the middle of a square of soil with heads on
 * two sides: the conductivity of a square array of insulating cylinders of area fraction c, k
 * (1 - 2 c/(1 + c - .305827 c^4/(1 - 1.402958 c^8) - .013362 c^8)) (Perrins, McKenzie, McPhedran
 * 1979, Proc. R. Soc. A 369). Where the centre leaves one site in a row, (.07, .31), it is refused.
 */
static void cylinder(void) {
  static const double centres[][2] = {{0, 0}, {.25, .25}, {.4, .1}, {.13, .37}};
  for (int n = 0; n < 8; n++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = n % 2 ? .01 : .02, *off = centres[n / 2];
    const double c = M_PI * 4 * dx * dx / .25, c4 = pow(c, 4), c8 = pow(c, 8);
    const double exact =
        1e-3 * .5 * (1 - 2 * c / (1 + c - .305827 * c4 / (1 - 1.402958 * c8) - .013362 * c8));
    double flow = 0;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
          "domain = { size = [\"0.5 m\", \"0.5 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.5 m\", \"0.5 "
          "m\"]; porosity = 0.4; permeability = \"1e-3 m/s\"; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"10 mm\", \"0.5 m\"]; head = \"1 m\"; },\n"
          "{ type = \"inflow\"; box = [\".49 m\", \"0\", \".5 m\", \"0.5 m\"]; head = \"0.5 m\"; "
          "},\n{ type = \"wall\"; centre = [\"%.9g m\", \"%.9g m\"]; radius = \"%g m\"; slip = "
          "true; } );\nisph = { wall = { slip = true; }; };\n",
          dx, .25 + off[0] * dx, .25 + off[1] * dx, 2 * dx);
    for (int row = 0; row < 20; row++) {
      advance(&run, 2 + .2 * row);
      flow += flux_at(&run.s, row % 2 ? .05 : .45) / (run.s.thickness * 20);
    }
    snprintf(name, sizeof name, "cylinder of 4 spacings in soil, %g mm, off by (%g, %g)", 1e3 * dx,
             off[0], off[1]);
    report(name, exact, flow, .03 * exact, started);
    finish(&run);
  }
}

/* Starts soil of conductivity 1e-3 m/s that repeats every l x h spacings of 1 cm, with walls, under
 * a head gradient of 1 at an angle to x; returns the velocity along it, m/s, when the water has
 * moved by 5 to 10 spacings. */
static double through_walls(double l, double h, double angle, const char *walls) {
  struct run run = {0};
  double sum = 0;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1000 s\"; };\n"
        "domain = { size = [\"%.12g cm\", \"%.12g cm\"]; spacing = \"1 cm\"; periodic = [true, "
        "true]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"%.12g cm\", \"%.12g "
        "cm\"]; porosity = 0.4; permeability = \"1e-3 m/s\"; },\n%s );\n"
        "force = { body_acceleration = [\"%.12g m/s^2\", \"%.12g m/s^2\"]; };\n",
        l, h, l, h, walls, 9.80665 * cos(angle), 9.80665 * sin(angle));
  for (int n = 1; n <= 10; n++) {
    double v[3];
    advance(&run, 20 + 2 * n);
    isph_darcy_velocity(&run.s, v);
    sum += (v[0] * cos(angle) + v[2] * sin(angle)) / 10;
  }
  finish(&run);
  return sum;
}

/* Wall cylinders, some spacings across, every so many in both directions, off the lattice's middle:
 * Perrins, McKenzie, McPhedran 1979, as above. */
static void cylinders(void) {
  static const double cases[][5] = {
      {2, 6, .13, .37, .03},    {2, 6, .25, .1, .03},     {3, 9, .5, .5, .01},
      {6.1, 18, .13, .37, .01}, {4, 12, .13, .37, .02},   {4, 12, .25, .25, .02},
      {4, 12, .4, .1, .02},     {5.5, 16, .07, .31, .01}, {7, 21, .25, .25, .01},
      {8, 24, .4, .1, .01},     {8, 12, .13, .37, .02},   {8, 12, .25, .25, .02}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    const double *size = cases[n], *off = size + 2, middle = floor(.5 * size[1]);
    const double started = clock_seconds(), c = .25 * M_PI * pow(size[0] / size[1], 2);
    const double c4 = pow(c, 4), c8 = pow(c, 8);
    const double exact =
        1e-3 * (1 - 2 * c / (1 + c - .305827 * c4 / (1 - 1.402958 * c8) - .013362 * c8));
    char wall[160], name[96];
    snprintf(wall, sizeof wall,
             "{ type = \"wall\"; centre = [\"%.9g cm\", \"%.9g cm\"]; radius = \"%g cm\"; }",
             middle + off[0], middle + off[1], .5 * size[0]);
    snprintf(name, sizeof name, "wall cylinders of %g spacings every %g, off by (%g, %g)", size[0],
             size[1], off[0], off[1]);
    report(name, exact, through_walls(size[1], size[1], 0, wall), size[4] * exact, started);
  }
}

/* Soil between plates at a slope to the lattice, that are `thick` spacings high in x = const and
 * repeat every `rise`: along them k times what is open. */
static void plates(void) {
  static const struct {
    double rise, thick, at;
  } cases[] = {{10, 3, 2.4}, {16, 3.3, 5.17}, {24, 4, 7.4}, {33, 6.1, 9.05}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    const double started = clock_seconds(), rise = cases[n].rise, thick = cases[n].thick;
    const double at = cases[n].at, first = (rise - at - thick) / rise * 40,
                 last = (rise - at) / rise * 40, angle = atan2(rise, 40);
    const double exact = 1e-3 * (1 - thick / rise);
    char walls[480], name[96];
    snprintf(walls, sizeof walls,
             "{ type = \"wall\"; corners = [\"0\", \"%.12g cm\", \"%.12g cm\", \"%g cm\", "
             "\"%.12g cm\", \"%g cm\", \"0\", \"%.12g cm\"]; },\n"
             "{ type = \"wall\"; corners = [\"%.12g cm\", \"0\", \"40 cm\", \"%.12g cm\", "
             "\"40 cm\", \"%.12g cm\", \"%.12g cm\", \"0\"]; }",
             at, last, rise, first, rise, at + thick, last, at, at + thick, first);
    snprintf(name, sizeof name, "soil between plates at %.3g degrees, %.3g spacings wide",
             angle * 180 / M_PI, (rise - thick) * cos(angle));
    report(name, exact, through_walls(40, rise, angle, walls), .015 * exact, started);
  }
}

/* A drain of 4 spacings across under a pond that falls, Q/(k H) in soil 20 deep, 40 from the next:
 * sinks within the drain, fitted to the head on its perimeter to 1e-8, each with its images in the
 * bed, the floor and the next drains; deep and alone it is 2 pi/acosh(depth/radius) to 2e-4. At
 * first the bed, through which the rows of the pond have not moved yet, lets more through than its
 * soil; judged is what the drain takes once a row of the pond has seeped in. */
static void drained_pond(void) {
  static const struct {
    double below, exact, dx, off; /* spacings from the bed to its centre */
  } cases[] = {{6, 3.31318, .02, .37},
               {10, 2.33507, .02, .37},
               {10, 2.33507, .01, .13},
               {14, 1.81627, .02, .37}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = cases[n].dx, k = 4e-3, exact = cases[n].exact;
    const double w = 40 * dx, depth = 20 * dx, pond = 20 * dx;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
          "domain = { size = [\"%g m\", \"%g m\"]; spacing = \"%g m\"; periodic = [true, false]; "
          "};\nregions = ( { type = \"water\"; box = [\"0\", \"0\", \"%g m\", \"%g m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"%g m\", \"%g m\"]; porosity = 0.4; "
          "permeability = \"%g m/s\"; },\n"
          "{ type = \"drain\"; centre = [\"%.9g m\", \"%g m\"]; radius = \"%g m\"; head = \"%g "
          "m\"; } );\n"
          "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n"
          "isph = { wall = { slip = true; }; };\n",
          w, depth + pond + 6 * dx, dx, w, depth + pond, w, depth, k, .5 * w + cases[n].off * dx,
          depth - cases[n].below * dx, 2 * dx, depth);
    for (int part = 0; part < 2; part++) {
      const double before = taken_by(&run), since = run.s.time;
      while (taken_by(&run) < (part == 0 ? 1 : 3) * dx * w) advance(&run, run.s.time + .05);
      const double head[2] = {pond - before / w, pond - taken_by(&run) / w};
      const double measured = log(head[0] / head[1]) * w / (k * (run.s.time - since));
      snprintf(name, sizeof name, "drain under a pond, %g deep, %g mm: flow, %s", cases[n].below,
               1e3 * dx, part == 0 ? "first row" : "later");
      if (part == 0)
        show(name, exact, measured, started);
      else
        report(name, exact, measured, .01 * exact, started);
    }
    finish(&run);
  }
}

/* What the head falls by between .25 and .35 m from a well: images of alternate sign in a square
 * with head 0 on its sides, -ln(r)/(2 pi), summed to 81 by 81; Thiem (1906) without the sides:
 * ln(.35/.25)/(2 pi) = .05355. */
static void pumped_square(void) {
  const double rate = 5e-3, exact = .0556546 * rate / CONDUCTIVITY;
  const double near[3] = {.75, 0, .5}, far[3] = {.85, 0, .5};
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = fine ? .02 : .04;
    double fall = 0;
    const int rows = 20;
    char name[96];
    start_square(&run, dx,
                 "type = \"well\"; rate = \"5e-3 m^2/s\"; centre = [\".5 m\", \".5 m\"]; "
                 "radius = \".1 m\";");
    advance(&run, 1);
    for (int n = 0; n < rows; n++) {
      advance(&run, 1 + .1 * (n + 1));
      fall += (pressure_at(&run.s, far) - pressure_at(&run.s, near)) / (9806.65 * rows);
    }
    snprintf(name, sizeof name, "well in a square: fall of head beside it, spacing %g mm",
             1e3 * dx);
    report(name, exact, fall, (fine ? .04 : .06) * exact, started);
    snprintf(name, sizeof name, "well in a square: taken over its rate, spacing %g mm", 1e3 * dx);
    report(name, 1, taken_by(&run) / (rate * run.s.time), 1e-12, started);
    finish(&run);
  }
}

/* A drain half-way up soil of depth D, a distance L from a head on either side: images up and down,
 * Q = 2 pi k H / (pi L/D + ln(D/(2 pi r))) for r << D. */
static void drained_strip(void) {
  const double exact = 2 * M_PI * CONDUCTIVITY * .3 / (M_PI + log(1 / (2 * M_PI * .12)));
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    const double started = clock_seconds(), dx = fine ? .02 : .04;
    char name[96];
    start(
        &run,
        "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
        "domain = { size = [\"2 m\", \"1 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
        "};\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"2 m\", \"1 m\"]; porosity = 0.4; "
        "permeability = \"%g m/s\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"10 mm\", \"1 m\"]; head = \"1.5 m\"; },\n"
        "{ type = \"inflow\"; box = [\"1.99 m\", \"0\", \"2 m\", \"1 m\"]; head = \"1.5 m\"; },\n"
        "{ type = \"drain\"; centre = [\"1 m\", \"0.5 m\"]; radius = \"0.12 m\"; head = \"1.2 "
        "m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n"
        "isph = { wall = { slip = true; }; };\n",
        dx, CONDUCTIVITY);
    const double flow = flow_between(&run, 1, fine ? 2 : 4);
    snprintf(name, sizeof name, "drain between two heads: flow, spacing %g mm", 1e3 * dx);
    report(name, exact, flow, (fine ? .03 : .05) * exact, started);
    finish(&run);
  }
}

/* A ditch through all of the soil, at level h, a distance L from a level H: k (H^2 - h^2)/2L, exact
 * with the free surface and its face of seepage (Charny 1951). It drains in times of 4 eps L^2 /
 * (pi^2 k h), 27 s. */
static void ditch(void) {
  const double exact = CONDUCTIVITY * (.8 * .8 - .3 * .3) / 2;
  struct run run = {0};
  const double started = clock_seconds();
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"200 s\"; };\n"
      "domain = { size = [\"1.2 m\", \"1 m\"]; spacing = \"5 cm\"; periodic = [false, false]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"1.2 m\", \"0.6 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0\", \"0\", \"1.2 m\", \"0.9 m\"]; porosity = 0.4; "
      "permeability = \"%g m/s\"; saturated = false; },\n"
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"10 mm\", \"0.9 m\"]; head = \"0.8 m\"; },\n"
      "{ type = \"drain\"; box = [\"1 m\", \"0\", \"1.2 m\", \"0.9 m\"]; head = \"0.3 m\"; } );\n"
      "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n"
      "isph = { wall = { slip = true; }; };\n",
      CONDUCTIVITY);
  report("ditch through soil with a free surface: flow, 50 mm", exact, flow_between(&run, 120, 200),
         .04 * exact, started);
  finish(&run);
}

/* A dam whose core is 1e7 times tighter than its shells, with equal levels on both sides: rest. And
 * two soils in a U-tube, one after the other or one over the other, between levels that differ by
 * .1 m: Darcy's flux, Q = .1 A / sum L/k or .1/L sum A k, for a time in which the levels hardly
 * change. */
static void zones(void) {
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), dx = fine ? .01 : .02, off = 0;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
          "domain = { size = [\"1 m\", \"0.6 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\n"
          "regions = ( { type = \"porous\"; box = [\"0.3 m\", \"0\", \"0.7 m\", \"0.56 m\"]; "
          "porosity = 0.4; permeability = \"1e-2 m/s\"; },\n"
          "{ type = \"porous\"; box = [\"0.44 m\", \"0\", \"0.56 m\", \"0.56 m\"]; porosity = "
          "0.4; permeability = \"1e-9 m/s\"; },\n"
          "{ type = \"water\"; box = [\"0\", \"0\", \"1 m\", \"0.5 m\"]; } );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          dx);
    advance(&run, 1);
    for (size_t i = 0; i < run.s.count; i++)
      off = fmax(off, fabs(run.s.pressure[i] - 9810 * (.5 - run.s.position[i][2])) / 4905);
    snprintf(name, sizeof name, "dam with a core at rest: velocity rms, m/s, %g cm", 100 * dx);
    report(name, 0, rms_velocity(&run.s), 1e-6, started);
    snprintf(name, sizeof name, "dam with a core at rest: pressure, over that at its foot, %g cm",
             100 * dx);
    report(name, 0, off, 1e-3, started);
    finish(&run);
  }
  for (int k = 0; k < 4; k++) {
    const bool along = k > 1;
    struct run run = {0};
    double started = clock_seconds(), dx = k % 2 ? .01 : .02, flux = 0, n = 0;
    const double shell = 1e-2, core = 1e-5;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
          "isph = { wall = { slip = true; }; };\n"
          "domain = { size = [\"1 m\", \"0.6 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\n"
          "regions = ( { type = \"porous\"; box = [\"0.3 m\", \"0\", \"0.7 m\", \"0.2 m\"]; "
          "porosity = 0.4; permeability = \"%g m/s\"; },\n"
          "{ type = \"porous\"; box = [\"%g m\", \"0\", \"%g m\", \"%g m\"]; porosity = 0.4; "
          "permeability = \"%g m/s\"; },\n"
          "{ type = \"water\"; box = [\"0\", \"0\", \"0.5 m\", \"0.5 m\"]; },\n"
          "{ type = \"water\"; box = [\"0.5 m\", \"0\", \"1 m\", \"0.4 m\"]; },\n"
          "{ type = \"wall\"; box = [\"0.3 m\", \"0.2 m\", \"0.7 m\", \"0.6 m\"]; } );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          dx, shell, along ? .3 : .44, along ? .7 : .56, along ? .1 : .2, core);
    for (int row = 0; row < 10; row++, n++) {
      advance(&run, .15 + .015 * row);
      flux += flux_at(&run.s, .5);
    }
    const double thick = run.s.thickness;
    const double exact = along ? .1 / .4 * .1 * (shell + core) * thick
                               : .1 * .2 * thick / (.28 / shell + .12 / core);
    snprintf(name, sizeof name, "soils of 1e3, one %s the other: flux, %g cm",
             along ? "over" : "after", 100 * dx);
    report(name, exact, flux / n, .04 * exact, started);
    finish(&run);
  }
}

/* Two ponds over soil, joined under a wall that reaches half way down: their levels draw near each
 * other as exp(-2 k C t/w), w the width of a pond. C of the soil's square bends by finite
 * differences: .39541, from .39482, .39518, .39532 at 5, 2.5, 1.25 mm. */
static void bends(void) {
  const double conductance = .39541, k = 1e-2, width = .56, end = 16;
  const double left[3] = {.28, 0, .45}, right[3] = {.92, 0, .45};
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), dx = fine ? .01 : .02, sum = 0, n = 0;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"%g s\"; };\n"
          "domain = { size = [\"1.2 m\", \"0.8 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"1.2 m\", \"0.4 m\"]; "
          "porosity = 0.4; permeability = \"%g m/s\"; },\n"
          "{ type = \"water\"; box = [\"0\", \"0\", \"0.6 m\", \"0.7 m\"]; },\n"
          "{ type = \"water\"; box = [\"0.6 m\", \"0\", \"1.2 m\", \"0.5 m\"]; },\n"
          "{ type = \"wall\"; box = [\"0.56 m\", \"0.2 m\", \"0.64 m\", \"0.8 m\"]; } );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          end + 1, dx, k);
    for (int row = 0; row <= 20; row++, n++) {
      advance(&run, end - 1 + .1 * row);
      sum += (pressure_at(&run.s, left) - pressure_at(&run.s, right)) / 9810;
    }
    const double rate = log(.2 / (sum / n)) / end, exact = 2 * k * conductance / width;
    snprintf(name, sizeof name, "under a wall between two ponds: rate, 1/s, %g cm", 100 * dx);
    report(name, exact, rate, (fine ? .02 : .03) * exact, started);
    finish(&run);
  }
}

/* A wall two spacings thick that reaches half way down in soil 2 m long and 1 m deep, between heads
 * at both ends: Q = k C (H_1 - H_2), C by finite differences (extrapolated from 12.5, 6.25, 3.125
 * mm). And one a twentieth of a spacing thick: C of half the soil, a rectangle with a wall along
 * half of a side, from its conformal map sn onto the half plane, C = K(l)/2K(1 - l) with l the
 * cross ratio of the images of the tip and the corners. */
static void membrane(double dx, double thick, double conductance, double bound) {
  struct run run = {0};
  const double started = clock_seconds(), k = 1e-4, exact = k * conductance * .1;
  char name[96];
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"2 m\", \"1 m\"]; spacing = \"%g m\"; periodic = [false, false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"2 m\", \"1 m\"]; porosity = "
        "0.4; permeability = \"%g m/s\"; saturated = true; },\n"
        "{ type = \"wall\"; box = [\"%.9g m\", \"0.5 m\", \"%.9g m\", \"1 m\"]; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"%g m\", \"1 m\"]; head = \"1.2 m\"; },\n"
        "{ type = \"inflow\"; box = [\"%g m\", \"0\", \"2 m\", \"1 m\"]; head = \"1.1 m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
        dx, k, 1 - .5 * thick * dx, 1 + .5 * thick * dx, dx, 2 - dx);
  advance(&run, .2);
  snprintf(name, sizeof name, "under a pile %g spacings thick: flux, %g mm", thick, 1e3 * dx);
  report(name, exact * run.s.thickness, flux_at(&run.s, .5), bound * dx * exact * run.s.thickness,
         started);
  finish(&run);
}

static void pile(void) {
  membrane(.05, 2, .38801, .6), membrane(.025, 2, .39734, .6), membrane(.0125, 2, .40275, .6);
  for (double dx = .05; dx > .01; dx /= 2) membrane(dx, .05, .409822, 1);
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"recharge", recharge},
                                             {"drain", drained_square},
                                             {"narrow", narrow_drain},
                                             {"sides", drains_at_sides},
                                             {"pond", drained_pond},
                                             {"cylinder", cylinder},
                                             {"well", pumped_square},
                                             {"strip", drained_strip},
                                             {"ditch", ditch},
                                             {"zones", zones},
                                             {"bends", bends},
                                             {"pile", pile},
                                             {"wall cylinders", cylinders},
                                             {"plates", plates}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
