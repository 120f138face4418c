/* The first lattice of an open cascade: few sites across a mean pore, or across grains that are
 * thinner than the pores between them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sphsolve/stokes/cascade/cascade_levels.h"

/* In spacings, for pores and grains of so many, in a body of 1000. */
static double first_of(double width, double grain) {
  const struct lattice base = {
      .dimensions = 3, .size = {1000, 1000, 1000}, .spacing = {1.0, 1.0, 1.0}};
  const struct plan plan = {.context = {.spacing = 1.0, .lattice = &base},
                            .shape = {.width = width, .grain = grain}};
  return cascade_first_spacing(&plan, &base);
}

/* A void ratio is that of 4 V / S of the pores to twice 2 V / S of the grains. */
static double first_spacing(double void_ratio, double grain) {
  return first_of(2.0 * void_ratio * grain, grain);
}

static void test_pores_of_sands_count(void **state) {
  (void)state;
  for (double e = 0.4; e < 0.999; e += 0.1)
    assert_true(fabs(first_spacing(e, 20.0) / (2.0 * e * 20.0 / 1.6) - 1.0) < 1e-12);
}

static void test_fibres_of_felts_count(void **state) {
  (void)state;
  assert_true(fabs(first_spacing(1.0001, 20.0) / first_spacing(0.9999, 20.0) - 1.0) < 1e-3);
  for (double e = 2.0; e < 500.0; e *= 3.0)
    assert_true(fabs(first_spacing(e, 20.0) / (20.0 / 1.6) - 1.0) < 1e-12);
}

static void test_bodies_without_grains(void **state) {
  (void)state;
  assert_true(first_of(8.0, INFINITY) == 5.0);      /* between boxes */
  assert_true(first_of(INFINITY, INFINITY) == 1.0); /* no walls at all */
}

/* Of few pores along its shortest axis, but for one along which nothing changes, a body needs a
 * lattice more; of a mirrored one half is its own. */
static void test_few_pores_need_one_lattice_more(void **state) {
  (void)state;
  enum { NX = 32, NY = 24, NZ = 8 };
  static float distance[NX * NY * NZ];
  for (size_t i = 0; i < NX * NY * NZ; i++)
    distance[i] = (float)sin(0.4 * (double)(i % NX) + 0.3 * (double)(i / NX % NY));
  struct lattice base = {.dimensions = 3,
                         .size = {NX, NY, NZ},
                         .spacing = {1.0, 1.0, 1.0},
                         .count = NX * NY * NZ,
                         .wall_distance = distance};
  struct plan plan = {.context = {.spacing = 1.0, .lattice = &base},
                      .shape = {.width = 2.0, .grain = INFINITY}};
  assert_true(cascade_pores_across(&plan, &base) == NY / 2.0);
  assert_int_equal(cascade_lattices_needed(cascade_pores_across(&plan, &base)), 4);
  base.model.sides_mirrored = true;
  assert_int_equal(cascade_lattices_needed(cascade_pores_across(&plan, &base)), 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pores_of_sands_count),
                                     cmocka_unit_test(test_fibres_of_felts_count),
                                     cmocka_unit_test(test_bodies_without_grains),
                                     cmocka_unit_test(test_few_pores_need_one_lattice_more)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
