/* Method stokes with soil whose pores are below the sites (effects/soil_drag.h, soil_viscosity.h),
 * against exact solutions of Darcy, Brinkman and Stokes.
 *   verify_micro [FILE.json]
 * Measured is the permeability; bound the largest relative error that passes. The widths and
 * permeabilities are whole numbers of sites, and of their squares. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/stokes/soil_response.h"
#include "sphsolve/stokes/solver/step.h"

static FILE *json;
static int count, failed;
static long iterations; /* of the last solve */
static double slope;    /* d ln k / d ln k_micro, of the last with soil, where `sloped` */
static double work;     /* iterations times the sites solved */
static bool sloped;

static void report(const char *name, double reference, double measured, double bound) {
  const bool pass = fabs(measured / reference - 1.0) <= bound;
  failed += !pass;
  if (json)
    fprintf(json,
            "%s{\"case\": \"%s\", \"status\": \"%s\", \"reference\": %.8g, \"measured\": %.8g, "
            "\"bound\": %g, \"seconds\": 0}",
            count++ ? ",\n" : "[\n", name, pass ? "pass" : "fail", reference, measured, bound);
  printf("%-52s %-4s %12.6g %12.6g %+9.4f %% (bound %g %%) %3ld iterations\n", name,
         pass ? "pass" : "fail", reference, measured, 100.0 * (measured / reference - 1.0),
         100.0 * bound, iterations);
}

/* What a site is: 0 pore, 1 wall, 2 soil with these. */
struct place {
  int kind;
  double porosity, permeability;
};
typedef struct place geometry(const size_t at[3], const double *parameter);

static void fill(struct lattice *l, const size_t size[3], geometry *place,
                 const double *parameter) {
  *l = (struct lattice){.dimensions = 3, .count = size[0] * size[1] * size[2]};
  l->bulk_count = (double)l->count;
  for (int a = 0; a < 3; a++) l->size[a] = size[a], l->spacing[a] = 1.0;
  if (memory_allocate(&l->kind, l->count, 1, "kind") != STATUS_OK ||
      memory_allocate(&l->wall_distance, l->count, sizeof(float), "d") != STATUS_OK ||
      memory_allocate(&l->micro_porosity, l->count, sizeof(float), "n") != STATUS_OK ||
      memory_allocate(&l->micro_permeability, l->count, sizeof(float), "k") != STATUS_OK)
    exit(1);
  bool soil = false;
  for (size_t s = 0; s < l->count; s++) {
    const size_t at[3] = {s % size[0], s / size[0] % size[1], s / size[0] / size[1]};
    const struct place p = place(at, parameter);
    l->kind[s] = p.kind == 1 ? SITE_WALL : SITE_FLUID;
    l->wall_distance[s] = p.kind == 1 ? -0.5f : 0.5f; /* beside it; farther on it is not asked */
    if (p.kind == 2) {
      l->micro_porosity[s] = (float)p.porosity;
      l->micro_permeability[s] = (float)p.permeability;
      soil = true;
    }
    *(p.kind == 1 ? &l->wall_count : &l->fluid_count) += 1;
  }
  if (soil) return;
  memory_free(&l->micro_porosity);
  memory_free(&l->micro_permeability);
}

static double permeability(const size_t size[3], geometry *place, const double *parameter, int axis,
                           double mean) {
  static struct scene scene;
  struct lattice l;
  struct stokes_solver s;
  double driving[3] = {0.0}, k = NAN;
  driving[axis] = 1.0;
  scene.stokes.kernel = KERNEL_CUBIC; /* the default, with its support */
  fill(&l, size, place, parameter);
  const struct stokes_goal goal = {.residual = mean > 0.0 ? 0.0 : 1e-7, .mean = mean};
  if (stokes_solver_build(&l, &scene, 1.8, WALL_SUBVOXEL, 1.0, driving, &s) == STATUS_OK &&
      stokes_solver_run(&s, &goal) == STATUS_OK)
    k = s.mean[axis];
  else
    printf("%s\n", error_message());
  error_clear();
  iterations = s.iterations;
  work = (double)s.iterations * (double)s.grid.active_all;
  struct micropores_point point = {.slope = NAN};
  if (sloped && isfinite(k) && soil_response_measure(&s, &l, &point) != STATUS_OK) error_clear();
  slope = point.slope;
  stokes_solver_free(&s);
  memory_free(&l.kind);
  memory_free(&l.wall_distance);
  memory_free(&l.micro_porosity);
  memory_free(&l.micro_permeability);
  return k;
}

/* Layers across x: width, porosity, permeability of each; permeability INFINITY: water, 0: wall. */
#define LAYERS_MOST 3
struct layers {
  double count, width[LAYERS_MOST], porosity[LAYERS_MOST], permeability[LAYERS_MOST];
};
static struct place layer_at(const size_t at[3], const double *parameter) {
  const struct layers *l = (const struct layers *)(const void *)parameter;
  double x = (double)at[0] + 0.5;
  int i = 0;
  while (i + 1 < (int)l->count && x > l->width[i]) x -= l->width[i++];
  if (isinf(l->permeability[i])) return (struct place){0};
  if (l->permeability[i] == 0.0) return (struct place){.kind = 1};
  return (struct place){2, l->porosity[i], l->permeability[i]};
}
static double of_layers(const struct layers *l, int axis, double mean) {
  size_t size[3] = {0, 2, 2};
  for (int i = 0; i < (int)l->count; i++) size[0] += (size_t)l->width[i];
  return permeability(size, layer_at, (const double *)(const void *)l, axis, mean);
}

/* Water 2 h wide between surfaces of soil 2 s thick, along them: in water v = A - x^2 / 2, in soil
 * k + B cosh(y / r), r^2 = k / n, v and stress continuous (Beavers, Joseph 1967; Neale, Nader
 * 1974).
 */
static double exact_channel(double h, double s, double n, double k) {
  const double r = sqrt(k / n), slip = sqrt(k * n) / tanh(s / r);
  return (h * h * h / 3.0 + h * k + slip * h * h + k * s + k * h) / (h + s);
}

static void channel(double width, double soil, double n, double k, double scale, double bound) {
  char name[80];
  const struct layers l = {2, {width, soil}, {0, n}, {INFINITY, k * scale * scale}};
  snprintf(name, sizeof name, "channel %g wide over soil %g thick, k_micro %g", width, soil,
           k * scale * scale);
  report(name, exact_channel(0.5 * width, 0.5 * soil, n, k * scale * scale), of_layers(&l, 2, 0),
         bound);
}

/* Spheres of radius r in cubes of n: soil, or solid where the permeability is 0. */
static struct place sphere_at(const size_t at[3], const double *p) {
  double square = 0.0;
  for (int a = 0; a < 3; a++) square += pow((double)at[a] + 0.5 - 0.5 * p[0], 2);
  if (square > p[1] * p[1]) return (struct place){0};
  if (p[3] == 0.0) return (struct place){.kind = 1};
  return (struct place){2, p[2], p[3]};
}
static double spheres(double n, double radius, double porosity, double k) {
  const double p[4] = {n, radius, porosity, k};
  const size_t size[3] = {(size_t)n, (size_t)n, (size_t)n};
  return permeability(size, sphere_at, p, 2, 1e-4);
}

/* Radius of the sphere that has the volume of the voxels. */
static double same_volume(double n, double radius) {
  const double p[4] = {n, radius, 0.0, 1.0};
  size_t at[3], voxels = 0;
  for (at[2] = 0; at[2] < (size_t)n; at[2]++)
    for (at[1] = 0; at[1] < (size_t)n; at[1]++)
      for (at[0] = 0; at[0] < (size_t)n; at[0]++) voxels += sphere_at(at, p).kind == 2;
  return cbrt(0.75 / M_PI * (double)voxels);
}

/* Brinkman 1947, drag of a sphere of soil over Stokes', with the viscosity of water inside; and in
 * a dilute cubic array after Hasimoto 1959, to c^(1/3), with that drag. */
static double exact_dilute(double box, double radius, double k) {
  const double b = radius / sqrt(k), t = 1.0 - tanh(b) / b;
  const double drag = 2.0 * b * b * t / (2.0 * b * b + 3.0 * t);
  const double hydraulic = drag * radius, c = 4.0 / 3.0 * M_PI * pow(hydraulic / box, 3);
  return box * box / (6.0 * M_PI * hydraulic) * box * (1.0 - 1.7601 * cbrt(c) + c);
}

/* A sand of aggregates: each grain of the generator's sand is made of solid spheres on a cubic
 * lattice, cut at the grain's surface; and the same with the grains soil, of the porosity and the
 * permeability that one cell of that lattice has. */
#define AGGREGATES 160 /* sites a side; a grain has 64 across, 8 cells */
#define CELL 8
#define CELL_RADIUS 3.7
static unsigned char *aggregates; /* [z][y][x] 1: in a grain; made by make_aggregates */

static bool in_small_sphere(const size_t at[3]) {
  double square = 0.0;
  for (int a = 0; a < 3; a++) square += pow((double)(at[a] % CELL) + 0.5 - 0.5 * CELL, 2);
  return square < CELL_RADIUS * CELL_RADIUS;
}
static struct place cell_at(const size_t at[3], const double *parameter) {
  (void)parameter;
  return (struct place){.kind = in_small_sphere(at)};
}
/* parameter: 0 for the resolved sand, 1 with grains of soil, 2 solid; porosity, permeability */
static struct place aggregate_at(const size_t at[3], const double *p) {
  if (!aggregates[(at[2] * AGGREGATES + at[1]) * AGGREGATES + at[0]]) return (struct place){0};
  if (p[0] == 1.0) return (struct place){2, p[1], p[2]};
  return (struct place){.kind = p[0] == 2.0 || in_small_sphere(at)};
}

static bool make_aggregates(void) {
  const size_t sites = (size_t)AGGREGATES * AGGREGATES * AGGREGATES;
  const char *build = getenv("BUILD") ? getenv("BUILD") : "build";
  char folder[] = "/tmp/verify_micro_XXXXXX", line[1000];
  if (mkdtemp(folder) == NULL ||
      memory_allocate(&aggregates, sites, 1, "the aggregates") != STATUS_OK)
    return false;
  snprintf(line, sizeof line,
           "%s/bin/generate_sand --output %s/slices --format png8 --size %dx%dx%d --voxel-size 5um "
           "--grain-size 320um --void-ratio 0.7 --seed 22 --truth %s/truth.raw --quiet",
           build, folder, AGGREGATES, AGGREGATES, AGGREGATES, folder);
  bool made = system(line) == 0;
  snprintf(line, sizeof line, "%s/truth.raw", folder);
  FILE *file = made ? fopen(line, "rb") : NULL;
  made = file != NULL && fread(aggregates, 1, sites, file) == sites;
  if (file) fclose(file);
  snprintf(line, sizeof line, "rm -r %s", folder);
  return system(line) == 0 && made;
}

static void sand_of_aggregates(void) {
  const size_t size[3] = {AGGREGATES, AGGREGATES, AGGREGATES}, cell[3] = {CELL, CELL, CELL};
  size_t solid = 0, at[3];
  if (!make_aggregates()) {
    report("sand of aggregates: the generator makes it", 1.0, 0.0, 0.0);
    return;
  }
  for (at[2] = 0; at[2] < CELL; at[2]++)
    for (at[1] = 0; at[1] < CELL; at[1]++)
      for (at[0] = 0; at[0] < CELL; at[0]++) solid += in_small_sphere(at);
  const double k = permeability(cell, cell_at, NULL, 2, 1e-4);
  double p[3] = {0.0, 1.0 - (double)solid / (CELL * CELL * CELL), k};
  const double resolved = permeability(size, aggregate_at, p, 2, 1e-3);
  printf("  porosity %.3g, k_micro %.3g; %ld iterations resolved\n", p[1], k, iterations);
  p[0] = 1.0;
  report("sand of aggregates, soil over resolved", resolved,
         permeability(size, aggregate_at, p, 2, 1e-3), 0.05);
  p[0] = 2.0;
  const double closed = permeability(size, aggregate_at, p, 2, 1e-3);
  printf("  with solid grains %.6g, %.3g of it\n", closed, closed / resolved);
  memory_free(&aggregates);
}

/* The slope of one solution against that of the exact flow. */
static void channel_slope(double n, double k) {
  char name[80];
  const struct layers l = {2, {16, 8}, {0, n}, {INFINITY, k}};
  sloped = true;
  of_layers(&l, 2, 0);
  sloped = false;
  snprintf(name, sizeof name, "slope of a channel 16 wide, k_micro %g", k);
  report(name,
         log(exact_channel(8, 4, n, 1.01 * k) / exact_channel(8, 4, n, k / 1.01)) / (2 * log(1.01)),
         slope, 0.05);
}

/* Balls of grain at random, radius 4 to 6, and of soil between them, a third of the sites;
 * parameter: permeability, 0 for grain in place of soil. */
#define PACKING 60
static unsigned char *packing; /* [z][y][x] kind of a site */
static void throw_balls(double share, int kind, unsigned *seed) {
  const size_t sites = (size_t)PACKING * PACKING * PACKING;
  for (size_t taken = 0; (double)taken < share * (double)sites;) {
    double ball[4]; /* centre, radius */
    for (int i = 0; i < 4; i++) {
      *seed = *seed * 1664525u + 1013904223u;
      ball[i] = (*seed >> 8) / 16777216.0 * (i < 3 ? PACKING : 2.0) + (i < 3 ? 0.0 : 4.0);
    }
    for (size_t s = 0; s < sites; s++) {
      const size_t at[3] = {s % PACKING, s / PACKING % PACKING, s / PACKING / PACKING};
      double square = 0.0;
      for (int a = 0; a < 3; a++) {
        const double away = fabs((double)at[a] + 0.5 - ball[a]);
        square += pow(fmin(away, PACKING - away), 2);
      }
      if (packing[s] != 0 || square > ball[3] * ball[3]) continue;
      packing[s] = (unsigned char)kind;
      taken++;
    }
  }
}
static struct place packed_at(const size_t at[3], const double *p) {
  const int kind = packing[(at[2] * PACKING + at[1]) * PACKING + at[0]];
  if (kind == 2 && p[0] == 0.0) return (struct place){.kind = 1};
  return (struct place){kind, 0.35, p[0]};
}

/* What soil costs beside the same packing with it closed, which has half the sites; and the slope
 * against solves. */
static void packing_of_soil(void) {
  const size_t size[3] = {PACKING, PACKING, PACKING};
  unsigned seed = 22;
  char name[80];
  double k[3];
  if (memory_allocate(&packing, (size_t)PACKING * PACKING * PACKING, 1, "a packing")) exit(1);
  throw_balls(0.36, 1, &seed);
  throw_balls(0.33, 2, &seed);
  const double closed_k = permeability(size, packed_at, (const double[]){0.0}, 2, 1e-4);
  const double closed = work;
  const long closed_iterations = iterations;
  printf("  packing with its soil closed: k %.6g, %ld iterations\n", closed_k, iterations);
  for (int e = -4; e <= -2; e += 2) {
    for (int i = 0; i < 3; i++) {
      const double p = pow(10, e) * pow(1.1, i - 1);
      sloped = i == 1;
      k[i] = permeability(size, packed_at, &p, 2, i == 1 ? 1e-4 : 1e-5);
      if (i != 1) continue;
      printf("  k_micro %g: %ld iterations, times the sites %.3g of that closed\n", p, iterations,
             work / closed);
      snprintf(name, sizeof name, "packing, a third soil, k_micro %g: iterations, and closed", p);
      report(name, (double)closed_iterations, (double)iterations, 0.3);
      k[i] = slope;
    }
    sloped = false;
    snprintf(name, sizeof name, "packing, a third soil, k_micro %g: slope", pow(10, e));
    report(name, log(k[2] / k[0]) / log(1.21), k[1], 0.15);
  }
  memory_free(&packing);
}

int main(int argc, char **argv) {
  char name[80];
  if (argc > 1) json = fopen(argv[1], "w");
  log_start("verify_micro", LOG_QUIET);
  /* From walls to soil that lets through nearly as much as water. */
  for (int e = -8; e <= 0; e++) channel(16, 8, 0.35, pow(10, e), 1.0, 0.01);
  for (int e = -8; e <= 0; e += 2) channel(16, 8, 0.8, pow(10, e), 1.0, 0.01);
  /* The order: the same body with finer sites. */
  for (int i = 2; i <= 32; i *= 2) channel(2 * i, i, 0.35, 0.02, i, 0.04 / (i * i) + 1e-3);
  for (int e = -8; e <= 0; e += 2) {
    const double k = pow(10, e);
    const struct layers series = {2, {8, 8}, {0, 0.35}, {INFINITY, k}};
    snprintf(name, sizeof name, "water and soil in series, k_micro %g", k);
    report(name, 2.0 * k, of_layers(&series, 0, 0), 0.01);
    const struct layers two = {2, {8, 8}, {0.35, 0.5}, {k, 0.01 * k}};
    snprintf(name, sizeof name, "two soils in series, k_micro %g and %g", k, 0.01 * k);
    report(name, 2.0 / (1.0 / k + 1.0 / (0.01 * k)), of_layers(&two, 0, 0), 0.01);
    snprintf(name, sizeof name, "two soils in parallel, k_micro %g and %g", 1e-2 * k, 1e-4 * k);
    const struct layers beside = {2, {8, 8}, {0.35, 0.5}, {1e-2 * k, 1e-4 * k}};
    report(name, 0.5 * (1e-2 * k + 1e-4 * k), of_layers(&beside, 2, 0), 0.01);
  }
  for (int e = -6; e <= 0; e += 2) channel_slope(0.35, pow(10, e));
  packing_of_soil();
  /* Limit of grain, and iterations over the permeability. */
  const double radius = cbrt(0.75 * 0.216 / M_PI) * 24;
  const double solid = spheres(24, radius, 0, 0);
  const long solid_iterations = iterations;
  long most = 0;
  for (int e = -8; e <= 0; e++) {
    const double k = spheres(24, radius, 0.35, pow(10, e));
    snprintf(name, sizeof name, "spheres of soil, k_micro %g, over solid ones", pow(10, e));
    if (e <= -5)
      report(name, solid, k, 0.01);
    else
      printf("%-52s      %12.6g %12.6g %34ld iterations\n", name, solid, k, iterations);
    most = iterations > most ? iterations : most;
  }
  report("spheres of soil, most iterations beside solid ones", (double)solid_iterations,
         (double)most, 0.5);
  /* Of voxels, against a sphere of their volume, which is 5 % more at a radius of 5 sites. */
  for (int r = 5; r <= 9; r += r < 7 ? 2 : 1) {
    const double box = 8 * r, soil = 0.04 * r * r;
    snprintf(name, sizeof name, "dilute array of spheres of soil, radius %d", r);
    report(name, exact_dilute(box, same_volume(box, r), soil), spheres(box, r, 0.999, soil),
           r < 8 ? 0.02 : 0.01); /* 1 % at 16 sites across */
  }
  sand_of_aggregates();
  if (json) fprintf(json, "\n]\n"), fclose(json);
  printf("%d failed\n", failed);
  return failed > 0;
}
