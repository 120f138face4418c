/* Large datasets of the HDF5 layer, whose chunks are packed and unpacked by several threads. */
#include "files_rig.h"

#include <sys/stat.h>

#include "common/hdf5_file.h"
#include "common/memory.h"

/* A byte of the file, after that share of it, is another; another time it is itself again. */
static void damage_file(double share) {
  FILE *file = fopen(path, "r+b");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  fseek(file, (long)(share * (double)ftell(file)), SEEK_SET);
  const int byte = fgetc(file);
  fseek(file, -1, SEEK_CUR);
  fputc(byte ^ 0x55, file);
  fclose(file);
}

/* Chunks that are cut along each axis, with a part of one left at the end, come back, and through
 * HDF5's own filters too, which other numbers are read by; the last two have as many chunks as are
 * packed and unpacked by several threads, the last of little over half a chunk's bytes each. */
static void test_chunks(void **state) {
  (void)state;
  const size_t shapes[][3] = {{3, 650, 900}, {301, 60, 60},  {2, 3, 300001}, {1, 1, 5000},
                              {1, 650, 900}, {17, 300, 900}, {33, 132, 1000}};
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
    const size_t *dims = shapes[k], count = dims[0] * dims[1] * dims[2];
    float *values = malloc(count * sizeof *values), *again = NULL;
    double *others = NULL;
    size_t found[3];
    struct h5_file *file = NULL;
    for (size_t i = 0; i < count; i++) values[i] = (float)((i * 2654435761u) % 1000u);
    assert_int_equal(h5_create(path, &file), STATUS_OK);
    assert_int_equal(h5_write(file, "/values", H5_F32, 3, dims, values, true), STATUS_OK);
    assert_int_equal(h5_commit(file), STATUS_OK);
    assert_int_equal(h5_open(path, &file), STATUS_OK);
    assert_int_equal(h5_read(file, "/values", H5_F32, 3, found, &again), STATUS_OK);
    assert_int_equal(h5_read(file, "/values", H5_F64, 3, found, &others), STATUS_OK);
    h5_close(file);
    assert_memory_equal(found, dims, sizeof found);
    assert_memory_equal(again, values, count * sizeof *values);
    for (size_t i = 0; i < count; i++) assert_true((float)others[i] == values[i]);
    memory_free(&again);
    memory_free(&others);
    free(values);
    if (count < 1000000) continue;
    damage_file(0.5);
    assert_int_equal(h5_open(path, &file), STATUS_OK);
    refused(h5_read(file, "/values", H5_F32, 3, found, &again), "damaged");
    h5_close(file);
  }
}

/* Numbers whose lower bytes are noise, which is stored and not packed, take no more room than they
 * are long, and a byte that was changed is found wherever it lies. */
static void test_noise(void **state) {
  (void)state;
  const size_t dims[3] = {33, 132, 1000}, count = dims[0] * dims[1] * dims[2];
  float *values = malloc(count * sizeof *values), *again = NULL;
  double *others = NULL;
  size_t found[3];
  struct h5_file *file = NULL;
  struct stat info;
  uint32_t random = 1;
  for (size_t i = 0; i < count; i++) {
    random = random * 1664525u + 1013904223u;
    values[i] = 1.0f + (float)(random >> 9) / 8388608.0f;
  }
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_write(file, "/values", H5_F32, 3, dims, values, true), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(stat(path, &info), 0);
  assert_true((double)info.st_size < 0.8 * (double)(count * sizeof *values));
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(h5_read(file, "/values", H5_F32, 3, found, &again), STATUS_OK);
  h5_close(file);
  assert_memory_equal(again, values, count * sizeof *values);
  memory_free(&again);
  for (int i = 1; i < 20; i++) {
    damage_file(i / 20.0);
    assert_int_equal(h5_open(path, &file), STATUS_OK);
    refused(h5_read(file, "/values", H5_F32, 3, found, &again), "damaged");
    refused(h5_read(file, "/values", H5_F64, 3, found, &others), "damaged");
    h5_close(file);
    damage_file(i / 20.0);
  }
  free(values);
}

/* Coordinates of a lattice's sites, which come and go in rows, take a sixth of their length, as
 * each component lies apart; whole, in part, and through HDF5's own filters they are what was
 * written. */
static void test_points(void **state) {
  (void)state;
  const size_t nx = 190, count = 700003, dims[2] = {count, 3}, first = 333,
               share[2] = {count / 2, 3};
  double *points = malloc(3 * count * sizeof *points), *again = NULL;
  float *others = NULL;
  size_t found[2];
  struct h5_file *file = NULL;
  struct stat info;
  for (size_t i = 0, site = 0; i < count; i++, site += site % 7 < 4 ? 1 : 3) {
    const size_t at[3] = {site % nx, site / nx % nx, site / nx / nx};
    for (int a = 0; a < 3; a++) points[3 * i + (size_t)a] = 4.9e-6 + 9.82e-6 * (double)at[a];
  }
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_write(file, "/points", H5_F64, 2, dims, points, true), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(stat(path, &info), 0);
  assert_true((double)info.st_size < 0.17 * (double)(3 * count * sizeof *points));
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(h5_read(file, "/points", H5_F64, 2, found, &again), STATUS_OK);
  assert_memory_equal(found, dims, sizeof found);
  assert_memory_equal(again, points, 3 * count * sizeof *points);
  memory_free(&again);
  assert_int_equal(h5_read(file, "/points", H5_F32, 2, found, &others), STATUS_OK);
  for (size_t i = 0; i < 3 * count; i++) assert_true(others[i] == (float)points[i]);
  memory_free(&others);
  size_t rows[2] = {share[0], share[1]};
  assert_int_equal(h5_read_rows(file, "/points", H5_F64, 2, count, first, rows, &again), STATUS_OK);
  assert_memory_equal(again, points + 3 * first, 3 * share[0] * sizeof *points);
  memory_free(&again);
  h5_close(file);
  for (int i = 1; i < 10; i++) {
    damage_file(i / 10.0);
    assert_int_equal(h5_open(path, &file), STATUS_OK);
    refused(h5_read(file, "/points", H5_F64, 2, found, &again), "damaged");
    h5_close(file);
    damage_file(i / 10.0);
  }
  free(points);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_chunks), cmocka_unit_test(test_noise),
                                     cmocka_unit_test(test_points)};
  return cmocka_run_group_tests(tests, make_file, remove_folder);
}
