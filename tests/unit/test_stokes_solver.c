/* Method stokes against exact solutions on hand-made lattices. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#include "common/memory.h"
#include "sphsolve/stokes/solver/step.h"

typedef double distance_function(const double at[3], double parameter);

/* Unit cube (or slab) of nx x ny x nz sites with an analytic wall distance. */
static void lattice_fill(struct lattice *lattice, const size_t size[3], double spacing,
                         distance_function *distance, double parameter) {
  memset(lattice, 0, sizeof *lattice);
  lattice->dimensions = 3;
  lattice->count = size[0] * size[1] * size[2];
  lattice->bulk_count = (double)lattice->count;
  for (int a = 0; a < 3; a++) lattice->size[a] = size[a], lattice->spacing[a] = spacing;
  assert_int_equal(memory_allocate(&lattice->kind, lattice->count, 1, "kind"), STATUS_OK);
  assert_int_equal(memory_allocate(&lattice->wall_distance, lattice->count, sizeof(float), "d"),
                   STATUS_OK);
  for (size_t s = 0; s < lattice->count; s++) {
    const size_t at[3] = {s % size[0], s / size[0] % size[1], s / size[0] / size[1]};
    const double x[3] = {((double)at[0] + 0.5) * spacing, ((double)at[1] + 0.5) * spacing,
                         ((double)at[2] + 0.5) * spacing};
    const double d = distance(x, parameter);
    lattice->wall_distance[s] = (float)d;
    lattice->kind[s] = d > 0.0 ? SITE_FLUID : SITE_WALL;
    if (d > 0.0)
      lattice->fluid_count++;
    else
      lattice->wall_count++;
  }
}

static void lattice_empty(struct lattice *lattice) {
  memory_free(&lattice->kind);
  memory_free(&lattice->wall_distance);
}

static double permeability(const size_t size[3], double spacing, distance_function *distance,
                           double parameter, enum wall_scheme wall) {
  struct lattice lattice;
  struct stokes_solver solver;
  const double driving[3] = {0.0, 0.0, -2.0};
  lattice_fill(&lattice, size, spacing, distance, parameter);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9 * spacing, wall, 1.0, driving, &solver),
                   STATUS_OK);
  assert_int_equal(stokes_solver_run(&solver, &(struct stokes_goal){.residual = 1e-5}), STATUS_OK);
  const double k = -solver.mean[2] * spacing * spacing;
  stokes_solver_free(&solver);
  lattice_empty(&lattice);
  return k;
}

/* Simple cubic spheres, one a unit cell, of volume fraction c. */
static double sphere_distance(const double at[3], double c) {
  const double radius = cbrt(0.75 * c / M_PI);
  double least = INFINITY;
  for (int i = 0; i < 27; i++) {
    const int image[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    double square = 0.0;
    for (int a = 0; a < 3; a++) square += pow(at[a] - 0.5 - image[a], 2);
    least = fmin(least, sqrt(square) - radius);
  }
  return least;
}

/* Zick, Homsy 1982 (drag K): k/a^2 = 2 / (9 c K); one per cent at 24 sites a side. */
static void test_spheres_within_one_per_cent(void **state) {
  (void)state;
  const double c = 0.216, drag = 7.4419, radius = cbrt(0.75 * c / M_PI);
  const size_t size[3] = {24, 24, 24};
  const double k = permeability(size, 1.0 / 24.0, sphere_distance, c, WALL_SUBVOXEL);
  assert_true(fabs(k / (radius * radius * 2.0 / (9.0 * c * drag)) - 1.0) < 0.01);
}

/* A ball so small that it holds back one site of a cube, as coarse lattices of felts have them. */
static double small_ball(const double at[3], double radius) {
  double square = 0.0;
  for (int a = 0; a < 3; a++) square += pow(at[a] - 0.53, 2);
  return sqrt(square) - radius;
}

/* Where nearly all is pore the memory meant for a site leaves a short Krylov basis: with one of 3
 * this does not converge. */
static void test_open_pores_converge(void **state) {
  (void)state;
  const size_t size[3] = {12, 12, 12};
  const struct scene scene = {.stokes.kernel = KERNEL_CUBIC};
  const double driving[3] = {0.0, 0.0, -2.0};
  for (double part = 0.38; part < 0.7; part += 0.04) { /* of a spacing */
    struct lattice lattice;
    struct stokes_solver solver;
    lattice_fill(&lattice, size, 1.0 / 12.0, small_ball, part / 12.0);
    assert_int_equal(lattice.wall_count, 1);
    assert_int_equal(
        stokes_solver_build(&lattice, &scene, 1.8 / 12.0, WALL_SUBVOXEL, 1.0, driving, &solver),
        STATUS_OK);
    assert_int_equal(stokes_solver_run(&solver, &(struct stokes_goal){.mean = 1e-3}), STATUS_OK);
    assert_true(solver.iterations <= 20);
    stokes_solver_free(&solver);
    lattice_empty(&lattice);
  }
}

/* Between planes w apart: k = w^3 / (12 L) for a period L = w + 3. `shift` moves the slit. */
#define SLIT_WIDTH 4.0
/* What cannot be solved any better is good enough where slack is given, and an error where not. */
static void test_no_progress(void **state) {
  (void)state;
  const size_t size[3] = {12, 12, 12};
  const struct scene scene = {.stokes.kernel = KERNEL_CUBIC};
  const double driving[3] = {0.0, 0.0, -2.0};
  const struct stokes_goal without = {.mean = -1.0}, with = {.mean = -1.0, .slack = 0.02};
  struct lattice lattice;
  struct stokes_solver solver;
  lattice_fill(&lattice, size, 1.0 / 12.0, small_ball, 0.5 / 12.0);
  assert_int_equal(
      stokes_solver_build(&lattice, &scene, 1.8 / 12.0, WALL_SUBVOXEL, 1.0, driving, &solver),
      STATUS_OK);
  assert_int_equal(stokes_solver_run(&solver, &without), STATUS_NUMERIC);
  assert_non_null(strstr(error_message(), "no progress"));
  error_clear();
  assert_int_equal(stokes_solver_run(&solver, &with), STATUS_OK);
  stokes_solver_free(&solver);
  lattice_empty(&lattice);
}

/* A round of a crop of Berea, from its solution before it was blurred: k was 2.3 times too large.
 */
static void test_chance_is_not_convergence(void **state) {
  (void)state;
  struct stokes_solver s = {.residual_before = 1.7, .residual_now = 0.297, .change = 0.00308};
  assert_true(stokes_solver_mean_error(&s) > 0.05);
  assert_false(stokes_solver_converged(&s, &(struct stokes_goal){.mean = 1e-3}));
  /* A later one of the same, whose flux is right to 5e-5. */
  s = (struct stokes_solver){
      .residual_before = 0.00488, .residual_now = 0.00117, .change = 0.00044};
  assert_true(stokes_solver_converged(&s, &(struct stokes_goal){.mean = 3e-4}));
}

static double slit_distance(const double at[3], double shift) {
  const double x = at[0] - shift;
  return x < SLIT_WIDTH ? fmin(x, SLIT_WIDTH - x) : -fmin(x - SLIT_WIDTH, 7.0 - x);
}
static double slit_shifted(const double at[3], double shift) {
  const double wrapped[3] = {at[0] < shift ? at[0] + 7.0 : at[0], at[1], at[2]};
  return slit_distance(wrapped, shift);
}

static void test_slit_at_any_shift(void **state) {
  (void)state;
  const size_t size[3] = {7, 1, 2}; /* narrower than the support: right by wrapping */
  const double exact = pow(SLIT_WIDTH, 3) / 12.0 / 7.0;
  for (double shift = 0.0; shift < 1.0; shift += 0.23) {
    const double k = permeability(size, 1.0, slit_shifted, shift, WALL_SUBVOXEL);
    assert_true(fabs(k / exact - 1.0) < 0.04);
  }
}

static void test_walls_of_a_slit(void **state) {
  (void)state;
  const size_t size[3] = {7, 1, 1};
  const double exact = pow(SLIT_WIDTH, 3) / 12.0 / 7.0;
  const double frozen = permeability(size, 1.0, slit_shifted, 0.0, WALL_FROZEN) / exact;
  const double adami = permeability(size, 1.0, slit_shifted, 0.0, WALL_ADAMI) / exact;
  const double subvoxel = permeability(size, 1.0, slit_shifted, 0.0, WALL_SUBVOXEL) / exact;
  assert_true(fabs(frozen - 1.934) < 0.01); /* exact lattice theory of the slit: +93.4 % */
  assert_true(fabs(adami - 1.147) < 0.005); /* +14.7 % */
  assert_true(fabs(subvoxel - 1.0) < 1e-5);
}

/* A pore closed along z carries nothing, whatever leads around in x. */
static double channel_along_x(const double at[3], double unused) {
  (void)unused;
  return at[2] > 3.0 && at[2] < 5.0 ? fmin(at[2] - 3.0, 5.0 - at[2]) : -1.0;
}

static void test_blocked_pores_are_left_out(void **state) {
  (void)state;
  struct lattice lattice;
  struct stokes_solver solver;
  const size_t size[3] = {4, 4, 8};
  const double along[3] = {1.0, 0.0, 0.0}, across[3] = {0.0, 0.0, 1.0};
  lattice_fill(&lattice, size, 1.0, channel_along_x, 0.0);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, across, &solver),
                   STATUS_OK);
  assert_int_equal(solver.grid.active, 0);
  stokes_solver_free(&solver);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, along, &solver),
                   STATUS_OK);
  assert_int_equal(solver.grid.active, 4 * 4 * 2);
  stokes_solver_free(&solver);
  lattice_empty(&lattice);
}

/* A throat one site wide: coarse, but k is positive and of the right size (0.4217 w^4 / 12). */
static double throat(const double at[3], double unused) {
  (void)unused;
  double d[2];
  for (int a = 0; a < 2; a++) d[a] = 0.5 - fabs(at[a] - 3.5);
  return d[0] < 0.0 && d[1] < 0.0 ? -hypot(d[0], d[1]) : fmin(d[0], d[1]);
}

static void test_throat_one_site_wide(void **state) {
  (void)state;
  const size_t size[3] = {7, 7, 4};
  const double k = permeability(size, 1.0, throat, 0.0, WALL_SUBVOXEL) * 49.0 / (0.421731 / 12.0);
  assert_true(k > 0.5 && k < 2.0);
}

static double no_wall(const double at[3], double unused) {
  (void)at, (void)unused;
  return 1.0;
}

static void test_no_wall_is_an_input_error(void **state) {
  (void)state;
  struct lattice lattice;
  struct stokes_solver solver;
  const size_t size[3] = {4, 4, 4};
  const double driving[3] = {0.0, 0.0, 1.0}, none[3] = {0.0};
  lattice_fill(&lattice, size, 1.0, no_wall, 0.0);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, driving, &solver),
                   STATUS_INPUT);
  assert_non_null(strstr(error_message(), "no wall"));
  error_clear();
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, none, &solver),
                   STATUS_INPUT);
  error_clear();
  lattice_empty(&lattice);
}

/* Eleven layers of water between walls, the upper one moving: v = U z / 11, also off the lattice.
 */
static double couette_distance(const double at[3], double shift) {
  return at[2] < 8.0 ? at[2] - 3.0 - shift : 14.0 - shift - at[2];
}

static void test_couette(void **state) {
  (void)state;
  struct region regions[2] = {{.type = REGION_WALL},
                              {.type = REGION_WALL, .velocity = {2.0, 0, 0}}};
  const struct scene scene = {.regions = regions, .region_count = 2};
  const size_t size[3] = {3, 2, 17};
  const double none[3] = {0.0};
  for (double shift = 0.0; shift < 1.0; shift += 0.3) {
    struct lattice lattice;
    struct stokes_solver solver;
    lattice_fill(&lattice, size, 1.0, couette_distance, shift);
    assert_int_equal(memory_allocate(&lattice.region, lattice.count, sizeof(uint16_t), "regions"),
                     STATUS_OK);
    for (size_t s = 0; s < lattice.count; s++)
      lattice.region[s] = lattice.kind[s] == SITE_WALL ? (s < lattice.count / 2 ? 1 : 2) : 0;
    assert_int_equal(stokes_solver_build(&lattice, &scene, 2.9, WALL_SUBVOXEL, 0.5, none, &solver),
                     STATUS_OK);
    assert_int_equal(stokes_solver_run(&solver, &(struct stokes_goal){.residual = 1e-6}),
                     STATUS_OK);
    const double gap = 11.0 - 2.0 * shift;
    assert_true(fabs(solver.mean[0] * solver.velocity_unit / (gap / 17.0) - 1.0) < 1e-4);
    assert_true(fabs(solver.mean[2] * solver.velocity_unit) < 1e-6);
    stokes_solver_free(&solver);
    memory_free(&lattice.region);
    lattice_empty(&lattice);
  }
}

static void test_bits_do_not_depend_on_threads(void **state) {
  (void)state;
  const size_t size[3] = {20, 20, 20};
  const int threads = omp_get_max_threads();
  double *first = NULL;
  size_t length = 0;
  for (int n = 1; n <= 2; n++) {
    struct lattice lattice;
    struct stokes_solver solver;
    const double driving[3] = {0.0, 1.0, 0.3};
    omp_set_num_threads(n);
    lattice_fill(&lattice, size, 0.05, sphere_distance, 0.3);
    assert_int_equal(
        stokes_solver_build(&lattice, NULL, 2.9 * 0.05, WALL_SUBVOXEL, 1.0, driving, &solver),
        STATUS_OK);
    assert_int_equal(solver.operator.threads, n); /* or the test would compare one with one */
    stokes_solver_round(&solver);
    if (first == NULL) {
      first = solver.x;
      solver.x = NULL;
      length = 4 * solver.grid.active;
    } else {
      assert_memory_equal(first, solver.x, length * sizeof *first);
    }
    stokes_solver_free(&solver);
    lattice_empty(&lattice);
  }
  memory_free(&first);
  omp_set_num_threads(threads);
}

/* Balls that are no mirror image of themselves within a box, in two that mirror each other in y. */
static double mirrored_balls(const double at[3], double radius) {
  const double y = at[1] < 1.0 ? at[1] : 2.0 - at[1];
  const double balls[2][3] = {{0.31, 0.23, 0.4}, {0.7, 0.71, 0.87}};
  double least = INFINITY;
  for (int b = 0; b < 2; b++)
    for (int i = 0; i < 18; i++) {
      const double image = i / 9 == 0 ? balls[b][1] : -balls[b][1];
      const double away[3] = {at[0] - balls[b][0] - (double)(i % 3 - 1), y - image,
                              at[2] - balls[b][2] - (double)(i / 3 % 3 - 1)};
      least = fmin(least, sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]) - radius);
    }
  return least;
}

/* A lattice that is mirrored in y is solved by half: the same flow from half the sites. */
static void test_half_along_y(void **state) {
  (void)state;
  const size_t size[3] = {14, 28, 14};
  const double driving[3] = {0.0, 0.0, -2.0};
  double k[2], across[2];
  size_t active[2];
  for (int half = 0; half < 2; half++) {
    struct lattice lattice;
    struct stokes_solver s;
    lattice_fill(&lattice, size, 1.0 / 14.0, mirrored_balls, 0.36);
    lattice.y_mirrored = half == 1;
    assert_int_equal(
        stokes_solver_build_half(&lattice, NULL, 2.9 / 14.0, WALL_SUBVOXEL, 1.0, driving, &s),
        STATUS_OK);
    assert_int_equal(stokes_solver_run(&s, &(struct stokes_goal){.residual = 1e-6}), STATUS_OK);
    assert_true(fabs(s.mean[1]) < 1e-4 * fabs(s.mean[2]));
    k[half] = -s.mean[2];
    across[half] = s.mean[0];
    active[half] = s.grid.active;
    stokes_solver_free(&s);
    lattice_empty(&lattice);
  }
  print_message("# mirrored in y: k %.9g, by half %.9g; across %.3g, %.3g of it\n", k[0], k[1],
                across[0] / k[0], across[1] / k[0]);
  assert_int_equal(active[0], 2 * active[1]);
  assert_true(fabs(k[1] / k[0] - 1.0) < 1e-5);
  assert_true(fabs(across[1] - across[0]) < 1e-5 * k[0]);
}

/* What drives still water is found without the sums over neighbours, to the same bits. */
static void test_right_side(void **state) {
  (void)state;
  const size_t size[3] = {20, 20, 20};
  const double driving[3] = {0.0, 1.0, 0.3};
  const enum wall_scheme walls[] = {WALL_SUBVOXEL, WALL_ADAMI};
  for (int w = 0; w < 2; w++) {
    struct lattice lattice;
    struct stokes_solver s;
    double *work = NULL;
    float *summed = NULL;
    lattice_fill(&lattice, size, 0.05, sphere_distance, 0.3);
    assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9 * 0.05, walls[w], 1.0, driving, &s),
                     STATUS_OK);
    const size_t n = s.grid.active;
    assert_int_equal(memory_allocate(&work, n, sizeof *work, "test"), STATUS_OK);
    assert_int_equal(memory_allocate(&summed, 4 * n, sizeof *summed, "test"), STATUS_OK);
    stokes_operator_residual(&s.operator, s.force, s.x, work, summed);
    stokes_operator_right_side(&s.operator, s.force, s.residual);
    for (size_t i = 0; i < 4 * n; i++) assert_true(summed[i] == s.residual[i]);
    assert_true(summed[n] != 0.0f);
    memory_free(&work);
    memory_free(&summed);
    stokes_solver_free(&s);
    lattice_empty(&lattice);
  }
}

/* Every instruction set against the sum written out, rows shorter than the support included. */
static void check_row_loops(double support) {
  const struct stokes_rows *sets[] = {&stokes_rows_base, &stokes_rows_avx2, stokes_rows_best()};
  const double spacing[3] = {1.0, 1.1, 0.9};
  static struct stokes_stencil stencil;
  static float field[25][64] __attribute__((aligned(64)));
  static float scratch[2048] __attribute__((aligned(64))), out[64] __attribute__((aligned(64)));
  assert_int_equal(stokes_stencil_build(3, spacing, KERNEL_QUINTIC, support, &stencil), STATUS_OK);
  const struct stokes_convolution *all[] = {&stencil.laplace, &stencil.gradient[0],
                                            &stencil.gradient[1], &stencil.gradient[2]};
  assert_true(stokes_rows_scratch(64) <= sizeof scratch / sizeof *scratch);
  for (size_t nx = 1; nx <= 64; nx += 7)
    for (size_t set = __builtin_cpu_supports("avx2") ? 0 : 2; set < 3; set++)
      for (int which = 0; which < 4; which++) {
        const float *rows[STOKES_CLASS_MAX][4];
        const size_t stride = (nx + STOKES_LANES - 1) / STOKES_LANES * STOKES_LANES;
        for (size_t r = 0; r < 25; r++)
          for (size_t i = 0; i < 64; i++)
            field[r][i] = i < nx ? sinf((float)(r * 64 + i * i)) : 0.0f;
        for (int c = 0; c < all[which]->class_count; c++)
          for (int r = 0; r < all[which]->classes[c].row_count; r++)
            rows[c][r] =
                field[(all[which]->classes[c].dk[r] + 2) * 5 + all[which]->classes[c].dj[r] + 2];
        sets[set]->convolve(all[which], (const float *const(*)[4])rows, nx, stride, scratch, out);
        for (size_t i = 0; i < nx; i++) {
          double sum = 0.0;
          for (int o = 0; o < stencil.offset_count; o++) {
            const struct stokes_offset *offset = &stencil.offsets[o];
            const double value = which == 0 ? offset->viscous : offset->gradient[which - 1];
            const size_t x = (i + 4 * nx + (size_t)(offset->step[0] + 4) - 4) % nx;
            sum += value * (double)field[(offset->step[2] + 2) * 5 + offset->step[1] + 2][x];
          }
          assert_true(fabs(sum - (double)out[i]) < 1e-5);
        }
      }
  stokes_stencil_free(&stencil);
}

/* With neighbours one and two sites off, each of which has loops of its own. */
static void test_row_loops(void **state) {
  (void)state;
  check_row_loops(1.7);
  check_row_loops(2.7);
}

/* Every pattern of pores there is, against the loop written out. */
static void test_pores_are_packed(void **state) {
  (void)state;
  const struct stokes_rows *sets[] = {&stokes_rows_base, &stokes_rows_avx2, stokes_rows_best()};
  float row[2 * STOKES_LANES] __attribute__((aligned(64))),
      back[2 * STOKES_LANES] __attribute__((aligned(64)));
  for (size_t set = __builtin_cpu_supports("avx2") ? 0 : 2; set < 3; set++)
    for (unsigned bits = 0; bits < 65536; bits++) {
      const uint16_t mask[2] = {(uint16_t)bits, (uint16_t)(65535 - bits / 3)};
      float wanted[2 * STOKES_LANES], packed[2 * STOKES_LANES];
      size_t count = 0;
      for (size_t i = 0; i < 2 * STOKES_LANES; i++) {
        row[i] = (float)i + 1.0f;
        if (mask[i / STOKES_LANES] >> i % STOKES_LANES & 1) wanted[count++] = row[i];
      }
      assert_int_equal(sets[set]->pack(mask, 2, row, packed), count);
      assert_memory_equal(packed, wanted, count * sizeof *packed);
      /* from where nothing follows */
      float *own = NULL;
      assert_int_equal(memory_allocate(&own, count, sizeof *own, "a test"), STATUS_OK);
      if (count > 0) memcpy(own, wanted, count * sizeof *own);
      assert_int_equal(sets[set]->unpack(mask, 2, own, back), count);
      for (size_t i = 0; i < 2 * STOKES_LANES; i++)
        if (!(mask[i / STOKES_LANES] >> i % STOKES_LANES & 1)) row[i] = 0.0f;
      assert_memory_equal(back, row, sizeof row);
      memory_free(&own);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_spheres_within_one_per_cent),
      cmocka_unit_test(test_open_pores_converge),
      cmocka_unit_test(test_no_progress),
      cmocka_unit_test(test_chance_is_not_convergence),
      cmocka_unit_test(test_slit_at_any_shift),
      cmocka_unit_test(test_walls_of_a_slit),
      cmocka_unit_test(test_couette),
      cmocka_unit_test(test_bits_do_not_depend_on_threads),
      cmocka_unit_test(test_half_along_y),
      cmocka_unit_test(test_right_side),
      cmocka_unit_test(test_row_loops),
      cmocka_unit_test(test_pores_are_packed),
      cmocka_unit_test(test_throat_one_site_wide),
      cmocka_unit_test(test_blocked_pores_are_left_out),
      cmocka_unit_test(test_no_wall_is_an_input_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
