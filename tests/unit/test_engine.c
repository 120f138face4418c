/* The engine against brute force, against itself on other threads and instruction sets. */
#include "sphsolve/wcsph/engine/engine.h"

#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "common/kernel.h"
#include "common/threads.h"
#include "sphsolve/wcsph/kernels/quintic.h"
/* The second kernel's forms have the same names. */
#undef KERNEL_NAME
#undef KERNEL_AT_0
#define kernel_vector_w wendland_w
#define kernel_vector_slope wendland_slope
#include "sphsolve/wcsph/kernels/wendland.h"
#undef kernel_vector_w
#undef kernel_vector_slope
#include "tests/unit/engine_lattice.h"

static void test_kernel_matches(void **state) {
  (void)state;
  for (int i = 0; i < 4000; i++) {
    float s = (float)i * 0.001f, w[SIMD_WIDTH], slope[SIMD_WIDTH];
    vec_store(w, kernel_vector_w(vec_set(s)));
    vec_store(slope, kernel_vector_slope(vec_set(s)));
    double alpha = 1 / (120 * M_PI);
    assert_true(fabs(alpha * (double)w[0] - kernel_w(KERNEL_QUINTIC, 3, (double)s, 1)) < 5e-7);
    assert_true(fabs(-5 * alpha * (double)slope[0] - kernel_dw(KERNEL_QUINTIC, 3, (double)s, 1)) <
                1e-6);
    vec_store(w, wendland_w(vec_set(s)));
    vec_store(slope, wendland_slope(vec_set(s)));
    alpha = 21 / (16 * M_PI);
    assert_true(fabs(alpha * (double)w[0] - kernel_w(KERNEL_WENDLAND, 3, (double)s, 1)) < 5e-7);
    assert_true(fabs(-5 * alpha * (double)slope[0] - kernel_dw(KERNEL_WENDLAND, 3, (double)s, 1)) <
                1e-6);
  }
}

/* Sum of the kernel and number of neighbours by brute force over images. */
static void brute_force(const struct engine *engine, size_t slot, double *sum, uint64_t *pairs) {
  const struct lattice *lattice = engine->lattice;
  const struct particles *p = &engine->particles;
  double support = engine->settings.support, at[3], other[3], length[3];
  int images[3];
  for (int a = 0; a < 3; a++) {
    length[a] = lattice->spacing[a] * (double)lattice->size[a];
    images[a] = lattice->dimensions == 2 && a == 1 ? 0 : (int)ceil(support / length[a]) + 1;
  }
  particles_position(p, lattice, slot, at);
  *sum = 0;
  *pairs = 0;
  size_t fluid = particles_slots(p), all = fluid + lattice->count;
  for (size_t j = 0; j < all; j++) {
    if (j < fluid) {
      if (p->id[j] == NO_PARTICLE) continue;
      particles_position(p, lattice, j, other);
    } else {
      size_t site = j - fluid;
      if (lattice->kind[site] != SITE_WALL) continue;
      size_t index[3] = {site % lattice->size[0], site / lattice->size[0] % lattice->size[1],
                         site / (lattice->size[0] * lattice->size[1])};
      for (int a = 0; a < 3; a++) other[a] = (double)index[a] * lattice->spacing[a];
    }
    for (int k = -images[2]; k <= images[2]; k++) {
      const double z = other[2] + k * length[2] - at[2];
      for (int l = -images[1]; l <= images[1] && fabs(z) < support; l++) {
        const double y = other[1] + l * length[1] - at[1];
        for (int i = -images[0]; i <= images[0] && fabs(y) < support; i++) {
          const double x = other[0] + i * length[0] - at[0], r = sqrt(x * x + y * y + z * z);
          if (r >= support) continue;
          *sum += kernel_w(engine->settings.kernel, lattice->dimensions, r,
                           engine->settings.smoothing_length);
          *pairs += 1;
        }
      }
    }
  }
  *pairs -= 1;
}

static void compare_densities_of(enum kernel kernel, struct lattice *lattice, double support,
                                 double jitter) {
  struct engine_settings settings = test_settings_of(kernel, lattice, PASS_FROZEN, support);
  struct engine engine;
  uint64_t seed = 7, pairs_all = 0;
  settings.sound_speed = 1;
  settings.dt = 1e-12;
  assert_int_equal(engine_make(lattice, &settings, &engine), STATUS_OK);
  struct particles *p = &engine.particles;
  for (size_t i = 0; i < particles_slots(p); i++)
    for (int a = 0; a < 3; a++)
      p->x[a][i] +=
          (uint32_t)(int32_t)((double)p->frame.step[a] * jitter * (test_random(&seed) - 0.5));
  assert_int_equal(engine_step(&engine), STATUS_OK);
  double volume = lattice->spacing[0] * lattice->spacing[2] *
                  (lattice->dimensions == 3 ? lattice->spacing[1] : 1);
  size_t seen = 0;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    double sum;
    uint64_t pairs;
    brute_force(&engine, i, &sum, &pairs);
    pairs_all += pairs;
    assert_true(fabs(engine_density(&engine, i) / (volume * sum) - 1) < 3e-6);
    seen++;
  }
  assert_int_equal(seen, lattice->fluid_count);
  /* A pair at the very edge of the support may fall on either side in single precision. */
  assert_true(fabs((double)engine.pairs_fluid - (double)pairs_all) <= 1e-4 * (double)pairs_all + 2);
  engine_free(&engine);
}

static void compare_densities(struct lattice *lattice, double support, double jitter) {
  compare_densities_of(KERNEL_QUINTIC, lattice, support, jitter);
}

static void test_neighbours_wide(void **state) {
  (void)state;
  struct lattice lattice = test_grains(15, 1e-3, 0.45, 5);
  compare_densities(&lattice, 2.9e-3, 0.9);
  compare_densities_of(KERNEL_WENDLAND, &lattice, 2.9e-3, 0.9);
  test_lattice_free(&lattice);
}
static void test_neighbours_narrow(void **state) {
  (void)state;
  size_t sizes[][3] = {{1, 1, 9}, {2, 3, 30}, {5, 4, 6}, {40, 2, 2}};
  for (size_t s = 0; s < 4; s++) {
    struct lattice lattice = test_lattice(3, sizes[s][0], sizes[s][1], sizes[s][2], 1, 1, 1);
    compare_densities(&lattice, 2.9, 0.8);
    test_lattice_free(&lattice);
  }
}
static void test_neighbours_anisotropic(void **state) {
  (void)state;
  struct lattice lattice = test_lattice(3, 9, 14, 7, 1.0, 0.8, 1.3);
  for (size_t i = 0; i < lattice.count; i += 3) lattice.kind[i] = SITE_WALL;
  test_recount(&lattice);
  compare_densities(&lattice, 2.9, 0.7);
  test_lattice_free(&lattice);
}
static void test_neighbours_flat(void **state) {
  (void)state;
  struct lattice lattice = test_slit(20, 0.5, 0.01);
  compare_densities(&lattice, 0.029, 0.8);
  test_lattice_free(&lattice);
}

/* Puts `value` wherever no particle stands. */
static void fill_empty(const struct particles *p, float value) {
  for (size_t i = 0; i < p->capacity; i++) {
    if (i < particles_slots(p) && p->id[i] != NO_PARTICLE) continue;
    for (int a = 0; a < 3; a++) {
      p->v[a][i] = p->v_next[a][i] = value;
      p->x[a][i] = (uint32_t)i * 2654435769u;
      if (p->shift[a] != NULL) p->shift[a][i] = value;
    }
    p->state[i] = value;
  }
}

static float empty; /* what stands there after each step of a march; 0: what the engine left */

/* Marches a sand model and leaves velocities and positions by id. */
static void march(enum pass_wall wall, int threads, const char *isa, int steps, size_t n,
                  float (*v)[3], uint32_t (*x)[3]) {
  struct lattice lattice = test_grains(n, 46e-6, 0.45, 11);
  struct engine_settings settings = test_settings(&lattice, wall, 2.9 * 46e-6);
  struct engine engine;
  settings.sound_speed = 1.5;
  settings.dt = 2e-5;
  settings.kinematic_viscosity = 1e-6;
  settings.pressure_diffusion = WCSPH_STABILISATION * 46e-6 * 46e-6 / 1e-6 * 2.25;
  settings.force[2] = -2000;
  if (isa != NULL) setenv("TOSUI_ISA", isa, 1);
  threads_use(threads);
  assert_int_equal(engine_make(&lattice, &settings, &engine), STATUS_OK);
  unsetenv("TOSUI_ISA");
  for (int s = 0; s < steps; s++) {
    assert_int_equal(engine_step(&engine), STATUS_OK);
    if (empty != 0) fill_empty(&engine.particles, empty);
  }
  assert_true(engine.rebuilds > 1);
  const struct particles *p = &engine.particles;
  memset(v, 0, lattice.count * sizeof *v);
  memset(x, 0, lattice.count * sizeof *x);
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    for (int a = 0; a < 3; a++) {
      v[p->id[i]][a] = p->v[a][i];
      x[p->id[i]][a] = p->x[a][i];
    }
  }
  engine_free(&engine);
  test_lattice_free(&lattice);
  threads_use(0);
  omp_set_num_threads(1);
}

#define SIDE 12
#define SITES (SIDE * SIDE * (SIDE + 1))

/* Marches of every wall on 1 to `threads` threads, with `value` where no particle stands, end as
 * the march on one thread does. */
static void march_as_one_thread(int threads, float value) {
  static float v[2][SITES][3];
  static uint32_t x[2][SITES][3];
  enum pass_wall walls[] = {PASS_FROZEN, PASS_ADAMI, PASS_SUBVOXEL};
  for (int w = 0; w < 3; w++) {
    empty = 0;
    march(walls[w], 1, NULL, 24, SIDE, v[0], x[0]);
    empty = value;
    for (int n = value != 0 ? 1 : 2; n <= threads; n++) {
      march(walls[w], n, NULL, 24, SIDE, v[1], x[1]);
      assert_memory_equal(v[0], v[1], sizeof v[0]);
      assert_memory_equal(x[0], x[1], sizeof x[0]);
    }
  }
  empty = 0;
}

static void test_threads_change_no_bit(void **state) {
  (void)state;
  march_as_one_thread(3, 0);
}

/* A resumed run does not know what stood in slots without a particle. */
static void test_empty_slots_change_no_bit(void **state) {
  (void)state;
  march_as_one_thread(1, 5); /* m/s: more than any particle's */
}

/* AVX2 and AVX-512 give the same bits; the baseline has no fused operations. (`make check` alone
 * builds one of them, for this machine.) */
static void test_instruction_sets_agree(void **state) {
  (void)state;
  static float v[2][SITES][3];
  static uint32_t x[2][SITES][3];
  const char *names[] = {"avx2", "baseline"};
  const struct pair_table *widest;
  assert_int_equal(pair_table_choose(KERNEL_QUINTIC, &widest), STATUS_OK);
  enum pass_wall walls[] = {PASS_FROZEN, PASS_ADAMI, PASS_SUBVOXEL};
  for (int w = 0; w < 3; w++) {
    march(walls[w], 1, NULL, 20, SIDE, v[0], x[0]);
    for (int n = 0; n < 2; n++) {
      if (strcmp(widest->name, "baseline") == 0 && n == 0) continue;
      if (!pair_isa_is_built(names[n])) continue;
      march(walls[w], 1, names[n], 20, SIDE, v[1], x[1]);
      if (n == 0) {
        assert_memory_equal(v[0], v[1], sizeof v[0]);
        assert_memory_equal(x[0], x[1], sizeof x[0]);
        continue;
      }
      double square = 0, differ = 0;
      for (size_t i = 0; i < SITES; i++)
        for (int a = 0; a < 3; a++) {
          double d = (double)v[0][i][a] - (double)v[1][i][a];
          square += (double)v[0][i][a] * (double)v[0][i][a];
          differ += d * d;
        }
      assert_true(sqrt(differ / square) < 2e-4);
    }
  }
}

int main(void) {
  omp_set_num_threads(1);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_kernel_matches),
      cmocka_unit_test(test_neighbours_wide),
      cmocka_unit_test(test_neighbours_narrow),
      cmocka_unit_test(test_neighbours_anisotropic),
      cmocka_unit_test(test_neighbours_flat),
      cmocka_unit_test(test_threads_change_no_bit),
      cmocka_unit_test(test_instruction_sets_agree),
      cmocka_unit_test(test_empty_slots_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
