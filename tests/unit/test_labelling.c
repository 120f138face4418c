/* Connected parts against a flood fill, and percolation in periodic boxes. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "ct2model/model/connect.h"
#include "ct2model/surface/specks.h"

enum { NX = 17, NY = 13, NZ = 11, SITES = NX * NY * NZ };

static size_t neighbour(size_t site, int axis, int step, const bool periodic[3]) {
  const size_t size[3] = {NX, NY, NZ};
  size_t at[3] = {site % NX, site / NX % NY, site / NX / NY};
  if (!periodic[axis] && ((step < 0 && at[axis] == 0) || (step > 0 && at[axis] == size[axis] - 1)))
    return site;
  at[axis] = (at[axis] + size[axis] + (size_t)(step > 0 ? 1 : size[axis] - 1)) % size[axis];
  return (at[2] * NY + at[1]) * NX + at[0];
}

static void flood(const uint8_t *image, const bool periodic[3], int *label, size_t *count) {
  static size_t stack[SITES];
  *count = 0;
  for (size_t i = 0; i < SITES; i++) label[i] = -1;
  for (size_t i = 0; i < SITES; i++) {
    if (image[i] != 0 || label[i] >= 0) continue;
    size_t top = 0;
    stack[top++] = i;
    label[i] = (int)*count;
    while (top > 0) {
      size_t site = stack[--top];
      for (int n = 0; n < 6; n++) {
        size_t next = neighbour(site, n / 2, n % 2 != 0 ? 1 : -1, periodic);
        if (image[next] != 0 || label[next] >= 0) continue;
        label[next] = label[site];
        stack[top++] = next;
      }
    }
    (*count)++;
  }
}

static void test_random_images_match_a_flood_fill(void **state) {
  (void)state;
  static uint8_t image[SITES];
  static int label[SITES];
  const size_t size[3] = {NX, NY, NZ};
  srand(7);
  for (int round = 0; round < 60; round++) {
    const bool periodic[3] = {(round & 1) != 0, (round & 2) != 0, (round & 4) != 0};
    int solid_share = 20 + 10 * (round % 7);
    for (size_t i = 0; i < SITES; i++) image[i] = rand() % 100 < solid_share;
    struct parts parts;
    size_t count;
    assert_int_equal(parts_find(image, size, periodic, 0, &parts), STATUS_OK);
    flood(image, periodic, label, &count);
    assert_int_equal(parts.count, count);
    /* Same partition: each part meets exactly one label. */
    int *match = calloc(count, sizeof *match);
    for (size_t row = 0; row < NY * NZ; row++)
      for (size_t r = parts.row_first[row]; r < parts.row_first[row + 1]; r++)
        for (size_t x = parts.runs[r].x0; x < parts.runs[r].x1; x++) {
          int *seen = &match[parts.runs[r].part];
          if (*seen == 0) *seen = label[row * NX + x] + 1;
          assert_int_equal(*seen, label[row * NX + x] + 1);
        }
    free(match);
    parts_end(&parts);
  }
}

static void find_one(const uint8_t *image, const size_t size[3], const bool periodic[3],
                     struct part *part, size_t *count) {
  struct parts parts;
  assert_int_equal(parts_find(image, size, periodic, 0, &parts), STATUS_OK);
  *count = parts.count;
  if (parts.count > 0) *part = parts.parts[0];
  parts_end(&parts);
}

static void test_percolation(void **state) {
  (void)state;
  enum { N = 6 };
  const size_t size[3] = {N, N, N};
  const bool all[3] = {true, true, true}, none[3] = {false, false, false};
  uint8_t image[N * N * N];
  struct part part = {0};
  size_t count;
  /* A straight tube along z. */
  memset(image, 1, sizeof image);
  for (size_t z = 0; z < N; z++) image[z * N * N + 2 * N + 3] = 0;
  find_one(image, size, all, &part, &count);
  assert_true(count == 1 && part.percolates[2] && !part.percolates[0] && !part.percolates[1]);
  find_one(image, size, none, &part, &count);
  assert_true(part.percolates[2] && !part.percolates[0] && !part.percolates[1]);
  /* Both ends open but not opposite: blocked when periodic. */
  memset(image, 1, sizeof image);
  for (size_t z = 0; z < 3; z++) image[z * N * N + 1 * N + 1] = 0;
  for (size_t x = 1; x < 5; x++) image[3 * N * N + 1 * N + x] = 0;
  for (size_t z = 3; z < N; z++) image[z * N * N + 1 * N + 4] = 0;
  find_one(image, size, all, &part, &count);
  assert_true(count == 1 && !part.percolates[2]);
  find_one(image, size, none, &part, &count);
  assert_true(part.percolates[2]);
  /* A tube that climbs one period in x for one in z: leads along both. */
  memset(image, 1, sizeof image);
  for (size_t z = 0; z < N; z++) {
    image[z * N * N + z] = 0;
    image[z * N * N + (z + 1) % N] = 0;
  }
  find_one(image, size, all, &part, &count);
  assert_true(count == 1 && part.percolates[0] && part.percolates[2] && !part.percolates[1]);
  /* A ball percolates nowhere, even across a corner of the box. */
  memset(image, 1, sizeof image);
  const size_t corner[2] = {0, N - 1};
  for (int c = 0; c < 8; c++)
    image[(corner[c >> 2] * N + corner[c >> 1 & 1]) * N + corner[c & 1]] = 0;
  find_one(image, size, all, &part, &count);
  assert_true(count == 1 && part.voxels == 8);
  assert_true(!part.percolates[0] && !part.percolates[1] && !part.percolates[2]);
  find_one(image, size, none, &part, &count);
  assert_int_equal(count, 8);
}

static bool small(const struct part *part, const void *context) {
  return part->voxels <= *(const size_t *)context;
}

static void test_painting(void **state) {
  (void)state;
  const size_t size[3] = {8, 1, 1};
  const bool none[3] = {false, false, false};
  uint8_t image[8] = {0, 0, 1, 0, 1, 0, 0, 0};
  size_t limit = 2;
  struct parts parts;
  assert_int_equal(parts_find(image, size, none, 0, &parts), STATUS_OK);
  assert_int_equal(parts_paint(&parts, small, &limit, 1, image), 3);
  parts_end(&parts);
  const uint8_t expected[8] = {1, 1, 1, 1, 1, 0, 0, 0};
  assert_memory_equal(image, expected, 8);
}

/* Islands by their bits against islands by their labels, in smooth noise of both phases. */
static void test_specks_are_the_small_parts(void **state) {
  (void)state;
  const size_t size[3] = {75, 14, 12}, sites = 75 * 14 * 12;
  const bool periodic[3] = {true, true, false};
  int16_t *field = malloc(sites * sizeof *field);
  uint8_t *grain = malloc(sites);
  const size_t rows = size[1] * size[2], words = phase_words(size[0]);
  uint64_t *bits = malloc(3 * rows * words * sizeof *bits), row_bits[2];
  srand(11);
  for (int round = 0; round < 40; round++) {
    const size_t limit = (size_t)(2 + rand() % 63);
    for (size_t i = 0; i < sites; i++) field[i] = (int16_t)(rand() % 201 - 100);
    for (int smooth = 0; smooth < round % 4; smooth++)
      for (size_t i = sites - 1; i >= 75; i--)
        field[i] = (int16_t)((field[i] + field[i - 1] + 2 * field[i - 75]) / 3);
    for (size_t i = 0; i < sites; i++) grain[i] = field[i] > 0;
    for (size_t row = 0; row < rows; row++)
      phase_row(field + row * size[0], size[0], bits + row * words);
    size_t expected = 0;
    for (uint8_t phase = 0; phase < 2; phase++) {
      struct parts parts;
      assert_int_equal(parts_find(grain, size, periodic, phase, &parts), STATUS_OK);
      for (size_t row = 0; row < size[1] * size[2]; row++)
        for (size_t r = parts.row_first[row]; r < parts.row_first[row + 1]; r++) {
          const struct part *part = &parts.parts[parts.runs[r].part];
          if (part->voxels >= limit || part->at_border) continue;
          const size_t length = parts.runs[r].x1 - parts.runs[r].x0;
          memset(grain + row * size[0] + parts.runs[r].x0, phase == 0, length);
          expected += length;
        }
      parts_end(&parts);
    }
    assert_int_equal(specks_remove(field, bits, size, limit, bits + rows * words), expected);
    for (size_t i = 0; i < sites; i++) assert_int_equal(field[i] > 0, grain[i]);
    for (size_t row = 0; row < rows; row++) {
      phase_row(field + row * size[0], size[0], row_bits);
      assert_memory_equal(row_bits, bits + row * words, words * sizeof *bits);
    }
  }
  free(bits);
  free(field);
  free(grain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_images_match_a_flood_fill),
      cmocka_unit_test(test_percolation),
      cmocka_unit_test(test_painting),
      cmocka_unit_test(test_specks_are_the_small_parts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
