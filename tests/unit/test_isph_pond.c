/* Ponds on soil: one that seeps away, by the solution of Green and Ampt, and a thin one that stays.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/unit/isph_scene.h"

#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"

/* What Green and Ampt (1911) have of a pond of depth H in dry soil after time t: with L the depth
 * of the front, h what still stands on the soil, eps dL/dt = k (L + h)/L,   h + eps L = H, so that
 * k t/eps = L/(1-eps) - H/(1-eps)^2 ln(1 + (1-eps) L/H). `deep`: L is no more than that. */
static double of_green_and_ampt(double eps, double k, double pond, double deep, double time) {
  double low = 0, high = deep;
  for (int n = 0; n < 60; n++) {
    const double l = .5 * (low + high), x = (1 - eps) * l / pond;
    const double t = pond / pow(1 - eps, 2) * (x - log(1 + x)) * eps / k;
    if (t < time)
      low = l;
    else
      high = l;
  }
  return eps * low / pond;
}

/* A pond on dry soil. Water that had crowded in the edge of the soil, which drag lets spread no
 * faster than the scene's tau, stood there 1.75 times as dense, under no pressure, and .42 of it
 * was in the soil where .37 are. Then its last rows crowded, 1.35 times after a minute: as the
 * kinetic energy, which water that seeps hardly has, was all that friction was thought to take. */
static void a_pond_seeps_away_as_it_should(void **state) {
  (void)state;
  struct run run;
  const char *limit;
  double most = 0;
  const double eps = .34, k = 9.81 / (1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * 6.4e-7));
  start(&run,
        "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
        "domain = { size = [\"32 cm\", \"48 cm\"]; spacing = \"4 cm\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"32 cm\", \"24 cm\"]; porosity "
        "= 0.34; grain_size = \"0.8 mm\"; },\n"
        "{ type = \"water\"; box = [\"0\", \"24 cm\", \"16 cm\", \"48 cm\"]; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  for (int part = 0; part < 2; part++) {
    double inside = 0, all = 0;
    while (run.s.time < (part == 0 ? 29 : 59)) {
      assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
      for (size_t i = 0; i < run.s.count && run.s.time > 5; i++)
        most = fmax(most, run.s.kernel_sum[i]);
    }
    for (size_t i = 0; i < run.s.count; i++) {
      all += run.s.mass[i];
      const double below = (.24 - run.s.position[i][2]) / run.s.size[i];
      inside += run.s.mass[i] * fmax(0, fmin(1, .5 + below));
    }
    const double exact = of_green_and_ampt(eps, k, .12, .24, run.s.time);
    print_message("%.3f in the soil, exact %.3f; largest kernel sum %.3g\n", inside / all, exact,
                  most);
    if (part == 0) assert_true(fabs(inside / all - exact) < .02);
    assert_true(most < 1.3);
  }
  finish(&run);
}

/* What shifting gives three ragged rows of water let go on fine soil, from 5 s on, of the energy of
 * their fall. The particles start off their places by 1e-6 of a spacing, differently for each draw.
 */
static double given_by_shifting(uint32_t draw) {
  struct run run;
  const char *limit;
  const double spacing = 0.0168874930755, fall = 1000 * 80 * pow(spacing, 3) * 9.81 * 4 * spacing;
  double landed = NAN;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
        "domain = { size = [\"0.405299833812 m\", \"0.33774986151 m\"]; spacing = "
        "\"0.0168874930755 m\"; periodic = [false, false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.405299833812 m\", "
        "\"0.101324958453 m\"]; porosity = 0.222; grain_size = \"54.2 um\"; saturated = true; },\n"
        "{ type = \"water\"; box = [\"0\", \"0.101324958453 m\", \"0.135099944604 m\", "
        "\"0.270199889208 m\"]; } );\n"
        "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n");
  draw_places(&run, draw);
  while (run.s.time < 30) {
    assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
    if (isnan(landed) && run.s.time > 5) landed = run.s.budget.sums.work[BUDGET_SHIFTING];
  }
  const double given = run.s.budget.sums.work[BUDGET_SHIFTING] - landed;
  finish(&run);
  return given / fall;
}

/* It kept ragged rows astir where they were shifted up, by .30 in every draw. Now and then a draw
 * has rows that stir: of 84 eighteen, by .1 to .45. So it is not one that decides but more than
 * half of sixteen, which that share exceeds once in a hundred times, and no more are drawn than
 * decide. */
static void shifting_does_not_lift_thin_water(void **state) {
  (void)state;
  enum { DRAWS = 16 };
  int stirred = 0, still = 0;
  for (uint32_t draw = 0; 2 * stirred < DRAWS && 2 * still <= DRAWS; draw++) {
    const double given = given_by_shifting(draw);
    print_message("shifting gives %.3g of the fall\n", given);
    given < .1 ? still++ : stirred++;
  }
  assert_true(2 * stirred < DRAWS);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_pond_seeps_away_as_it_should),
                                     cmocka_unit_test(shifting_does_not_lift_thin_water)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
