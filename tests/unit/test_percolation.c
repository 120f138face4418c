/* Which pores lead around the box: runs that are joined, against a flood site by site. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "sphsolve/geometry/percolation.h"

#define MOST 1000

/* By its definition: sites of a pore with the turns on the way from its first, until a site is met
 * with other turns. */
static bool flood(const struct lattice *l, const double driving[3], bool corners, size_t seed,
                  uint8_t *label, uint8_t *pore) {
  static size_t queue[MOST];
  static int turns[MOST][3];
  bool flows = false;
  size_t tail = 1;
  queue[0] = seed;
  memset(pore, 0, l->count);
  memset(turns[seed], 0, sizeof turns[seed]);
  label[seed] = pore[seed] = 1;
  for (size_t head = 0; head < tail; head++) {
    const size_t site = queue[head], at[3] = {site % l->size[0], site / l->size[0] % l->size[1],
                                              site / (l->size[0] * l->size[1])};
    for (int s = 0; s < 27; s++) {
      const int move[3] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
      if (!corners && abs(move[0]) + abs(move[1]) + abs(move[2]) != 1) continue;
      int count[3];
      size_t to[3];
      double work = 0.0;
      for (int a = 0; a < 3; a++) {
        const long n = (long)l->size[a], next = (long)at[a] + move[a];
        count[a] = turns[site][a] + (next < 0 ? -1 : next >= n ? 1 : 0);
        to[a] = (size_t)((next + n) % n);
      }
      const size_t next = (to[2] * l->size[1] + to[1]) * l->size[0] + to[0];
      if (l->kind[next] != SITE_FLUID) continue;
      if (!label[next]) {
        label[next] = pore[next] = 1;
        memcpy(turns[next], count, sizeof count);
        queue[tail++] = next;
      }
      for (int a = 0; a < 3; a++)
        work += driving[a] * (count[a] - turns[next][a]) * (double)l->size[a] * l->spacing[a];
      flows = flows || fabs(work) > 1e-9;
    }
  }
  return flows;
}

static void test_runs_against_a_flood(void **state) {
  (void)state;
  static const size_t sizes[][3] = {{7, 6, 5}, {9, 1, 8}, {1, 5, 6}, {2, 2, 2}, {10, 10, 10}};
  static const double drivings[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -1, 0}, {1, 2, .5}};
  uint32_t random = 7;
  size_t flowed = 0, blocked = 0;
  for (int trial = 0; trial < 3000; trial++) {
    uint8_t kind[MOST], label[MOST] = {0}, pore[MOST], wanted[MOST] = {0}, found[MOST] = {0};
    struct lattice l = {.dimensions = 3, .spacing = {1, 1, 1}, .kind = kind, .count = 1};
    memcpy(l.size, sizes[trial % 5], sizeof l.size);
    for (int a = 0; a < 3; a++) l.count *= l.size[a];
    const double *driving = drivings[trial / 5 % 5];
    const bool corners = trial / 25 % 2;
    for (size_t s = 0; s < l.count; s++) {
      random = random * 1664525u + 1013904223u;
      const bool fluid = (random >> 16) % 100 < (unsigned)(trial % 11 * 10);
      kind[s] = fluid ? SITE_FLUID : SITE_WALL;
      l.fluid_count += fluid;
    }
    bool flows = false, any = false, asked;
    for (size_t s = 0; s < l.count; s++)
      if (kind[s] == SITE_FLUID && !label[s] && flood(&l, driving, corners, s, label, pore)) {
        any = true;
        for (size_t i = 0; i < l.count; i++)
          if (pore[i]) wanted[i] = PERCOLATION_FLOWS;
      }
    assert_int_equal(percolation_find(&l, driving, corners, found, &flows), STATUS_OK);
    assert_int_equal(flows, any);
    assert_memory_equal(found, wanted, l.count);
    assert_int_equal(percolation_find(&l, driving, corners, NULL, &asked), STATUS_OK);
    assert_int_equal(asked, any);
    flowed += any, blocked += !any;
  }
  assert_true(flowed > 500 && blocked > 500);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_runs_against_a_flood)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
