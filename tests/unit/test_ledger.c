/* The account of momentum and energy, where the balance is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "sphsolve/isph/isph_account.h"
#include "tests/unit/isph_scene.h"

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    print_message("%g is not %g +- %g\n", value, expected, tolerance);
  assert_true(fabs(value - expected) <= tolerance);
}

/* Energy is an identity, particle by particle: sums of N numbers round to N 2^-53 of the largest.
 */
static void assert_energy_closes(struct run *run) {
  double open;
  isph_account_end(&run->s);
  assert_true(ledger_energy_open(&run->s.account, &open) < 1e-11);
}

static double impulse(const struct run *run, enum ledger_term term, int axis) {
  return run->s.account.sums.impulse[term][axis];
}

#define GRAVITY "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
#define TANK                                                                                       \
  "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"                                          \
  "domain = { size = [\"0.2 m\", \"0.3 m\"]; spacing = \"1 cm\"; };\n" GRAVITY

/* The floor carries the weight; the sides push as hard from left as from right. The pressure is
 * known to half a spacing of depth, of twenty. */
static void floor_carries_the_weight(void **state) {
  (void)state;
  struct run run;
  start(&run,
        TANK "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.2 m\"]; } );");
  advance(&run, 0.1);
  const double weight = 1000 * 0.2 * 0.2 * 0.01 * 9.81 * 0.1;
  assert_near(impulse(&run, LEDGER_FORCE, 2), -weight, 1e-9 * weight);
  assert_near(impulse(&run, LEDGER_WALL_PRESSURE, 2), weight, 0.025 * weight);
  assert_near(impulse(&run, LEDGER_WALL_PRESSURE, 0), 0, 1e-6 * weight);
  assert_energy_closes(&run);
  finish(&run);
}

/* A drop in free fall has momentum M g t to rounding. Each of n steps dt moves it by the velocity
 * at its end, so that it falls g t (t + dt)/2: the time steps take m g^2 t dt/2. */
static void a_falling_drop_keeps_its_energy(void **state) {
  (void)state;
  struct run run;
  double open[3];
  start(&run, TANK "regions = ( { type = \"water\"; box = [\"0.1 m\", \"0.26 m\", \"0.11 m\", "
                   "\"0.27 m\"]; } );");
  for (int k = 0; k < 100; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  const double m = 1000 * 0.01 * 0.01 * 0.01, g = 9.81, t = 0.1, dt = 1e-3;
  const struct ledger_account *account = &run.s.account;
  assert_energy_closes(&run);
  assert_true(ledger_momentum_open(account, open) < 1e-11);
  assert_near(account->momentum[1][2], -m * g * t, 1e-9 * m * g * t);
  assert_near(account->energy[1], 0.5 * m * g * g * t * t, 1e-9 * m);
  assert_near(account->sums.work[LEDGER_FORCE], 0.5 * m * g * g * t * (t + dt), 1e-9 * m);
  assert_near(account->sums.work[LEDGER_TIME_STEP], -0.5 * m * g * g * t * dt, 1e-9 * m);
  assert_near(account->sums.work[LEDGER_PROJECTION], 0, 1e-9 * m);
  finish(&run);
}

/* Seepage round a periodic box of soil: the drag carries the head, and heats by what it gives. */
static void drag_carries_the_head(void **state) {
  (void)state;
  struct run run;
  double open[3];
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"4 cm\", \"4 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"4 cm\", \"4 cm\"]; porosity = "
        "0.3; grain_size = \"1 mm\"; alpha = 1000.0; beta = 1.1; } );\n" GRAVITY
        "isph = { dt = \"1 ms\"; };\n");
  for (int k = 0; k < 200; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  const struct ledger_account *account = &run.s.account;
  assert_energy_closes(&run);
  assert_true(ledger_momentum_open(account, open) < run.scene.isph.tolerance);
  /* Steady within a millisecond: in 200 all but a hundredth goes into drag. */
  assert_near(impulse(&run, LEDGER_DRAG_LINEAR, 2) + impulse(&run, LEDGER_DRAG_FORCHHEIMER, 2),
              -impulse(&run, LEDGER_FORCE, 2), 0.01 * -impulse(&run, LEDGER_FORCE, 2));
  assert_near(account->sums.work[LEDGER_DRAG_LINEAR] + account->sums.work[LEDGER_DRAG_FORCHHEIMER],
              -account->sums.work[LEDGER_FORCE], 0.01 * account->sums.work[LEDGER_FORCE]);
  finish(&run);
}

/* Water that falls into soil in a tank, a piston, moving soil, open sides, eddies: whatever a step
 * does is in the account. */
static void energy_closes_with_everything(void **state) {
  (void)state;
  static const char *const scenes[] = {
      TANK
      "regions = ( { type = \"porous\"; box = [\"0.1 m\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity "
      "= 0.4; grain_size = \"1 cm\"; }, { type = \"water\"; box = [\"0\", \"0\", \"0.1 m\", "
      "\"0.2 m\"]; } );",
      TANK
      "regions = ( { type = \"water\"; box = [\"0.03 m\", \"0\", \"0.2 m\", \"0.1 m\"]; }, { type "
      "= \"wall\"; box = [\"0\", \"0\", \"0.03 m\", \"0.1 m\"]; velocity = [\"0.1 m/s\", \"0\"]; "
      "} );",
      "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
      "domain = { size = [\"0.3 m\", \"0.05 m\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.3 m\", \"0.05 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.05 m\"]; porosity = 0.4; "
      "grain_size = \"2 mm\"; velocity = [\"0.1 m/s\", \"0\"]; } );\n"
      "force = { gravity = [\"0\", \"0\"]; };\n",
      TANK
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.3 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0.05 m\", \"0\", \"0.15 m\", \"0.3 m\"]; porosity = 0.4; "
      "grain_size = \"5 mm\"; },\n"
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.3 m\"]; head = \"0.5 m\"; },\n"
      "{ type = \"inflow\"; box = [\"0.19 m\", \"0\", \"0.2 m\", \"0.3 m\"]; head = \"0.4 m\"; } "
      ");"};
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
    struct run run;
    start(&run, scenes[k]);
    advance(&run, 0.2);
    assert_energy_closes(&run);
    finish(&run);
  }
}

static void threads_keep_one_account(void **state) {
  (void)state;
#ifdef _OPENMP
  struct run run[2];
  int before = omp_get_max_threads();
  for (int k = 0; k < 2; k++) {
    omp_set_num_threads(1 + 2 * k);
    start(&run[k],
          TANK "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.1 m\", \"0.2 m\"]; "
               "} );");
    advance(&run[k], 0.1);
    isph_account_end(&run[k].s);
  }
  omp_set_num_threads(before);
  assert_memory_equal(&run[0].s.account, &run[1].s.account, sizeof run[0].s.account);
  for (int k = 0; k < 2; k++) finish(&run[k]);
#endif
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(floor_carries_the_weight), cmocka_unit_test(a_falling_drop_keeps_its_energy),
      cmocka_unit_test(drag_carries_the_head),    cmocka_unit_test(energy_closes_with_everything),
      cmocka_unit_test(threads_keep_one_account),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
