/* The error of a volume by its labels against bodies of known volume put down anew many times: the
 * deviation over the error stated has a square of about one. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "ct2model/scan/label_volume.h"

enum { SIDE = 24, MOST = SIDE * SIDE * SIDE, DRAWS = 200 };
static uint8_t grain[MOST];
static const bool periodic[3] = {false, false, false};

static double chance(void) {
  static uint64_t state = 8301;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 11) / 9007199254740992.0;
}

static double error_of(const size_t size[3]) {
  double error = 0.0;
  assert_int_equal(label_volume_error(grain, size, periodic, &error), STATUS_OK);
  return error;
}

/* Draws ellipsoids of half axes 4 to 10, those beyond the first `bent` axes endless, and gives the
 * root mean square of (share - true share) / error. Middle: in the middle of the cell. */
static double deviations(int bent, bool middle) {
  const size_t size[3] = {SIDE, SIDE, SIDE};
  double sum = 0.0;
  for (int draw = 0; draw < DRAWS; draw++) {
    double half[3], centre[3], share = bent == 3 ? 4.0 / 3.0 * M_PI : M_PI;
    for (int a = 0; a < 3; a++) {
      half[a] = 4.0 + 6.0 * chance();
      centre[a] = 0.5 * SIDE + (middle ? 0.0 : chance());
      if (a < bent) share *= half[a] / SIDE;
    }
    double seen = 0.0;
    for (size_t i = 0; i < MOST; i++) {
      const size_t place[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
      double square = 0.0;
      for (int a = 0; a < bent; a++)
        square += pow(((double)place[a] + 0.5 - centre[a]) / half[a], 2.0);
      grain[i] = square < 1.0;
      seen += grain[i];
    }
    sum += pow((seen / MOST - share) / error_of(size), 2.0);
  }
  return sqrt(sum / DRAWS);
}

static void test_errors_are_those_of_bodies_put_down_by_chance(void **state) {
  (void)state;
  for (int bent = 2; bent <= 3; bent++)
    for (int middle = 0; middle < 2; middle++) {
      const double off = deviations(bent, middle);
      print_message("%d axes bent, %s: %.2f\n", bent, middle ? "in the middle" : "anywhere", off);
      assert_true(off > 0.7 && off < 1.4);
    }
}

/* Twice as many grains: the share's error falls with the root of their number; a body that is as
 * long again along its axis says nothing new; a layer is as wide as drawn. */
static void test_what_says_something_new(void **state) {
  (void)state;
  const size_t one[3] = {12, 12, 12}, longer[3] = {12, 12, 24}, layers[3] = {12, 12, 12};
  for (int i = 0; i < 12 * 12 * 24; i++) grain[i] = hypot(i % 12 - 5.3, i / 12 % 12 - 5.8) < 4.1;
  const double once = error_of(one);
  assert_true(once > 0.008 && once < 0.012);
  assert_true(fabs(error_of(longer) / once - 1.0) < 1e-12);
  /* Balls of other places and sizes along z. */
  double alone = 0.0;
  for (int balls = 1; balls <= 2; balls++) {
    const size_t size[3] = {12, 12, 12 * (size_t)balls};
    for (int i = 0; i < 12 * 12 * 12 * balls; i++) {
      const double x = i % 12 - 5.3, y = i / 12 % 12 - 5.8, z = i / 144 % 12 - 5.4;
      grain[i] = sqrt(x * x + y * y + z * z) < (i < 12 * 144 ? 4.1 : 4.4);
    }
    const double error = error_of(size);
    if (balls == 1)
      alone = error;
    else
      assert_true(fabs(error / alone * sqrt(2.0) - 1.0) < 0.15);
  }
  for (int i = 0; i < 12 * 12 * 12; i++) grain[i] = i % 12 < 5;
  assert_true(error_of(layers) == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_errors_are_those_of_bodies_put_down_by_chance),
      cmocka_unit_test(test_what_says_something_new),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
