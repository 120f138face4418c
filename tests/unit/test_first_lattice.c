/* The first lattice of an open cascade: few sites across a mean pore, or across grains that are
 * thinner than the pores between them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/hdf5_file.h"
#include "sphsolve/error/cascade_add.h"
#include "sphsolve/error/cascade_levels.h"
#include "sphsolve/error/cascade_next.h"
#include "sphsolve/error/error_forecast.h"

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

/* What a checkpoint keeps of a cascade comes back, and with it the error of k. */
static void test_checkpoint_keeps_all(void **state) {
  (void)state;
  char path[] = "/tmp/test_cascade_XXXXXX";
  struct h5_file *file = NULL;
  const struct lattice base = {.dimensions = 3, .size = {9, 9, 9}, .spacing = {1.0, 1.0, 1.0}};
  const struct scene scene = {.lattice_spacing = NAN};
  const struct plan plan = {.context = {.spacing = 1.0, .lattice = &base, .scene = &scene},
                            .shape = {.width = 2.0, .grain = INFINITY}};
  struct cascade kept = {.plan = &plan, .base = &base, .fixed = 1, .tried = 2, .model_parts = true};
  kept.sides = 0.01, kept.mirrored = 0.97;
  struct uncertainty *u = &kept.uncertainty;
  *u = uncertainty_none();
  u->slope_void_ratio = 2.1, u->void_ratio = 0.02, u->threshold = 0.03, u->model = 0.04;
  u->slope_threshold = 0.05, u->slope_blur = 0.06, u->scan = 0.07, u->sides_closed = 0.08;
  u->blur_assumed = 0.09, u->sides_unknown = 0.11;
  for (int i = 0; i < 2; i++)
    u->levels[u->level_count++] = (struct error_level){.spacing = 2.0 - i,
                                                       .permeability = 1.1 - 0.1 * i,
                                                       .sites = 100.0 + i,
                                                       .seconds = 0.5 + i,
                                                       .iterations = 7 + i,
                                                       .slope_blur = 0.01 + 0.1 * i,
                                                       .critical = 0.25 - 0.125 * i};
  cascade_estimate(&kept);
  struct cascade found = {.plan = &plan, .base = &base, .fixed = 1};
  found.uncertainty = uncertainty_none();
  close(mkstemp(path));
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_make_group(file, "/state"), STATUS_OK);
  assert_int_equal(cascade_write(&kept, false, file), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(cascade_read(&found, file), STATUS_OK);
  h5_close(file);
  unlink(path);
  assert_int_equal(found.tried, kept.tried);
  assert_true(found.model_parts && found.sides == kept.sides && found.mirrored == kept.mirrored);
  assert_true(u->critical_width == 0.125 && u->resolution > 0.125);
  const double *a = found.uncertainty.parts.value, *b = u->parts.value;
  for (int i = 0; i < UNCERTAINTY_PARTS; i++)
    assert_true(a[i] == b[i] || (isnan(a[i]) && isnan(b[i])));
  assert_true(found.uncertainty.model == u->model && found.uncertainty.slope_blur == u->slope_blur);
  assert_true(found.uncertainty.critical_width == u->critical_width);
  for (int i = 0; i < 2; i++) {
    const struct error_level *l = &found.uncertainty.levels[i], *of = &u->levels[i];
    assert_true(l->spacing == of->spacing && l->permeability == of->permeability);
    assert_true(l->sites == of->sites && l->seconds == of->seconds);
    assert_true(l->iterations == of->iterations && l->slope_blur == of->slope_blur);
    assert_true(l->critical == of->critical);
  }
}

/* What no lattice lessens of the error foretold; without a scanner that of the threshold alone. */
static void test_rest_has_scan_and_threshold(void **state) {
  (void)state;
  struct plan plan = {.expected_scan = 0.04, .expected_threshold = 0.03};
  assert_true(fabs(error_expected_rest(&plan) - 0.05) < 1e-15);
  plan.expected_scan = NAN;
  assert_true(error_expected_rest(&plan) == 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pores_of_sands_count),
                                     cmocka_unit_test(test_fibres_of_felts_count),
                                     cmocka_unit_test(test_bodies_without_grains),
                                     cmocka_unit_test(test_few_pores_need_one_lattice_more),
                                     cmocka_unit_test(test_checkpoint_keeps_all),
                                     cmocka_unit_test(test_rest_has_scan_and_threshold)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
