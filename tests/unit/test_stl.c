/* Regions within a surface that an STL file holds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/config.h"
#include "common/error.h"
#include "sphsolve/scene/scene_read.h"
#include "sphsolve/scene/stl.h"

static char folder[] = "/tmp/test_stl_XXXXXX", path[64], scene_path[64];

static int set_up(void **state) {
  (void)state;
  if (mkdtemp(folder) == NULL) return 1;
  snprintf(path, sizeof path, "%s/body.stl", folder);
  snprintf(scene_path, sizeof scene_path, "%s/scene.cfg", folder);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  unlink(path), unlink(scene_path);
  return rmdir(folder);
}

struct body {
  int count;
  float corner[5000][3][3];
};
static struct body body;

static void add(const float a[3], const float b[3], const float c[3]) {
  memcpy(body.corner[body.count][0], a, sizeof(float[3]));
  memcpy(body.corner[body.count][1], b, sizeof(float[3]));
  memcpy(body.corner[body.count++][2], c, sizeof(float[3]));
}

/* A ball of meridians and parallels round (50, 50, 50), its corners on the sphere. */
static void make_ball(float radius, int n) {
  float at[64][128][3];
  body.count = 0;
  for (int k = 0; k <= n; k++)
    for (int i = 0; i < 2 * n; i++) {
      const double high = M_PI * k / n, round = M_PI * i / n;
      at[k][i][0] = 50 + radius * (k % n ? (float)(sin(high) * cos(round)) : 0);
      at[k][i][1] = 50 + radius * (k % n ? (float)(sin(high) * sin(round)) : 0);
      at[k][i][2] = 50 + radius * (float)cos(high);
    }
  for (int k = 0; k < n; k++)
    for (int i = 0; i < 2 * n; i++) {
      const int j = (i + 1) % (2 * n);
      if (k > 0) add(at[k][i], at[k + 1][i], at[k][j]);
      if (k < n - 1) add(at[k][j], at[k + 1][i], at[k + 1][j]);
    }
}

/* A wedge of right angle, 20 to 80 along x and y, z from 10 to 70 at x = 20 and none at 80. */
static void make_wedge(void) {
  const float p[6][3] = {{20, 20, 10}, {80, 20, 10}, {20, 20, 70},
                         {20, 80, 10}, {80, 80, 10}, {20, 80, 70}};
  static const int face[8][3] = {{0, 1, 2}, {3, 5, 4}, {0, 3, 1}, {1, 3, 4},
                                 {0, 2, 3}, {2, 5, 3}, {1, 4, 2}, {2, 4, 5}};
  body.count = 0;
  for (int k = 0; k < 8; k++) add(p[face[k][0]], p[face[k][1]], p[face[k][2]]);
}

static double volume(void) {
  double sum = 0;
  for (int t = 0; t < body.count; t++) {
    double x[3][3];
    for (int k = 0; k < 9; k++) x[k / 3][k % 3] = (double)body.corner[t][k / 3][k % 3] - 50;
    sum += x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) -
           x[0][1] * (x[1][0] * x[2][2] - x[1][2] * x[2][0]) +
           x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
  }
  return fabs(sum) / 6 * 1e-9;
}

static void write_binary(void) {
  unsigned char head[84] = "solid by name, binary by its length", record[50] = {0};
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  head[80] = (unsigned char)(body.count & 255), head[81] = (unsigned char)(body.count >> 8);
  fwrite(head, 1, sizeof head, file);
  for (int t = 0; t < body.count; t++) {
    memcpy(record + 12, body.corner[t], sizeof body.corner[t]);
    fwrite(record, 1, sizeof record, file);
  }
  fclose(file);
}

static void write_text(const char *text) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  if (text != NULL) fputs(text, file);
  for (int t = 0; text == NULL && t < body.count; t++) {
    if (t == 0) fputs("solid a body\n", file);
    fputs(" facet normal 0 0 0\n  OUTER loop\n", file);
    for (int c = 0; c < 3; c++) {
      const float *x = body.corner[t][c];
      fprintf(file, "   vertex %.9g %.9g %.9g\n", (double)x[0], (double)x[1], (double)x[2]);
    }
    fputs("  endloop\n endfacet\n", file);
    if (t == body.count - 1) fputs("endsolid a body\n", file);
  }
  fclose(file);
}

static enum status read_scene(const char *type, const char *more, struct scene *scene) {
  FILE *file = fopen(scene_path, "w");
  assert_non_null(file);
  fprintf(file,
          "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
          "domain = { size = [\"0.1 m\", \"0.1 m\", \"0.1 m\"]; spacing = \"5 mm\"; periodic = "
          "[true, true, true]; };\n"
          "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0\", \"0.1 m\", \"0.1 m\", \"0.1 "
          "m\"]; }, { type = \"%s\"; stl = \"body.stl\"; %s } );\n",
          type, more);
  fclose(file);
  return scene_read(scene_path, NULL, 0, scene);
}

#define SOIL "stl_unit = \"1 mm\"; porosity = 0.4; grain_size = \"1 mm\";"

static double volume_of(const char *type, const char *more, size_t *boxes) {
  struct scene scene;
  double sum = 0;
  assert_int_equal(read_scene(type, more, &scene), STATUS_OK);
  *boxes = scene.region_count - 1;
  for (size_t k = 1; k < scene.region_count; k++) {
    const double *box = scene.regions[k].box;
    double product = 1;
    assert_true(scene.regions[k].is_part && scene.regions[k].first == 1);
    for (int a = 0; a < 3; a++) {
      assert_true(box[a + 3] > box[a]);
      product *= box[a + 3] - box[a];
    }
    sum += product;
  }
  scene_free(&scene);
  return sum;
}

/* Soil keeps its volume; walls are the sites that they cover. */
static void boxes_have_the_volume(void **state) {
  size_t boxes;
  (void)state;
  make_ball(33, 20);
  write_binary();
  const double ball = volume(), binary = volume_of("porous", SOIL, &boxes);
  assert_true(fabs(binary / ball - 1) < 5e-3);
  assert_true(boxes < 250);
  write_text(NULL);
  assert_true(fabs(volume_of("porous", SOIL, &boxes) / binary - 1) < 1e-7);
  assert_true(fabs(volume_of("wall", "stl_unit = \"1 mm\";", &boxes) / ball - 1) < 0.02);
  make_wedge();
  write_binary();
  assert_true(fabs(volume_of("porous", SOIL, &boxes) / 108e-6 - 1) < 1e-6);
  assert_int_equal(boxes, 12); /* one for each row of slope: they go on along y */
}

static void refused(const char *word) {
  struct stl stl;
  assert_int_equal(stl_read(path, 1e-3, &stl), STATUS_INPUT);
  if (strstr(error_message(), word) == NULL) fail_msg("'%s': %s", word, error_message());
  error_clear();
  stl_free(&stl);
}

static void wrong_files_are_told(void **state) {
  struct scene scene;
  (void)state;
  make_wedge();
  body.count--;
  write_binary();
  refused("the surface is open: 3 edges belong to an odd number of triangles");
  body.count++;
  body.corner[3][1][0] = NAN;
  write_binary();
  refused("triangle 4 has a corner that is no number");
  body.count = 0;
  write_binary();
  refused("holds no triangle");
  write_text("");
  refused("no STL");
  write_text("# a mesh of another kind\n");
  refused("no STL");
  write_text("solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2\nendloop\n");
  refused("body.stl:5: three numbers are wanted here");
  write_text("solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 1 2 4\nendloop\n");
  refused("body.stl:6: 'vertex' is wanted here");
  write_text("solid\nendsolid\nwhatever\n");
  refused("body.stl:3: 'solid' is wanted here");
  write_text("solid\nfacet");
  refused("'normal' is wanted here");
  make_wedge();
  write_binary();
  assert_int_equal(truncate(path, 300), 0);
  refused("a binary one of 8 triangles has 484 bytes, not 300");
  write_binary();
  static const char *const wrong[][2] = {{"stl_unit = \"1 cm\";", "lies outside the domain"},
                                         {"", "stl_unit is missing"},
                                         {"stl_unit = \"1 s\";", "m is wanted"}};
  for (int k = 0; k < 3; k++) {
    assert_int_equal(read_scene("wall", wrong[k][0], &scene), STATUS_INPUT);
    if (strstr(error_message(), wrong[k][1]) == NULL)
      fail_msg("'%s': %s", wrong[k][1], error_message());
    error_clear();
  }
}

/* Nobody may ever write into a pipe. */
static void test_pipes(void **state) {
  (void)state;
  struct stl stl = {0};
  struct config *config;
  unlink(path);
  assert_int_equal(mkfifo(path, 0600), 0);
  assert_int_equal(stl_read(path, 1e-3, &stl), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "is a pipe or device, not a file"));
  error_clear();
  assert_int_equal(config_open(path, NULL, 0, &config), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "is a pipe or device, not a file"));
  error_clear();
  unlink(path);
  assert_int_equal(config_open(folder, NULL, 0, &config), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "is a folder, not a file"));
  error_clear();
}

/* libconfig takes "a : 1" for a setting too. */
static void test_settings_are_counted(void **state) {
  (void)state;
  struct config *config;
  for (int k = 0; k < 2; k++) {
    FILE *file = fopen(scene_path, "w");
    for (int i = 0; i < 20001; i++) fprintf(file, "a%d %c 1;\n", i, "=:"[k]);
    fclose(file);
    assert_int_equal(config_open(scene_path, NULL, 0, &config), STATUS_INPUT);
    assert_non_null(strstr(error_message(), "20001 settings: no scene file"));
    error_clear();
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pipes),
      cmocka_unit_test(test_settings_are_counted),
      cmocka_unit_test(boxes_have_the_volume),
      cmocka_unit_test(wrong_files_are_told),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
