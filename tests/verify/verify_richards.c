/* Water in soil that is not full by method richards against exact solutions, an independent
 * reference and an experiment. Usage: verify_richards RESULTS.json [CASE...]: all cases, or those
 * whose names start with CASE.
 *
 * Exact: water at rest; steady flow to and from a water table, dh/dz = q/K(h) - 1; a front of
 * constant shape in a long column (Philip 1957); infiltration into soil whose K and theta are
 * exponential, in series (Srivastava, Yeh 1991). dh/dz = (K_dry + c (theta - theta_dry))/K - 1 with
 * c = (K_wet - K_dry)/(theta_wet - theta_dry). Both equations are integrated here by Runge and
 * Kutta's method. The soil's curves and a column of an independent solver, ten times finer, are in
 * richards_reference.h. */
#include "tests/unit/richards_scene.h"
#include "tests/verify/richards_reference.h"
#include "tests/verify/rows.h"
#include "sphsolve/scene/scene_read.h"

/* As a scene has it. */
static const char *text_of(const struct soil *s, const char *start) {
  static char text[2][400];
  static int turn;
  char *to = text[turn ^= 1];
  if (s->n == 0)
    snprintf(to, sizeof text[0],
             "porosity = %.12g; permeability = \"%.12g m/s\"; gardner = { alpha = \"%.12g 1/m\"; "
             "theta_r = %.12g; }; %s;",
             s->theta_s, s->k, s->alpha, s->theta_r, start);
  else if (s->k_n > 0)
    snprintf(to, sizeof text[0],
             "porosity = %.12g; permeability = \"%.12g m/s\"; haverkamp = { h_theta = \"%.12g m\"; "
             "beta = %.12g; h_k = \"%.12g m\"; gamma = %.12g; theta_r = %.12g; }; %s;",
             s->theta_s, s->k, 1 / s->alpha, s->n, 1 / s->k_alpha, s->k_n, s->theta_r, start);
  else
    snprintf(to, sizeof text[0],
             "porosity = %.12g; permeability = \"%.12g m/s\"; van_genuchten = { alpha = \"%.12g "
             "1/m\"; n = %.12g; theta_r = %.12g; }; %s;",
             s->theta_s, s->k, s->alpha, s->n, s->theta_r, start);
  return to;
}

/* The inflow at the top, what = "pressure_head = ...;", and at the foot unless NULL. */
static const char *sides(double length, double dx, const char *top, const char *foot) {
  static char text[600];
  size_t n = (size_t)snprintf(text, sizeof text,
                              ", { type = \"inflow\"; box = [\"0\", \"%.12g m\", \"%.12g m\", "
                              "\"%.12g m\"]; %s }",
                              length - 0.01 * dx, dx, length, top);
  if (foot != NULL)
    snprintf(text + n, sizeof text - n,
             ", { type = \"inflow\"; box = [\"0\", \"0\", \"%.12g m\", \"%.12g m\"]; %s }", dx,
             0.01 * dx, foot);
  return text;
}

static const struct soil celia = {.102, .368, 3.35, 2, 9.22e-5, 0, 0},
                         loam = {.05, .4, 2, 1.5, 1e-5, 0, 0}, sand = {.05, .4, 5, 6, 1e-4, 0, 0},
                         silt = {.05, .45, 1, 1.3, 2e-6, 0, 0};

/* ---- water at rest ---- */
static void rest(void) {
  struct run run;
  const double started = clock_seconds();
  double most = 0;
  const char *upper = text_of(&silt, "head = \"0.3 m\""),
             *lower = text_of(&sand, "head = \"0.3 m\"");
  start(&run,
        "scene = { end_time = \"1000 d\"; };\ndomain = { size = [\"0.2 m\", \"2 m\"]; spacing = "
        "\"0.05 m\"; periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
        "\"0\", \"0.2 m\", \"1 m\"]; %s }, { type = \"porous\"; box = [\"0\", \"1 m\", \"0.2 m\", "
        "\"2 m\"]; %s } );\n" GRAVITY,
        lower, upper);
  advance(&run, 1e7);
  for (size_t i = 0; i < run.s.count; i++) {
    double x[3];
    richards_place(&run.s, i, x);
    most = fmax(most, fabs(run.s.h[i] - (.3 - x[2])));
  }
  report("rest: two soils over a water table, 1 + move of a head, m", 1, 1 + most, 1e-9,
         passed(started));
  finish(&run);
}

/* ---- steady flow ---- */
/* dh/dz at h: `q` downwards, m/s; or of a front that moves down at speed c. */
struct slope {
  const struct soil *soil;
  double q, c, theta;
};
static double slope_of(const struct slope *s, double h) {
  return (s->q + s->c * (theta_of(s->soil, h) - s->theta)) / k_of(s->soil, h) - 1;
}
/* h a height dz further on, in steps of 0.1 mm at most. */
static double follow(const struct slope *s, double h, double dz) {
  const int n = (int)ceil(fabs(dz) / 1e-4);
  const double d = dz / n;
  for (int i = 0; i < n; i++) {
    const double a = slope_of(s, h), b = slope_of(s, h + .5 * d * a),
                 c = slope_of(s, h + .5 * d * b), e = slope_of(s, h + d * c);
    h += d / 6 * (a + 2 * b + 2 * c + e);
  }
  return h;
}

/* The largest error of a head over its range, and of the flux through the foot. */
static double steady_error(const struct soil *soil, double q, double length, double dx,
                           double *flux) {
  struct run run;
  char top[80];
  const struct slope slope = {soil, q, 0, 0};
  snprintf(top, sizeof top, "flux = \"%.15g m/s\";", q);
  start_column(&run, length, dx, text_of(soil, "head = \"0 m\""),
               sides(length, dx, top, "head = \"0 m\";"));
  advance(&run, 3e8);
  double h = 0, z = 0, most = 0, range = 0;
  for (size_t i = 0; i < run.s.count; i++) {
    double x[3];
    richards_place(&run.s, i, x);
    h = follow(&slope, h, x[2] - z), z = x[2];
    most = fmax(most, fabs(run.s.h[i] - h)), range = fmax(range, fabs(h));
  }
  for (size_t e = 0; e < run.s.edge_count; e++)
    if (run.s.edges[e].low) *flux = -run.s.edge_flux[e].q;
  finish(&run);
  return most / range;
}

static void steady(void) {
  static const struct {
    const char *name;
    const struct soil *soil;
    double share, length, bound;
  } cases[] = {{"rain of .5 K on loam", &loam, .5, 2, .004},
               {"rain of .01 K on loam", &loam, .01, 2, .001},
               {"rain of .5 K on sand, n 6", &sand, .5, 1, .001},
               {"evaporation from loam, .03 K", &loam, -.03, .6, .001},
               {"evaporation from silt, n 1.3, .02 K", &silt, -.02, 1, .001}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const double q = cases[k].share * cases[k].soil->k, started = clock_seconds();
    double flux, error[2];
    char name[120];
    for (int fine = 0; fine < 2; fine++)
      error[fine] = steady_error(cases[k].soil, q, cases[k].length, fine ? .01 : .05, &flux);
    snprintf(name, sizeof name, "steady: %s, 1 + error of a head at 5 cm", cases[k].name);
    report(name, 1, 1 + error[0], cases[k].bound, passed(started));
    snprintf(name, sizeof name, "steady: %s, 1 + error of a head at 1 cm", cases[k].name);
    report(name, 1, 1 + error[1], cases[k].bound / 10, passed(started));
    snprintf(name, sizeof name, "steady: %s, flux through the foot", cases[k].name);
    report(name, q, flux, 1e-6, passed(started));
  }
}

/* ---- soil with an exponential curve ---- */
/* K/K_s at z above a water table, a time t after rain of q K_s begins on water at rest in a column
 * of length l; z and l in 1/alpha, t in (theta_s - theta_r)/(alpha K_s). Srivastava, Yeh (1991,
 * Water Resour. Res. 27, eqs. 13, 14), with the roots r of tan(r l) = -2 r. */
static double rained(double q, double l, double z, double t) {
  double sum = 0;
  for (int n = 0; n < 200; n++) {
    double low = (n + .5) * M_PI / l, high = (n + 1) * M_PI / l, r = low;
    const double sign = n % 2 ? -1 : 1;
    for (int k = 0; k < 60; k++) {
      r = .5 * (low + high);
      if (sign * (sin(r * l) + 2 * r * cos(r * l)) > 0)
        low = r;
      else
        high = r;
    }
    sum += sin(r * z) * sin(r * l) * exp(-r * r * t) / (1 + l / 2 + 2 * r * r * l);
  }
  return q - (q - 1) * exp(-z) - 4 * q * exp((l - z) / 2 - t / 4) * sum;
}

/* Rain of half of K_s on two metres over a water table: heads after .2 to 10 hours, and in the end
 * the steady ones of Gardner (1958), which the fluxes between sites are made for. */
static void gardner(void) {
  const struct soil soil = {.06, .4, 3, 0, 1e-5, 0, 0};
  const double length = 2, times[] = {720, 3.6e3, 3.6e4, 3e8};
  const double unit = (soil.theta_s - soil.theta_r) / (soil.alpha * soil.k);
  for (int fine = 0; fine < 2; fine++) {
    struct run run;
    const double dx = fine ? .01 : .05, started = clock_seconds();
    start_column(&run, length, dx, text_of(&soil, "head = \"0 m\""),
                 sides(length, dx, "flux = \"5e-6 m/s\";", "pressure_head = \"0 m\";"));
    for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
      double most = 0;
      char name[120];
      advance(&run, times[k]);
      for (size_t i = 0; i < run.s.count; i++) {
        double x[3];
        richards_place(&run.s, i, x);
        const double exact =
            log(rained(.5, soil.alpha * length, soil.alpha * x[2], times[k] / unit)) / soil.alpha;
        most = fmax(most, fabs(run.s.h[i] - exact) / length);
      }
      const double bound = k == 3 ? 1e-6 : .5 * dx / length; /* half a spacing */
      snprintf(name, sizeof name, "gardner: 1 + error of a head after %g h, %g mm", times[k] / 3600,
               1e3 * dx);
      report(name, 1, 1 + most, bound, passed(started));
    }
    finish(&run);
  }
}

/* ---- a front of constant shape ---- */
static void front(void) {
  const struct soil *soil = &loam;
  const double wet = -.2, dry = -3, length = 6;
  const double c =
      (k_of(soil, wet) - k_of(soil, dry)) / (theta_of(soil, wet) - theta_of(soil, dry));
  const struct slope slope = {soil, k_of(soil, dry), c, theta_of(soil, dry)};
  for (int fine = 0; fine < 2; fine++) {
    struct run run;
    char top[80], foot[80], name[120];
    const double dx = fine ? .01 : .05, started = clock_seconds(), middle = -1;
    snprintf(top, sizeof top, "pressure_head = \"%g m\";", wet);
    snprintf(foot, sizeof foot, "pressure_head = \"%g m\";", dry);
    start_column(&run, length, dx, text_of(soil, "pressure_head = \"-3 m\""),
                 sides(length, dx, top, foot));
    /* The front starts with h = -1 m at 4.5 m and goes 3 m. */
    for (int pass = 0; pass < 2; pass++) {
      double h = middle, z = pass ? 1.5 : 4.5, square = 0;
      size_t begin = 0;
      while (begin < run.s.count && dx * ((double)begin + .5) < z) begin++;
      for (int up = 0; up < 2; up++) {
        h = middle, z = pass ? 1.5 : 4.5;
        for (size_t i = up ? begin : begin - 1; i < run.s.count; up ? i++ : i--) {
          h = follow(&slope, h, dx * ((double)i + .5) - z), z = dx * ((double)i + .5);
          h = fmin(fmax(h, dry), wet - 1e-9);
          if (!pass) run.s.h[i] = h;
          const double error = run.s.now[i].theta - theta_of(soil, h);
          square += error * error * dx;
          if (i == 0) break;
        }
      }
      if (!pass) {
        richards_evaluate(&run.s, 0);
        for (size_t i = 0; i < run.s.count; i++) run.s.water[i] = run.s.now[i].theta;
        run.s.start = richards_water(&run.s);
        advance(&run, 3 / c);
        continue;
      }
      /* A shift d of the front is an error of the water above 1.5 m. */
      double water = 0, exact = 0;
      for (size_t i = 0; i < run.s.count; i++) water += run.s.now[i].theta * dx;
      exact = run.s.start / (dx * dx) + 3 * (theta_of(soil, wet) - theta_of(soil, dry));
      snprintf(name, sizeof name, "front: 3 m by a front of constant shape, spacing %g mm",
               1e3 * dx);
      report(name, 3, 3 + (water - exact) / (theta_of(soil, wet) - theta_of(soil, dry)),
             fine ? 5e-4 : 2e-3, passed(started));
      snprintf(name, sizeof name, "front: its shape, 1 + rms of theta over 6 m, spacing %g mm",
               1e3 * dx);
      report(name, 1, 1 + sqrt(square / length), fine ? 5e-4 : 5e-3, passed(started));
    }
    snprintf(name, sizeof name, "front: 1 + water unaccounted for, spacing %g mm", 1e3 * dx);
    report(name, 1, 1 + water_open(&run.s), 1e-10, passed(started));
    finish(&run);
  }
}

static void infiltration(void) {
  const double started = clock_seconds();
  struct reference r;
  char name[120];
  refer(&celia, &celia, 9, 1, 1000, -10, -.75, -10, 86400, 20, &r);
  for (int k = 0; k < 3; k++) {
    struct run run;
    const double dx = k == 0 ? .05 : k == 1 ? .025 : .01;
    start_column(&run, 1, dx, text_of(&celia, "pressure_head = \"-10 m\""),
                 sides(1, dx, "pressure_head = \"-75 cm\";", "pressure_head = \"-10 m\";"));
    advance(&run, 86400);
    snprintf(name, sizeof name, "infiltration (Celia): m in 24 h, spacing %g mm", 1e3 * dx);
    report(name, r.infiltrated, run.s.in / (dx * dx), 3e-3, passed(started));
    snprintf(name, sizeof name, "infiltration (Celia): 1 + rms of theta, spacing %g mm", 1e3 * dx);
    report(name, 1, 1 + apart(&run, &r, &celia, &celia, 9), k == 0 ? 5e-3 : 2e-3, passed(started));
    snprintf(name, sizeof name, "infiltration (Celia): 1 + water open, spacing %g mm", 1e3 * dx);
    report(name, 1, 1 + water_open(&run.s), 1e-10, passed(started));
    finish(&run);
  }
  free(r.h);
}

/* Haverkamp et al. (1977), as Celia et al. (1990) have it: 40 cm of sand from -61.5 cm on under
 * -20.7 cm, for 360 s; constants in cm, alpha = 1.611e6 and A = 1.175e6. */
static void haverkamp(void) {
  const double started = clock_seconds(), cm = .01;
  const struct soil soil = {.theta_r = .075,
                            .theta_s = .287,
                            .alpha = 1 / (pow(1.611e6, 1 / 3.96) * cm),
                            .n = 3.96,
                            .k = 34 * cm / 3600,
                            .k_alpha = 1 / (pow(1.175e6, 1 / 4.74) * cm),
                            .k_n = 4.74};
  struct reference r;
  char name[120];
  refer(&soil, &soil, 9, .4, 800, -.615, -.207, -.615, 360, .1, &r);
  for (int fine = 0; fine < 2; fine++) {
    struct run run;
    const double dx = fine ? .0025 : .01;
    start_column(&run, .4, dx, text_of(&soil, "pressure_head = \"-61.5 cm\""),
                 sides(.4, dx, "pressure_head = \"-20.7 cm\";", "pressure_head = \"-61.5 cm\";"));
    advance(&run, 360);
    snprintf(name, sizeof name, "haverkamp: m in 360 s, spacing %g mm", 1e3 * dx);
    report(name, r.infiltrated, run.s.in / (dx * dx), fine ? 3e-4 : 2e-3, passed(started));
    snprintf(name, sizeof name, "haverkamp: 1 + rms of theta, spacing %g mm", 1e3 * dx);
    report(name, 1, 1 + apart(&run, &r, &soil, &soil, 9), fine ? 2e-4 : 1e-3, passed(started));
    finish(&run);
  }
  free(r.h);
}

/* Between spacings, and between tolerances of the step. */
static void orders(void) {
  double in[3];
  for (int k = 0; k < 3; k++) {
    struct run run;
    const double dx = .04 / (1 << k);
    start_column(&run, 1, dx, text_of(&celia, "pressure_head = \"-10 m\""),
                 sides(1, dx, "pressure_head = \"-75 cm\";", "pressure_head = \"-10 m\";"));
    run.s.tolerance = 2e-4;
    advance(&run, 86400);
    in[k] = run.s.in / (dx * dx);
    finish(&run);
  }
  report("orders: of the spacing, 4 to 1 cm", 2, log2((in[0] - in[1]) / (in[1] - in[2])), .35, 0);
  double steps[3];
  for (int k = 0; k < 3; k++) {
    struct run run;
    start_column(&run, 1, .02, text_of(&celia, "pressure_head = \"-10 m\""),
                 sides(1, .02, "pressure_head = \"-75 cm\";", "pressure_head = \"-10 m\";"));
    run.s.tolerance = k == 0 ? 1.6e-2 : k == 1 ? 1e-3 : 1e-5;
    advance(&run, 86400);
    in[k] = run.s.in / (.02 * .02), steps[k] = (double)run.s.step;
    finish(&run);
  }
  report("orders: of the step, against one of 1/30", 2,
         log((in[0] - in[2]) / (in[1] - in[2])) / log(steps[1] / steps[0]), .5, 0);
  report("orders: m in 24 h by steps 10 times longer", in[2], in[0], 1e-4, 0);
}

/* Soil of other curves above: fine sand over silt, and silt over sand, a capillary barrier. */
static void layers(void) {
  static const struct {
    const char *name;
    const struct soil *lower, *upper;
    double top, time;
  } cases[] = {{"sand over silt", &silt, &sand, -.1, 2e4},
               {"silt over sand", &sand, &silt, -.1, 1.5e5}};
  for (size_t k = 0; k < 2; k++) {
    struct reference r;
    const double started = clock_seconds();
    const char *soils[2];
    char name[120];
    refer(cases[k].lower, cases[k].upper, .5, 1, 500, -3, cases[k].top, NAN, cases[k].time,
          cases[k].time / 8000, &r);
    for (int fine = 0; fine < 2; fine++) {
      struct run run;
      const double dx = fine ? .02 : .05;
      soils[0] = text_of(cases[k].lower, "pressure_head = \"-3 m\"");
      soils[1] = text_of(cases[k].upper, "pressure_head = \"-3 m\"");
      start(&run,
            "scene = { end_time = \"1000 d\"; };\ndomain = { size = [\"%g m\", \"1 m\"]; spacing = "
            "\"%g m\"; periodic = [true, false]; };\nregions = ( { type = \"porous\"; box = "
            "[\"0\", \"0\", \"%g m\", \"0.5 m\"]; %s }, { type = \"porous\"; box = [\"0\", \"0.5 "
            "m\", \"%g m\", \"1 m\"]; %s }, { type = \"inflow\"; box = [\"0\", \"0.999 m\", \"%g "
            "m\", \"1 m\"]; pressure_head = \"%g m\"; } );\n" GRAVITY,
            dx, dx, dx, soils[0], dx, soils[1], dx, cases[k].top);
      advance(&run, cases[k].time);
      snprintf(name, sizeof name, "layers: %s, m infiltrated, spacing %g mm", cases[k].name,
               1e3 * dx);
      report(name, r.infiltrated, run.s.in / (dx * dx), fine ? .001 : .003, passed(started));
      snprintf(name, sizeof name, "layers: %s, 1 + rms of theta, spacing %g mm", cases[k].name,
               1e3 * dx);
      report(name, 1, 1 + apart(&run, &r, cases[k].lower, cases[k].upper, .5), fine ? .001 : .003,
             passed(started));
      snprintf(name, sizeof name, "layers: %s, 1 + water open, spacing %g mm", cases[k].name,
               1e3 * dx);
      report(name, 1, 1 + water_open(&run.s), 1e-10, passed(started));
      finish(&run);
    }
    free(r.h);
  }
}

/* The water table under rain on half a metre of a box of sand: levels that Vauclin, Khanji and
 * Vachaud (1979) measured, read off their figure. The curve of the sand is not theirs but that by
 * which Clement, Wise and Molz (1994) computed the same, and 6 cm is what it leaves. */
static void recharge(void) {
  static const double x[3] = {.02, .7, 1.6}, hours[4] = {2, 4, 6, 8},
                      level[4][3] = {{.786, .751, .664},
                                     {1.027, .938, .762},
                                     {1.121, 1.038, .836},
                                     {1.211, 1.146, .958}};
  for (int fine = 0; fine < 2; fine++) {
    struct run run;
    const double started = clock_seconds();
    char spacing[64];
    const char *more[] = {spacing};
    snprintf(spacing, sizeof spacing, "domain.spacing=\"%s\"", fine ? "5 cm" : "10 cm");
    memset(&run, 0, sizeof run);
    must(scene_read("data-samples/scenes/recharge.cfg", more, 1, &run.scene));
    must(lattice_build(&run.scene, 0, &run.lattice));
    must(plan_make(&run.scene, &run.lattice, &method_richards, "", 1, &run.plan));
    must(richards_create(&run.scene, &run.lattice, &run.s));
    for (int t = 0; t < 4; t++) {
      advance(&run, 3600 * hours[t]);
      for (int p = 0; p < 3; p++) {
        const double at[3] = {x[p], 0, .5}, found = richards_level_at(&run.s, at);
        char name[120];
        snprintf(name, sizeof name, "recharge (Vauclin): level at %g m, %g h, spacing %g cm", x[p],
                 hours[t], fine ? 5. : 10.);
        report(name, level[t][p], found, .075 / level[t][p], passed(started));
      }
    }
    report("recharge: 1 + water open", 1, 1 + water_open(&run.s), 1e-10, passed(started));
    finish(&run);
  }
}

/* Dry sand, sharp fronts, n from 1.1 to 10: right to what is left between spacings, and balanced.
 */
static void hard(void) {
  static const struct {
    const char *name;
    struct soil soil;
    const char *start, *top;
    double time, bound;
  } cases[] = {{"sand, n 10, from -1e4 m",
                {.05, .4, 5, 10, 1e-4, 0, 0},
                "pressure_head = \"-1e4 m\"",
                "pressure_head = \"0 m\";",
                1000,
                .004},
               {"sand, n 4, 10 cm of water on it",
                {.05, .4, 5, 4, 1e-4, 0, 0},
                "pressure_head = \"-1e4 m\"",
                "pressure_head = \"0.1 m\";",
                1000,
                .004},
               {"clay, n 1.1, from -1e4 m",
                {.05, .4, .5, 1.1, 1e-7, 0, 0},
                "pressure_head = \"-1e4 m\"",
                "pressure_head = \"0 m\";",
                8.64e5,
                .01},
               {"drained by its foot, n 10",
                {.05, .4, 5, 10, 1e-4, 0, 0},
                "head = \"1 m\"",
                "flux = \"0 m/s\";",
                8.64e4,
                .006}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double moved[2];
    const double started = clock_seconds();
    char name[120];
    for (int fine = 0; fine < 2; fine++) {
      struct run run;
      const double dx = fine ? .005 : .025;
      start_column(&run, 1, dx, text_of(&cases[k].soil, cases[k].start),
                   sides(1, dx, cases[k].top, k == 3 ? "pressure_head = \"0 m\";" : NULL));
      advance(&run, cases[k].time);
      moved[fine] = (run.s.in + run.s.out) / (dx * dx);
      snprintf(name, sizeof name, "hard: %s, 1 + water open, %g mm", cases[k].name, 1e3 * dx);
      report(name, 1, 1 + water_open(&run.s), 1e-10, passed(started));
      finish(&run);
    }
    snprintf(name, sizeof name, "hard: %s, m moved, 25 mm against 5", cases[k].name);
    report(name, moved[1], moved[0], cases[k].bound, passed(started));
  }
}

/* ---- water that sinks into dry soil ---- */
static void basin(void) {
  static const struct {
    const char *name;
    const struct soil *soil;
    double time;
  } cases[] = {{"dry loam", &loam, 7200}, {"dry sand", &sand, 900}, {"dry silt", &silt, 36000}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    struct reference r;
    double started = clock_seconds(), water = .3;
    refer_below(cases[k].soil, cases[k].soil, 9, 1, 500, -3, &water, true, NAN, cases[k].time,
                cases[k].time / 5000, &r);
    for (int fine = 0; fine < 2; fine++) {
      struct run run;
      const double dx = fine ? .025 : .05;
      char name[120];
      start(&run,
            "scene = { end_time = \"1000 d\"; };\ndomain = { size = [\"%g m\", \"1.5 m\"]; spacing "
            "= \"%g m\"; periodic = [true, false]; };\nregions = ( { type = \"porous\"; box = "
            "[\"0\", \"0\", \"%g m\", \"1 m\"]; %s }, { type = \"water\"; box = [\"0\", \"1 m\", "
            "\"%g m\", \"1.3 m\"]; } );\n" GRAVITY,
            dx, dx, dx, text_of(cases[k].soil, "pressure_head = \"-3 m\""), dx);
      advance(&run, cases[k].time);
      snprintf(name, sizeof name, "basin: into %s, m of .3 gone, %g mm", cases[k].name, 1e3 * dx);
      report(name, .3 - water, .3 - run.s.pool_volumes[0] / (dx * dx), fine ? .005 : .01,
             passed(started));
      snprintf(name, sizeof name, "basin: into %s, 1 + water open, %g mm", cases[k].name, 1e3 * dx);
      report(name, 1, 1 + water_open(&run.s), 1e-10, passed(started));
      finish(&run), started = clock_seconds();
    }
    free(r.h);
  }
}

/* What drain number `region` takes, m^2/s for each m along y. */
static double drained(const struct run *run, size_t region) {
  double sum = 0;
  for (size_t e = 0; e < run->s.edge_count; e++)
    if (run->s.edges[e].region == &run->scene.regions[region]) sum -= run->s.edge_flux[e].q;
  return sum * run->s.spacing;
}

/* A drain of 1 to 4 spacings across in a square of full soil of side w between four heads, its
 * centre anywhere on the lattice: 2 pi k H/ln(1.0787 w/(2 r)) (Balcerzak, Raynor 1961), which half
 * a spacing off the middle changes by under .1 %. */
static void narrow_drains(void) {
  static const struct {
    double wide, off[2], bound;
  } cases[] = {{4, {0, 0}, .01},     {4, {.5, .5}, .01},   {4, {.5, 0}, .01},  {4, {.25, .25}, .01},
               {4, {.4, .1}, .01},   {4, {.07, .31}, .01}, {2, {0, 0}, .02},   {2, {.5, .5}, .02},
               {2, {.25, .25}, .02}, {2, {.07, .31}, .02}, {1, {.5, .5}, .05}, {1, {.4, .1}, .05},
               {1, {.25, .25}, .05}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    const double started = clock_seconds(), dx = .01, wide = cases[n].wide, *off = cases[n].off;
    const double exact = 2 * M_PI * sand.k * .5 / log(1.0787 * .5 / (wide * dx));
    struct run run;
    char name[96];
    start(&run,
          "scene = { end_time = \"1000 d\"; };\n"
          "domain = { size = [\"0.5 m\", \"0.5 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.5 m\", \"0.5 "
          "m\"]; %s },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"5 mm\", \"0.5 m\"]; pressure_head = \"0.5 "
          "m\"; },\n{ type = \"inflow\"; box = [\".495 m\", \"0\", \".5 m\", \"0.5 m\"]; "
          "pressure_head = \"0.5 m\"; },\n{ type = \"inflow\"; box = [\"5 mm\", \"0\", \".495 m\", "
          "\"5 mm\"]; pressure_head = \"0.5 m\"; },\n{ type = \"inflow\"; box = [\"5 mm\", \".495 "
          "m\", \".495 m\", \"0.5 m\"]; pressure_head = \"0.5 m\"; },\n{ type = \"drain\"; name = "
          "\"pipe\"; centre = [\"%.9g m\", \"%.9g m\"]; radius = \"%g m\"; } );\n",
          dx, text_of(&sand, "pressure_head = \"0.5 m\""), .25 + off[0] * dx, .25 + off[1] * dx,
          .5 * wide * dx);
    advance(&run, 1e4);
    snprintf(name, sizeof name, "drain of %g spacings, centre off by (%g, %g)", wide, off[0],
             off[1]);
    report(name, exact, drained(&run, 5), cases[n].bound, passed(started));
    finish(&run);
  }
}

/* Rain of a tenth of K on .4 m of soil with a drain of the air's pressure in its middle: the level
 * of the water beside the closed side, and what is drained until it is steady. */
static void rain_to_drain(double dx, const double centre[2], double *level, double *taken) {
  struct run run;
  const double beside[3] = {.03, 0, .05};
  start(&run,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"0.4 m\", \"0.4 m\"]; spacing = \"%.12g m\"; periodic = [false, "
        "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.4 "
        "m\"]; %s },\n{ type = \"drain\"; name = \"pipe\"; centre = [\"%.9g m\", \"%.9g m\"]; "
        "radius = \"4 cm\"; },\n{ type = \"rain\"; box = [\"0\", \"0.399 m\", \"0.4 m\", \"0.4 "
        "m\"]; rate = \"%g m/s\"; } );\n" GRAVITY,
        dx, text_of(&sand, "head = \"0.2 m\""), centre[0], centre[1], .1 * sand.k);
  advance(&run, 600);
  *taken = -run.s.entered[1] / run.s.spacing;
  advance(&run, 4000);
  *level = richards_level_at(&run.s, beside);
  finish(&run);
}

/* A drain of 4 spacings across with the water table at it, its centre anywhere on the lattice,
 * against a lattice three times finer. */
static void drains_at_table(void) {
  static const double centres[][2] = {{0, 0}, {.5, .5}, {.25, .65}, {.43, .17}};
  for (int n = 0; n < 4; n++) {
    const double started = clock_seconds(), dx = .02;
    const double centre[2] = {.2 + centres[n][0] * dx, .16 + centres[n][1] * dx};
    double level[2], taken[2];
    char name[96];
    rain_to_drain(dx, centre, &level[0], &taken[0]);
    rain_to_drain(dx / 3, centre, &level[1], &taken[1]);
    snprintf(name, sizeof name, "drain of 4 spacings at a water table, off by (%g, %g): level",
             centres[n][0], centres[n][1]);
    report(name, level[1], level[0], .1 * dx / level[1], passed(started));
    snprintf(name, sizeof name, "drain of 4 spacings at a water table, off by (%g, %g): taken",
             centres[n][0], centres[n][1]);
    report(name, taken[1], taken[0], .03, passed(started));
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"rest", rest},
                                             {"steady", steady},
                                             {"front", front},
                                             {"gardner", gardner},
                                             {"infiltration", infiltration},
                                             {"haverkamp", haverkamp},
                                             {"orders", orders},
                                             {"layers", layers},
                                             {"hard", hard},
                                             {"basin", basin},
                                             {"recharge", recharge},
                                             {"narrow", narrow_drains},
                                             {"table", drains_at_table}};
  return rows_of_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
