/* Soil whose permeability is a tensor (isph/anisotropy.h). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "sphsolve/isph/anisotropy.h"
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/shape.h"
#include "sphsolve/isph/symmetric.h"
#include "tests/unit/isph_scene.h"

static void near(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) fail_msg("%.10g is not %.10g within %g", a, b, within);
}

static void tensors_have_roots_and_inverses(void **state) {
  const double t[6] = {5, 1.5, -2, 3, .4, 2}, x[3] = {1, -2, 3};
  double root[6], inverse[6], y[3], z[3];
  (void)state;
  symmetric_root(t, root);
  symmetric_times(root, x, y), symmetric_times(root, y, y), symmetric_times(t, x, z);
  for (int a = 0; a < 3; a++) near(y[a], z[a], 1e-12);
  symmetric_inverse(t, inverse);
  symmetric_times(inverse, z, y);
  for (int a = 0; a < 3; a++) near(y[a], x[a], 1e-12);
  near(symmetric_along(t, x), x[0] * z[0] + x[1] * z[1] + x[2] * z[2], 1e-12);
  const double unit[6] = {1, 0, 0, 1, 0, 1};
  symmetric_between(root, unit, inverse);
  for (int k = 0; k < 6; k++) near(inverse[k], t[k], 1e-12);
}

/* Neighbours on a square or cubic lattice with the weights of a kernel that ends at 2.4. */
static void lattice(int dimensions, struct isph_directions *around, double moment[6]) {
  for (int k = -2; k <= 2; k++)
    for (int j = -2; j <= 2; j++)
      for (int i = -2; i <= 2; i++) {
        const double r[3] = {i + .03, j + .02, k - .04}, length = sqrt(i * i + j * j + k * k);
        if ((dimensions == 2 && j != 0) || length == 0 || length > 2.4) continue;
        isph_directions_add(around, (double[3]){r[0], dimensions == 2 ? 0 : r[1], r[2]},
                            pow(2.4 - length, 2) / 10, moment);
      }
}

/* Positive weights with the moment of beds at any angle, ten times as permeable along as across;
 * where no neighbour of the lattice lies along the beds, near it. */
static void weights_have_the_moment(void **state) {
  static const double none[6] = {0};
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++)
    for (int angle = 0; angle < 180; angle += 9) {
      const double c = cos(angle * M_PI / 180), s = sin(angle * M_PI / 180), along = sqrt(10);
      const double k[6] = {along * c * c + s * s / along, 0, (along - 1 / along) * c * s, 1, 0,
                           along * s * s + c * c / along};
      struct isph_directions around = {.count = 0};
      double even[6] = {0}, found[6] = {0}, root[6], target[6], start[6];
      float shape[6];
      lattice(dimensions, &around, even);
      if (dimensions == 2) even[3] = 1;
      symmetric_root(k, root);
      symmetric_between(root, even, target);
      isph_shape_even(dimensions, k, start);
      isph_shape_find(dimensions, &around, target, start, shape);
      for (size_t m = 0; m < around.count; m++) {
        const double *n = around.n[m];
        double wide[6], weight;
        for (int l = 0; l < 6; l++) wide[l] = (double)shape[l];
        weight = around.weight[m] * exp(symmetric_along(wide, n));
        for (int a = 0, l = 0; a < 3; a++)
          for (int b = a; b < 3; b++, l++) found[l] += weight * n[a] * n[b];
      }
      for (int l = 0; l < 6; l++)
        if (dimensions == 3 || (l != 1 && l != 3 && l != 4)) near(found[l], target[l], 0.015);
      /* A moment that needs no weights changes none. */
      isph_shape_find(dimensions, &around, even, none, shape);
      for (int l = 0; l < 6; l++) near((double)shape[l], 0, 1e-6);
    }
}

#define BEDS                                                                                       \
  "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity = 0.4; permeability " \
  "= "

/* Between two walls the water goes along x, whatever way the beds lie: 1/k = (1/K)_xx. */
static void walls_turn_the_flow_along_them(void **state) {
  struct run run;
  double v[3];
  (void)state;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"0.2 m\", \"0.1 m\"]; spacing = \"1 cm\"; periodic = [true, false]; "
        "};\n"
        "regions = ( " BEDS "[\"1e-3 m/s\", \"1e-4 m/s\"]; bedding = [2.0, -1.0]; } );\n"
        "force = { body_acceleration = [\"9.80665 m/s^2\", \"0\"]; };\n"
        "isph = { wall = { slip = true; }; };\n");
  assert_true(run.s.on.anisotropy && run.s.anisotropy != NULL);
  advance(&run, 0.2);
  isph_darcy_velocity(&run.s, v);
  near(v[0], 1 / (.8 / 1e-3 + .2 / 1e-4), 0.01 * 3.57e-4);
  near(v[2], 0, 1e-6);
  finish(&run);
}

/* Round a periodic box v = K i, and soil of one permeability, in whatever way it is given, has none
 * of it. */
static void a_number_costs_nothing(void **state) {
  static const char *const soils[] = {"\"5e-4 m/s\"; }", "[\"5e-4 m/s\", \"5e-4 m/s\"]; }",
                                      "[\"4e-4 m/s\", \"1e-4 m/s\"]; }"};
  double v[3][3];
  (void)state;
  for (int k = 0; k < 3; k++) {
    struct run run;
    char text[1000];
    snprintf(text, sizeof text,
             "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
             "domain = { size = [\"0.2 m\", \"0.1 m\"]; spacing = \"1 cm\"; periodic = [true, "
             "true]; };\n"
             "regions = ( " BEDS "%s );\n"
             "force = { body_acceleration = [\"0.980665 m/s^2\", \"0.980665 m/s^2\"]; };\n",
             soils[k]);
    start(&run, text);
    assert_int_equal(run.s.on.anisotropy, k == 2);
    assert_true((run.s.anisotropy == NULL) == (k < 2) && (run.s.shape == NULL) == (k < 2));
    assert_true((run.s.chunks[0].plain == NULL) == (k < 2));
    advance(&run, 0.05);
    isph_darcy_velocity(&run.s, v[k]);
    finish(&run);
  }
  for (int a = 0; a < 3; a++) assert_true(v[0][a] == v[1][a]);
  near(v[2][0], 4e-5, 1e-3 * 4e-5);
  near(v[2][2], 1e-5, 1e-3 * 1e-5);
}

/* Beds that lie at an angle beside soil of one permeability: both share the gradient along the
 * interface and the flux across it, in closed form. */
static void beds_beside_other_soil(void **state) {
  struct run run;
  double v[3];
  (void)state;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"0.1 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [true, true]; "
        "};\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.2 m\"]; porosity = "
        "0.4; permeability = \"5e-4 m/s\"; },\n"
        "{ type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.1 m\"]; porosity = 0.4; "
        "permeability = [\"1e-3 m/s\", \"1e-4 m/s\"]; bedding = [2.0, -1.0]; } );\n"
        "force = { body_acceleration = [\"0\", \"9.80665 m/s^2\"]; };\n");
  advance(&run, 0.1);
  isph_darcy_velocity(&run.s, v);
  const double xz = -.4 * 9e-4, zz = .2 * 1e-3 + .8 * 1e-4, across = 1 / (.5 / 5e-4 + .5 / zz);
  near(v[2], across, 0.015 * across);
  near(v[0], .5 * xz / zz * across, 0.02 * across);
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tensors_have_roots_and_inverses), cmocka_unit_test(weights_have_the_moment),
      cmocka_unit_test(walls_turn_the_flow_along_them),  cmocka_unit_test(a_number_costs_nothing),
      cmocka_unit_test(beds_beside_other_soil),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
