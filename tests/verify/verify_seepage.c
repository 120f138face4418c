/* Seepage, windows and moving bodies by method isph against exact solutions (docs/physics/isph.md
 * names each). Usage: verify_seepage RESULTS.json [CASE...]     all cases, or those whose names
 * start with CASE */
#include "tests/verify/isph_rig.h"
#include "tests/verify/soils.h"

/* Fully saturated soil without walls: v_D = 2 G g / (a + sqrt(a^2 + 4 b G g)). The same flow for
 * any size of the box, so the finer one is smaller. */
static void steady_columns(void) {
  static const struct {
    double eps, grain;
    const char *form;
    double v;
  } table[] = {{.3, 1e-2, "akbari", 3.4907e-2}, {.3, 1e-3, "akbari", 5.4009e-4},
               {.3, 1e-4, "akbari", 5.4055e-6}, {.5, 1e-2, "akbari", 1.2831e-1},
               {.8, 1e-2, "akbari", 4.6881e-1}, {.3, 1e-2, "m15", 7.9890e-2},
               {.3, 1e-3, "m15", 1.7968e-3},    {.3, 1e-4, "m15", 1.8018e-5},
               {.5, 1e-2, "m15", 1.8966e-1},    {.8, 1e-2, "m15", 5.2520e-1}};
  for (size_t k = 0; k < 2 * sizeof table / sizeof *table; k++) {
    struct run run = {0};
    char name[96];
    double started = clock_seconds(), dx = k % 2 == 0 ? .01 : .005, v[3];
    size_t i = k / 2;
    start(&run,
          "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
          "domain = { size = [\"%g m\", \"%g m\", \"%g m\"]; spacing = \"%g m\"; "
          "periodic = [true, true, true]; };\n"
          "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0\", \"%g m\", \"%g m\", "
          "\"%g m\"]; porosity = %g; grain_size = \"%g m\"; } );\n"
          "force = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\n"
          "isph = { form = \"%s\"; dt = \"1 ms\"; };\n",
          5 * dx, 5 * dx, 8 * dx, dx, 5 * dx, 5 * dx, 8 * dx, table[i].eps, table[i].grain,
          table[i].form);
    advance(&run, 0.5);
    isph_darcy_velocity(&run.s, v);
    snprintf(name, sizeof name, "column: %s eps %g D50 %g mm, spacing %g mm", table[i].form,
             table[i].eps, 1e3 * table[i].grain, 1e3 * dx);
    report(name, table[i].v, -v[2], 0.01 * table[i].v, started);
    finish(&run);
  }
}

/* Two soils one after the other between fixed heads: the same v_D in both, a_1 v + b_1 v^2 and
 * a_2 v + b_2 v^2 share the head. */
static void series(void) {
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), flux = 0, head = 0, contact[3] = {.2, 0, .05};
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"4 s\"; };\n"
          "domain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity = 0.4; "
          "grain_size = \"5 mm\"; },\n"
          "{ type = \"porous\"; box = [\"0.2 m\", \"0\", \"0.4 m\", \"0.1 m\"]; porosity = 0.3; "
          "grain_size = \"5 mm\"; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = \"0.4 m\"; },\n"
          "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; "
          "} );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
          "isph = { dt = \"2 ms\"; wall = { slip = true; }; };\n",
          fine ? .005 : .01);
    for (int k = 1; k <= 20; k++) {
      advance(&run, 1 + 0.1 * k);
      flux += flux_at(&run.s, 0.2) / 20;
      head += (pressure_at(&run.s, contact) / 9810 + .05) / 20;
    }
    double a[2], b[2], eps[2] = {.4, .3}, low = 0, high = 1;
    for (int k = 0; k < 2; k++) {
      a[k] = 1000 * 1e-6 * pow(1 - eps[k], 2) / (pow(eps[k], 3) * 25e-6);
      b[k] = 1.1 * (1 - eps[k]) / (pow(eps[k], 3) * 5e-3);
    }
    for (int k = 0; k < 60; k++) {
      double v = .5 * (low + high), drop = 0;
      for (int m = 0; m < 2; m++) drop += .2 * (a[m] * v + b[m] * v * v);
      if (drop > 9.81 * .2)
        high = v;
      else
        low = v;
    }
    double area = .1 * run.scene.spacing;
    snprintf(name, sizeof name, "two soils in series: v_D, spacing %g mm", 1e3 * run.scene.spacing);
    report(name, low, flux / area, .03 * low, started);
    double fall = .2 * (a[0] * low + b[0] * low * low) / 9.81;
    snprintf(name, sizeof name, "two soils in series: head at the contact, %g mm",
             1e3 * run.scene.spacing);
    report(name, .4 - fall, head, .03 * .2, started);
    finish(&run);
  }
}

/* Falling head (verification.md): water stands on soil, L = .2 m, and drains below against a head
 * level with the soil's top; time at which h has fallen to .05 m. */
static void falling_head(void) {
  static const double h[] = {.25, .2, .15, .1, .05};
  static const double t[] = {2.8376, 6.2590, 10.6015, 16.6217, 26.7343};
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), dx = fine ? .005 : .01, last = 0;
    double before = .3, inside = .3;
    char name[96];
    start(
        &run,
        "scene = { method = \"isph\"; end_time = \"40 s\"; };\n"
        "domain = { size = [\"0.05 m\", \"0.55 m\"]; spacing = \"%g m\"; periodic = [true, "
        "false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.05 m\", \"0.5 m\"]; },\n"
        "{ type = \"porous\"; box = [\"0\", \"0\", \"0.05 m\", \"0.2 m\"]; porosity = 0.39; "
        "grain_size = \"3 mm\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"0.05 m\", \"1 cm\"]; head = \"0.2 m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
        dx);
    /* Particles leave one by one: as one's middle crosses the side, half of it is out. */
    for (int k = 0; k < 5 && run.s.time < 39;) {
      advance(&run, run.s.time + .02);
      double now = -.39 * .2;
      for (size_t i = 0; i < run.s.count; i++) now += run.s.mass[i] / 1000 / .05;
      if (now == inside) continue;
      double level = .5 * (now + inside);
      for (; k < 5 && level <= h[k]; k++) {
        double at = last + (run.s.time - last) * (before - h[k]) / (before - level);
        snprintf(name, sizeof name, "falling head: time to %g m, spacing %g mm", h[k], 1e3 * dx);
        report(name, t[k], at, (fine ? .02 : .04) * t[k], started);
      }
      inside = now, before = level, last = run.s.time;
    }
    finish(&run);
  }
}

/* Soil in a tank between two heads: beside the walls the water goes as fast as elsewhere. */
static void walled_column(void) {
  static const double eps[] = {.3, .5, .8};
  for (int k = 0; k < 6; k++) {
    struct run run = {0};
    double started = clock_seconds(), e = eps[k % 3], near = 0, weight = 0, all = 0, v[3];
    double dx = k < 3 ? .01 : .005, d = 5e-3;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
          "domain = { size = [\"0.1 m\", \"0.3 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.3 m\"]; porosity = "
          "%g; grain_size = \"5 mm\"; saturated = true; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0\", \"0.1 m\", \"1 cm\"]; head = \"0.3 m\"; },\n"
          "{ type = \"inflow\"; box = [\"0\", \"0.29 m\", \"0.1 m\", \"0.3 m\"]; head = \"0.6 m\"; "
          "} );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          dx, e);
    double a = 1000e-6 * pow(1 - e, 2) / (pow(e, 3) * d * d), b = 1.1 * (1 - e) / (pow(e, 3) * d);
    double exact = 2 * 9.81 / (a + sqrt(a * a + 4 * b * 9.81));
    double passing = .3 * e / exact; /* time a particle takes */
    for (int n = 1; n <= 40; n++) {
      advance(&run, passing * (.5 + .025 * n));
      isph_darcy_velocity(&run.s, v);
      all -= v[2] / 40;
      for (size_t i = 0; i < run.s.count; i++) {
        const double *x = run.s.position[i];
        if (fmin(x[0], .1 - x[0]) > dx || fabs(x[2] - .15) > .1) continue;
        near -= run.s.volume[i] * run.s.velocity[i][2], weight += run.s.volume[i];
      }
    }
    snprintf(name, sizeof name, "walled column: v_D, eps %g, spacing %g mm", e, 1e3 * dx);
    report(name, exact, all, .03 * exact, started);
    snprintf(name, sizeof name, "walled column: v_D beside the wall, eps %g, %g mm", e, 1e3 * dx);
    report(name, exact, near / weight, .03 * exact, started);
    finish(&run);
  }
}

/* A given flux of free water through a channel: what a plane shows, and how much it pulses. */
static void given_flux(void) {
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), dx = fine ? .005 : .01, mean = 0, square = 0;
    char name[96];
    start(
        &run,
        "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
        "domain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = \"%g m\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; flux = \"0.05 m/s\"; },\n"
        "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; "
        "} );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
        "isph = { wall = { slip = true; }; };\n",
        dx);
    for (int k = 1; k <= 100; k++) {
      advance(&run, .5 + .02 * k);
      double flux = flux_at(&run.s, .05) / (.1 * dx);
      mean += flux / 100, square += flux * flux / 100;
    }
    snprintf(name, sizeof name, "given flux: plane 5 cm behind the side, %g mm", 1e3 * dx);
    report(name, .05, mean, .01 * .05, started);
    snprintf(name, sizeof name, "given flux: its rms about the mean, relative, %g mm", 1e3 * dx);
    report(name, 0, sqrt(fmax(0, square / (mean * mean) - 1)), .05, started);
    finish(&run);
  }
}

/* A block of soil moves through a closed ring of water. d eps/dt + div v_D = 0 makes v_D + (1 -
 * eps) v_soil the same all round, and with no other force than its drag the water goes along with
 * the soil: v_D = v_soil in the free two thirds, eps v_soil in the block. */
static void moving_soil(void) {
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), dx = fine ? .005 : .01, v[3];
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
          "domain = { size = [\"0.3 m\", \"0.05 m\"]; spacing = \"%g m\"; periodic = [true, true]; "
          "};\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.3 m\", \"0.05 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.05 m\"]; porosity = 0.4; "
          "grain_size = \"2 mm\"; velocity = [\"0.1 m/s\", \"0\"]; } );\n"
          "force = { gravity = [\"0\", \"0\"]; };\nisph = { dt = \"2 ms\"; };\n",
          dx);
    advance(&run, 2);
    isph_darcy_velocity(&run.s, v);
    snprintf(name, sizeof name, "moving soil: v_D of a ring, spacing %g mm", 1e3 * dx);
    report(name, .08, v[0], (fine ? .02 : .04) * .08, started);
    finish(&run);
  }
}

/* A piston pushes water along a channel to an open end: all of it goes with the piston. */
static void piston(void) {
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), dx = fine ? .005 : .01, worst = 0;
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"2 s\"; };\n"
          "domain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"water\"; box = [\"0.05 m\", \"0\", \"0.4 m\", \"0.1 m\"]; },\n"
          "{ type = \"wall\"; box = [\"0\", \"0\", \"0.05 m\", \"0.1 m\"]; slip = true; velocity "
          "= [\"0.1 m/s\", \"0\"]; },\n"
          "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; "
          "} );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
          "isph = { wall = { slip = true; }; };\n",
          dx);
    for (int k = 1; k <= 50; k++) {
      advance(&run, .02 * k);
      double flux = flux_at(&run.s, .25) / (.1 * dx);
      if (k > 10) worst = fmax(worst, fabs(flux / .1 - 1));
    }
    snprintf(name, sizeof name, "piston: worst error of the flux, spacing %g mm", 1e3 * dx);
    report(name, 0, worst, .05, started);
    snprintf(name, sizeof name, "piston: particles lost, spacing %g mm", 1e3 * dx);
    report(name, 0, (double)run.s.lost_count, 0, started);
    finish(&run);
  }
}

/* Poiseuille flow between walls that do not fit the lattice (0.37 spacings off): flow over exact,
 * G L^3 / (12 nu), for walls that hold; and for walls that slip plug flow, G t L. */
static void walls_between_sites(void) {
  for (int k = 0; k < 4; k++) {
    struct run run = {0};
    bool slip = k % 2 == 1;
    int n = k < 2 ? 16 : 32;
    double started = clock_seconds(), dx = 1.0 / n, v[3];
    char name[96];
    start(
        &run,
        "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
        "domain = { size = [\"%g m\", \"%g m\"]; spacing = \"%g m\"; periodic = [true, false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%g m\", \"%g m\"]; },\n"
        "{ type = \"wall\"; box = [\"0\", \"0\", \"%g m\", \"%g m\"]; slip = %s; },\n"
        "{ type = \"wall\"; box = [\"0\", \"%g m\", \"%g m\", \"%g m\"]; slip = %s; } );\n"
        "force = { body_acceleration = [\"1 m/s^2\", \"0\"]; };\n",
        8 * dx, 1 + 8 * dx, dx, 8 * dx, 1 + 8 * dx, 8 * dx, 4.37 * dx, slip ? "true" : "false",
        1 + 4.37 * dx, 8 * dx, 1 + 8 * dx, slip ? "true" : "false");
    run.s.kinematic_viscosity = 1;
    run.plan.dt = .1 * dx * dx;
    advance(&run, .6);
    isph_darcy_velocity(&run.s, v);
    snprintf(name, sizeof name, "walls between sites: flow over exact, %s, %d across",
             slip ? "slip" : "no slip", n);
    report(name, 1, v[0] * (1 + 8 * dx) / (slip ? .6 : 1.0 / 12), n == 16 ? .06 : .03, started);
    finish(&run);
  }
}

/* Channel, soil below y = .5, nu = G = 1: verification.md's nine values; largest error over the
 * largest velocity. */
static void half_porous(void) {
  static const double u[] = {.00541, .00891, .01197, .01584, .022122,
                             .03770, .04327, .03885, .02442};
  for (int fine = 0; fine < 2; fine++) {
    struct run run = {0};
    double started = clock_seconds(), h = fine ? .025 : .05, worst = 0;
    char name[96];
    start(
        &run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"%g m\", \"1 m\"]; spacing = \"%g m\"; periodic = [true, false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%g m\", \"1 m\"]; },\n"
        "{ type = \"porous\"; box = [\"0\", \"0\", \"%g m\", \"0.5 m\"]; porosity = 0.4; "
        "grain_size = \"10 cm\"; alpha = 0.1777777777; beta = 0.0; } );\n"
        "force = { body_acceleration = [\"1 m/s^2\", \"0\"]; };\n",
        4 * h, h, 4 * h, 4 * h);
    run.s.kinematic_viscosity = 1;
    run.plan.dt = .1 * h * h;
    advance(&run, 1);
    for (int k = 0; k < 9; k++) {
      double y = .1 * (k + 1), s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
      for (size_t i = 0; i < run.s.count; i++) {
        double d = (run.s.position[i][2] - y) / h, w = exp(-d * d), v = run.s.velocity[i][0];
        s0 += w, s1 += w * d, s2 += w * d * d, t0 += w * v, t1 += w * d * v;
      }
      double value = (t0 * s2 - t1 * s1) / (s0 * s2 - s1 * s1);
      worst = fmax(worst, fabs(value - u[k]) / .04327);
    }
    snprintf(name, sizeof name, "half-porous channel: worst error / u_max, %d sites",
             fine ? 40 : 20);
    report(name, 0, worst, fine ? .05 : .1, started);
    finish(&run);
  }
}

/* Soils side by side, porosity .5 and .3 half each, over 10 s or until water has gone through
 * several layers. */
static void soils_side_by_side(void) {
  static const struct {
    const char *name;
    enum side_by_side kind;
    double thick, grain, end;
  } table[] = {
      {"along", ALONG_LAYERS, .05, 3e-3, 10},     {"along, coarse", ALONG_LAYERS, .05, 1e-2, 4},
      {"across", ACROSS, .05, 3e-3, 10},          {"across, coarse", ACROSS, .05, 1e-2, 4},
      {"at 45 degrees", OBLIQUE, .0707, 5e-4, 2}, {"checkerboard", CHECKERBOARD, .1, 5e-4, 2}};
  const double f = 2;
  for (size_t k = 0; k < 2 * sizeof table / sizeof *table; k++) {
    struct run run = {0};
    char name[96], soils[12000];
    const size_t i = k / 2;
    const enum side_by_side kind = table[i].kind;
    double started = clock_seconds(), dx = k % 2 == 0 ? .01 : .005, v[3], sum = 0, time = 0;
    const double grain = table[i].grain, exact = through_soils(kind, grain, f);
    const double turn = kind == OBLIQUE ? M_SQRT1_2 : 1;
    write_soils(soils, sizeof soils, kind, table[i].thick, dx, grain);
    start(&run,
          "scene = { method = \"isph\"; end_time = \"%g s\"; };\n"
          "domain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = \"%g m\"; periodic = [true, true]; "
          "};\nregions = ( %s );\n"
          "force = { body_acceleration = [\"%.9g m/s^2\", \"%.9g m/s^2\"]; };\n",
          table[i].end, dx, soils, f * turn, kind == OBLIQUE ? f * turn : 0);
    while (run.s.time < table[i].end - 1e-9) {
      const double before = run.s.time;
      advance(&run, fmin(table[i].end, before + .1));
      if (run.s.time < .5 * table[i].end) continue;
      isph_darcy_velocity(&run.s, v);
      sum += (v[0] + (kind == OBLIQUE ? v[2] : 0)) * turn * (run.s.time - before);
      time += run.s.time - before;
    }
    snprintf(name, sizeof name, "soils side by side: %s, spacing %g mm", table[i].name, 1e3 * dx);
    report(name, exact, sum / time, (k % 2 == 0 ? .03 : .015) * exact, started);
    finish(&run);
  }
}

/* Soil between two heads with free water before and behind it, over long runs with the automatic
 * step, until water of another spacing than what it starts with fills the soil: particles of unlike
 * mass once clumped beside it, to kernel sums of .4 to .6, and ended them after 9 and 24 s. Bounds
 * are the error that `explain` expects. (Short runs: verify_darcy.) */
static void between_heads(double eps, double grain, double end) {
  struct run run = {0};
  char name[96];
  double started = clock_seconds(), sum = 0, volume = 0, least = INFINITY;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"%g s\"; };\n"
        "domain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = \"1 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0.1 m\", \"0\", \"0.3 m\", \"0.1 m\"]; "
        "porosity = %g; grain_size = \"%g m\"; },\n"
        "{ type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = \"0.3 m\"; },\n"
        "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; "
        "} );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
        "isph = { wall = { slip = true; }; };\n",
        end, eps, grain);
  for (int row = 0; row < 20; row++) {
    advance(&run, end * (.525 + .025 * row));
    for (size_t p = 0; p < run.s.count; p++) {
      least = fmin(least, run.s.kernel_sum[p]);
      if (!(fabs(run.s.position[p][0] - .2) < .05)) continue;
      sum += run.s.volume[p] * run.s.velocity[p][0], volume += run.s.volume[p];
    }
  }
  const double exact = through(drag_a(eps, grain), drag_b(eps, grain), .5 * 9.81);
  snprintf(name, sizeof name, "between heads for long: eps %g, grains of %g mm", eps, 1e3 * grain);
  report(name, exact, sum / volume, run.plan.expected.error * exact, started);
  snprintf(name, sizeof name, "between heads for long: least kernel sum, eps %g", eps);
  report(name, 1, least, .35, started);
  finish(&run);
}

static void long_runs(void) {
  between_heads(.2, 1e-2, 15);
  between_heads(.3, 5e-3, 30);
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {
      {"column", steady_columns}, {"series", series},
      {"falling", falling_head},  {"walled", walled_column},
      {"flux", given_flux},       {"moving", moving_soil},
      {"piston", piston},         {"between", walls_between_sites},
      {"half", half_porous},      {"soils", soils_side_by_side},
      {"long", long_runs}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
