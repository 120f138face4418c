/* Walls drawn through labels: flat at any angle, round where labels are, and on the right side of
 * the voxels that a smoother surface would leave out. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "ct2model/scan/label_walls.h"

enum { NX = 60, NY = 12, NZ = 60, COUNT = NX * NY * NZ };
static uint8_t grain[COUNT], walls[COUNT];
static const size_t size[3] = {NX, NY, NZ};
static const bool plain[3] = {false, false, false};

static double grey(size_t x, size_t y, size_t z) {
  return (double)walls[(z * NY + y) * NX + x] / LABEL_GREY - 0.5;
}

/* Deviation of the surface from its mean plane, voxels: of the places where it crosses lines along
 * x, about (p x + q z) / hypot(p, q) modulo the slit's period. */
static double ripple(size_t p, size_t q) {
  const double length = hypot((double)p, (double)q);
  double sum = 0.0, square = 0.0, n = 0.0;
  for (size_t z = 0; z < NZ; z++)
    for (size_t x = 0; x < NX; x++) {
      const double here = grey(x, 0, z), next = grey((x + 1) % NX, 0, z);
      if (here > 0.0 || next <= 0.0) continue; /* from pore to grain alone: one wall */
      const double at = (double)p * ((double)x + here / (here - next)) + (double)(q * z);
      const double off = (at - (double)NX * floor(at / NX) - 0.5 * NX) / length;
      sum += off, square += off * off, n += 1.0;
    }
  return sqrt(fmax(0.0, square / n - sum * sum / n / n));
}

static void test_turned_slits_are_flat(void **state) {
  (void)state;
  const size_t turns[5][2] = {{1, 0}, {1, 1}, {2, 1}, {3, 1}, {4, 1}};
  for (int t = 0; t < 5; t++) {
    const size_t p = turns[t][0], q = turns[t][1];
    for (size_t i = 0; i < COUNT; i++)
      grain[i] = (p * (i % NX) + q * (i / (NX * NY))) % NX >= NX / 2;
    assert_int_equal(label_walls(grain, size, plain, walls), STATUS_OK);
    const double off = ripple(p, q);
    print_message("slit at %zu : %zu, walls rough by %.3f voxels\n", p, q, off);
    assert_true(off < 0.05);
  }
}

/* A slit and a sheet of one voxel, a corner: no voxel goes to the other side. */
static void test_narrow_pores_stay_open(void **state) {
  (void)state;
  for (size_t i = 0; i < COUNT; i++) {
    const size_t x = i % NX, z = i / (NX * NY);
    grain[i] = x != 10 && (x < 30 || x >= 50 || z < 20) && x != 55;
    if (x == 40 && z >= 20) grain[i] = 1;
  }
  assert_int_equal(label_walls(grain, size, plain, walls), STATUS_OK);
  for (size_t i = 0; i < COUNT; i++) assert_true((walls[i] > 0.5 * LABEL_GREY) == (grain[i] == 1));
}

/* Mirrored about the first face and the last centre: as the voxels mirrored so. */
static void test_mirrored_ends(void **state) {
  (void)state;
  const size_t half[3] = {NX, NY, NZ / 2};
  static uint8_t part[COUNT];
  const bool ends[3] = {false, false, true};
  for (size_t i = 0; i < COUNT / 2; i++)
    part[i] = hypot((double)(i % NX) - 30.2, 0.7 * (double)(i / (NX * NY)) - 4.0) < 9.6;
  assert_int_equal(label_walls(part, half, ends, walls), STATUS_OK);
  const uint8_t first = walls[30], last = walls[(NZ / 2 - 1) * NX * NY + 30];
  /* The period is NZ - 1: one layer, the last, occurs once. */
  const size_t whole[3] = {NX, NY, NZ - 1};
  for (size_t z = 0; z + 1 < NZ; z++)
    for (size_t i = 0; i < NX * NY; i++)
      grain[z * NX * NY + i] = part[(z < NZ / 2 ? z : NZ - 2 - z) * NX * NY + i];
  assert_int_equal(label_walls(grain, whole, plain, walls), STATUS_OK);
  assert_int_equal(walls[30], first);
  assert_int_equal(walls[(NZ / 2 - 1) * NX * NY + 30], last);
}

/* What bubbles in rows leave: struts that end in edges, of a few voxels. At five places on the
 * voxels the surface leaves as much of them as the labels do. */
static void test_struts_keep_their_volume(void **state) {
  (void)state;
  enum { CELL = 18, PLACES = 5 };
  const size_t cube[3] = {CELL, CELL, CELL}, count = (size_t)CELL * CELL * CELL;
  const double radius = 11.5;
  double drawn = 0.0, labels = 0.0;
  for (int place = 0; place < PLACES; place++) {
    for (size_t i = 0; i < count; i++) {
      const double x = (double)(i % CELL) - 8.5 + 0.11 * place;
      const double y = (double)(i / CELL % CELL) - 8.4 + 0.07 * place;
      const double z = (double)(i / ((size_t)CELL * CELL)) - 8.3 - 0.03 * place;
      grain[i] = hypot(hypot(x, y), z) > radius;
      labels += (double)grain[i];
    }
    assert_int_equal(label_walls(grain, cube, plain, walls), STATUS_OK);
    for (size_t i = 0; i < count; i++) /* greys are 3 voxels deep */
      drawn += fmin(fmax(0.5 + 3.0 * ((double)walls[i] / LABEL_GREY - 0.5), 0.0), 1.0);
  }
  print_message("struts: %.0f voxels, %.0f of the labels\n", drawn / PLACES, labels / PLACES);
  assert_true(fabs(drawn / labels - 1.0) < 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_turned_slits_are_flat),
      cmocka_unit_test(test_narrow_pores_stay_open),
      cmocka_unit_test(test_mirrored_ends),
      cmocka_unit_test(test_struts_keep_their_volume),
  };
  return cmocka_run_group_tests_name("label_walls", tests, NULL, NULL);
}
