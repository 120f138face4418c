/* Method richards: the curves of soil, the flux between two places, the matrix, and scenes in which
 * rain, levels, evaporation and air do what they should. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/unit/richards_scene.h"

static const struct region sand = {
    .porosity = .4,
    .permeability = 1e-4,
    .retention = {.given = true, .alpha = 5, .n = 3, .theta_r = .05, .l = .5}};

/* Against the formulas as they are printed, and integrals by the midpoint rule. */
static void curves(void **state) {
  (void)state;
  static const double n[] = {1.1, 1.5, 2, 4, 10}, heads[] = {-1e3, -10, -1, -.3, -.1, -.01};
  for (size_t k = 0; k < sizeof n / sizeof *n; k++) {
    struct region region = sand;
    struct retention soil;
    struct retention_state at, last = {0};
    double sum = 0, from = -1e-3 / 5;
    region.retention.n = n[k];
    assert_int_equal(retention_make(&region, &soil), STATUS_OK);
    for (size_t i = sizeof heads / sizeof *heads; i-- > 0;) {
      const double m = 1 - 1 / n[k], s = pow(1 + pow(5 * -heads[i], n[k]), -m);
      const double g = 1 - pow(1 - pow(s, 1 / m), m);
      retention_at(&soil, heads[i], &at);
      assert_true(fabs(at.theta - (.05 + .35 * s)) < 1e-14);
      /* as printed the formula has no digits where soil is dry */
      if (heads[i] >= -1) assert_true(fabs(at.k / (sqrt(s) * g * g) - 1) < 1e-7);
      assert_true(s == 1 || fabs(retention_head(&soil, s) / heads[i] - 1) <
                                1e-10 + 1e-15 / (1 - s)); /* the digits that s has */
      /* the slopes */
      struct retention_state low, high;
      const double d = 1e-5 * heads[i];
      retention_at(&soil, heads[i] + d, &low);
      retention_at(&soil, heads[i] - d, &high);
      assert_true(fabs((high.theta - low.theta) / (-2 * d) - at.capacity) <
                  1e-5 * at.capacity + 1e-15 / fabs(d));
      assert_true(fabs((high.k - low.k) / (-2 * d) - at.slope) < 1e-5 * at.slope + 1e-15 / fabs(d));
      assert_true(fabs(retention_fall(&high, &low) / (-2 * d) / at.k - 1) < 1e-5);
      /* the integral from the head before, in steps of ln |h| */
      if (i + 1 < sizeof heads / sizeof *heads) {
        const double step = log(heads[i] / from) / 20000;
        for (int q = 0; q < 20000; q++) {
          const double h = from * exp((q + .5) * step);
          struct retention_state mid;
          retention_at(&soil, h, &mid);
          sum += mid.k * -h * step;
        }
        assert_true(fabs(retention_fall(&last, &at) / sum - 1) < 1e-5);
      }
      last = at, from = heads[i], sum = 0;
    }
    retention_at(&soil, .3, &at);
    assert_true(at.theta == .4 && at.k == 1 && at.capacity == 0 && at.missing == -.3);
    /* F falls to nothing at the dry end, and k to 1 at the wet one, without a jump. */
    retention_at(&soil, soil.driest, &at);
    assert_true(at.potential < 1e-3 * soil.full && at.potential > 0);
    retention_at(&soil, -1e-14, &at);
    assert_true(at.k > 1 - 1e-9 && at.k <= 1);
    retention_free(&soil);
  }
}

/* Haverkamp's: half of the water and of K at the heads given, slopes and integral those of them. */
static void haverkamp(void **state) {
  (void)state;
  struct region region = sand;
  struct retention soil;
  struct retention_state at, low, high;
  region.retention = (struct retention_curve){
      .given = true, .alpha = 1 / .37, .n = 3.96, .k_alpha = 1 / .19, .k_n = 4.74, .theta_r = .05};
  assert_int_equal(retention_make(&region, &soil), STATUS_OK);
  retention_at(&soil, -.37, &at);
  assert_true(fabs(at.theta - .225) < 1e-14 && fabs(retention_head(&soil, .5) + .37) < 1e-12);
  retention_at(&soil, -.19, &at);
  assert_true(fabs(at.k - .5) < 1e-14);
  for (double h = -.01; h > -1e3; h *= 3) {
    const double d = -1e-5 * h;
    retention_at(&soil, h, &at);
    retention_at(&soil, h - d, &low);
    retention_at(&soil, h + d, &high);
    assert_true(fabs((high.theta - low.theta) / (2 * d) / at.capacity - 1) <
                1e-5 + 1e-11 / at.capacity);
    assert_true(fabs((high.k - low.k) / (2 * d) / at.slope - 1) < 1e-5 + 1e-11 / at.slope);
    assert_true(fabs(retention_fall(&high, &low) / (2 * d) / at.k - 1) < 1e-5);
  }
  retention_free(&soil);
}

/* Gardner's: 1/e of K and of the water at 1/alpha; Richards' equation is linear in F, of which K is
 * alpha times as much and the capacity alpha^2 times (theta_s - theta_r). */
static void gardner(void **state) {
  (void)state;
  struct region region = sand;
  struct retention soil;
  struct retention_state at, wet;
  region.retention =
      (struct retention_curve){.given = true, .exponential = true, .alpha = 2, .theta_r = .05};
  assert_int_equal(retention_make(&region, &soil), STATUS_OK);
  retention_at(&soil, 0, &wet);
  for (double h = -.01; h > soil.driest; h *= 3) {
    retention_at(&soil, h, &at);
    assert_true(fabs(at.k / exp(2 * h) - 1) < 1e-13);
    assert_true(fabs(at.theta - .05 - .35 * at.k) < 1e-15);
    assert_true(fabs(2 * at.potential / at.k - 1) < 1e-14);
    assert_true(fabs(at.capacity / (.7 * at.k) - 1) < 1e-14 && at.slope == 2 * at.k);
    assert_true(fabs(retention_fall(&wet, &at) / ((1 - at.k) / 2) - 1) < 1e-13);
    if (at.k > 1e-50) assert_true(fabs(retention_head(&soil, at.k) / h - 1) < 1e-12);
  }
  retention_free(&soil);
}

/* Water at rest does not move, full soil has Darcy's flux, suction alone int K dh; derivatives are
 * those of differences; and two halves of one soil are one. */
static void fluxes(void **state) {
  (void)state;
  struct retention soil;
  struct flux flux, other;
  assert_int_equal(retention_make(&sand, &soil), STATUS_OK);
  static const double pairs[][2] = {{-.1, -.3}, {-.3, -.1}, {-1e4, -.01},  {-.01, -100},
                                    {.2, -.2},  {.4, .1},   {-.2, -.2001}, {-2, -.0001}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
    for (int p = -1; p <= 1; p++) {
      struct retention_state i, j, more;
      retention_at(&soil, pairs[k][0], &i);
      retention_at(&soil, pairs[k][1], &j);
      flux_in_soil(2, .05, p, &i, &j, &flux);
      if (p == 0)
        assert_true(fabs(flux.q - 2 * retention_fall(&i, &j) / .05) < 1e-6 * fabs(flux.q));
      if (i.h > 0 && j.h > 0) assert_true(fabs(flux.q - 2 * ((i.h - j.h) / .05 + p)) < 1e-12);
      const double d = 1e-6 * fabs(i.h);
      retention_at(&soil, i.h + d, &more);
      flux_in_soil(2, .05, p, &more, &j, &other);
      assert_true(fabs((other.q - flux.q) / d - flux.di) <
                  1e-3 * (fabs(flux.di) + 40 * i.k + 1e-9) + 1e-15 * fabs(flux.q) / d);
      const double e = 1e-6 * fabs(j.h);
      retention_at(&soil, j.h + e, &more);
      flux_in_soil(2, .05, p, &i, &more, &other);
      assert_true(fabs((other.q - flux.q) / e - flux.dj) <
                  1e-3 * (fabs(flux.dj) + 40 * j.k + 1e-9) + 1e-15 * fabs(flux.q) / e);
      flux_between_soils(&soil, &soil, 2, .05, p, &i, &j, &other);
      flux_in_soil(soil.conductivity[2], .05, p, &i, &j, &flux);
      assert_true(p != 0 || fabs(other.q / flux.q - 1) < 1e-6);
    }
  for (int k = 0; k < 40; k++) {
    struct retention_state i, j;
    const double h = -1e-4 * pow(1.5, k);
    retention_at(&soil, h, &i);
    retention_at(&soil, h + .05, &j); /* i lies .05 m above j */
    flux_in_soil(1, .05, 1, &i, &j, &flux);
    assert_true(fabs(flux.q) < 1e-12 * i.k + 1e-30);
  }
  /* The higher the head that it flows down to, the less flows, and on the table nothing jumps. */
  for (double above = -2; above < -.1; above += .3) {
    struct retention_state i, j;
    double last = INFINITY;
    retention_at(&soil, above, &i);
    for (double h = 0; h < 3; h += h < .01 ? 1e-4 : .01) {
      retention_at(&soil, h, &j);
      flux_in_soil(1, .5, 1, &i, &j, &flux);
      assert_true(flux.q < last && (h == 0 || flux.dj < 0));
      assert_true(h == 0 || last - flux.q < 6 * (h < .0101 ? 1e-4 : .01));
      flux_in_soil(1, .5, -1, &j, &i, &other);
      assert_true(fabs(flux.q + other.q) < 1e-12 * (1 + fabs(flux.q)));
      last = flux.q;
    }
  }
  retention_free(&soil);
  /* Above a table at the depth t the steady flux q in soil of k = e^(a h) is exactly that of
   * (e^(a h) - q) e^(a t) = 1 - q, below the table Darcy's. */
  const double a = 3;
  struct retention gardner = {
      .alpha = a, .exponential = true, .full = 1 / a, .theta_r = .05, .theta_s = .4, .n = 2};
  for (double h = .05; h < 1; h += .1) {
    struct retention_state i, j;
    retention_at(&gardner, -.7, &i);
    retention_at(&gardner, h, &j);
    flux_in_soil(1, .5, 1, &i, &j, &flux);
    const double t = .5 - h / (1 - flux.q);
    assert_true(fabs((exp(-.7 * a) - flux.q) * exp(a * t) - (1 - flux.q)) < 1e-9);
  }
  /* By the head of sand as dry as dust: as little as k is there, and no rounding of the rest. */
  struct region coarse = sand;
  struct retention_state wet, dry;
  coarse.retention.alpha = 14, coarse.retention.n = 9.9;
  assert_int_equal(retention_make(&coarse, &soil), STATUS_OK);
  retention_at(&soil, 0, &wet);
  retention_at(&soil, -9445, &dry);
  for (int p = -1; p <= 1; p++) {
    flux_in_soil(1, .05, p, &wet, &dry, &flux);
    assert_true(fabs(flux.dj) < 1e-60);
    flux_in_soil(1, .05, p, &dry, &wet, &flux);
    assert_true(fabs(flux.di) < 1e-60);
  }
  retention_free(&soil);
}

/* Wet soil over dry soil of another kind, with n < 2, half a spacing of 5 cm to their interface:
 * the flux rises with the head of the wet soil and never jumps, and out of full soil it is what
 * gravity and suction drive through it. */
static void interfaces(void **state) {
  (void)state;
  static const struct region loam = {
      .porosity = .45,
      .permeability = 4.6e-7,
      .retention = {.given = true, .alpha = 3.24, .n = 1.18, .theta_r = .02, .l = .5}};
  static const struct region clay = {
      .porosity = .36,
      .permeability = 1.2e-6,
      .retention = {.given = true, .alpha = 4.29, .n = 1.14, .theta_r = .035, .l = .5}};
  static const struct region till = {.porosity = .48,
                                     .permeability = 1.3e-7,
                                     .retention = {.given = true,
                                                   .alpha = 1 / 2.4,
                                                   .n = 5.18,
                                                   .k_alpha = 1 / 2.27,
                                                   .k_n = 6.24,
                                                   .theta_r = .07}};
  static const struct region silt = {
      .porosity = .34,
      .permeability = 2.75e-6,
      .retention = {.given = true, .alpha = 8.63, .n = 1.19, .theta_r = .09, .l = .5}};
  static const struct {
    const struct region *wet, *dry;
    double below, from, to;
  } pairs[] = {{&loam, &clay, -164, -1e-3, 1e-3}, {&till, &silt, -1.66, .1, .2}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
    struct retention wet, dry;
    struct retention_state i, j;
    struct flux flux, other;
    assert_int_equal(retention_make(pairs[k].wet, &wet), STATUS_OK);
    assert_int_equal(retention_make(pairs[k].dry, &dry), STATUS_OK);
    retention_at(&dry, pairs[k].below, &j);
    const double step = (pairs[k].to - pairs[k].from) / 1000, full = wet.conductivity[2];
    double last = 0, slope = 0;
    for (int n = 0; n <= 1000; n++) {
      const double h = pairs[k].from + n * step;
      retention_at(&wet, h, &i);
      flux_between_soils(&wet, &dry, 2, .1, 1, &i, &j, &flux);
      assert_true(flux.di > 0 && flux.q > last);
      assert_true(n == 0 || flux.q - last < 1.5 * step * fmax(flux.di, slope));
      assert_true(h < 0 || flux.q > full * (1 + h / .05) * (1 - 1e-12));
      flux_between_soils(&dry, &wet, 2, .1, -1, &j, &i, &other);
      assert_true(fabs(flux.q + other.q) < 1e-9 * flux.q);
      last = flux.q, slope = flux.di;
    }
    retention_free(&wet), retention_free(&dry);
  }
}

/* A grid of `side` x `side` whose columns add up to `rest`, steeper one way than the other; the
 * iterations it takes. */
static int64_t solve_grid(uint32_t side, double rest) {
  const uint32_t all = side * side;
  struct rows r;
  int64_t iterations = 0;
  double *b = malloc(all * sizeof *b), *x = malloc(all * sizeof *x);
  assert_int_equal(rows_allocate(all, 5 * (size_t)all, &r), STATUS_OK);
  size_t k = 0;
  for (uint32_t i = 0; i < all; i++) {
    const int64_t step[5] = {-(int64_t)side, -1, 0, 1, side};
    r.start[i] = k;
    b[i] = sin(i) + 1;
    for (int s = 0; s < 5; s++) {
      const int64_t j = (int64_t)i + step[s];
      if (j < 0 || j >= all || (llabs(step[s]) == 1 && i / side != j / side)) continue;
      if (s == 2) r.diagonal[i] = k;
      r.column[k] = (uint32_t)j;
      r.value[k++] = s == 2 ? rest : s < 2 ? -1.01 : -.99;
    }
  }
  r.start[all] = k;
  for (k = 0; k < r.start[all]; k++)
    if (r.value[k] < 0) r.value[r.diagonal[r.column[k]]] -= r.value[k];
  assert_true(rows_solve(&r, 0.98, b, 1e-10, x, &iterations));
  double size = 0;
  for (uint32_t i = 0; i < all; i++) size += b[i] * b[i];
  for (uint32_t i = 0; i < all; i++) {
    double sum = 0;
    for (k = r.start[i]; k < r.start[i + 1]; k++) sum += r.value[k] * x[r.column[k]];
    assert_true(fabs(sum - b[i]) < 1e-9 * sqrt(size));
  }
  rows_free(&r);
  free(b), free(x);
  return iterations;
}

/* BiCGStab solves what its factors are not exact for, and takes sixteen times as many sites with
 * less than twice the iterations. */
static void rows(void **state) {
  (void)state;
  const int64_t few = solve_grid(20, 1e-3), more = solve_grid(80, 1e-3);
  printf("%lld iterations of 20 x 20, %lld of 80 x 80\n", (long long)few, (long long)more);
  assert_true(few > 1 && more < 2 * few);
}

#define SAND                                                                                       \
  "porosity = 0.4; permeability = \"1e-4 m/s\"; van_genuchten = { alpha = \"5 1/m\"; n = 3.0; "    \
  "theta_r = 0.05; }; "

static void start_box(struct run *run, const char *soil, const char *more) {
  start(run,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"0.4 m\", \"1 m\"]; spacing = \"5 cm\"; periodic = [false, false]; "
        "};\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"1 m\"]; %s } %s "
        ");\n" GRAVITY,
        soil, more);
}

/* Depth of the water on a face under rain, m; all of them have the same. */
static double pond_depth(const struct run *run) {
  double depth = NAN;
  for (size_t k = 0; k < run->s.pool_count; k++) {
    const double own = run->s.pool_volumes[k] / (run->s.spacing * run->s.spacing);
    assert_true(isnan(depth) || fabs(own - depth) < 1e-12);
    depth = own;
  }
  return depth;
}

/* Water stands on full soil as deep as allowed while it rains hard, and then falls as in a
 * permeameter, (d + L) ~ exp(-K t/L), to nothing. */
static void falling_head(void **state) {
  (void)state;
  struct run run;
  start_box(&run, SAND "head = \"1 m\";",
            ", { type = \"inflow\"; box = [\"0\", \"0\", \"0.4 m\", \"1 cm\"]; pressure_head = "
            "\"0 m\"; }, { type = \"rain\"; name = \"storm\"; box = [\"0\", \"0.99 m\", \"0.4 m\", "
            "\"1 m\"]; ponding = \"0.2 m\"; times = [\"0 s\", \"100 s\", \"101 s\"]; rate = "
            "[\"1e-2 m/s\", \"1e-2 m/s\", \"0 m/s\"]; }");
  advance(&run, 100);
  assert_true(fabs(pond_depth(&run) - .2) < 1e-15 && run.s.ran_off[2] > 0);
  advance(&run, 200);
  const double first = pond_depth(&run);
  assert_true(first > .18 && first < .2);
  for (double t = 400; t <= 1400; t += 200) {
    advance(&run, t);
    const double exact = (1 + first) * exp(-1e-4 * (t - 200)) - 1;
    assert_true(fabs(pond_depth(&run) - exact) < 1e-6);
    assert_true(water_open(&run.s) < 1e-10);
  }
  advance(&run, 3600);
  assert_true(pond_depth(&run) == 0 && water_open(&run.s) < 1e-10);
  finish(&run);
}

/* Rain faster than dry sand takes it stands, and all of it goes in after it; what would stand
 * deeper than allowed runs off. */
static void ponding(void **state) {
  (void)state;
  for (int shallow = 0; shallow < 2; shallow++) {
    struct run run;
    char storm[256];
    snprintf(storm, sizeof storm,
             ", { type = \"rain\"; name = \"storm\"; box = [\"0\", \"0.99 m\", \"0.4 m\", \"1 "
             "m\"]; ponding = \"%s\"; times = [\"0 s\", \"200 s\", \"201 s\"]; rate = [\"5e-4 "
             "m/s\", \"5e-4 m/s\", \"0 m/s\"]; }",
             shallow ? "1 cm" : "1 m");
    start_box(&run, SAND "pressure_head = \"-10 m\";", storm);
    const double area = .4 * run.s.spacing, fallen = 5e-4 * 200.5;
    double stood = 0;
    static const double times[] = {50,  100, 150, 200,
                                   201, 300, 400}; /* kinks of the rain as well */
    for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
      advance(&run, times[k]);
      stood = fmax(stood, pond_depth(&run));
      assert_true(water_open(&run.s) < 1e-10);
    }
    advance(&run, 7200);
    assert_true(pond_depth(&run) == 0);
    assert_true(fabs(run.s.rained[1] / (area * fallen) - 1) < 1e-12);
    const double soaked = (richards_water(&run.s) - run.s.start) / area;
    if (shallow) {
      assert_true(fabs(stood - .01) < 1e-15);
      assert_true(fabs(run.s.ran_off[1] / area + soaked - fallen) < 1e-12);
      assert_true(run.s.ran_off[1] > .1 * run.s.rained[1]);
    } else {
      assert_true(stood > .03 && fabs(run.s.ran_off[1]) < 1e-12 * run.s.rained[1]);
      assert_true(fabs(soaked - fallen) < 1e-12);
    }
    finish(&run);
  }
}

/* Rains and given fluxes that meet within a face bring what they do where they meet between two. */
static void meeting(void **state) {
  (void)state;
  for (int within = 0; within < 2; within++) {
    struct run run;
    const char *edge = within ? "0.225 m" : "0.2 m";
    char more[1000];
    snprintf(
        more, sizeof more,
        ", { type = \"rain\"; name = \"a\"; box = [\"0\", \"0.99 m\", \"%s\", \"1 m\"]; rate "
        "= \"4e-5 m/s\"; }, { type = \"rain\"; name = \"b\"; box = [\"%s\", \"0.99 m\", \"0.4 "
        "m\", \"1 m\"]; rate = \"%.9g m/s\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"1 "
        "cm\", \"%s\"]; flux = \"1e-6 m/s\"; }, { type = \"inflow\"; box = [\"0\", \"%s\", \"1 "
        "cm\", \"0.4 m\"]; flux = \"-1e-6 m/s\"; }",
        edge, edge, within ? 8e-6 / .175 : 4e-5, edge, edge);
    start_box(&run, SAND "head = \"0.3 m\";", more);
    advance(&run, 1800);
    const double wide = .05 * 1800, *rained = run.s.rained, *entered = run.s.entered;
    assert_true(fabs(rained[1] / (wide * 4e-5 * (within ? .225 : .2)) - 1) < 1e-12);
    assert_true(fabs(rained[2] / (wide * 8e-6) - 1) < 1e-9);
    assert_true(fabs(entered[3] / (wide * 1e-6 * (within ? .225 : .2)) - 1) < 1e-12);
    assert_true(fabs(entered[4] / (wide * -1e-6 * (within ? .175 : .2)) - 1) < 1e-12);
    assert_true(fabs(run.s.ran_off[1]) < 1e-12 * rained[1]);
    assert_true(water_open(&run.s) < 1e-10);
    finish(&run);
  }
}

static double level_in(const struct run *run, double x, double z) {
  const double at[3] = {x, 0, z};
  return richards_level_at(&run->s, at);
}

/* A body of water over full soil falls as in a permeameter, (d + L) ~ exp(-K t/L), to nothing; the
 * last of it wets a part of the floor. */
static void sinking(void **state) {
  (void)state;
  for (int fine = 0; fine < 2; fine++) {
    struct run run;
    start(&run,
          "scene = { end_time = \"1 d\"; };\ndomain = { size = [\"0.4 m\", \"1.4 m\"]; spacing = "
          "\"%s\"; periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
          "\"0\", \"0.4 m\", \"1 m\"]; " SAND
          "head = \"1 m\"; }, { type = \"water\"; box = [\"0\", "
          "\"1 m\", \"0.4 m\", \"1.3 m\"]; }, { type = \"inflow\"; box = [\"0\", \"0\", \"0.4 m\", "
          "\"1 cm\"]; pressure_head = \"0 m\"; } );\n" GRAVITY,
          fine ? "25 mm" : "50 mm");
    assert_true(fabs(level_in(&run, .2, .5) - 1.3) < 1e-12);
    for (double t = 500; t <= 2000; t += 500) {
      advance(&run, t);
      assert_true(fabs(level_in(&run, .2, .5) - 1.3 * exp(-1e-4 * t)) < 1e-5);
      assert_true(water_open(&run.s) < 1e-12);
    }
    advance(&run, 7200);
    assert_true(fabs(run.s.pool_volumes[0]) < 1e-15 && run.s.ran_off[1] < 1e-15);
    assert_true(water_open(&run.s) < 1e-12);
    finish(&run);
  }
}

/* Two bodies of water joined by soil come to one level, and their difference falls as exp(-2 K A
 * t/(L S)). */
static void joined(void **state) {
  (void)state;
  for (int fine = 0; fine < 2; fine++) {
    struct run run;
    start(
        &run,
        "scene = { end_time = \"1 d\"; };\ndomain = { size = [\"1 m\", \"1.5 m\"]; spacing = "
        "\"%s\"; periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0.4 m\", "
        "\"0\", \"0.6 m\", \"0.5 m\"]; " SAND "head = \"1 m\"; }, { type = \"wall\"; box = [\"0.4 "
        "m\", \"0.5 m\", \"0.6 m\", \"1.5 m\"]; }, { type = \"water\"; box = [\"0\", \"0\", \"0.4 "
        "m\", \"1.21 m\"]; }, { type = \"water\"; box = [\"0.6 m\", \"0\", \"1 m\", \"0.81 m\"]; } "
        ");\n" GRAVITY,
        fine ? "25 mm" : "50 mm");
    const double rate = 2 * 1e-4 * .5 / (.2 * .4);
    for (double t = 200; t <= 2000; t += 600) {
      advance(&run, t);
      const double high = level_in(&run, .1, .2), low = level_in(&run, .9, .2);
      assert_true(fabs(high - low - .4 * exp(-rate * t)) < 1e-4);
      assert_true(fabs(high + low - 2.02) < 1e-11);
      assert_true(water_open(&run.s) < 1e-12);
    }
    finish(&run);
  }
}

/* A flux at the side of a body of water fills it, up to the top of a wall; the rest leaves. */
static void fed(void **state) {
  (void)state;
  struct run run;
  start(
      &run,
      "scene = { end_time = \"1 d\"; };\ndomain = { size = [\"1 m\", \"1 m\"]; spacing = \"5 cm\"; "
      "periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0.8 m\", \"0\", "
      "\"1 "
      "m\", \"0.2 m\"]; " SAND "head = \"0.1 m\"; }, { type = \"wall\"; box = [\"0.4 m\", \"0\", "
      "\"0.5 m\", \"0.6 m\"]; }, { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.31 m\"]; "
      "}, { type = \"inflow\"; box = [\"0\", \"0.1 m\", \"1 cm\", \"0.3 m\"]; flux = \"1e-4 m/s\"; "
      "} "
      ");\n" GRAVITY);
  advance(&run, 1000);
  assert_true(fabs(level_in(&run, .2, .1) - .31 - 1e-4 * .2 * 1000 / .4) < 1e-12);
  advance(&run, 10000);

  assert_true(fabs(level_in(&run, .2, .1) - .6) < 1e-12);
  assert_true(fabs(run.s.ran_off[2] - .05 * (1e-4 * .2 * 10000 - .4 * .29)) < 1e-12);
  assert_true(water_open(&run.s) < 1e-12);
  finish(&run);
}

/* A pit dug in dry soil: its water goes into floor and sides, all of it, and rain on it and on its
 * bare sides goes the same way, until nothing can take more. */
static void pit(void **state) {
  (void)state;
  for (int storm = 0; storm < 2; storm++) {
    struct run run;
    char rain[160] = "";
    if (storm)
      snprintf(
          rain, sizeof rain,
          ", { type = \"rain\"; name = \"r\"; box = [\"0\", \"1.1 m\", \"1 m\", \"1.2 m\"]; rate "
          "= \"2e-4 m/s\"; }");
    start(
        &run,
        "scene = { end_time = \"1000 d\"; };\ndomain = { size = [\"1 m\", \"1.2 m\"]; spacing = "
        "\"5 cm\"; periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
        "\"0\", \"1 m\", \"1 m\"]; " SAND "pressure_head = \"-5 m\"; }, { type = \"empty\"; box = "
        "[\"0.4 m\", \"0.6 m\", \"0.6 m\", \"1 m\"]; }, { type = \"empty\"; box = [\"0.3 m\", "
        "\"0.8 "
        "m\", \"0.4 m\", \"1 m\"]; }, { type = \"water\"; box = [\"0.4 m\", \"0.6 m\", \"0.6 m\", "
        "\"0.75 m\"]; } %s );\n" GRAVITY,
        rain);
    const double volume = .2 * .15 * .05;
    assert_true(fabs(run.s.pool_volumes[0] - volume) < 1e-15);
    advance(&run, 60);
    assert_true(run.s.pool_volumes[0] < .9 * volume + storm);
    assert_true(water_open(&run.s) < 1e-12);
    advance(&run, storm ? 20000 : 7200);
    assert_true(water_open(&run.s) < 1e-12);
    if (!storm) {
      assert_true(fabs(run.s.pool_volumes[0]) < 1e-15);
      assert_true(fabs(richards_water(&run.s) - run.s.start) < 1e-12);
    } else { /* the soil is full in the end, and the water at the top of the domain */
      assert_true(fabs(level_in(&run, .5, .7) - 1.2) < 1e-9 && run.s.ran_off[3] > 0);
      assert_true(fabs(run.s.pool_volumes[0] - .05 * (.2 * .4 + .1 * .2 + .2)) < 1e-12);
    }
    finish(&run);
  }
}

/* Water that two regions make, one on the other, is one body, whichever comes first; its level is
 * that of a gauge in it, over soil that is not full. */
static void stacked(void **state) {
  (void)state;
  for (int swapped = 0; swapped < 2; swapped++) {
    struct run run;
    static const char *const part[] = {
        "{ type = \"water\"; box = [\"0.4 m\", \"0.3 m\", \"0.6 m\", \"0.45 m\"]; }",
        "{ type = \"water\"; box = [\"0.4 m\", \"0.45 m\", \"0.6 m\", \"0.6 m\"]; }"};
    start(&run,
          "scene = { end_time = \"1 d\"; };\ndomain = { size = [\"1 m\", \"1 m\"]; spacing = "
          "\"5 cm\"; periodic = [false, false]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
          "\"0\", \"1 m\", \"1 m\"]; " SAND
          "head = \"0.1 m\"; }, { type = \"empty\"; box = [\"0.4 m\", \"0.3 m\", \"0.6 m\", "
          "\"1 m\"]; }, %s, %s );\n" GRAVITY,
          part[swapped], part[1 - swapped]);
    assert_int_equal(run.s.pool_count, 1);
    assert_true(fabs(run.s.pool_volumes[0] - .2 * .3 * .05) < 1e-12);
    assert_true(fabs(richards_level_at(&run.s, (double[3]){.5, 0, .45}) - .6) < 1e-9);
    finish(&run);
  }
}

/* Soil takes rain at its rate until it can take no more; the rest runs off, and all is accounted
 * for. The rain covers three faces and a half. */
static void rain(void **state) {
  (void)state;
  struct run run;
  start_box(&run, SAND "pressure_head = \"-1 m\";",
            ", { type = \"rain\"; name = \"storm\"; box = [\"0\", \"0.99 m\", \"0.175 m\", \"1 "
            "m\"]; times = [\"0 s\", \"100 s\", \"600 s\"]; rate = [\"0 m/s\", \"2e-5 m/s\", "
            "\"2e-5 m/s\"]; }");
  const double width = .175 * run.s.spacing;
  advance(&run, 100);
  advance(&run, 600);
  assert_true(fabs(run.s.rained[1] / (width * 2e-5 * 550) - 1) < 1e-12);
  assert_true(fabs(run.s.ran_off[1]) < 1e-12 * run.s.rained[1]);
  assert_true(fabs(richards_water(&run.s) - run.s.start - run.s.rained[1]) < 1e-12 * run.s.start);
  finish(&run);
  start_box(&run, SAND "head = \"0.95 m\";",
            ", { type = \"rain\"; name = \"storm\"; box = [\"0\", \"0.99 m\", \"0.4 m\", \"1 "
            "m\"]; rate = \"2e-4 m/s\"; }");
  advance(&run, 3600); /* fills the closed box, then runs off */
  assert_true(fabs(run.s.rained[1] / (.4 * run.s.spacing * .72) - 1) < 1e-12);
  assert_true(run.s.ran_off[1] > .9 * run.s.rained[1]);
  assert_true(water_open(&run.s) < 1e-10);
  for (size_t i = 0; i < run.s.count; i++) {
    double x[3];
    richards_place(&run.s, i, x);
    assert_true(fabs(run.s.h[i] - (1 - x[2])) < 1e-6);
  }
  finish(&run);
}

/* Closed columns that rain fills to the top, and dust that a head of 0 wets: soil at the edge of
 * full, from n = 1.1 on, takes steps that get somewhere, and keeps its water. */
static void fills(void **state) {
  (void)state;
  static const struct {
    double n, alpha, k, rate, start, spacing, time;
  } columns[] = {{1.09, 2.76, 8.7e-8, .068, -840, .02, 5.2e7},
                 {1.3, 14.7, 1.5e-7, .207, -33.7, .02, 1.9e7},
                 {1.59, 3.88, 1.7e-5, .032, -.18, .05, 7e5},
                 {1.15, 1.84, 2.8e-8, .876, -3530, .05, 1.7e7},
                 {9.87, 13.8, 8e-8, 0, -9445, .05, 9.5e5}};
  for (size_t c = 0; c < sizeof columns / sizeof *columns; c++) {
    struct run run;
    char soil[240], side[240];
    const double dx = columns[c].spacing;
    snprintf(soil, sizeof soil,
             "porosity = 0.4; permeability = \"%g m/s\"; van_genuchten = { alpha = \"%g 1/m\"; n = "
             "%g; theta_r = 0.05; }; pressure_head = \"%g m\";",
             columns[c].k, columns[c].alpha, columns[c].n, columns[c].start);
    if (columns[c].rate > 0)
      snprintf(
          side, sizeof side,
          ", { type = \"rain\"; name = \"r\"; box = [\"0\", \"0.99 m\", \"%g m\", \"1 m\"]; rate "
          "= \"%g m/s\"; }",
          dx, columns[c].k * columns[c].rate);
    else
      snprintf(
          side, sizeof side,
          ", { type = \"inflow\"; box = [\"0\", \"0.9999 m\", \"%g m\", \"1 m\"]; pressure_head = "
          "\"0 m\"; }",
          dx);
    start_column(&run, 1, dx, soil, side);
    advance(&run, columns[c].time);
    assert_true(water_open(&run.s) < 1e-10);
    for (size_t i = 0; i < run.s.count && columns[c].rate > 0; i++) {
      double x[3];
      richards_place(&run.s, i, x);
      assert_true(fabs(run.s.h[i] - (1 - x[2])) < 1e-6);
    }
    finish(&run);
  }
}

/* Soil behind a ditch drains to its level: through the face below it, and out to the air above it
 * while there is pressure. */
static void ditch(void **state) {
  (void)state;
  struct run run;
  start_box(&run, SAND "head = \"0.9 m\";",
            ", { type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"1 m\"]; head = \"0.3 "
            "m\"; }");
  const double at[3] = {.02, 0, .5};
  assert_true(fabs(richards_level_at(&run.s, at) - .9) < 1e-9);
  bool above = false;
  advance(&run, 20);
  for (size_t e = 0; e < run.s.edge_count; e++)
    above = above || (run.s.edges[e].z > .4 && run.s.edge_flux[e].q < 0);
  assert_true(above);
  advance(&run, 1e7);
  assert_true(fabs(richards_level_at(&run.s, at) - .3) < 1e-6);
  assert_true(water_open(&run.s) < 1e-10);
  finish(&run);
}

/* A reservoir beside soil is a window on the soil's own face: its level rises and falls there, over
 * a step in the soil as well. */
static void reservoir(void **state) {
  (void)state;
  struct run pool, face;
  start(&face,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"0.4 m\", \"1 m\"]; spacing = \"5 cm\"; periodic = [false, false]; "
        "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"1 m\"]; " SAND
        "head = \"0.2 m\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"1 m\"]; "
        "times = [\"0 s\", \"1 h\", \"2 h\"]; head = [\"0.2 m\", \"0.8 m\", \"0.3 m\"]; } "
        ");\n" GRAVITY);
  start(&pool,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"1 m\", \"1.2 m\"]; spacing = \"5 cm\"; periodic = [false, false]; "
        "};\nregions = ( { type = \"porous\"; box = [\"0.6 m\", \"0\", \"1 m\", \"1 m\"]; " SAND
        "head = \"0.2 m\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"1.2 m\"]; "
        "times = [\"0 s\", \"1 h\", \"2 h\"]; head = [\"0.2 m\", \"0.8 m\", \"0.3 m\"]; }, "
        "{ type = \"wall\"; box = [\"0.3 m\", \"0\", \"0.5 m\", \"0.1 m\"]; } );\n" GRAVITY);
  assert_int_equal(pool.s.count, face.s.count);
  for (double t = 600; t <= 10800; t += 600) {
    advance(&face, t);
    advance(&pool, t);
    for (size_t i = 0; i < face.s.count; i++) assert_true(fabs(pool.s.h[i] - face.s.h[i]) < 1e-9);
    assert_true(fabs(pool.s.entered[1] - face.s.entered[1]) < 1e-12);
    assert_true(water_open(&pool.s) < 1e-10);
  }
  finish(&pool);
  finish(&face);
}

/* Rain falls on the slope that a drawdown bares, from then on, and into the water before. A gauge
 * in the water has its level. */
static void bared(void **state) {
  (void)state;
  static const char *const rates[] = {"0 m/s", "2e-6 m/s"};
  double into[2];
  for (int rain = 0; rain < 2; rain++) {
    struct run run;
    start(&run,
          "scene = { end_time = \"1000 d\"; };\n"
          "domain = { size = [\"1 m\", \"1.2 m\"]; spacing = \"5 cm\"; periodic = [false, false]; "
          "};\nregions = ( { type = \"porous\"; box = [\"0.6 m\", \"0\", \"1 m\", \"1 m\"]; " SAND
          "head = \"0.8 m\"; }, { type = \"porous\"; box = [\"0.4 m\", \"0\", \"0.6 m\", \"0.5 "
          "m\"]; " SAND "head = \"0.8 m\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", "
          "\"1.2 m\"]; times = [\"0 s\", \"1 h\", \"2 h\"]; head = [\"0.8 m\", \"0.8 m\", \"0.2 "
          "m\"]; }, { type = \"rain\"; name = \"r\"; box = [\"0.4 m\", \"1.1 m\", \"0.6 m\", \"1.2 "
          "m\"]; rate = \"%s\"; } );\n" GRAVITY,
          rates[rain]);
    const double pool[3] = {.2, 0, .1};
    assert_true(fabs(richards_head_at(&run.s, pool) - .7) < 1e-12);
    assert_true(fabs(richards_level_at(&run.s, pool) - .8) < 1e-12);
    advance(&run, 3600);
    assert_true(run.s.rained[3] == 0); /* on water */
    advance(&run, 7200);
    assert_true(fabs(richards_level_at(&run.s, pool) - .2) < 1e-12);
    const double first = run.s.rained[3], water = run.s.entered[2];
    /* bare for the last half of that hour */
    assert_true(fabs(first - rain * .2 * .05 * 2e-6 * 1800) < .05 * 2e-6 * 30);
    advance(&run, 7200 + 1e6);
    assert_true(fabs(run.s.rained[3] - first - rain * .2 * .05 * 2.) < 1e-12);
    assert_true(water_open(&run.s) < 1e-10);
    into[rain] = run.s.entered[2] - water;
    finish(&run);
  }
  /* All of it comes out into the reservoir in the end, but for what the soil holds of it. */
  assert_true(into[1] - into[0] < -.9 * .2 * .05 * 2.);
}

/* A wall thinner than half a spacing on a side of the domain closes what lies behind it. */
static void walled_side(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    struct run run;
    char more[600];
    snprintf(
        more, sizeof more,
        ", { type = \"wall\"; box = [\"0\", \"0\", \"1 mm\", \"%s\"]; }, { type = \"inflow\"; box "
        "= [\"0\", \"0\", \"1 cm\", \"1 m\"]; head = \"0.9 m\"; }",
        k == 0 ? "0.5 m" : "0.9 m");
    start_box(&run, SAND "head = \"0.2 m\";", more);
    advance(&run, 600);
    bool below = false;
    for (size_t e = 0; e < run.s.edge_count; e++) below = below || run.s.edges[e].z < .5;
    assert_true(!below && (run.s.entered[2] > 0) == (k == 0));
    finish(&run);
  }
}

/* A sheet pile thinner than the spacing holds the water of a reservoir, and a crest that the
 * lattice has half a spacing above it. */
static void held_back(void **state) {
  (void)state;
  static const char *const between[] = {
      "{ type = \"wall\"; box = [\"0.31 m\", \"0\", \"0.32 m\", \"1.2 m\"]; }",
      "{ type = \"wall\"; box = [\"0.3 m\", \"0\", \"0.4 m\", \"0.8 m\"]; }"};
  for (int k = 0; k < 2; k++) {
    struct run run;
    char scene[2000];
    snprintf(scene, sizeof scene,
             "scene = { end_time = \"1 d\"; };\n"
             "domain = { size = [\"1 m\", \"1.2 m\"]; spacing = \"5 cm\"; periodic = [false, "
             "false]; };\nregions = ( { type = \"porous\"; box = [\"0.6 m\", \"0\", \"1 m\", \"1 "
             "m\"]; " SAND
             "head = \"0.2 m\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"1.2 m\"]; "
             "head = \"0.82 m\"; }, %s );\n" GRAVITY,
             between[k]);
    start(&run, scene);
    advance(&run, 3600);
    assert_true(run.s.entered[1] == 0);
    finish(&run);
  }
}

/* Filters beside clay, with sites many times 1/alpha high: Newton's method converges as squares
 * where a derivative has the wrong sign but others outweigh it, and steps grow. */
static void coarse(void **state) {
  (void)state;
  struct run run;
  start(&run,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"10 m\", \"5 m\"]; spacing = \"50 cm\"; periodic = [false, false]; "
        "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"10 m\", \"5 m\"]; porosity = "
        "0.35; permeability = \"1e-3 m/s\"; van_genuchten = { alpha = \"10 1/m\"; n = 3.0; theta_r "
        "= 0.03; }; head = \"0.5 m\"; }, { type = \"inflow\"; box = [\"9.9 m\", \"0\", \"10 m\", "
        "\"5 m\"]; head = \"0.25 m\"; } );\n" GRAVITY);
  advance(&run, 86400);
  printf("%lld steps, %lld Newton iterations\n", (long long)run.s.step,
         (long long)run.s.iterations_total);
  assert_true(run.s.step < 300);
  assert_true(water_open(&run.s) < 1e-10);
  finish(&run);
}

/* A well between two levels, in full soil: the head in it by Darcy's law from both sides. In a
 * closed box it has its rate while there is pressure, and the rest of the soil's water after that
 * falls to its foot; a drain takes no more than stands above its head, and gives nothing back. */
static void wells(void **state) {
  (void)state;
  struct run run;
  start(&run,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"1.05 m\", \"0.2 m\"]; spacing = \"5 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"1.05 m\", \"0.2 m\"]; " SAND
        "head = \"1 m\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.2 m\"]; head "
        "= \"1 m\"; }, { type = \"inflow\"; box = [\"1.04 m\", \"0\", \"1.05 m\", \"0.2 m\"]; "
        "head = \"1 m\"; }, { type = \"well\"; name = \"pump\"; box = [\"0.5 m\", \"0\", \"0.55 "
        "m\", \"0.2 m\"]; rate = \"1e-5 m^2/s\"; } );\n" GRAVITY);
  advance(&run, 1000);
  assert_true(fabs(run.s.entered[3] / (-1e-5 * 1000 * .05) - 1) < 1e-9);
  const double at[3] = {.525, 0, .1};
  assert_true(fabs(richards_head_at(&run.s, at) - (.9 - .5e-5 * .525 / (1e-4 * .2))) < 1e-6);
  finish(&run);
  start_box(&run, SAND "head = \"0.9 m\";",
            ", { type = \"well\"; name = \"pump\"; box = [\"0.1 m\", \"0.3 m\", \"0.2 m\", \"0.6 "
            "m\"]; rate = \"1e-5 m^2/s\"; }");
  advance(&run, 1000);
  assert_true(fabs(run.s.entered[1] / (-1e-5 * 1000 * .05) - 1) < 1e-9);
  advance(&run, 1e7);
  const double beside[3] = {.35, 0, .2};
  assert_true(fabs(richards_level_at(&run.s, beside) - .325) < 1e-3); /* the lowest site's middle */
  assert_true(water_open(&run.s) < 1e-10);
  finish(&run);
  for (int low = 0; low < 2; low++) {
    start_box(
        &run, SAND "head = \"0.9 m\";",
        low ? ", { type = \"drain\"; name = \"d\"; box = [\"0.1 m\", \"0.1 m\", \"0.2 m\", \"0.2 "
              "m\"]; head = \"0.4 m\"; }"
            : ", { type = \"drain\"; name = \"d\"; box = [\"0.1 m\", \"0.1 m\", \"0.2 m\", \"0.2 "
              "m\"]; head = \"0.95 m\"; }");
    advance(&run, 1e7);
    assert_true(fabs(richards_level_at(&run.s, beside) - (low ? .4 : .9)) < 1e-5);
    assert_true(low || run.s.entered[1] == 0);
    assert_true(water_open(&run.s) < 1e-10);
    finish(&run);
  }
}

/* Soil over a drain as wide, whose face lies anywhere between two lattice points: Darcy's flux
 * through what is above it, where the drain holds the air's pressure or a level over its face. */
static void drain_below(void **state) {
  (void)state;
  for (int n = 0; n < 6; n++) {
    struct run run;
    const double face = n % 3 == 0 ? .33 : n % 3 == 1 ? .3 : .269, head = n < 3 ? 0 : .6;
    start(&run,
          "scene = { end_time = \"1000 d\"; };\n"
          "domain = { size = [\"0.2 m\", \"1 m\"]; spacing = \"10 cm\"; periodic = [true, "
          "false]; };\n"
          "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"1 m\"]; " SAND
          "head = \"1 m\"; }, { type = \"inflow\"; box = [\"0\", \"0.99 m\", \"0.2 m\", \"1 m\"]; "
          "pressure_head = \"0.5 m\"; }, { type = \"drain\"; name = \"d\"; box = [\"0\", \"0\", "
          "\"0.2 m\", \"%g m\"]; head = \"%g m\"; } );\n" GRAVITY,
          face, head);
    advance(&run, 1e5);
    double out = 0;
    for (size_t e = 0; e < run.s.edge_count; e++)
      if (run.s.edges[e].kind == EDGE_DRAIN) out -= .5 * run.s.edge_flux[e].q; /* two columns */
    assert_true(fabs(out / (1e-4 * (1.5 - fmax(head, face)) / (1 - face)) - 1) < 1e-7);
    assert_true(water_open(&run.s) < 1e-10);
    finish(&run);
  }
}

/* What evaporates is what is asked for while the soil can give it, and less then, for ever. */
static void evaporation(void **state) {
  (void)state;
  struct run run;
  start_box(&run, SAND "head = \"0.5 m\";",
            ", { type = \"inflow\"; box = [\"0\", \"0.99 m\", \"0.4 m\", \"1 m\"]; flux = \"-1e-7 "
            "m/s\"; }");
  advance(&run, 1000);
  assert_true(fabs(run.s.out / (.4 * run.s.spacing * 1e-7 * 1000) - 1) < 1e-9);
  advance(&run, 1e9);
  assert_true(run.s.out < .4 * run.s.spacing * 1e-7 * 1e8);
  for (size_t i = 0; i < run.s.count; i++) assert_true(isfinite(run.s.h[i]));
  assert_true(water_open(&run.s) < 1e-10);
  finish(&run);
}

/* Without gravity water spreads as the root of time (Boltzmann): the sorptivity stays. */
static void sorption(void **state) {
  (void)state;
  struct run run;
  double in[2];
  start(&run,
        "scene = { end_time = \"1 d\"; };\ndomain = { size = [\"2 m\", \"0.02 m\"]; spacing = "
        "\"0.02 m\"; periodic = [false, true]; };\nregions = ( { type = \"porous\"; box = [\"0\", "
        "\"0\", \"2 m\", \"0.02 m\"]; " SAND "water_content = 0.1; }, { type = \"inflow\"; box = "
        "[\"0\", \"0\", \"0.01 m\", \"0.02 m\"]; pressure_head = \"-0.05 m\"; } );\n");
  for (int k = 0; k < 2; k++) {
    advance(&run, k ? 2000 : 500);
    in[k] = run.s.in;
  }
  printf("in %g, twice as much in four times the time: %g\n", in[0], in[1] / in[0]);
  assert_true(fabs(in[1] / in[0] - 2) < .01);
  finish(&run);
}

/* Water that a head brings into soil of Gardner's curve, dry to S = 1e-38, whose storage is nothing
 * beside what the fluxes seem to change with its head: it fills, and comes to rest under that head.
 */
static void dry_gardner(void **state) {
  (void)state;
  struct run run;
  start(
      &run,
      "scene = { end_time = \"1 d\"; };\ndomain = { size = [\"0.05 m\", \"1 m\"]; spacing = "
      "\"0.05 m\"; periodic = [true, false]; };\nforce = { gravity = [\"0\", \"-9.80665 m/s^2\"]; "
      "};\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.05 m\", \"1 m\"]; porosity = "
      "0.4; permeability = \"1e-4 m/s\"; gardner = { alpha = \"65 1/m\"; theta_r = 0.05; }; "
      "pressure_head = \"-1.35 m\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"0.05 m\", "
      "\"0.02 m\"]; head = \"0.38 m\"; } );\n");
  advance(&run, 86400);
  for (size_t i = 0; i < run.s.count; i++) {
    double x[3];
    richards_place(&run.s, i, x);
    if (x[2] < .4) assert_true(fabs(run.s.h[i] - (.38 - x[2])) < 1e-6);
  }
  assert_true(water_open(&run.s) < 1e-10);
  finish(&run);
}

/* Soil that is full all round takes no given flux: an error with the place, and no endless run. */
static void too_much(void **state) {
  (void)state;
  struct run run;
  start_box(&run, SAND "head = \"0.5 m\";",
            ", { type = \"inflow\"; box = [\"0\", \"0.99 m\", \"0.4 m\", \"1 m\"]; flux = \"1e-4 "
            "m/s\"; }");
  assert_int_equal(try_advance(&run, 1e5), STATUS_NUMERIC);
  assert_non_null(strstr(error_message(), "takes no more water"));
  error_clear();
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(curves),       cmocka_unit_test(haverkamp),  cmocka_unit_test(gardner),
      cmocka_unit_test(fluxes),       cmocka_unit_test(interfaces), cmocka_unit_test(rows),
      cmocka_unit_test(rain),         cmocka_unit_test(fills),      cmocka_unit_test(ditch),
      cmocka_unit_test(reservoir),    cmocka_unit_test(held_back),  cmocka_unit_test(meeting),
      cmocka_unit_test(sinking),      cmocka_unit_test(joined),     cmocka_unit_test(pit),
      cmocka_unit_test(stacked),      cmocka_unit_test(fed),        cmocka_unit_test(bared),
      cmocka_unit_test(walled_side),  cmocka_unit_test(coarse),     cmocka_unit_test(wells),
      cmocka_unit_test(evaporation),  cmocka_unit_test(sorption),   cmocka_unit_test(too_much),
      cmocka_unit_test(falling_head), cmocka_unit_test(ponding),    cmocka_unit_test(dry_gardner),
      cmocka_unit_test(drain_below)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
