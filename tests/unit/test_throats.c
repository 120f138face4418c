/* Throats that coarser sites close and open. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdlib.h>

#include "sphsolve/geometry/throats.h"

/* A periodic lattice of one layer from rows of text, '.' pore and '#' grain; x to the right. */
static struct lattice of_rows(const char *const *rows, size_t nx, size_t nz, double spacing) {
  struct lattice l = {.dimensions = 2, .size = {nx, 1, nz}, .count = nx * nz};
  for (int a = 0; a < 3; a++) l.spacing[a] = spacing, l.origin[a] = 0.5 * spacing;
  l.spacing[1] = 1.0, l.origin[1] = 0.5;
  l.kind = malloc(l.count);
  assert_non_null(l.kind);
  for (size_t s = 0; s < l.count; s++) {
    l.kind[s] = rows[s / nx][s % nx] == '.' ? SITE_FLUID : SITE_WALL;
    l.fluid_count += l.kind[s] == SITE_FLUID;
  }
  return l;
}

/* Two chambers joined by a throat, and two parted by a thin wall. */
static const char *const FINE[] = {"################", "#....##....#...#", "#..........#...#",
                                   "#....##....#...#", "#....##....#...#", "################",
                                   "################", "################"};

static void compare(const char *const *rows, size_t closed, size_t opened) {
  struct lattice fine = of_rows(FINE, 16, 8, 1.0), coarse = of_rows(rows, 8, 4, 2.0);
  struct throats throats;
  assert_int_equal(throats_compare(&fine, &coarse, &throats), STATUS_OK);
  assert_int_equal(throats.closed, closed);
  assert_int_equal(throats.opened, opened);
  free(fine.kind);
  free(coarse.kind);
}

static void test_counts(void **state) {
  (void)state;
  static const char *const JOINED[] = {"########", ".....#..", ".....#..", "########"};
  compare(JOINED, 0, 1); /* round the periodic box */
  static const char *const CUT[] = {"########", "#.#..#.#", "#.#..#.#", "########"};
  compare(CUT, 1, 0);
  static const char *const KEPT[] = {"########", "#....#.#", "#....#.#", "########"};
  compare(KEPT, 0, 0);
  static const char *const BOTH[] = {"########", "#.#....#", "#.#....#", "########"};
  compare(BOTH, 1, 1);
  static const char *const SPLINTER[] = {"########", "#....#.#", "#...##.#", "########"};
  compare(SPLINTER, 0, 0);
}

static void test_same_sites_change_nothing(void **state) {
  (void)state;
  struct lattice fine = of_rows(FINE, 16, 8, 1.0);
  struct throats throats;
  assert_int_equal(throats_compare(&fine, &fine, &throats), STATUS_OK);
  assert_int_equal(throats.closed + throats.opened, 0);
  free(fine.kind);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_counts),
                                     cmocka_unit_test(test_same_sites_change_nothing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
