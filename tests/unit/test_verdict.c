/* What the head of the report says a k is good for. */
#include "analyze/report/page_verdict.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "common/json_number.h"

/* What is to be done for 5 % of a k whose lattice was of 12 um, by the parts of its error. */
static void advice_is(double voxel, const char *needs, double resolution, double threshold,
                      double void_ratio, const char *advice) {
  const struct run run = {.density = 1000, .viscosity = 1e-3, .path = "run.hdf"};
  json_t *results = json_pack("[{s:f,s:f,s:f,s:f,s:f,s:s,s:{s:s,s:f,s:o,s:o}}]", "k_m_per_s", 1e-4,
                              "k_low_m_per_s", 9e-5, "k_high_m_per_s", 1.1e-4, "k_relative_error",
                              0.1, "spacing_m", 12e-6, "path", "run.hdf", "error_budget",
                              "resolution_needs", needs, "resolution", resolution, "threshold",
                              json_number(threshold), "void_ratio", json_number(void_ratio));
  assert_non_null(results);
  verdict_judge(results, &run, voxel);
  assert_string_equal(json_string_value(json_object_get(json_array_get(results, 0), "advice")),
                      advice);
  json_decref(results);
}

static void test_advice(void **state) {
  (void)state;
  /* The lattice could bring it just below what is wanted, and by no lattice that can be paid. */
  advice_is(3e-6, "lattice", 0.03, 0.049, NAN,
            "For 5 %: measure the void ratio; a finer lattice alone takes it only just below, to "
            "4.9 % at best, where the threshold binds.");
  advice_is(3e-6, "lattice", 0.1, NAN, 0,
            "For 5 %: refine the lattice from 12 to about 8.5 um, some 2.8 times as many points.");
  /* The last lattice of a model is as fine as the scan. */
  advice_is(9e-6, "lattice", 0.1, NAN, 0,
            "For 5 %: a scan with voxels of about 8.5 um; its own are 9 um, the lattice's 12.");
  advice_is(9e-6, "model", 0.1, NAN, 0,
            "For 5 %: a scan with voxels of about 8.5 um; its own are 9 um, the model's 12.");
  advice_is(9e-6, "lattice", 0.01, 0.1, NAN,
            "For 5 %: measure the void ratio (10 % by the threshold alone).");
  advice_is(9e-6, "lattice", 0.01, 0.1, 0,
            "For 5 %: measure the void ratio more precisely (10 % by the threshold alone).");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_advice)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
