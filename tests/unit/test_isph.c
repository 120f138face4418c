/* Method isph: kernels against the common ones, water at rest as an exact state, Darcy's law in
 * saturated soil, the rule for what starts wet, and the same bits for any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "common/kernel.h"
#include "sphsolve/isph/effects/turbulence.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/step.h"
#include "tests/unit/isph_scene.h"

static void assert_near(double value, double expected, double tolerance) {
  assert_true(fabs(value - expected) <= tolerance);
}

static void kernels_agree(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++)
    for (int k = 0; k < 2; k++) {
      enum kernel kernel = k ? KERNEL_QUINTIC : KERNEL_CUBIC;
      for (double r = 0.05; r < 1; r += 0.09) {
        double w, slope, h = 1 / kernel_support_ratio(kernel);
        isph_kernel(kernel, dimensions, r, 1, &w, &slope);
        assert_near(w, kernel_w(kernel, dimensions, r, h), 1e-9);
        assert_near(slope, -kernel_dw(kernel, dimensions, r, h) / r, 1e-6);
      }
    }
}

static const char tank[] =
    "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
    "domain = { size = [\"8 cm\", \"6 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [false, "
    "false, false]; };\n"
    "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0\", \"8 cm\", \"6 cm\", \"8 cm\"]; "
    "},\n"
    "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"8 cm\", \"6 cm\", \"4 cm\"]; porosity = "
    "0.4; "
    "grain_size = \"5 mm\"; } );\n"
    "force = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"1 ms\"; };\n";

/* P = rho g (z_s - z) solves the discrete equations on the lattice, and nothing moves but for what
 * the kernel sum does at the soil's edge. */
static void rest_is_exact(void **state) {
  (void)state;
  struct run run;
  char text[sizeof tank];
  strcpy(text, tank);
  *strstr(text, "},\n{ type = \"porous\"") = '\0';
  strcat(text, "} );\nforce = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\n"
               "isph = { dt = \"1 ms\"; tolerance = 1e-9; };\n");
  start(&run, text);
  assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  double fastest = 0;
  for (size_t i = 0; i < run.s.count; i++) {
    double expected = 1000 * 9.81 * (0.08 - run.s.position[i][2]);
    assert_near(run.s.pressure[i], expected, 0.02 * 785);
    for (int a = 0; a < 3; a++) fastest = fmax(fastest, fabs(run.s.velocity[i][a]));
  }
  /* A step of free fall is g dt = 1e-2 m/s; the edge where surface meets wall is not exact. */
  print_message("fastest %g m/s\n", fastest);
  assert_true(fastest < 1e-3);
  finish(&run);
}

static void soil_is_wet_where_water_is(void **state) {
  (void)state;
  struct run run;
  start(&run, tank);
  double mass = 0;
  for (size_t i = 0; i < run.s.count; i++) {
    mass += run.s.mass[i];
    assert_near(run.s.mass[i], 1e-3, 1e-4); /* in soil as outside */
  }
  assert_int_equal(run.s.count, 8 * 6 * 4 + 6 * 4 * 3);
  assert_near(mass, 1e-3 * (8 * 6 * 4 + 0.4 * 8 * 6 * 4), 1e-9);
  finish(&run);
  start(&run, "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
              "domain = { size = [\"8 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"4 cm\", \"8 cm\", \"8 cm\"]; },\n"
              "{ type = \"porous\"; box = [\"0\", \"0\", \"8 cm\", \"4 cm\"]; porosity = 0.4; "
              "grain_size = \"5 mm\"; } );\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  assert_int_equal(run.s.count, 8 * 4); /* the block below starts dry */
  finish(&run);
}

/* v_D = 2 g / (a + sqrt(a^2 + 4 b g)), grains of 0.1 mm at 1 ms: 300 times the explicit limit. */
static void saturated_soil_obeys_darcy(void **state) {
  (void)state;
  struct run run;
  double v[3];
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"8 cm\", \"8 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"8 cm\", \"8 cm\"]; porosity = "
        "0.25; grain_size = \"0.1 mm\"; alpha = 1000.0; beta = 1.1; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"1 ms\"; };\n");
  for (int k = 0; k < 50; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  isph_darcy_velocity(&run.s, v);
  assert_near(v[2], -2.725e-6, 2.5e-10);
  finish(&run);
}

/* A box of saturated soil that is no whole number of spacings holds all of its water. */
static void soil_between_sites_is_full(void **state) {
  (void)state;
  struct run run;
  double mass = 0;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"30 cm\", \"30 cm\"]; spacing = \"1 cm\"; periodic = [false, false]; "
        "};\n"
        "regions = ( { type = \"porous\"; box = [\"15 cm\", \"0\", \"25.33 cm\", \"10.5 cm\"]; "
        "porosity = 0.37; grain_size = \"1 mm\"; saturated = true; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  for (size_t i = 0; i < run.s.count; i++) mass += run.s.mass[i];
  assert_near(mass, 1000 * .37 * .1033 * .105, 1e-9);
  finish(&run);
}

/* Through a layer two spacings thick as through its resistance, and as fast before it as behind
 * (isph/link.h; by mobilities of smoothed soil 9 % too much). */
static void a_thin_layer_resists_as_its_soil(void **state) {
  (void)state;
  struct run run;
  double v[3], sum = 0;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"8 cm\", \"10 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"8 cm\", \"10 cm\"]; },\n"
        "{ type = \"porous\"; box = [\"0\", \"4 cm\", \"8 cm\", \"6 cm\"]; porosity = 0.3; "
        "grain_size = \"5 mm\"; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"5 ms\"; };\n");
  for (int k = 0; k < 200; k++) {
    assert_int_equal(isph_advance(&run.s, 5e-3), STATUS_OK);
    isph_darcy_velocity(&run.s, v);
    if (k >= 100) sum -= 0.01 * v[2];
  }
  const double a = 1e-3 * .49 / (.027 * 25e-6), b = 1.1 * .7 / (.027 * 5e-3), f = 5 * 9.81;
  const double exact = 2 * f / (a + sqrt(a * a + 4 * b * f));
  assert_near(sum, exact, 0.03 * exact);
  finish(&run);
}

/* Rows drawn out to twice their distance, as where water enters soil: the second moments of a pair
 * operator stay those of the lattice (without isph/moment.c .94 across the rows). */
static void drawn_out_rows_count_in_full(void **state) {
  (void)state;
  struct run run;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"12 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"12 cm\", \"12 cm\"]; porosity = "
      "0.4; grain_size = \"5 mm\"; } );\n"
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  struct isph *s = &run.s;
  size_t kept = 0;
  for (size_t i = 0; i < s->count; i++) {
    if ((int)(s->position[i][2] / 0.01) % 2 == 1) continue;
    memmove(s->position[kept], s->position[i], sizeof *s->position);
    s->mass[kept] = 2 * s->mass[i], s->id[kept++] = s->id[i];
  }
  s->count = kept;
  assert_int_equal(isph_refresh(s), STATUS_OK);
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      double xx = 0, zz = 0, r[3];
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
        const struct isph_chunk *chunk = &s->chunks[c];
        isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
        double f = s->volume[chunk->pair[p] & PAIR_MASK] * (double)chunk->slope[p];
        xx += f * r[0] * r[0], zz += f * r[2] * r[2];
      }
      assert_near(xx, 1, 0.02);
      assert_near(zz, 1, 0.02);
    }
  finish(&run);
}

static void threads_agree(void **state) {
  (void)state;
#ifdef _OPENMP
  int before = omp_get_max_threads();
  struct run one, three;
  threads_use(1);
  start(&one, tank);
  for (int k = 0; k < 20; k++) assert_int_equal(isph_advance(&one.s, 1e-3), STATUS_OK);
  threads_use(3);
  start(&three, tank);
  for (int k = 0; k < 20; k++) assert_int_equal(isph_advance(&three.s, 1e-3), STATUS_OK);
  threads_use(0);
  omp_set_num_threads(before);
  assert_int_equal(one.s.count, three.s.count);
  assert_memory_equal(one.s.position, three.s.position, one.s.count * sizeof *one.s.position);
  assert_memory_equal(one.s.velocity, three.s.velocity, one.s.count * sizeof *one.s.velocity);
  assert_memory_equal(one.s.pressure, three.s.pressure, one.s.count * sizeof *one.s.pressure);
  finish(&one);
  finish(&three);
#endif
}

/* Few iterations, and fewer from the last step's pressure than from nothing. */
static void warm_start_saves(void **state) {
  (void)state;
  struct run run;
  start(&run, tank);
  memset(run.s.pressure, 0, run.s.count * sizeof *run.s.pressure);
  assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  int cold = run.s.solve.iterations;
  for (int k = 0; k < 5; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  assert_in_range(cold, 2, 25);
  assert_true(run.s.solve.iterations < cold);
  finish(&run);
}

#define CHANNEL                                                                                    \
  "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"                                          \
  "domain = { size = [\"0.2 m\", \"0.1 m\"]; spacing = \"1 cm\"; periodic = [false, false]; };\n"  \
  "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { wall = { slip = true; }; };\n"       \
  "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; },\n"               \
  "{ type = \"inflow\"; box = [\"0.19 m\", \"0\", \"0.2 m\", \"0.1 m\"]; head = \"0.2 m\"; },\n"

static void a_given_flux_is_what_goes_through(void **state) {
  (void)state;
  struct run run;
  double mean = 0, worst = 0;
  start(
      &run, CHANNEL
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; flux = \"0.05 m/s\"; } );");
  for (int k = 0; k < 40; k++) {
    advance(&run, 0.5 + 0.02 * k);
    double flux = flux_at(&run.s, 0.05) / (0.1 * 0.01);
    mean += flux / 40, worst = fmax(worst, fabs(flux / 0.05 - 1));
  }
  assert_near(mean, 0.05, 0.0015);
  assert_true(worst < 0.1);
  assert_int_equal(run.s.lost_count, 0);
  assert_near(run.s.passed.entered, 1000 * 0.05 * run.s.time * 0.1 * 0.01, 0.1 * 0.01 * 10.01);
  finish(&run);
}

/* Gravel between two heads: the flux of its drag, and a straight line of heads. */
static void heads_hold(void **state) {
  (void)state;
  struct run run;
  double v[3], mean = 0, head[2] = {0};
  start(&run, CHANNEL "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity = "
                      "0.4; grain_size = \"5 mm\"; },\n"
                      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = "
                      "\"0.3 m\"; } );");
  for (int k = 0; k < 40; k++) {
    advance(&run, 0.5 + 0.02 * k);
    isph_darcy_velocity(&run.s, v);
    mean += v[0] / 40;
    for (int g = 0; g < 2; g++) {
      const double at[3] = {g == 0 ? 0.05 : 0.15, 0, 0.05};
      head[g] += (pressure_at(&run.s, at) / 9810 + 0.05) / 40;
    }
  }
  double a = 1000 * 1e-6 * 0.36 / (0.064 * 25e-6), b = 1.1 * 0.6 / (0.064 * 5e-3);
  assert_near(mean, (-a + sqrt(a * a + 4 * b * 9.81 * 0.5)) / (2 * b), 0.03 * 0.0186);
  assert_near(head[0], 0.275, 0.002);
  assert_near(head[1], 0.225, 0.002);
  finish(&run);
}

/* Disordered water in coarse soil that ends a hundredth of a spacing before fine soil: what moves
 * along the interface is not turned into flow across it, so that nothing stirs, in short steps
 * either. */
static void coarse_soil_before_fine_stays_even(void **state) {
  (void)state;
  struct run run;
  double worst = 0;
  start(&run, CHANNEL "{ type = \"porous\"; box = [\"0.03 m\", \"0\", \"0.0951 m\", \"0.1 m\"]; "
                      "porosity = 0.84; grain_size = \"5 mm\"; },\n"
                      "{ type = \"porous\"; box = [\"0.0951 m\", \"0\", \"0.17 m\", \"0.1 m\"]; "
                      "porosity = 0.76; grain_size = \"0.1 mm\"; },\n"
                      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = "
                      "\"0.25 m\"; } );\n");
  for (size_t i = 0; i < run.s.count; i++) {
    uint32_t word[4] = {1, (uint32_t)i};
    philox4x32(word, 0, 0);
    for (int a = 0; a < 3; a += 2)
      run.s.position[i][a] += 0.2 * run.s.spacing * (random_share(word[a]) - 0.5);
  }
  assert_int_equal(isph_refresh(&run.s), STATUS_OK);
  for (int k = 0; k < 600; k++) {
    double across = 0, v[3];
    assert_int_equal(isph_advance(&run.s, 3e-3), STATUS_OK);
    for (size_t i = 0; i < run.s.count; i++)
      across += pow(run.s.velocity[i][2], 2) / (double)run.s.count;
    isph_darcy_velocity(&run.s, v);
    worst = fmax(worst, sqrt(across) / v[0]);
  }
  print_message("across the flow at most %.2f of its velocity\n", worst);
  assert_true(worst < 1);
  finish(&run);
}

/* Soil that ends at a wall is the same as soil that goes on behind its face, at the surface of soil
 * beside the wall too; behind a wall that moves there is water. */
static void walls_do_not_thin_soil(void **state) {
  (void)state;
  static const double at[][2] = {{.05, .095}, {.01, .09}, {.102, .1}, {.15, .1}, {.15, .07}};
  struct soil_point found[3][5];
  for (int k = 0; k < 3; k++) {
    struct run run;
    char text[1024];
    snprintf(text, sizeof text,
             "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
             "domain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [false, "
             "false]; };\n"
             "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.15 m\"]; },\n"
             "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity = 0.4; "
             "grain_size = \"5 mm\"; },\n"
             "%s { type = \"wall\"; box = [\"0\", \"0.1 m\", \"0.1 m\", \"0.2 m\"]; %s } );\n"
             "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
             k == 1 ? "{ type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.2 m\"]; porosity = "
                      "0.4; grain_size = \"5 mm\"; },"
                    : "",
             k == 2 ? "velocity = [\"0\", \"1 mm/s\"];" : "");
    start(&run, text);
    for (int n = 0; n < 5; n++)
      isph_soil_at(&run.s, (double[3]){at[n][0], 0, at[n][1]}, 0, &found[k][n]);
    finish(&run);
  }
  for (int n = 0; n < 5; n++) {
    const struct soil_point *here = &found[0][n], *under = &found[1][n];
    assert_true(fabs(here->porosity - under->porosity) < 1e-9);
    assert_true(fabs(here->a / under->a - 1) < 1e-9);
    if (n != 2 && n != 3) assert_true(fabs(here->porosity - 0.4) < 1e-9);
  }
  assert_true(found[2][0].porosity > 0.45);
}

/* A block of soil that moves round a ring takes the water along. */
static void moving_soil_carries_water(void **state) {
  (void)state;
  struct run run;
  double v[3];
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
      "domain = { size = [\"0.3 m\", \"0.05 m\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.3 m\", \"0.05 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.05 m\"]; porosity = 0.4; "
      "grain_size = \"2 mm\"; velocity = [\"0.1 m/s\", \"0\"]; } );\n"
      "force = { gravity = [\"0\", \"0\"]; };\nisph = { dt = \"2 ms\"; };\n");
  advance(&run, 1);
  isph_darcy_velocity(&run.s, v);
  assert_near(v[0], 0.08, 0.004); /* v_soil in two thirds, eps v_soil in one */
  finish(&run);
}

static void a_piston_pushes(void **state) {
  (void)state;
  struct run run;
  start(&run,
        CHANNEL "{ type = \"wall\"; box = [\"0\", \"0\", \"0.03 m\", \"0.1 m\"]; slip = true; "
                "velocity = [\"0.1 m/s\", \"0\"]; } );");
  advance(&run, 0.5);
  assert_near(flux_at(&run.s, 0.15) / (0.1 * 0.01), 0.1, 0.005);
  assert_int_equal(run.s.lost_count, 0);
  finish(&run);
}

/* Water of one velocity: through a plane passes that times the height that is open there, beside a
 * side of the domain, too, and in a wall, beside which water cannot pass. */
static void planes_count_what_passes(void **state) {
  (void)state;
  struct run run;
  start(&run, CHANNEL "{ type = \"wall\"; box = [\"0.12 m\", \"0.04 m\", \"0.14 m\", \"0.1 m\"]; } "
                      ");");
  for (size_t i = 0; i < run.s.count; i++) run.s.velocity[i][0] = 0.1;
  static const double at[] = {0.06, 0.004, 0.13}, open[] = {0.1, 0.1, 0.04};
  for (int k = 0; k < 3; k++) {
    const double flux = flux_at(&run.s, at[k]) / (0.1 * run.s.thickness * open[k]);
    print_message("plane at %g: %.4f of what passes\n", at[k], flux);
    assert_near(flux, 1, 0.03);
  }
  finish(&run);
}

/* The same in soils that fill the domain, of particles so large that three lie side by side in one:
 * their volumes overlap at its edges. */
static void planes_in_soil_count_what_passes(void **state) {
  (void)state;
  struct run run;
  start(&run, CHANNEL "{ type = \"porous\"; box = [\"0.05 m\", \"0\", \"0.14 m\", \"0.1 m\"]; "
                      "porosity = 0.1; grain_size = \"1 mm\"; },\n"
                      "{ type = \"porous\"; box = [\"0.14 m\", \"0\", \"0.2 m\", \"0.1 m\"]; "
                      "porosity = 0.3; grain_size = \"5 mm\"; },\n"
                      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = "
                      "\"0.3 m\"; } );\n");
  for (size_t i = 0; i < run.s.count; i++) run.s.velocity[i][0] = 0.1;
  for (int k = 1; k < 10; k++)
    assert_near(flux_at(&run.s, 0.02 * k) / (0.1 * run.s.thickness * 0.1), 1, 1e-9);
  finish(&run);
}

/* How many of `n` points at x, and of their images, are closer to particle i than half its support
 * (all of it for walls) and half of theirs. */
static size_t count_near(const struct isph *s, size_t i, double (*x)[3], size_t n, bool walls) {
  size_t near = 0;
  for (uint32_t code = 0; code < 27; code++) {
    const int at[3] = {(int)code % 3 - 1, (int)code / 3 % 3 - 1, (int)code / 9 - 1};
    bool exists = true;
    for (int a = 0; a < 3; a++)
      exists = exists && (at[a] == 0 || s->periodic[a] || s->reflects[a][at[a] > 0]);
    for (size_t j = 0; j < n && exists; j++) {
      const double reach = walls ? s->support[i] : 0.5 * (s->support[i] + s->support[j]);
      double r[3];
      isph_separation(s, s->position[i], x, (uint32_t)j | code << PAIR_BITS, r);
      near += dot(r, r) < reach * reach && (walls || code != IMAGE_NONE || j != i);
    }
  }
  return near;
}

/* Lists hold all neighbours within the support, each once, and no others: beside periodic and
 * reflecting sides, walls, and soil in which supports are wider; in three dimensions and in two. */
static void lists_are_complete(void **state) {
  (void)state;
  static const char *const scenes[] = {
      "domain = { size = [\"0.12 m\", \"0.1 m\", \"0.09 m\"]; spacing = \"1 cm\"; periodic = "
      "[true, false, false]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0\", \"0.12 m\", \"0.1 m\", "
      "\"0.07 m\"]; }, { type = \"porous\"; box = [\"0.05 m\", \"0\", \"0\", \"0.12 m\", "
      "\"0.1 m\", \"0.09 m\"]; porosity = 0.3; permeability = \"1e-3 m/s\"; }, { type = "
      "\"wall\"; box = [\"0.02 m\", \"0.02 m\", \"0\", \"0.04 m\", \"0.04 m\", \"0.05 m\"]; } "
      ");\n",
      "domain = { size = [\"0.5 m\", \"0.3 m\"]; spacing = \"1 cm\"; periodic = [false, false]; "
      "};\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.5 m\", \"0.2 m\"]; }, { type = "
      "\"porous\"; box = [\"0.3 m\", \"0\", \"0.4 m\", \"0.3 m\"]; porosity = 0.3; permeability "
      "= \"1e-3 m/s\"; }, { type = \"wall\"; box = [\"0.1 m\", \"0\", \"0.12 m\", \"0.1 m\"]; } "
      ");\n"};
  for (int k = 0; k < 2; k++) {
    struct run run;
    char text[1200];
    snprintf(text, sizeof text,
             "scene = { method = \"isph\"; end_time = \"9 s\"; };\n%s"
             "force = { gravity = [\"0\", \"-9.81 m/s^2\"%s]; };\n",
             scenes[k], k == 0 ? ", \"0\"" : "");
    start(&run, text);
    struct isph *s = &run.s;
    srand(1);
    for (size_t i = 0; i < s->count; i++)
      for (int a = 0; a < 3; a++)
        if (isph_uses_axis(s, a)) {
          const double x = s->position[i][a] + 0.01 * ((double)rand() / RAND_MAX - 0.5);
          s->position[i][a] = fmin(fmax(x, s->low[a]), s->high[a] - 1e-9);
        }
    assert_int_equal(isph_refresh(s), STATUS_OK);
    for (size_t c = 0; c < s->chunk_count; c++)
      for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
        const uint32_t *pair = s->chunks[c].pair + s->pair_first[i];
        for (size_t p = 0; p < s->pair_number[i]; p++)
          for (size_t q = 0; q < p; q++) assert_true(pair[p] != pair[q]);
        assert_int_equal(s->pair_number[i], count_near(s, i, s->position, s->count, false));
        assert_int_equal(s->wall_number[i],
                         count_near(s, i, s->boundary_position, s->boundary_count, true));
      }
    finish(&run);
  }
}

/* The solver needs no more iterations for 27 times the particles, none for a particle alone, and
 * few for spray. */
static void iterations_stay(void **state) {
  (void)state;
  struct run run;
  int cold[2];
  for (int fine = 0; fine < 2; fine++) {
    char text[600];
    snprintf(text, sizeof text,
             "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
             "domain = { size = [\"0.9 m\", \"0.9 m\", \"1.2 m\"]; spacing = \"%s\"; periodic = "
             "[false, false, false]; };\n"
             "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0\", \"0.9 m\", \"0.9 m\", "
             "\"0.9 m\"]; } );\n"
             "force = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\n",
             fine ? "3 cm" : "9 cm");
    start(&run, text);
    memset(run.s.pressure, 0, run.s.count * sizeof *run.s.pressure);
    assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
    cold[fine] = run.s.solve.iterations;
    if (fine) { /* spray: one particle in 23 stays */
      size_t kept = 0;
      for (size_t i = 0; i < run.s.count; i += 23, kept++) {
        memcpy(run.s.position[kept], run.s.position[i], sizeof run.s.position[i]);
        memset(run.s.velocity[kept], 0, sizeof run.s.velocity[i]);
        run.s.mass[kept] = run.s.mass[i], run.s.id[kept] = run.s.id[i], run.s.pressure[kept] = 0;
      }
      run.s.count = kept;
      assert_int_equal(isph_refresh(&run.s), STATUS_OK);
      for (int k = 0; k < 10; k++) {
        assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
        assert_in_range(run.s.solve.iterations, 0, 20);
      }
    }
    finish(&run);
  }
  assert_in_range(cold[1], 1, cold[0] + 3);
  start(&run,
        "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
        "domain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0.1 m\", \"0.15 m\", \"0.11 m\", \"0.16 m\"]; "
        "} );\nforce = { gravity = [\"0\", \"-10 m/s^2\"]; };\n");
  for (int k = 0; k < 10; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  assert_int_equal(run.s.count, 1);
  assert_near(run.s.velocity[0][2], -0.1, 1e-6); /* free flight */
  finish(&run);
}

/* Nor for soil of little porosity, whose particles are larger than the cells of the solver's grid:
 * water of two levels over soil, in 2-D and in 3-D. */
static void sparse_soil_is_solved_as_fast(void **state) {
  (void)state;
  static const double eps[2] = {0.1, 0.6};
  for (int deep = 0; deep < 2; deep++) {
    int sum[2] = {0};
    for (int k = 0; k < 2; k++) {
      const char *y = deep ? "\"0.2 m\", " : "", *low = deep ? "\"0\", " : "";
      struct run run;
      char text[1200];
      snprintf(
          text, sizeof text,
          "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
          "domain = { size = [\"0.4 m\", %s\"0.6 m\"]; spacing = \"2 cm\"; periodic = [false, "
          "%s false]; };\n"
          "regions = ( { type = \"water\"; box = [\"0\", %s\"0\", \"0.2 m\", %s\"0.5 m\"]; },\n"
          "{ type = \"water\"; box = [\"0.2 m\", %s\"0\", \"0.4 m\", %s\"0.4 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", %s\"0\", \"0.4 m\", %s\"0.3 m\"]; porosity = %g; "
          "permeability = \"1 cm/s\"; } );\n"
          "force = { gravity = [\"0\", %s\"-9.81 m/s^2\"]; };\n",
          y, deep ? "false," : "", low, y, low, y, low, y, eps[k], low);
      start(&run, text);
      for (int n = 0; n < 10; n++) {
        assert_int_equal(isph_advance(&run.s, 2e-3), STATUS_OK);
        sum[k] += run.s.solve.iterations;
      }
      finish(&run);
    }
    print_message("%d-D: %.1f iterations at a porosity of %g, %.1f at %g\n", 2 + deep, sum[0] / 10.,
                  eps[0], sum[1] / 10., eps[1]);
    assert_true(sum[0] < 1.5 * sum[1]);
  }
}

/* Nor for soil whose mobility is 1e-10 of the water's beside it; and in it the pressure is as
 * exact, so that what seeps is the same from step to step. */
static void fine_soil_is_solved_as_fast(void **state) {
  (void)state;
  struct run run;
  int most = 0;
  double before[3], now[3], jump = 0;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
      "domain = { size = [\"34 cm\", \"6 cm\"]; spacing = \"1 cm\"; periodic = [false, false]; };\n"
      "regions = ( { type = \"porous\"; box = [\"7 cm\", \"0\", \"17 cm\", \"6 cm\"]; porosity = "
      "0.067; grain_size = \"1 um\"; },\n"
      "{ type = \"porous\"; box = [\"17 cm\", \"0\", \"27 cm\", \"6 cm\"]; porosity = 0.62; "
      "grain_size = \"9 um\"; },\n"
      "{ type = \"water\"; box = [\"0\", \"0\", \"34 cm\", \"6 cm\"]; },\n"
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"6 cm\"]; head = \"8 cm\"; },\n"
      "{ type = \"inflow\"; box = [\"33 cm\", \"0\", \"34 cm\", \"6 cm\"]; head = \"7 cm\"; } );\n"
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  for (int n = 0; n < 80; n++) {
    assert_int_equal(isph_advance(&run.s, 5e-3), STATUS_OK);
    most = run.s.solve.iterations > most ? run.s.solve.iterations : most;
    isph_darcy_velocity(&run.s, now);
    if (n >= 60) jump = fmax(jump, fabs(now[0] / before[0] - 1));
    memcpy(before, now, sizeof before);
  }
  print_message("%d iterations at most, flux from step to step %.2g %%\n", most, 100 * jump);
  assert_in_range(most, 1, 25);
  assert_true(jump < 0.005);
  finish(&run);
}

/* The law of the wall and the viscous layer meet, and each holds on its side. */
static void walls_hold_by_the_law_of_the_wall(void **state) {
  (void)state;
  const double nu = 1e-6, distance = 5e-3;
  for (double speed = 0.1; speed < 10; speed *= 2) {
    double friction = sqrt(wall_viscosity(nu, speed, distance) * speed / distance);
    assert_near(speed, friction * log(9.8 * friction * distance / nu) / 0.41, 1e-3 * speed);
  }
  assert_near(wall_viscosity(nu, 0.9 * 11.6 * 11.6 * nu / distance, distance), nu, 1e-15);
  assert_near(wall_viscosity(nu, 11.7 * 11.7 * nu / distance, distance), nu, 0.05 * nu);
  assert_near(wall_viscosity(0, 1, distance), 0, 0);
  assert_near(wall_viscosity(nu, 0, distance), nu, 0);
}

/* A square of water with a surface tension: over its first step the pressure is that of curvature,
 * largest at the corners, and what tension gives is in the budget, under its own name; without
 * gravity it neither moves nor turns as a whole. */
static void tension_presses(void **state) {
  (void)state;
  struct run run;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"4 mm\", \"4 mm\"]; spacing = \"0.2 mm\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"water\"; box = [\"1 mm\", \"1 mm\", \"3 mm\", \"3 mm\"]; } );\n");
  assert_int_equal(run.s.on.own_count, 0); /* no surface_tension, no effect, no memory */
  assert_null(run.s.surface_pressure);
  finish(&run);
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"4 mm\", \"4 mm\"]; spacing = \"0.2 mm\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"water\"; box = [\"1 mm\", \"1 mm\", \"3 mm\", \"3 mm\"]; } );\n"
      "@surface_tension = \"0.07 N/m\";");
  struct isph *s = &run.s;
  double middle = 0, corner = 0, momentum[2] = {0}, radius = 2e-3 / sqrt(M_PI), end = 0;
  s->kinematic_viscosity = 1e-4;
  assert_int_equal(s->on.own_count, 1);
  assert_int_equal(isph_advance(s, 1e-5), STATUS_OK);
  for (size_t i = 0; i < s->count; i++) {
    const double *x = s->position[i];
    if (fabs(x[0] - 2e-3) > 0.85e-3 && fabs(x[2] - 2e-3) > 0.85e-3)
      corner = fmax(corner, s->surface_pressure[i]);
    if (s->surface[i] > 0 && fabs(x[0] - 2e-3) < 0.2e-3)
      middle = fmax(middle, s->surface_pressure[i]);
  }
  assert_true(corner > 2 * 0.07 / 2e-3 && middle < 0.2 * corner);
  while (s->time < 10e-3) assert_int_equal(isph_advance(s, 2e-5), STATUS_OK);
  for (size_t i = 0, n = 0; i < s->count; i++) {
    const double dx = s->position[i][0] - 2e-3, dz = s->position[i][2] - 2e-3;
    for (int a = 0; a < 2; a++) momentum[a] += s->mass[i] * s->velocity[i][2 * a];
    if (dx * dx + dz * dz < 0.25 * radius * radius) end += (s->pressure[i] - end) / (double)++n;
  }
  assert_near(end / (0.07 / radius), 1, 0.05);
  assert_true(hypot(momentum[0], momentum[1]) < 1e-3 * 4e-6 * 1000 * 0.07);
  const double *impulse = s->budget.sums.impulse[BUDGET_OWN];
  assert_string_equal(budget_name(&s->budget, BUDGET_OWN), "isph_surface_tension");
  assert_true(s->budget.sums.work[BUDGET_OWN] > 0 && isfinite(impulse[0]));
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(kernels_agree),
      cmocka_unit_test(rest_is_exact),
      cmocka_unit_test(soil_is_wet_where_water_is),
      cmocka_unit_test(saturated_soil_obeys_darcy),
      cmocka_unit_test(soil_between_sites_is_full),
      cmocka_unit_test(a_thin_layer_resists_as_its_soil),
      cmocka_unit_test(drawn_out_rows_count_in_full),
      cmocka_unit_test(threads_agree),
      cmocka_unit_test(warm_start_saves),
      cmocka_unit_test(a_given_flux_is_what_goes_through),
      cmocka_unit_test(heads_hold),
      cmocka_unit_test(moving_soil_carries_water),
      cmocka_unit_test(a_piston_pushes),
      cmocka_unit_test(coarse_soil_before_fine_stays_even),
      cmocka_unit_test(walls_do_not_thin_soil),
      cmocka_unit_test(planes_count_what_passes),
      cmocka_unit_test(planes_in_soil_count_what_passes),
      cmocka_unit_test(lists_are_complete),
      cmocka_unit_test(iterations_stay),
      cmocka_unit_test(fine_soil_is_solved_as_fast),
      cmocka_unit_test(sparse_soil_is_solved_as_fast),
      cmocka_unit_test(walls_hold_by_the_law_of_the_wall),
      cmocka_unit_test(tension_presses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
