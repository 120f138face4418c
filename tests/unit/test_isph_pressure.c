/* Method isph: pressures that one can read. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sphsolve/isph/output.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/moment.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"
#include "tests/unit/isph_scene.h"

/* A sheet of one row that an impact has squeezed to two thirds of its length stays a surface, in
 * 2-D and, a row across, in 3-D: neighbours above and below are missing, whatever the kernel sum.
 */
static void a_squeezed_sheet_is_a_surface(void **state) {
  (void)state;
  static const char *const texts[] = {
      "domain = { size = [\"40 cm\", \"20 cm\"]; spacing = \"1 cm\"; periodic = [false, false]; "
      "};\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"10 cm\", \"40 cm\", \"11 cm\"]; } );\n",
      "domain = { size = [\"20 cm\", \"10 cm\", \"10 cm\"]; spacing = \"1 cm\"; periodic = [false, "
      "true, false]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"5 cm\", \"20 cm\", \"10 cm\", "
      "\"6 cm\"]; } );\n"};
  for (int k = 0; k < 2; k++) {
    struct run run;
    char text[1024];
    double dense = 0;
    snprintf(text, sizeof text,
             "%sscene = { method = \"isph\"; end_time = \"1 s\"; };\n"
             "force = { gravity = [%s\"0\", \"-9.81 m/s^2\"]; };\n",
             texts[k], k == 1 ? "\"0\", " : "");
    start(&run, text);
    for (size_t i = 0; i < run.s.count; i++) run.s.position[i][0] *= k == 0 ? .66 : .5;
    assert_int_equal(isph_refresh(&run.s), STATUS_OK);
    for (size_t i = 0; i < run.s.count; i++) {
      dense = fmax(dense, run.s.kernel_sum[i]);
      assert_true(run.s.surface[i] == 1);
    }
    assert_true(dense > .8); /* by which alone it would be inside */
    finish(&run);
  }
}

/* The least eigenvalue of Q diag(.3, .7, 1) Q, Q a reflection. */
static void the_least_moment_is_found(void **state) {
  (void)state;
  const double n[3] = {2. / 7, 3. / 7, 6. / 7}, of[3] = {.3, .7, 1};
  double t[6] = {0};
  for (int e = 0; e < 3; e++)
    for (int a = 0, k = 0; a < 3; a++)
      for (int b = a; b < 3; b++, k++)
        t[k] += of[e] * ((a == e) - 2 * n[a] * n[e]) * ((b == e) - 2 * n[b] * n[e]);
  assert_true(fabs(symmetric_least(t, false, 2) - .3) < 1e-12);
  assert_true(symmetric_least((double[6]){.9, .1, 0, .8, .1, 1}, false, .5) >= .5);
  assert_true(fabs(symmetric_least((double[6]){.5, 0, .2, 0, 0, .8}, true, 2) - .4) < 1e-12);
}

/* Tanks side by side, one full to its lid: it has no surface, and its pressure begins at nothing
 * under the lid; and one that wants four particles to be full, which no surface particle that comes
 * and goes turns into megapascals. */
static void full_water_is_still(void **state) {
  (void)state;
  static const char settings[] =
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"1 ms\"; };\n"
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"20 cm\", \"10 cm\"]; spacing = \"1 cm\"; periodic = [false, false]; "
      "};\n";
  static const struct {
    const char *regions;
    double foot[3];
    double swing; /* of its pressure, over rho g H */
    int steps;    /* the last 50 are judged: the void is shut after 320 */
  } cases[] = {{"regions = ( { type = \"wall\"; box = [\"10 cm\", \"0\", \"13 cm\", \"10 cm\"]; }, "
                "{ type = \"water\"; box = [\"0\", \"0\", \"10 cm\", \"5 cm\"]; }, "
                "{ type = \"water\"; box = [\"13 cm\", \"0\", \"20 cm\", \"10 cm\"]; } );\n",
                {.165, 0, 0},
                .01,
                200},
               {"regions = ( { type = \"water\"; box = [\"0\", \"0\", \"20 cm\", \"10 cm\"]; }, "
                "{ type = \"empty\"; box = [\"0\", \"8 cm\", \"2 cm\", \"10 cm\"]; } );\n",
                {.1, 0, 0},
                .02,
                500}};
  for (int k = 0; k < 2; k++) {
    struct run run;
    char text[1200];
    snprintf(text, sizeof text, "%s%s", settings, cases[k].regions);
    start(&run, text);
    assert_int_equal(run.s.enclosed_count, k == 0);
    for (int step = 0; step < cases[k].steps; step++) {
      assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
      double head = pressure_at(&run.s, cases[k].foot) / (1000 * 9.81 * .1);
      assert_true(head < 10); /* 4.3 in the step in which the void falls shut */
      if (step >= cases[k].steps - 50) assert_true(fabs(head - 1) <= cases[k].swing);
    }
    double squares = 0;
    for (size_t i = 0; i < run.s.count; i++)
      for (int a = 0; a < 3; a++) squares += pow(run.s.velocity[i][a], 2) / (double)run.s.count;
    print_message("rms velocity %g m/s\n", sqrt(squares));
    assert_true(sqrt(squares) < (k == 0 ? .001 : .04));
    assert_int_equal(run.s.enclosed_count, 1);
    finish(&run);
  }
}

/* A column that collapses, at the step the program chooses: from one step to the next its pressure
 * changes as the flow does, by less than 2 % (by a third when shifting turned particles over). */
static void pressure_does_not_alternate(void **state) {
  (void)state;
  struct run run;
  static const double at[3] = {.07, 0, .05};
  start(&run, "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
              "domain = { size = [\"50 cm\", \"30 cm\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"15 cm\", \"28 cm\"]; } );\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  double before = 0, worst = 0;
  while (run.s.time < 0.16) {
    const char *limit;
    assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
    double now = pressure_at(&run.s, at);
    if (run.s.time > 0.07) worst = fmax(worst, fabs(now / before - 1));
    before = now;
  }
  print_message("largest change of pressure in a step %.2g %%\n", 100 * worst);
  assert_true(worst < 0.02);
  finish(&run);
}

/* Mean Darcy velocity of the water between two places along x, m/s. */
static double velocity_between(const struct isph *s, double from, double to) {
  double sum = 0, volume = 0;
  for (size_t i = 0; i < s->count; i++)
    if (s->position[i][0] > from && s->position[i][0] < to)
      sum += s->volume[i] * s->velocity[i][0], volume += s->volume[i];
  return sum / volume;
}

/* Two soils whose drags differ by 1e4 to 1e6, one behind the other between two heads: what seeps is
 * what the finer one lets through, and it is the same from step to step. A trace of coarse soil at
 * the particles of the fine one, and normals of the interface that differ, stirred the water (5 m/s
 * in the first 10 steps where 1e-8 seep); pressures as exact as the velocities of all the water let
 * the flux jump by a third. */
static void soils_that_differ_much_stay_still(void **state) {
  (void)state;
  static const struct {
    double porosity[2], grain[2];
  } cases[] = {{{.47, .2}, {2.5e-3, 1.4e-5}}, {{.84, .76}, {5e-3, 1e-4}}, {{.2, .6}, {8e-6, 7e-5}}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    struct run run;
    char text[1200];
    const char *limit;
    double resistance = 0, v, sum = 0, least = INFINITY, most = -INFINITY;
    for (int n = 0; n < 2; n++) {
      const double eps = cases[k].porosity[n], d = cases[k].grain[n];
      resistance += .1 * 1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * d * d);
    }
    snprintf(text, sizeof text,
             "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
             "domain = { size = [\"34 cm\", \"6 cm\"]; spacing = \"1 cm\"; periodic = [false, "
             "false]; };\n"
             "regions = ( { type = \"porous\"; box = [\"7 cm\", \"0\", \"17 cm\", \"6 cm\"]; "
             "porosity = %g; "
             "grain_size = \"%g m\"; },\n"
             "{ type = \"porous\"; box = [\"17 cm\", \"0\", \"27 cm\", \"6 cm\"]; porosity = %g; "
             "grain_size = \"%g m\"; },\n"
             "{ type = \"water\"; box = [\"0\", \"0\", \"34 cm\", \"6 cm\"]; },\n"
             "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"6 cm\"]; head = \"0.1 m\"; },\n"
             "{ type = \"inflow\"; box = [\"33 cm\", \"0\", \"34 cm\", \"6 cm\"]; head = \"0.07 "
             "m\"; } );\n"
             "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
             cases[k].porosity[0], cases[k].grain[0], cases[k].porosity[1], cases[k].grain[1]);
    start(&run, text);
    for (int step = 0; step < 150; step++) {
      assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
      v = velocity_between(&run.s, .09, .15);
      if (step < 100) continue;
      sum += v / 50, least = fmin(least, v), most = fmax(most, v);
    }
    const double exact = 9.81 * .03 / resistance;
    print_message("%.4f of %.3g m/s, within %.2g %%\n", sum / exact, exact,
                  100 * (most - least) / exact);
    assert_true(fabs(sum - exact) < .08 * exact); /* .35 of a particle, of 4.5 (plan.c) */
    assert_true(most - least < .02 * exact);
    finish(&run);
  }
}

/* Largest change of the pressure at `at` from one step to the next over its mean, from time `from`
 * to `until`, at the steps that the program chooses. */
static double largest_jump(struct run *run, const double at[3], double from, double until) {
  const char *limit;
  double before = 0, worst = 0, sum = 0;
  int steps = 0;
  while (run->s.time < until) {
    assert_int_equal(isph_advance(&run->s, isph_stable_dt(&run->s, &limit)), STATUS_OK);
    const double now = pressure_at(&run->s, at);
    if (run->s.time > from) {
      if (steps > 0) worst = fmax(worst, fabs(now - before));
      sum += now, steps++;
    }
    before = now;
  }
  return worst * steps / sum;
}

/* A plate that moves in water over clay beside gravel does not push the water in the clay, though
 * it is within the support of particles there: water stands between. Pressures stay those of the
 * water's weight, with half a row of particles and the wave V sqrt(h/g) before a plate of speed V,
 * twice at a side.
 */
static void a_plate_does_not_press_on_clay(void **state) {
  (void)state;
  struct run run;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"24 cm\", \"22 cm\"]; spacing = \"1 cm\"; };\n"
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
      "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"15 cm\", \"6 cm\"]; porosity = 0.4; "
      "permeability = \"1e-10 m/s\"; },\n"
      "{ type = \"porous\"; box = [\"15 cm\", \"0\", \"24 cm\", \"6 cm\"]; porosity = 0.5; "
      "permeability = \"2e-2 m/s\"; },\n"
      "{ type = \"water\"; box = [\"0\", \"0\", \"24 cm\", \"14 cm\"]; },\n"
      "{ type = \"wall\"; box = [\"8 cm\", \"8 cm\", \"11 cm\", \"20 cm\"]; slip = true; velocity "
      "= "
      "[\"5 cm/s\", \"0\"]; } );\n");
  const double most = 1000 * 9.81 * (0.14 + 0.005 + 2 * 0.05 * sqrt(0.14 / 9.81));
  for (int k = 0; k < 40; k++) {
    double highest = 0;
    advance(&run, 0.01 * (k + 1));
    for (size_t i = 0; i < run.s.count; i++) highest = fmax(highest, run.s.pressure[i]);
    if (!(highest <= most)) print_message("step %d: %g Pa, %g\n", k, highest, most);
    assert_true(highest <= most);
  }
  finish(&run);
}

/* Coarse soil crossed fast, from window to window: rows of particles come and go in every few
 * steps. What stands in the corners of windows and closed sides continues the sides alone; as walls
 * of their own they held back the water there, stirred what entered and made the pressure jump by a
 * tenth and more. Shifting turned particles over from step to step beside it. */
static void windows_come_and_go_unnoticed(void **state) {
  (void)state;
  static const double at[3] = {.15, 0, .03};
  struct run run;
  double sum = 0;
  const char *limit;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
        "domain = { size = [\"30 cm\", \"6 cm\"]; spacing = \"1 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"7 cm\", \"0\", \"23 cm\", \"6 cm\"]; porosity "
        "= 0.73; grain_size = \"12 mm\"; },\n"
        "{ type = \"water\"; box = [\"0\", \"0\", \"30 cm\", \"6 cm\"]; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"6 cm\"]; head = \"0.35 m\"; },\n"
        "{ type = \"inflow\"; box = [\"29 cm\", \"0\", \"30 cm\", \"6 cm\"]; head = \"0.07 "
        "m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  const double worst = largest_jump(&run, at, .5, 1);
  for (int step = 0; step < 200; step++) {
    assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
    sum += velocity_between(&run.s, .1, .2) / 200;
  }
  const double eps = .73, d = .012, a = 1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * d * d),
               b = 1.1 * (1 - eps) / (pow(eps, 3) * d);
  const double exact = 2 * 9.81 * .28 / .16 / (a + sqrt(a * a + 4 * b * 9.81 * .28 / .16));
  print_message("largest jump %.2g %%, flow %.4f of exact\n", 100 * worst, sum / exact);
  finish(&run);
  assert_true(worst < .02);
  assert_true(fabs(sum / exact - 1) < .005);
}

/* What has left stands on behind the window where it went, a spacing from the row before it: even
 * flow stays even. */
static void columns_go_on_from_what_has_left(void **state) {
  (void)state;
  struct run run;
  double worst = 0;
  start(&run, "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
              "domain = { size = [\"20 cm\", \"6 cm\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"20 cm\", \"6 cm\"]; "
              "velocity = [\"0.3 m/s\", \"0\"]; },\n"
              "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"6 cm\"]; flux = \"0.3 "
              "m/s\"; },\n"
              "{ type = \"inflow\"; box = [\"19 cm\", \"0\", \"20 cm\", \"6 cm\"]; head = \"0.1 "
              "m\"; } );\n"
              "isph = { wall = { slip = true; }; };\n");
  struct isph *s = &run.s;
  for (int step = 0; step < 300; step++) {
    assert_int_equal(isph_advance(s, 1.7e-3), STATUS_OK);
    for (size_t c = 0; c < s->column_count; c++) {
      const struct isph_column *column = &s->columns[c];
      double depth = INFINITY;
      if (s->sides[column->side].inward > 0) continue;
      for (size_t i = 0; i < s->count; i++)
        if (fabs(s->position[i][2] - column->at[2]) < .5 * s->spacing)
          depth = fmin(depth, s->high[0] - s->position[i][0]);
      worst = fmax(worst, fabs((s->column_front[c] + depth) / s->spacing - 1));
    }
  }
  print_message("off by %.2g spacings, %zu have left\n", worst, s->left_count);
  assert_true(s->left_count > 60);
  finish(&run);
  assert_true(worst < .01);
}

/* A head falls through soil onto a window, where rows of two and of three particles leave between
 * three columns. What leaves becomes the foremost of one that waits for it: with columns that went
 * on by themselves all pressures jumped by 4 %, and the head fell 9 % late. */
static void heads_fall_through_windows_smoothly(void **state) {
  (void)state;
  static const double at[3] = {.03, 0, .04};
  struct run run;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"99 s\"; };\n"
        "domain = { size = [\"6 cm\", \"24 cm\"]; spacing = \"1 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"6 cm\", \"22 cm\"]; },\n"
        "{ type = \"porous\"; box = [\"0\", \"0\", \"6 cm\", \"8 cm\"]; porosity = 0.25; "
        "grain_size = \"4 mm\"; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"6 cm\", \"1 cm\"]; head = \"0.1 m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  const double worst = largest_jump(&run, at, 1, 20);
  print_message("largest jump %.2g %%, %zu have left\n", 100 * worst, run.s.left_count);
  assert_true(run.s.left_count > 20);
  finish(&run);
  assert_true(worst < .02);
}

/* Rows of a front in soil of low porosity are drawn apart, and nothing disorders them between
 * periodic sides: it goes on as a plug does, (H + C_r s) q' = g (H + s) - s (a q + b q^2). */
static void fronts_in_tight_soil_go_on(void **state) {
  (void)state;
  const double eps = .3, d = 5e-3, dt = 1e-4, cr = 1 + .34 * (1 - eps) / eps;
  const double a = 1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * d * d),
               b = 1.1 * (1 - eps) / (pow(eps, 3) * d);
  struct run run;
  double q = 0, sunk = 1e-9, low = INFINITY;
  start(&run, "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
              "domain = { size = [\"0.1 m\", \"0.8 m\"]; spacing = \"1 cm\"; periodic = [true, "
              "false]; };\n"
              "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.4 m\"]; "
              "porosity = 0.3; grain_size = \"5 mm\"; saturated = false; },\n"
              "{ type = \"water\"; box = [\"0\", \"0.4 m\", \"0.1 m\", \"0.6 m\"]; } );\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  advance(&run, 1.5);
  for (double t = 0; t < 1.5; t += dt) {
    const double over = .2 - eps * sunk;
    q += dt * (9.81 * (over + sunk) - sunk * (a * q + b * q * q)) / (over + cr * sunk);
    sunk += dt * q / eps;
  }
  for (size_t i = 0; i < run.s.count; i++)
    low = fmin(low, run.s.position[i][2] - .5 * sqrt(run.s.volume[i]));
  print_message("front %.4f m deep, exact %.4f\n", .4 - low, sunk);
  finish(&run);
  assert_true(fabs((.4 - low) / sunk - 1) < .08);
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Where the front stands, in whatever order the 19 lowest particles do: their water fills a height
 * of 1/eps spacings, with its mean in the middle. */
static double front_by_volume(const struct isph *s, double eps) {
  double z[1024], sum = 0;
  assert_true(s->count < 1024);
  for (size_t i = 0; i < s->count; i++) z[i] = s->position[i][2];
  qsort(z, s->count, sizeof *z, ascending);
  for (int i = 0; i < 19; i++) sum += z[i] / 19;
  return sum - .5 * s->spacing / eps;
}

/* When a plug's front has sunk by `until`, s: (H + C_r s) q' = g (H + s) - eps s (a q + b q^2), the
 * form m15, 18 cm of water, grains of 1 cm. */
static double plug_passes(double eps, double until) {
  const double d = .01, dt = 1e-5, cr = 1 + .34 * (1 - eps) / eps;
  const double a = 1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * d * d),
               b = 1.1 * (1 - eps) / (pow(eps, 3) * d);
  double q = 0, sunk = 1e-9, time = 0;
  for (; sunk < until; time += dt) {
    const double over = .18 - eps * sunk;
    q += dt * (9.81 * (over + sunk) - eps * sunk * (a * q + b * q * q)) / (over + cr * sunk);
    sunk += dt * q / eps;
  }
  return time;
}

/* The most of the moment along its normal that pairs and void together make of a particle on the
 * surface, in soil and away from its faces; 1 is all of it. */
static double moment_most(const struct isph *s) {
  double most = 0;
  for (size_t i = 0; i < s->count; i++) {
    double inverse[6], m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int k = 0; k < 6; k++) inverse[k] = (double)s->correction[i][(int[]){0, 1, 2, 4, 5, 8}[k]];
    const double *n = s->gradient_sum[i], square = n[0] * n[0] + n[2] * n[2];
    if (s->surface[i] < .9 || s->position[i][2] > .15 || s->position[i][2] < .03) continue;
    isph_moment_inverse(2, inverse, m);
    const double along = m[0] * n[0] * n[0] + 2 * m[2] * n[0] * n[2] + m[8] * n[2] * n[2];
    most = fmax(most, along / square + s->surface[i] * sqrt(s->volume[i] * square));
  }
  return most;
}

/* 18 cm of water fall through 20 cm of dry soil: when the front, by the volume of its water, comes
 * within half a row of the bottom, and when its lowest particle touches it (the last half spacing
 * at the speed of the one before), against a plug. Without correction of the foremost rows' moments
 * the front is up to 3.3 % late. Nowhere do pairs and void make more than a whole moment. */
static void fronts_stand_where_their_water_ends(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    const double eps = k ? .34 : .32, until[3] = {.2 - .005 / eps, .185, .195};
    struct run run;
    double passed[3] = {0}, most = 0;
    char scene[768];
    snprintf(scene, sizeof scene,
             "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
             "domain = { size = [\"0.19 m\", \"0.48 m\"]; spacing = \"1 cm\"; periodic = [false, "
             "false]; };\n"
             "regions = ( { type = \"water\"; box = [\"0\", \"0.2 m\", \"0.19 m\", \"0.38 m\"]; "
             "},\n{ type = \"porous\"; box = [\"0\", \"0\", \"0.19 m\", \"0.2 m\"]; "
             "porosity = %g; grain_size = \"1 cm\"; } );\n"
             "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { form = \"m15\"; };\n",
             eps);
    start(&run, scene);
    const struct isph *s = &run.s;
    while ((passed[0] == 0 || passed[2] == 0) && s->time < 2) {
      double low = 1;
      assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
      for (size_t i = 0; i < s->count; i++)
        low = fmin(low, s->position[i][2] - .5 * sqrt(s->volume[i]));
      if (passed[0] == 0 && front_by_volume(s, eps) <= .2 - until[0]) passed[0] = s->time;
      most = fmax(most, moment_most(s));
      for (int n = 1; n < 3; n++)
        if (passed[n] == 0 && low <= .2 - until[n]) passed[n] = s->time;
    }
    const double lowest = passed[2] + .5 * (passed[2] - passed[1]);
    const double exact[2] = {plug_passes(eps, until[0]), plug_passes(eps, .2)};
    print_message("front after %.4f s, exact %.4f; lowest %.4f, %.4f; moment %.3f\n", passed[0],
                  exact[0], lowest, exact[1], most);
    assert_true(fabs(passed[0] / exact[0] - 1) < .02);
    assert_true(fabs(lowest / exact[1] - 1) < .05);
    assert_true(most < 1.01);
    finish(&run);
  }
}

/* Under a wall that reaches into the soil: nothing jumps as a particle comes out from under it. */
static void edges_of_walls_are_passed_unnoticed(void **state) {
  (void)state;
  static const double at[3] = {.155, 0, .015};
  struct run run;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
        "domain = { size = [\"30 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"30 cm\", \"7 cm\"]; porosity "
        "= 0.466; grain_size = \"13 mm\"; },\n"
        "{ type = \"water\"; box = [\"0\", \"0\", \"30 cm\", \"12 cm\"]; },\n"
        "{ type = \"wall\"; box = [\"14 cm\", \"3 cm\", \"17 cm\", \"12 cm\"]; },\n"
        "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"12 cm\"]; head = \"0.144 m\"; },\n"
        "{ type = \"inflow\"; box = [\"29 cm\", \"0\", \"30 cm\", \"12 cm\"]; head = \"0.13 "
        "m\"; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  const double worst = largest_jump(&run, at, 1, 4);
  print_message("largest jump %.2g %%\n", 100 * worst);
  finish(&run);
  assert_true(worst < .02);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(soils_that_differ_much_stay_still),
      cmocka_unit_test(a_squeezed_sheet_is_a_surface),
      cmocka_unit_test(the_least_moment_is_found),
      cmocka_unit_test(full_water_is_still),
      cmocka_unit_test(pressure_does_not_alternate),
      cmocka_unit_test(a_plate_does_not_press_on_clay),
      cmocka_unit_test(windows_come_and_go_unnoticed),
      cmocka_unit_test(columns_go_on_from_what_has_left),
      cmocka_unit_test(heads_fall_through_windows_smoothly),
      cmocka_unit_test(fronts_in_tight_soil_go_on),
      cmocka_unit_test(fronts_stand_where_their_water_ends),
      cmocka_unit_test(edges_of_walls_are_passed_unnoticed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
