/* The grain surface against spheres, whose distance and volume are known. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/surface/coarse.h"
#include "ct2model/readers/stack.h"
#include "ct2model/scan/survey.h"
#include "ct2model/surface/specks.h"
#include "ct2model/surface/surfels.h"
#include "ct2model/surface/wall_distance.h"

/* A scan of one sphere in a periodic box: grey 100 in the grain, 20 outside, linear across a blur
 * of two voxels, written as raw floats. */
struct scan {
  size_t size[3];
  double centre[3], radius;
  char path[256];
  struct stack stack;
  struct region region;
};

static double sphere_distance(const struct scan *scan, const double at[3], bool mirror,
                              double plane) {
  double best = INFINITY;
  for (int iz = -1; iz <= 1; iz++) {
    for (int iy = -1; iy <= 1; iy++) {
      for (int ix = -1; ix <= 1; ix++) {
        double z = scan->centre[2] + iz * (double)scan->size[2];
        if (mirror)
          z = iz < 0 ? -scan->centre[2] : iz > 0 ? 2.0 * plane - scan->centre[2] : scan->centre[2];
        double d[3] = {at[0] - scan->centre[0] - ix * (double)scan->size[0],
                       at[1] - scan->centre[1] - iy * (double)scan->size[1], at[2] - z};
        best = fmin(best, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - scan->radius);
      }
    }
  }
  return best;
}

static void scan_make(struct scan *scan, bool mirror, double plane) {
  const char *build = getenv("BUILD");
  snprintf(scan->path, sizeof scan->path, "%s/sphere-XXXXXX", build != NULL ? build : "/tmp");
  int handle = mkstemp(scan->path);
  assert_true(handle >= 0);
  FILE *file = fdopen(handle, "wb");
  for (size_t z = 0; z < scan->size[2]; z++)
    for (size_t y = 0; y < scan->size[1]; y++)
      for (size_t x = 0; x < scan->size[0]; x++) {
        double at[3] = {(double)x + 0.5, (double)y + 0.5, (double)z + 0.5};
        double d = sphere_distance(scan, at, mirror, plane);
        float grey = (float)(60.0 - 40.0 * fmin(1.0, fmax(-1.0, d / 1.5)));
        fwrite(&grey, sizeof grey, 1, file);
      }
  fclose(file);
  struct raw_layout raw = {
      true, {scan->size[0], scan->size[1], scan->size[2]}, PIXEL_F32, false, 0};
  const char *paths[] = {scan->path};
  assert_int_equal(stack_open(paths, 1, &raw, &scan->stack), STATUS_OK);
  scan->region = (struct region){.stack = &scan->stack, .voxel = {1, 1, 1}, .scale = 1.0};
  memcpy(scan->region.size, scan->size, sizeof scan->size);
}

static void scan_end(struct scan *scan) {
  stack_close(&scan->stack);
  remove(scan->path);
}

/* Largest error of the distance within `near` voxels of the surface, in full-resolution voxels. */
static double worst_error(const struct scan *scan, const struct wall_request *request,
                          const struct wall_result *walls, double near) {
  double worst = 0.0, factor[3];
  double plane =
      ((double)request->size[2] - 0.5) * (double)scan->size[2] / (double)request->size[2];
  for (int d = 0; d < 3; d++) factor[d] = (double)scan->size[d] / (double)request->size[d];
  size_t i = 0, seen = 0;
  for (size_t z = 0; z < request->size[2]; z++)
    for (size_t y = 0; y < request->size[1]; y++)
      for (size_t x = 0; x < request->size[0]; x++, i++) {
        double at[3] = {((double)x + 0.5) * factor[0], ((double)y + 0.5) * factor[1],
                        ((double)z + 0.5) * factor[2]};
        double exact = sphere_distance(scan, at, request->mirror, plane);
        if (fabs(exact) > near || exact < 3.0 - scan->radius) continue;
        seen++;
        worst = fmax(worst, fabs((double)walls->distance[i] - exact));
      }
  assert_true(seen > 100);
  return worst;
}

/* The scan as `coarse` has it after one reading. */
static void average(const struct region *region, const size_t size[3], struct coarse *coarse) {
  const struct survey survey = {
      .phases = {.pore_peak = 20, .grain_peak = 100, .contrast_to_noise = 100}};
  float *slice, *sums;
  assert_int_equal(coarse_start(region, size, &survey, coarse), STATUS_OK);
  assert_true(coarse->step > 1);
  assert_int_equal(memory_allocate(&slice, region->size[0] * region->size[1], sizeof *slice, ""),
                   STATUS_OK);
  assert_int_equal(memory_allocate(&sums, coarse_sums(coarse), sizeof *sums, ""), STATUS_OK);
  for (size_t z = 0; z < region->size[2]; z++) {
    assert_int_equal(region_read(region, &z, 1, slice), STATUS_OK);
    for (size_t y = 0; y < region->size[1]; y++)
      coarse_add(coarse, y, z, slice + y * region->size[0], sums);
    if ((z + 1) % coarse->step == 0) coarse_store(coarse, z / coarse->step, sums);
  }
  assert_int_equal(coarse->histogram.total, coarse->size[0] * coarse->size[1] * coarse->size[2]);
  memory_free(&slice);
  memory_free(&sums);
}

static void measure(struct scan *scan, const size_t size[3], bool mirror, bool averaged,
                    double near, double bound) {
  struct wall_request request = {
      .threshold = 60, .contrast = 80, .distances = true, .mirror = mirror};
  struct wall_result walls;
  struct coarse coarse = {.step = 1};
  memcpy(request.size, size, sizeof request.size);
  double plane = ((double)size[2] - 0.5) * (double)scan->size[2] / (double)size[2];
  scan_make(scan, mirror, plane);
  struct region region = scan->region;
  if (averaged) {
    average(&scan->region, size, &coarse);
    region = coarse_region(&coarse, &scan->region);
    request.threshold = (60 - coarse.low) / coarse.unit;
    request.contrast = 80 / coarse.unit;
  }
  assert_int_equal(wall_measure(&region, &request, &walls), STATUS_OK);
  double error = worst_error(scan, &request, &walls, near);
  print_message("# distance error %.3f voxels\n", error);
  assert_true(error < bound);
  if (!mirror) { /* the whole sphere, periodic: its volume and surface */
    double sum = 0.0, sites = (double)(size[0] * size[1] * size[2]);
    for (size_t i = 0; i < size[0] * size[1] * size[2]; i++) sum += (double)walls.grain_fraction[i];
    double volume = 4.0 / 3.0 * M_PI * pow(scan->radius, 3.0);
    double measured = sum / sites * (double)(scan->size[0] * scan->size[1] * scan->size[2]);
    print_message("# volume error %.4f\n", measured / volume - 1.0);
    assert_true(fabs(measured / volume - 1.0) < 0.005);
  }
  wall_result_end(&walls);
  coarse_end(&coarse);
  scan_end(scan);
}

static void check(struct scan *scan, const size_t size[3], bool mirror, double near, double bound) {
  measure(scan, size, mirror, false, near, bound);
}

static void test_sphere_reduced(void **state) {
  (void)state;
  struct scan scan = {.size = {64, 64, 64}, .centre = {32.3, 31.6, 32.1}, .radius = 20};
  check(&scan, (size_t[3]){16, 16, 16}, false, 16.0, 0.1);
}

/* Averaged over 2x2x2 voxels, for a model of eight: within a twentieth of the model's voxel. */
static void test_sphere_in_large_voxels(void **state) {
  (void)state;
  struct scan periodic = {.size = {96, 96, 96}, .centre = {47.3, 93.6, 50.1}, .radius = 33};
  measure(&periodic, (size_t[3]){12, 12, 12}, false, true, 16.0, 0.4);
  struct scan mirrored = {.size = {96, 96, 96}, .centre = {47.1, 49.2, 0.0}, .radius = 30};
  measure(&mirrored, (size_t[3]){12, 12, 12}, true, true, 16.0, 0.4);
}

static void test_sphere_full_resolution(void **state) {
  (void)state;
  struct scan scan = {.size = {40, 44, 36}, .centre = {20.4, 20.1, 18.2}, .radius = 11};
  check(&scan, (size_t[3]){40, 44, 36}, false, 4.0, 0.1);
}

static void test_sphere_across_the_periodic_faces(void **state) {
  (void)state;
  struct scan scan = {.size = {48, 48, 48}, .centre = {2.0, 46.5, 24.0}, .radius = 15};
  check(&scan, (size_t[3]){12, 12, 12}, false, 12.0, 0.1);
  struct scan wrapped = {.size = {48, 48, 48}, .centre = {24.0, 20.0, 47.0}, .radius = 15};
  check(&wrapped, (size_t[3]){12, 12, 12}, false, 12.0, 0.1);
}

/* Centred on the plane, so that the mirrored surface has no crease. */
static void test_sphere_at_the_mirror_planes(void **state) {
  (void)state;
  struct scan low = {.size = {48, 48, 64}, .centre = {24.0, 24.0, 0.0}, .radius = 14};
  check(&low, (size_t[3]){12, 12, 16}, true, 12.0, 0.1);
  struct scan high = {.size = {48, 48, 64}, .centre = {24.0, 24.0, 62.0}, .radius = 14};
  check(&high, (size_t[3]){12, 12, 16}, true, 12.0, 0.1);
}

static void test_far_voxels_follow_the_eikonal_equation(void **state) {
  (void)state;
  /* A plane wall at x = 0 of a long box: distances grow to the middle. */
  enum { N = 40 };
  const size_t size[3] = {N, 3, 2};
  const double spacing[3] = {0.5, 1.0, 2.0};
  float distance[N * 6];
  unsigned char solid[N * 6];
  for (size_t i = 0; i < N * 6; i++) {
    size_t x = i % N;
    solid[i] = x == 0;
    distance[i] = x == 0 ? -0.25f : x == 1 || x == N - 1 ? 0.25f : INFINITY;
  }
  size_t disagree;
  assert_int_equal(wall_complete(distance, solid, size, spacing, &disagree), STATUS_OK);
  assert_int_equal(disagree, 0);
  for (size_t i = 0; i < N * 6; i++) {
    size_t x = i % N;
    double exact = x == 0 ? -0.25 : 0.5 * (double)(x < N - x ? x : N - x) - 0.25;
    assert_true(fabs((double)distance[i] - exact) < 1e-5);
  }
}

static void test_signs_follow_the_model(void **state) {
  (void)state;
  const size_t size[3] = {4, 1, 1};
  const double spacing[3] = {1, 1, 1};
  float distance[4] = {-0.4f, 0.3f, 0.2f, 0.001f};
  const unsigned char solid[4] = {1, 1, 0, 1};
  size_t disagree;
  assert_int_equal(wall_complete(distance, solid, size, spacing, &disagree), STATUS_OK);
  assert_int_equal(disagree, 2);
  assert_true(distance[0] == -0.4f && distance[1] == -0.01f && distance[2] == 0.2f &&
              distance[3] == -0.01f);
}

/* The nearest of all discs and of their images, each looked at. */
static double nearest_of_all(const struct surfels *surfels, const double point[3], double limit) {
  double best = limit * limit;
  for (size_t b = 0; b < surfels->blocks[0] * surfels->blocks[1] * surfels->blocks[2]; b++)
    for (uint32_t i = surfels->first[b]; i < surfels->first[b + 1]; i++)
      for (int image = 0; image < 9; image++) {
        const size_t at[3] = {b % surfels->blocks[0], b / surfels->blocks[0] % surfels->blocks[1],
                              b / surfels->blocks[0] / surfels->blocks[1]};
        const uint32_t place = surfels->items[i], normal = surfels->items[surfels->count + i];
        const int shift[3] = {image % 3 - 1, image / 3 - 1, 0};
        double height = 0.0, square = 0.0;
        for (int d = 0; d < 3; d++) {
          const double cell = (double)(at[d] * SURFELS_BLOCK) + 0.5 +
                              (double)(place >> 10 * d & 1023U) / 255.0 +
                              shift[d] * (double)surfels->size[d];
          const double apart = point[d] - cell * surfels->stretch[d];
          height += apart * (double)(int8_t)(normal >> 8 * d) / 127.0;
          square += apart * apart;
        }
        const double aside = fmax(sqrt(fmax(square - height * height, 0.0)) - SURFELS_RADIUS, 0.0);
        best = fmin(best, height * height + aside * aside);
      }
  return sqrt(best);
}

static void test_nearest(void **state) {
  enum { NX = 45, NY = 38, NZ = 33 };
  static int16_t field[NZ * NY * NX];
  static uint64_t bits[NZ * NY];
  const size_t size[3] = {NX, NY, NZ};
  const double voxel[3] = {1.0, 1.0, 1.0}, stretch[2][3] = {{1.0, 1.0, 1.0}, {1.0, 1.2, 1.5}};
  double worst = 0.0;
  (void)state;
  for (size_t row = 0; row < NZ * NY; row++) {
    const double y = (double)(row % NY), z = (double)(row / NY);
    for (size_t x = 0; x < NX; x++)
      field[row * NX + x] = (int16_t)(1 + (int)(8000.0 * (sin(0.31 * (double)x) + cos(0.4 * y) +
                                                          sin(0.27 * z + 0.1 * (double)x))));
    phase_row(field + row * NX, NX, bits + row);
  }
  for (size_t run = 0; run < 2; run++) {
    struct surfels surfels;
    size_t near = SURFELS_NOWHERE;
    assert_int_equal(surfels_build(field, bits, size, stretch[run], &surfels), STATUS_OK);
    for (size_t i = 0; i < 60; i++) {
      const size_t at[3] = {7 * i % NX, 11 * i % NY, 13 * i % NZ}, p = i % SURFELS_POINTS;
      struct surfel_points points;
      surfel_points_place(at, size, voxel, stretch[run], 9.0, &points);
      surfels_distances(&surfels, &points, &near);
      const double point[3] = {points.at[0][p], points.at[1][p], points.at[2][p]};
      worst = fmax(worst, fabs(points.distance[p] - nearest_of_all(&surfels, point, 9.0)));
    }
    surfels_end(&surfels);
  }
  print_message("nearest of all discs: %.1e voxels apart\n", worst);
  assert_true(worst < 1e-5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sphere_reduced),
      cmocka_unit_test(test_sphere_in_large_voxels),
      cmocka_unit_test(test_sphere_full_resolution),
      cmocka_unit_test(test_sphere_across_the_periodic_faces),
      cmocka_unit_test(test_sphere_at_the_mirror_planes),
      cmocka_unit_test(test_far_voxels_follow_the_eikonal_equation),
      cmocka_unit_test(test_signs_follow_the_model),
      cmocka_unit_test(test_nearest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
