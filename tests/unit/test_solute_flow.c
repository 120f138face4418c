/* The flow that carries a solute: what walls leave of cells and faces, fluxes that add up. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "sphsolve/solute/flow.h"

static void assert_near(double value, double expected, double within) {
  if (!(fabs(value - expected) <= within)) fail_msg("%.7g, not %.7g", value, expected);
}

struct slit {
  double low, high; /* m, between the walls, normal to x */
};

static double slit_distance(const void *context, const double x[3]) {
  const struct slit *s = context;
  return fmin(x[0] - s->low, s->high - x[0]);
}

static void slit_velocity(const void *context, const double x[3], double u[3]) {
  const struct slit *s = context;
  const double gap = s->high - s->low;
  u[0] = u[1] = 0;
  u[2] = 6 * (x[0] - s->low) * (s->high - x[0]) / (gap * gap); /* mean 1 */
}

struct ball {
  double centre[3], radius;
};

static double ball_distance(const void *context, const double x[3]) {
  const struct ball *b = context;
  double square = 0;
  for (int a = 0; a < 3; a++) square += pow(x[a] - b->centre[a], 2);
  return sqrt(square) - b->radius;
}

/* Uniform flow, which walls and the projection bend around the ball. */
static void uniform(const void *context, const double x[3], double u[3]) {
  (void)context, (void)x;
  u[0] = 0.3, u[1] = -0.2, u[2] = 1;
}

/* Largest difference of what flows into a cell and out of it, over the largest flux. */
static double largest_divergence(const struct solute_flow *f) {
  double largest = 0, flux = 0;
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const int x[3] = {i, j, k};
        double sum = 0;
        for (int a = 0; a < 3; a++) {
          int up[3] = {i, j, k};
          up[a] = (x[a] + 1) % f->n[a];
          const size_t at = ((size_t)k * (size_t)f->n[1] + (size_t)j) * (size_t)f->n[0] + (size_t)i;
          const size_t next =
              ((size_t)up[2] * (size_t)f->n[1] + (size_t)up[1]) * (size_t)f->n[0] + (size_t)up[0];
          sum += ((double)f->velocity[a][next] - (double)f->velocity[a][at]) / f->spacing[a];
          flux = fmax(flux, fabs((double)f->velocity[a][at]) / f->spacing[a]);
        }
        largest = fmax(largest, fabs(sum));
      }
  return largest / flux;
}

static void slit_between_sites(void **state) {
  (void)state;
  const int n[3] = {16, 1, 4};
  const double h[3] = {1e-5, 1e-5, 1e-5};
  const struct slit slit = {1.27e-5, 12.81e-5};
  struct solute_flow f;
  assert_int_equal(solute_flow_build(n, h, slit_distance, slit_velocity, &slit, &f), STATUS_OK);
  assert_near(f.porosity, (slit.high - slit.low) / 16e-5, 1e-5);
  assert_near(f.mean_velocity[2], 1, 0.01);
  assert_near(f.mean_velocity[0], 0, 1e-6);
  assert_near((double)f.aperture[2][1], 0.73, 1e-4);
  assert_near((double)f.volume[1], 0.73, 2e-3);
  assert_true(f.dimensions == 2);
  assert_true(largest_divergence(&f) < 1e-6);
  solute_flow_free(&f);
}

static void ball_in_a_box(void **state) {
  (void)state;
  const int n[3] = {16, 16, 16};
  const double h[3] = {1.0 / 16, 1.0 / 16, 1.0 / 16};
  const struct ball ball = {{0.51, 0.48, 0.5}, 0.3};
  struct solute_flow f, coarse;
  assert_int_equal(solute_flow_build(n, h, ball_distance, uniform, &ball, &f), STATUS_OK);
  const double solid = 4.0 / 3.0 * 3.14159265358979 * pow(ball.radius, 3);
  assert_near(1 - f.porosity, solid, 2e-3 * solid);
  assert_near(f.grain_size, 0.6, 0.02);
  assert_true(largest_divergence(&f) < 2e-6);
  assert_true(f.correction > 0.01 && f.correction < 0.5);
  assert_int_equal(solute_flow_coarsen(&f, &coarse), STATUS_OK);
  assert_int_equal(coarse.n[2], 8);
  assert_near(coarse.porosity, f.porosity, 1e-6);
  for (int a = 0; a < 3; a++) assert_near(coarse.mean_velocity[a], f.mean_velocity[a], 1e-6);
  assert_true(largest_divergence(&coarse) < 2e-6);
  solute_flow_free(&coarse);
  solute_flow_free(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(slit_between_sites),
                                     cmocka_unit_test(ball_in_a_box)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
