/* Closed sides of method isph reflect (sphsolve/isph/reflection.h). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/step.h"
#include "tests/unit/isph_scene.h"

#define WATER                                                                                      \
  "domain = { size = [\"%g m\", \"0.3 m\"]; spacing = \"1 cm\"; periodic = [%s, false]; };\n"      \
  "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%g m\", \"0.2 m\"]; } );\n"              \
  "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"                                          \
  "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"                                             \
  "isph = { tolerance = 1e-12; wall = { slip = true; }; };\n"

/* Half a wave between sides at 0 and .2 m, or with `whole` the wave of .4 m round a periodic axis.
 */
static void wave(struct run *run, bool whole) {
  char text[1024];
  const double width = whole ? 0.4 : 0.2, k = M_PI / 0.2;
  snprintf(text, sizeof text, WATER, width, whole ? "true" : "false", width);
  start(run, text);
  for (size_t i = 0; i < run->s.count; i++) {
    const double *x = run->s.position[i];
    run->s.velocity[i][0] = -0.3 * cosh(k * x[2]) / cosh(k * 0.2) * sin(k * x[0]);
    run->s.velocity[i][2] = 0.3 * sinh(k * x[2]) / cosh(k * 0.2) * cos(k * x[0]);
  }
}

static size_t nearest(const struct isph *s, const double x[3]) {
  size_t best = 0;
  double least = INFINITY;
  for (size_t j = 0; j < s->count; j++) {
    const double *y = s->position[j], away = hypot(x[0] - y[0], x[2] - y[2]);
    if (away < least) least = away, best = j;
  }
  return best;
}

/* To round-off; the wave moves particles by 4 mm. */
static void a_side_is_a_plane_of_symmetry(void **state) {
  struct run half, whole;
  (void)state;
  wave(&half, false);
  wave(&whole, true);
  for (int step = 0; step < 40; step++) {
    assert_int_equal(isph_advance(&half.s, 2e-3), STATUS_OK);
    assert_int_equal(isph_advance(&whole.s, 2e-3), STATUS_OK);
  }
  assert_int_equal(2 * half.s.count, whole.s.count);
  double off[4] = {0};
  for (size_t i = 0; i < half.s.count; i++) {
    const size_t j = nearest(&whole.s, half.s.position[i]);
    for (int a = 0; a < 3; a += 2) {
      off[0] = fmax(off[0], fabs(half.s.position[i][a] - whole.s.position[j][a]));
      off[1] = fmax(off[1], fabs(half.s.velocity[i][a] - whole.s.velocity[j][a]));
    }
    off[2] = fmax(off[2], fabs(half.s.kernel_sum[i] - whole.s.kernel_sum[j]));
    off[3] = fmax(off[3], fabs(half.s.pressure[i] - whole.s.pressure[j]));
  }
  print_message("off by %.2g m, %.2g m/s, %.2g, %.2g Pa\n", off[0], off[1], off[2], off[3]);
  assert_true(off[0] < 1e-12 && off[1] < 1e-10 && off[2] < 1e-10 && off[3] < 1e-6);
  finish(&half);
  finish(&whole);
}

/* The walls' part of the budget is the force on the floor: the weight of the water. */
static void a_side_carries_the_weight(void **state) {
  struct run run;
  (void)state;
  wave(&run, false);
  memset(run.s.velocity, 0, run.s.count * sizeof *run.s.velocity);
  assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  isph_budget_begin(&run.s);
  assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  const double *wall = run.s.budget.sums.impulse[BUDGET_WALL_PRESSURE];
  const double *force = run.s.budget.sums.impulse[BUDGET_FORCE];
  assert_true(fabs(wall[2] + force[2]) < 0.02 * fabs(force[2]));
  assert_true(fabs(wall[0]) < 1e-3 * fabs(force[2]));
  finish(&run);
}

/* A gauge on a side, and in a corner, sees the images too: no water flows through there, however
 * the particles before it move, and hydrostatic pressure is exact. */
static void a_gauge_on_a_side_sees_images(void **state) {
  struct run run;
  (void)state;
  wave(&run, false);
  struct isph *s = &run.s;
  double number[GAUGE_NUMBERS];
  for (size_t i = 0; i < s->count; i++) {
    double *x = s->position[i];
    x[0] += 1e-3 * sin(1e3 * (double)i), x[2] += 1e-3 * cos(7e2 * (double)i);
    s->velocity[i][0] = sin(3e2 * (double)i), s->velocity[i][2] = 1;
    s->pressure[i] = 9810 * (0.2 - x[2]);
  }
  assert_int_equal(isph_refresh(s), STATUS_OK);
  isph_read_gauge(s, (double[3]){0, 0, 0.1}, number);
  assert_true(fabs(number[0] / 981 - 1) < 1e-12);
  assert_true(fabs(number[1]) < 1e-12 && fabs(number[3] - 1) < 1e-12);
  isph_read_gauge(s, (double[3]){0.2, 0, 0}, number);
  assert_true(fabs(number[0] / 1962 - 1) < 1e-12);
  assert_true(fabs(number[1]) < 1e-12 && fabs(number[3]) < 1e-12);
  finish(&run);
}

/* Sides beside soil under a surface, and windows, have wall particles instead of images, and a
 * gauge sees images there too: five particles of a corner, one behind the other, would tell it
 * nothing. Through a window water flows, so a gauge sees none. */
static void a_gauge_in_soil_sees_images(void **state) {
  struct run run;
  (void)state;
  start(&run, "domain = { size = [\"0.4 m\", \"0.3 m\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.2 m\"]; },\n"
              "{ type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.2 m\"]; porosity = 0.4; "
              "permeability = "
              "\"0.1 m/s\"; },\n"
              "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.3 m\"]; head = \"0.2 "
              "m\"; } );\n"
              "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
              "isph = { wall = { slip = true; }; };\n");
  struct isph *s = &run.s;
  double number[GAUGE_NUMBERS];
  for (int a = 0; a < 3; a++) assert_false(s->reflects[a][0] || s->reflects[a][1]);
  for (size_t i = 0; i < s->count; i++) {
    double *x = s->position[i];
    if (x[0] < 0.05) x[0] = 0.012 + 0.1 * x[2] + 1e-3 * sin(1e3 * (double)i);
    s->velocity[i][0] = 1 + x[0], s->velocity[i][2] = -x[2];
    s->pressure[i] = 9810 * (0.2 - x[2]);
  }
  isph_read_gauge(s, (double[3]){0, 0, 0}, number);
  assert_true(fabs(number[0] / 1962 - 1) < 1e-12);
  assert_true(fabs(number[1]) < 1e-12 && fabs(number[3]) < 1e-12);
  isph_read_gauge(s, (double[3]){0.4, 0, 0}, number);
  assert_true(fabs(number[0] / 1962 - 1) < 1e-12);
  assert_true(fabs(number[1] / 1.4 - 1) < 1e-12 && fabs(number[3]) < 1e-12);
  finish(&run);
}

/* Particles in soil have a larger support than those of free water: the fit is exact for a linear
 * pressure beside the edge of soil as well. */
static void a_gauge_beside_soil_is_exact(void **state) {
  struct run run;
  (void)state;
  start(&run, "domain = { size = [\"0.2 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.14 m\"]; },\n"
              "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity = 0.2; "
              "permeability = \"0.1 m/s\"; } );\n"
              "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  struct isph *s = &run.s;
  for (size_t i = 0; i < s->count; i++) s->pressure[i] = 9810 * (0.14 - s->position[i][2]);
  for (int k = -2; k <= 2; k++) {
    const double z = 0.1 + 0.004 * k;
    double number[GAUGE_NUMBERS];
    isph_read_gauge(s, (double[3]){0.1, 0, z}, number);
    assert_true(fabs(number[0] - 9810 * (0.14 - z)) < 1e-9);
  }
  finish(&run);
}

/* A row of particles below a gauge, as the tip of a wave, tells nothing of the pressure up there:
 * it reads as in a void. */
static void a_gauge_beyond_the_water_reads_nothing(void **state) {
  struct run run;
  (void)state;
  wave(&run, false);
  struct isph *s = &run.s;
  double number[GAUGE_NUMBERS], at[3] = {0.2, 0, 0.1};
  for (size_t i = 0; i < s->count; i++) {
    double *x = s->position[i], to = at[2] - 1.2 * s->spacing;
    const bool row = fabs(x[2] - to) < .5 * s->spacing;
    x[2] = row ? to + 1e-2 * s->spacing * sin(1e3 * (double)i) : .01 * x[2];
    s->pressure[i] = row ? 1e4 * (1 + sin(3e2 * (double)i)) : 0;
  }
  isph_read_gauge(s, at, number);
  assert_true(number[0] == 0 && fabs(number[4] - at[2]) < 1e-15);
  finish(&run);
}

/* Sides too close for one image, and sides beside windows, have walls of particles. */
static void narrow_domains_do_not_reflect(void **state) {
  struct run run;
  (void)state;
  char text[1024];
  snprintf(text, sizeof text, WATER, 0.02, "false", 0.02);
  start(&run, text);
  assert_false(run.s.reflects[0][0] || run.s.reflects[0][1]);
  assert_true(run.s.reflects[2][0] && run.s.reflects[2][1]);
  assert_true(run.s.boundary_count > 0);
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_side_is_a_plane_of_symmetry),
      cmocka_unit_test(a_side_carries_the_weight),
      cmocka_unit_test(a_gauge_on_a_side_sees_images),
      cmocka_unit_test(a_gauge_in_soil_sees_images),
      cmocka_unit_test(a_gauge_beside_soil_is_exact),
      cmocka_unit_test(a_gauge_beyond_the_water_reads_nothing),
      cmocka_unit_test(narrow_domains_do_not_reflect),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
