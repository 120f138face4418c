/* A scan restored in blocks: as if it were one, for any number of threads; and its sample. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "common/memory.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/restore.h"

enum { SIDE = 72, VOXELS = SIDE * SIDE * SIDE };
#define VOXEL 2e-6
#define BLUR (1.2 * VOXEL)

/* Balls on a crooked lattice, which touch, under a blur of 1.2 voxels and some noise; pores are 20
 * and grains 120. */
static float *draw(void) {
  float *grey = NULL, *work = NULL;
  const size_t size[3] = {SIDE, SIDE, SIDE};
  const double blur[3] = {1.2, 1.2, 1.2};
  assert_int_equal(memory_allocate(&grey, VOXELS, sizeof *grey, "a drawing"), STATUS_OK);
  assert_int_equal(memory_allocate(&work, VOXELS, sizeof *work, "a drawing"), STATUS_OK);
  for (size_t i = 0; i < VOXELS; i++) {
    const double x = (double)(i % SIDE), y = (double)(i / SIDE % SIDE),
                 z = (double)(i / SIDE / SIDE);
    const double a = remainder(x + 0.2 * y, 13.7), b = remainder(y + 0.3 * z, 12.9);
    const double c = remainder(z + 0.1 * x, 13.3);
    grey[i] = (float)fmin(fmax(6.9 - hypot(a, hypot(b, c)), 0.0), 1.0);
  }
  gaussian_filter(grey, size, blur, work, grey);
  srand(7);
  for (size_t i = 0; i < VOXELS; i++)
    grey[i] = 20.0F + 100.0F * grey[i] + 10.0F * ((float)rand() / (float)RAND_MAX - 0.5F);
  memory_free(&work);
  return grey;
}

/* Restores the drawing in blocks of up to `voxels` voxels, on so many threads. */
static struct coarse restored(const float *grey, double voxels, int threads, size_t count[3]) {
  const struct region region = {.size = {SIDE, SIDE, SIDE},
                                .voxel = {VOXEL, VOXEL, VOXEL},
                                .held = grey,
                                .held_type = PIXEL_F32};
  const struct scanner scanner = {.known = true,
                                  .blur = BLUR,
                                  .pore = 20.0,
                                  .grain = 120.0,
                                  .noise = 2.9,
                                  .noise_correlation = 0.3 * VOXEL};
  struct restore restore;
  omp_set_num_threads(threads);
  assert_int_equal(restore_start(&region, BLUR, voxels, &restore), STATUS_OK);
  assert_int_equal(restore_sample(&restore, &scanner, 0.0), STATUS_OK);
  assert_int_equal(restore_others(&restore, &scanner, 0.0), STATUS_OK);
  memcpy(count, restore.count, sizeof restore.count);
  return restore.levels;
}

/* Of a hundred levels two differ, by one of 255 but where a grain is cut off by the overlap. */
static void test_blocks(void **state) {
  (void)state;
  float *grey = draw();
  size_t one[3], many[3], differ = 0, far = 0;
  struct coarse whole = restored(grey, RESTORE_VOXELS, 2, one);
  struct coarse blocks = restored(grey, 160e3, 1, many), again = restored(grey, 160e3, 2, many);
  assert_int_equal(one[0] * one[1] * one[2], 1);
  assert_true(many[0] == 2 && many[1] == 2 && many[2] == 2);
  assert_memory_equal(blocks.levels, again.levels, VOXELS);
  for (size_t i = 0; i < VOXELS; i++) {
    const int off = abs((int)whole.levels[i] - (int)blocks.levels[i]);
    differ += off > 0;
    far += off > 4;
  }
  print_message("of %d levels %zu differ, %zu by more than 4 of 255\n", VOXELS, differ, far);
  assert_true(differ < 3 * VOXELS / 100 && far < VOXELS / 1000);
  assert_int_equal(blocks.histogram.total, VOXELS);
  coarse_end(&whole);
  coarse_end(&blocks);
  coarse_end(&again);
  memory_free(&grey);
}

/* All of a small scan, and of a large one a block in each third of each axis. */
static void test_sample(void **state) {
  (void)state;
  const struct region region = {.size = {SIDE, SIDE, SIDE}, .voxel = {VOXEL, VOXEL, VOXEL}};
  struct restore restore;
  assert_int_equal(restore_start(&region, BLUR, RESTORE_VOXELS, &restore), STATUS_OK);
  assert_int_equal(restore_sampled(&restore), 1);
  struct restore_block block = restore_sample_block(&restore, 0);
  for (int d = 0; d < 3; d++) assert_true(block.first[d] == 0 && block.size[d] == SIDE);
  coarse_end(&restore.levels);
  assert_int_equal(restore_start(&region, BLUR, 60e3, &restore), STATUS_OK);
  const size_t blocks = restore.count[0] * restore.count[1] * restore.count[2];
  assert_true(blocks >= 27);
  assert_int_equal(restore_sampled(&restore), 3);
  bool seen[3][3] = {{false}};
  for (size_t i = 0; i < 3; i++) {
    block = restore_sample_block(&restore, i);
    for (int d = 0; d < 3; d++) seen[d][3 * (block.first[d] + block.size[d] / 2) / SIDE] = true;
  }
  for (int d = 0; d < 3; d++)
    for (int third = 0; third < 3; third++) assert_true(seen[d][third]);
  coarse_end(&restore.levels);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_blocks), cmocka_unit_test(test_sample)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
