/* Quantities: every way users write them, and every way they get them wrong. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "common/units.h"

static void parses(const char *text, struct dimension dimension, double expected) {
  double value = NAN;
  assert_int_equal(quantity_parse(text, dimension, &value), STATUS_OK);
  if (!(fabs(value - expected) <= 1e-14 * fabs(expected))) fail_msg("%s gives %g", text, value);
}

static void refuses(const char *text, struct dimension dimension, const char *because) {
  double value = 42;
  assert_int_equal(quantity_parse(text, dimension, &value), STATUS_INPUT);
  if (!strstr(error_message(), because)) fail_msg("%s: \"%s\"", text, error_message());
  assert_true(value == 42);
  error_clear();
}

static void test_right(void **state) {
  (void)state;
  parses("5.83um", DIM_LENGTH, 5.83e-6);
  parses("5.83 \xc2\xb5m", DIM_LENGTH, 5.83e-6);
  parses(" 1 cm ", DIM_LENGTH, 0.01);
  parses("1e-3 Pa s", DIM_VISCOSITY, 1e-3);
  parses("1 mPa s", DIM_VISCOSITY, 1e-3);
  parses("1e-3 Pa*s", DIM_VISCOSITY, 1e-3);
  parses("1 cP", DIM_VISCOSITY, 1e-3);
  parses("3.35 1/m", (struct dimension){-1, 0, 0}, 3.35);
  parses("0.0335 1/cm", (struct dimension){-1, 0, 0}, 3.35);
  parses("3.35/m", (struct dimension){-1, 0, 0}, 3.35);
  parses("1e-3 kg/m/s", DIM_VISCOSITY, 1e-3);
  parses("-9.8 m/s^2", DIM_ACCELERATION, -9.8);
  parses("9.8 m s^-2", DIM_ACCELERATION, 9.8);
  parses("9.8 m/s2", DIM_ACCELERATION, 9.8);
  parses("9.8 m/s\xc2\xb2", DIM_ACCELERATION, 9.8);
  parses("1000 kg/m\xc2\xb3", DIM_DENSITY, 1000);
  parses("1e-3 kg/(m s)", DIM_VISCOSITY, 1e-3);
  parses("1e-3 kg/(m\xc2\xb7s)", DIM_VISCOSITY, 1e-3);
  parses("2 (Pa/m)", DIM_PRESSURE_GRADIENT, 2);
  parses("2 m/(s/Hz)", DIM_ACCELERATION, 2);
  parses("1 G", DIM_ACCELERATION, 9.80665);
  parses("1000 kg/m^3", DIM_DENSITY, 1000);
  parses("1 g/cm^3", DIM_DENSITY, 1000);
  parses("10 min", DIM_TIME, 600);
  parses("2 kPa", DIM_PRESSURE, 2000);
  parses("9807 Pa/m", DIM_PRESSURE_GRADIENT, 9807);
  parses("0.725", DIM_NONE, 0.725);
  parses("5 %", DIM_NONE, 0.05);
  parses("0", DIM_ACCELERATION, 0);
}

static void test_wrong(void **state) {
  (void)state;
  refuses("5.83", DIM_LENGTH, "no unit");
  refuses("5.83 s", DIM_LENGTH, "is in s");
  refuses("5.83 furlong", DIM_LENGTH, "unknown unit 'furlong'");
  refuses("wide", DIM_LENGTH, "no number");
  refuses("", DIM_LENGTH, "no number");
  refuses("nan m", DIM_LENGTH, "no number");
  refuses("inf", DIM_NONE, "no number");
  refuses("1e999 m", DIM_LENGTH, "not finite");
  refuses("1 m/", DIM_LENGTH, "unknown unit");
  refuses("1 kg/(m s", DIM_VISCOSITY, "unknown unit '('");
  refuses("1 kg/m)", DIM_LENGTH, "unknown unit ')'");
  refuses("1 kg/(m/)", DIM_LENGTH, "unknown unit");
  refuses("1 m\xc2\xb2\xc2\xb3", DIM_LENGTH, "unknown unit");
  refuses("1 m^99", DIM_LENGTH, "unknown unit");
  refuses("1 m", DIM_NONE, "is in m");
  refuses("0 s", DIM_LENGTH, "is in s");
}

static void test_format(void **state) {
  (void)state;
  char text[64];
  quantity_format(4.664e-5, "m", text, sizeof text);
  assert_string_equal(text, "46.64 um");
  quantity_format(2.5e-5, "s", text, sizeof text);
  assert_string_equal(text, "25 us");
  quantity_format(0, "m", text, sizeof text);
  assert_string_equal(text, "0 m");
  dimension_format(DIM_ACCELERATION, text, sizeof text);
  assert_string_equal(text, "m/s^2");
  dimension_format(DIM_NONE, text, sizeof text);
  assert_string_equal(text, "a plain number");
  char share[32];
  assert_string_equal(percent_format(0.01234, share), "1.2");
  assert_string_equal(percent_format(0.994, share), "99");
  assert_string_equal(percent_format(0.9996, share), "100");
  assert_string_equal(percent_format(3.62, share), "362");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_right), cmocka_unit_test(test_wrong),
                                     cmocka_unit_test(test_format)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
