/* Speed of the engine. Time is that of the processor, so that other work on the machine disturbs
 * little; threads are compared by the wall clock.
 *   bench_engine OUT.json [LARGEST]   the suite, up to LARGEST sites (1e7)
 *   bench_engine count WALL VISCOSITY DIFFUSION SHIFT MOVING    a small run for
 * scripts/count-effects */
#include <immintrin.h>
#include <jansson.h>
#include <omp.h>
#include <stdio.h>
#include <time.h>

#include "common/log.h"
#include "common/memory.h"
#include "tests/unit/engine_lattice.h"

#define DX 46.64e-6
/* Operations of a pair as the goals count them: summed density 40, forces 60. */
#define FLOP_DENSITY 40.0
#define FLOP_FORCE 60.0

static double cpu_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct engine_settings settings_of(const struct lattice *lattice, enum pass_wall wall) {
  struct engine_settings settings = test_settings(lattice, wall, 2.893 * DX);
  settings.sound_speed = 1.5;
  settings.dt = 2.5e-5;
  settings.kinematic_viscosity = 1e-6;
  settings.force[2] = -9.8;
  settings.pressure_diffusion =
      (wall == PASS_EULERIAN ? WCSPH_STABILISATION_EULERIAN : WCSPH_STABILISATION) * DX * DX /
      1e-6 * 2.25;
  return settings;
}

struct measure {
  double step;  /* CPU s per step, lists not counted */
  double wall;  /* s per step by the clock */
  double lists; /* CPU s per making of the lists */
  double pairs; /* directed pairs per CPU second */
  double flops;
  double bytes; /* per fluid particle, lists included */
  size_t fluid;
};

static enum status measure_run(const struct lattice *lattice, enum pass_wall wall, int steps,
                               struct measure *measure) {
  enum status status = STATUS_OK;
  struct engine engine = {0};
  struct engine_settings settings = settings_of(lattice, wall);
  TRY(engine_make(lattice, &settings, &engine));
  TRY(engine_step(&engine)); /* makes the lists */
  double pairs = engine.pair_interactions, best = INFINITY, best_wall = INFINITY;
  for (int s = 0; s < steps; s++) {
    double cpu = cpu_seconds(), clock = clock_seconds();
    uint64_t rebuilds = engine.rebuilds;
    TRY(engine_step(&engine));
    if (engine.rebuilds > rebuilds) continue;
    best = fmin(best, cpu_seconds() - cpu);
    best_wall = fmin(best_wall, clock_seconds() - clock);
  }
  double start = cpu_seconds();
  if (wall != PASS_EULERIAN) { /* whose lists are made once */
    engine.moved = INFINITY;   /* orders the particles anew, too */
    engine.listed = false;
    TRY(engine_step(&engine));
  }
  measure->lists = cpu_seconds() - start - best;
  measure->step = best;
  measure->wall = best_wall;
  measure->pairs = pairs / best;
  double fluid = (double)engine.pairs_fluid;
  measure->flops = (wall == PASS_FROZEN ? FLOP_DENSITY * (pairs - fluid) + FLOP_FORCE * fluid
                                        : FLOP_FORCE * pairs) /
                   best;
  measure->fluid = engine.particles.count;
  measure->bytes =
      (double)(neighbours_bytes(&engine.fluid_fluid) + neighbours_bytes(&engine.fluid_wall) +
               engine.particles.capacity * particles_bytes_fluid(&engine.fields)) /
      (double)engine.particles.count;
cleanup:
  engine_free(&engine);
  return status;
}

/* Share of the processor's time in a flow from rest that goes to the lists and to each pass. */
static enum status measure_shares(const struct lattice *lattice, enum pass_wall wall,
                                  double gravity, int steps, double share[PHASE_COUNT]) {
  enum status status = STATUS_OK;
  struct engine engine = {0};
  struct engine_settings settings = settings_of(lattice, wall);
  double all = 0;
  settings.force[2] = -gravity;
  TRY(engine_make(lattice, &settings, &engine));
  for (int s = 0; s < steps; s++) TRY(engine_step(&engine));
  for (int p = 0; p < PHASE_COUNT; p++) all += engine.seconds[p];
  for (int p = 0; p < PHASE_COUNT; p++) share[p] = engine.seconds[p] / all;
cleanup:
  engine_free(&engine);
  return status;
}

/* Peaks of this machine, one core: fused operations in registers, and copying beyond the cache. */
__attribute__((target("avx512f"))) static double fused_avx512(size_t n) {
  __m512 a[12], m = _mm512_set1_ps(0.999f), c = _mm512_set1_ps(1e-3f);
  for (int i = 0; i < 12; i++) a[i] = _mm512_set1_ps((float)i);
  for (size_t k = 0; k < n; k++)
    for (int i = 0; i < 12; i++) a[i] = _mm512_fmadd_ps(a[i], m, c);
  float sum = 0;
  for (int i = 0; i < 12; i++) sum += _mm512_reduce_add_ps(a[i]);
  return (double)sum;
}
__attribute__((target("avx2,fma"))) static double fused_avx2(size_t n) {
  __m256 a[12], m = _mm256_set1_ps(0.999f), c = _mm256_set1_ps(1e-3f);
  for (int i = 0; i < 12; i++) a[i] = _mm256_set1_ps((float)i);
  for (size_t k = 0; k < n; k++)
    for (int i = 0; i < 12; i++) a[i] = _mm256_fmadd_ps(a[i], m, c);
  float lanes[8];
  _mm256_storeu_ps(lanes, a[0]);
  for (int i = 1; i < 12; i++) a[0] = _mm256_add_ps(a[0], a[i]);
  return (double)lanes[0];
}

static double peak_flops(const char *isa) {
  bool wide = strcmp(isa, "avx512") == 0;
  const size_t n = 4000000;
  volatile double sink = 0;
  double best = INFINITY;
  if (strcmp(isa, "baseline") == 0) return NAN;
  for (int repeat = 0; repeat < 5; repeat++) {
    double start = cpu_seconds();
    sink = sink + (wide ? fused_avx512(n) : fused_avx2(n));
    best = fmin(best, cpu_seconds() - start);
  }
  return 2.0 * 12 * (wide ? 16 : 8) * (double)n / best;
}

static double peak_bytes(void) {
  const size_t n = (size_t)1 << 27;
  char *a = malloc(n), *b = malloc(n);
  double best = INFINITY;
  memset(a, 1, n);
  memset(b, 2, n);
  for (int repeat = 0; repeat < 4; repeat++) {
    double start = cpu_seconds();
    memcpy(b, a, n);
    best = fmin(best, cpu_seconds() - start);
    a[repeat] = b[n - 1];
  }
  free(a);
  free(b);
  return 2.0 * (double)n / best;
}

static void add(json_t *results, const char *name, const char *unit, double measured, double bound,
                bool least, double seconds) {
  bool pass = isnan(bound) || (least ? measured >= bound : measured <= bound);
  printf("%-44s %12.4g %-8s %s%.4g%s\n", name, measured, unit,
         isnan(bound) ? ""
         : least      ? ">= "
                      : "<= ",
         isnan(bound) ? 0.0 : bound, pass ? "" : "   missed");
  json_array_append_new(results, json_pack("{s:s, s:s, s:s, s:o, s:f, s:o, s:f}", "case", name,
                                           "unit", unit, "status", pass ? "pass" : "fail",
                                           "reference", json_null(), "measured", measured, "bound",
                                           isnan(bound) ? json_null() : json_real(bound), "seconds",
                                           seconds));
}

static enum status suite(const char *path, double largest) {
  enum status status = STATUS_OK;
  json_t *results = json_array();
  struct lattice lattice = {0};
  struct measure m = {0}, two = {0};
  const struct pair_table *table;
  double first = NAN, worst = 1, start = clock_seconds(), shares[PHASE_COUNT];
  static const char *const phases[PHASE_COUNT] = {
      "density", "wall distance", "forces", "continuity", "drift", "lists", "budget"};
  omp_set_num_threads(1);
  TRY(pair_table_choose(KERNEL_QUINTIC, &table));
  double flops = peak_flops(table->name), bytes = peak_bytes();
  printf("instruction set %s\n", table->name);
  add(results, "peak: fused operations, one core", "flop/s", flops, NAN, true, 0);
  add(results, "peak: copying, one core", "B/s", bytes, NAN, true, 0);

  lattice = test_grains(60, DX, 0.58, 3);
  TRY(measure_run(&lattice, PASS_FROZEN, 12, &m));
  add(results, "S06 size, frozen: pairs per second and core", "1/s", m.pairs, 400e6, true, m.step);
  add(results, "S06 size, frozen: step on one core", "s", m.step, 0.055, false, m.step);
  add(results, "S06 size, frozen: making the lists", "s", m.lists, NAN, false, m.lists);
  add(results, "S06 size, frozen: share of peak flops", "1", m.flops / flops, NAN, true, m.step);
  for (int g = 1; g <= 10; g += 9) {
    char name[64];
    TRY(measure_shares(&lattice, PASS_FROZEN, 9.8 * g, 100, shares));
    snprintf(name, sizeof name, "S06 size, frozen, %d G: share of time of lists", g);
    add(results, name, "1", shares[PHASE_LISTS], g == 1 ? 0.1 : NAN, false, 0);
  }
  TRY(measure_shares(&lattice, PASS_SUBVOXEL, 9.8, 30, shares));
  for (int p = 0; p < PHASE_COUNT; p++) {
    char name[64];
    if (shares[p] == 0) continue;
    snprintf(name, sizeof name, "S06 size, subvoxel, 1 G: share of time of %s", phases[p]);
    add(results, name, "1", shares[p], NAN, false, 0);
  }
  TRY(measure_run(&lattice, PASS_SUBVOXEL, 12, &m));
  add(results, "S06 size, subvoxel: pairs per second and core", "1/s", m.pairs, 400e6, true,
      m.step);
  add(results, "S06 size, subvoxel: step on one core", "s", m.step, 0.055, false, m.step);
  add(results, "S06 size, subvoxel: share of peak flops", "1", m.flops / flops, NAN, true, m.step);
  add(results, "S06 size, subvoxel: bytes per fluid particle", "B", m.bytes, 100, false, 0);
  /* Arithmetic intensity: each pass reads the particles once from memory, the rest is cache. */
  add(results, "S06 size, subvoxel: operations per byte", "flop/B",
      m.flops * m.step / (2 * m.bytes * (double)m.fluid), NAN, true, 0);
  TRY(measure_run(&lattice, PASS_EULERIAN, 12, &two));
  add(results, "S06 size, Eulerian: pairs per second and core", "1/s", two.pairs, NAN, true,
      two.step);
  add(results, "S06 size, Eulerian: step on one core", "s", two.step, 0.055, false, two.step);
  add(results, "S06 size, Eulerian: bytes per fluid particle", "B", two.bytes, 100, false, 0);
  omp_set_num_threads(2);
  TRY(measure_run(&lattice, PASS_SUBVOXEL, 12, &two));
  add(results, "two threads: efficiency by the clock", "1", m.wall / (2 * two.wall), 0.95, true, 0);
  omp_set_num_threads(1);
  test_lattice_free(&lattice);

  for (double sites = 1e4; sites <= largest; sites *= 10) {
    char name[64];
    lattice = test_grains((size_t)cbrt(sites), DX, 0.58, 3);
    TRY(measure_run(&lattice, PASS_SUBVOXEL, sites > 2e6 ? 2 : 8, &m));
    double cost = m.step / (double)m.fluid;
    test_lattice_free(&lattice);
    if (isnan(first)) first = cost;
    worst = fmax(worst, cost / first);
    snprintf(name, sizeof name, "%.0e sites: cost per particle and step", sites);
    add(results, name, "s", cost, NAN, false, m.step);
  }
  add(results, "dearest size over 1e4 sites", "1", worst, 1.2, false, clock_seconds() - start);
  if (json_dump_file(results, path, JSON_INDENT(1)) != 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written", path);
cleanup:
  json_decref(results);
  return status;
}

/* A fixed run for counting the instructions of engine_step: prints its pairs and the bytes per slot
 * of fluid and wall. `moving`: the grains glide along x. */
static enum status count(enum pass_wall wall, bool viscosity, bool diffusion, bool shift,
                         bool moving) {
  enum status status = STATUS_OK;
  struct engine engine = {0};
  struct lattice lattice = test_grains(12, DX, 0.58, 3);
  struct engine_settings settings = settings_of(&lattice, wall);
  const double velocity[1][3] = {{1e-3, 0, 0}};
  lattice.region = calloc(lattice.count, sizeof *lattice.region);
  for (size_t i = 0; i < lattice.count; i++) lattice.region[i] = lattice.kind[i] == SITE_WALL;
  settings.viscous = viscosity;
  settings.diffusion = diffusion;
  settings.shift = shift;
  settings.wall_moves = moving;
  settings.region_velocity = velocity;
  settings.region_count = 1;
  omp_set_num_threads(1);
  TRY(engine_make(&lattice, &settings, &engine));
  for (int s = 0; s < 3; s++) TRY(engine_step(&engine));
  printf("%.0f %zu %zu\n", engine.pair_interactions, particles_bytes_fluid(&engine.fields),
         particles_bytes_wall(&engine.fields));
cleanup:
  engine_free(&engine);
  free(lattice.region);
  test_lattice_free(&lattice);
  return status;
}

int main(int argc, char **argv) {
  enum status status;
  log_start("bench_engine", LOG_NORMAL);
  if (argc == 7 && strcmp(argv[1], "count") == 0)
    status = count((enum pass_wall)atoi(argv[2]), *argv[3] == '1', *argv[4] == '1', *argv[5] == '1',
                   *argv[6] == '1');
  else if (argc == 2 || argc == 3)
    status = suite(argv[1], argc == 3 ? atof(argv[2]) : 1e7);
  else
    status =
        FAIL(STATUS_USAGE, "usage: bench_engine OUT.json [LARGEST] | count 0..3 0|1 0|1 0|1 0|1");
  if (status != STATUS_OK) log_pending_error();
  return (int)status;
}
