/* Runs made up for tests of analyze: a body of 60 um in steady flow, of n sites a side. */
#ifndef TOSUI_TESTS_UNIT_MADE_RUN_H
#define TOSUI_TESTS_UNIT_MADE_RUN_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "common/hdf5_file.h"
#include "common/snapshot_file.h"

enum { N = 6, ROWS = 40 };

static void write_text(struct h5_file *file, const char *name, const char *text) {
  assert_int_equal(h5_write_attribute_text(file, "/run", name, text), STATUS_OK);
}
static void write_numbers(struct h5_file *file, const char *name, size_t n, double a, double b,
                          double c) {
  double values[3] = {a, b, c};
  assert_int_equal(h5_write_attribute(file, "/run", name, H5_F64, n, values), STATUS_OK);
}
static void write_column(struct h5_file *file, const char *name, size_t width, const double *values,
                         const char *unit) {
  size_t dims[2] = {ROWS, width};
  char path[64];
  snprintf(path, sizeof path, "/history/%s", name);
  assert_int_equal(h5_write(file, path, H5_F64, width > 1 ? 2 : 1, dims, values, false), STATUS_OK);
  assert_int_equal(h5_write_attribute_text(file, path, "unit", unit), STATUS_OK);
}

static void write_snapshot(const char *path) {
  enum { COUNT = N * N * N };
  double points[COUNT][3], velocity[COUNT][3];
  for (int i = 0; i < COUNT; i++)
    for (int a = 0; a < 3; a++) {
      int at[3] = {i % N, i / N % N, i / N / N};
      points[i][a] = (at[a] + 0.5) * 1e-5;
      velocity[i][a] = a == 2 ? -1e-4 * (1 + at[0]) : 1e-6 * at[1];
    }
  const struct snapshot_field place = {.type = H5_F64, .components = 3, .data = points};
  const struct snapshot_field field = {.name = "velocity",
                                       .unit = "m/s",
                                       .description = "velocity",
                                       .type = H5_F64,
                                       .components = 3,
                                       .data = velocity};
  assert_int_equal(snapshot_write(path, 1, 10, 0, COUNT, &place, 1, &field), STATUS_OK);
}

/* A body of 60 um, n sites a side. */
static void write_run(const char *name, double gradient, int n) {
  struct h5_file *file;
  char path[64], snapshot[64];
  double time[ROWS], v[ROWS][3], density[ROWS];
  const char *snapshots[] = {snapshot};
  size_t one = 1;
  double last = 1, spacing = N * 1e-5 / n, count = n * n * n;
  snprintf(path, sizeof path, "%s.hdf", name);
  snprintf(snapshot, sizeof snapshot, "%s-0000.hdf", name);
  for (int i = 0; i < ROWS; i++) {
    time[i] = i / (ROWS - 1.0), density[i] = 1000 + i % 3;
    v[i][0] = v[i][1] = 0,
    v[i][2] = -3e-4 * (1 + 1.0 / (n * n)) * gradient * (1 - exp(-9 * time[i]));
  }
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_make_group(file, "/run"), STATUS_OK);
  write_column(file, "time", 1, time, "s");
  write_column(file, "darcy_velocity", 3, &v[0][0], "m/s");
  write_column(file, "density_max", 1, density, "kg/m^3");
  write_text(file, "method", "wcsph");
  write_text(file, "status", "steady");
  write_text(file, "wall", "subvoxel");
  write_text(file, "scene_name", name);
  write_text(file, "model_hash", n == N ? "0123" : "4567");
  write_numbers(file, "density", 1, 1000, 0, 0);
  write_numbers(file, "viscosity", 1, 1e-3, 0, 0);
  write_numbers(file, "spacing", 3, spacing, spacing, spacing);
  write_numbers(file, "origin", 3, spacing / 2, spacing / 2, spacing / 2);
  write_numbers(file, "size", 3, n, n, n);
  write_numbers(file, "driving", 3, 0, 0, -9.80665 * gradient);
  write_numbers(file, "hydraulic_gradient", 1, gradient, 0, 0);
  write_numbers(file, "darcy_velocity", 3, 0, 0, -3e-4 * gradient);
  write_numbers(file, "k", 1, 3e-4, 0, 0);
  write_numbers(file, "k_error", 1, 0.01, 0, 0);
  write_numbers(file, "bulk_count", 1, count, 0, 0);
  write_numbers(file, "fluid_count", 1, count, 0, 0);
  assert_int_equal(h5_write_texts(file, "/run/snapshots/name", 1, snapshots), STATUS_OK);
  assert_int_equal(h5_write(file, "/run/snapshots/time", H5_F64, 1, &one, &last, false), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  write_snapshot(snapshot);
}

#endif
