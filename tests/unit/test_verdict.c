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

/* The classes of an interval of k, m/s. */
static void classes_are(double low, double high, const char *din, const char *casagrande) {
  const struct run run = {.density = 1000, .viscosity = 1e-3};
  const struct page_model model = {.porosity = NAN, .specific_surface = NAN};
  json_t *results =
      json_pack("[{s:f,s:o,s:o,s:f}]", "k_m_per_s", 0.5 * (low + high), "k_low_m_per_s",
                json_number(low), "k_high_m_per_s", json_number(high), "k_relative_error", 0.1);
  verdict_judge(results, &run, &model);
  const json_t *first = json_array_get(results, 0);
  assert_string_equal(json_string_value(json_object_get(first, "class_din")), din);
  assert_string_equal(json_string_value(json_object_get(first, "class_casagrande")), casagrande);
  json_decref(results);
}

static void test_classes(void **state) {
  (void)state;
  classes_are(2e-4, 3e-4, "strongly permeable", "good drainage");
  classes_are(5e-7, 5e-6, "weakly permeable to permeable", "poor drainage to good drainage");
  classes_are(0, 0, "very weakly permeable", "practically impervious");
  /* What the noise of a run may leave of water at rest. */
  classes_are(-2e-9, -1e-9, "very weakly permeable", "practically impervious");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_classes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
