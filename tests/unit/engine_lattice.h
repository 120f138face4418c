/* Lattices and engines made by hand, for the tests of the engine. */
#ifndef TOSUI_TESTS_UNIT_ENGINE_LATTICE_H
#define TOSUI_TESTS_UNIT_ENGINE_LATTICE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/wcsph/modes.h"
#include "sphsolve/wcsph/plan.h"

static inline double test_random(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

static inline struct lattice test_lattice(int dimensions, size_t nx, size_t ny, size_t nz,
                                          double dx, double dy, double dz) {
  struct lattice lattice = {.dimensions = dimensions,
                            .size = {nx, ny, nz},
                            .spacing = {dx, dy, dz},
                            .count = nx * ny * nz};
  lattice.kind = calloc(lattice.count, 1);
  lattice.wall_distance = calloc(lattice.count, sizeof(float));
  for (size_t i = 0; i < lattice.count; i++) lattice.kind[i] = SITE_FLUID;
  lattice.fluid_count = lattice.count;
  lattice.bulk_count = (double)lattice.count;
  return lattice;
}

static inline void test_lattice_free(struct lattice *lattice) {
  free(lattice->kind);
  free(lattice->wall_distance);
}

static inline void test_recount(struct lattice *lattice) {
  lattice->fluid_count = lattice->wall_count = 0;
  for (size_t i = 0; i < lattice->count; i++) {
    lattice->fluid_count += lattice->kind[i] == SITE_FLUID;
    lattice->wall_count += lattice->kind[i] == SITE_WALL;
  }
}

/* A 2-D slit along x, `width` spacings wide, 4 wall layers on each side, its lower surface
 * `phase` of a spacing above a site. */
static inline struct lattice test_slit(size_t width, double phase, double dx) {
  struct lattice lattice = test_lattice(2, 6, 1, width + 8, dx, dx, dx);
  double low = 3 + phase, high = low + (double)width;
  for (size_t i = 0; i < lattice.count; i++) {
    double z = (double)(i / 6), d = fmin(z - low, high - z);
    lattice.kind[i] = d > 0 ? SITE_FLUID : SITE_WALL;
    lattice.wall_distance[i] = (float)(d * dx);
  }
  test_recount(&lattice);
  return lattice;
}

/* Grains at random, a fraction `solid` of the box; distances to their voxel faces only roughly. */
static inline struct lattice test_grains(size_t n, double dx, double solid, uint64_t seed) {
  struct lattice lattice = test_lattice(3, n, n, n + 1, dx, dx, dx);
  for (size_t i = 0; i < lattice.count; i++) {
    size_t block = i % n / 3 + 31 * (i / n % n / 3) + 997 * (i / (n * n) / 3);
    uint64_t state = seed + block;
    test_random(&state);
    bool grain = test_random(&state) < solid;
    lattice.kind[i] = grain ? SITE_WALL : SITE_FLUID;
    lattice.wall_distance[i] = (float)((grain ? -0.5 : 0.5) * dx);
  }
  test_recount(&lattice);
  return lattice;
}

static inline struct engine_settings test_settings_of(enum kernel kernel,
                                                      const struct lattice *lattice,
                                                      enum pass_wall wall, double support) {
  struct engine_settings settings = {.kernel = kernel,
                                     .wall = wall,
                                     .viscous = true,
                                     .shift = wall != PASS_FROZEN && wall != PASS_EULERIAN,
                                     .diffusion = wall != PASS_FROZEN,
                                     .support = support,
                                     .smoothing_length = support / kernel_support_ratio(kernel)};
  struct lattice_modes modes =
      lattice_modes_find(kernel, lattice->dimensions, lattice->spacing, settings.smoothing_length);
  settings.rest_ratio = modes.sum;
  settings.moment = modes.moment;
  settings.shifting_stiffness = modes.shifting_stiffness;
  settings.weights = modes.weights;
  return settings;
}
static inline struct engine_settings test_settings(const struct lattice *lattice,
                                                   enum pass_wall wall, double support) {
  return test_settings_of(KERNEL_QUINTIC, lattice, wall, support);
}

#endif
