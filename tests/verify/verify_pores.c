/* Pore-scale cases of method wcsph, marched in time, against exact and independent references:
 * with particles on their sites, as these scenes have it by default, and with moving ones.
 *   verify_pores [FILE.json [DATA_FOLDER]]
 * writes FILE.json (a list of case, status, reference, measured, bound, seconds) and beside it
 * pores.dat (error and time against resolution) and pores.svg (by gnuplot, if it is there).
 * Measured is what is compared with the reference; bound the largest relative error that passes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/geometry/distance.h"
#include "sphsolve/stokes/solver/step.h"
#include "sphsolve/geometry/percolation.h"
#include "tests/unit/engine_march.h"
#include "tests/verify/rows.h"

#define DX 1e-4 /* m */
#define NU 1e-6 /* m^2/s */

#define TOLERANCE 1e-3
#define EXACT 1e-4

static FILE *data;
/* What sub-voxel walls have beside them: PASS_EULERIAN, or PASS_SUBVOXEL: particles move. */
static enum pass_wall fluid;
static const char *moving(void) {
  return fluid == PASS_EULERIAN ? "" : ", moving";
}

/* More than the reference is as good. */
static void report_least(const char *name, double reference, double measured, double bound,
                         double seconds) {
  const double error = measured / reference - 1;
  rows_write(name, error >= -bound ? "pass" : "fail", reference, measured, error, bound, seconds);
}

/* Drawn for particles on their sites. */
static void point(double width, double error, double seconds) {
  if (fluid != PASS_EULERIAN) return;
  fprintf(data, "%g %.6g %.4g\n", width, fabs(error), seconds);
}

/* Permeability, spacings^2: the flow creeps, and runs until it is steady by the program's own rule
 * (at most 200 viscous times of `width`). */
static double permeability(struct lattice *l, enum pass_wall wall, const double direction[3],
                           double width, double *seconds) {
  const double dx = l->spacing[0], started = clock_seconds();
  struct march m = {
      .wall = wall, .nu = NU, .end = 200 * width * width * dx * dx / NU, .tolerance = TOLERANCE};
  /* density within 1 % */
  const double f = 0.005 * NU * NU / (dx * dx * dx * width * width);
  for (int a = 0; a < 3; a++) m.force[a] = f * direction[a];
  const double darcy = test_march(l, &m, NULL);
  test_lattice_free(l);
  *seconds = clock_seconds() - started;
  return darcy * NU / f / (dx * dx);
}

/* Ratio of the flow rate to the exact one. */
static double slit(enum pass_wall wall, size_t width, double phase, double *seconds) {
  struct lattice l = test_slit(width, phase, DX);
  const double w = (double)width, wide = w + (wall == PASS_FROZEN);
  const double exact = w * w * w / 12 / (double)l.size[2];
  return permeability(&l, wall, (const double[3]){1, 0, 0}, wide, seconds) / exact;
}

static void slits(void) {
  static const double bound[] = {0.13, 0.04, 0.01, 0.003};
  char name[64];
  double seconds, error[4];
  for (int i = 0; i < 4; i++)
    for (int shift = 0; shift < 4; shift++) {
      const size_t w = 2u << i;
      const double ratio = slit(fluid, w, 0.5 + 0.25 * shift - (shift > 1), &seconds);
      snprintf(name, sizeof name, "slit %zu wide, shifted by %.2f%s", w, 0.25 * shift, moving());
      report(name, 1, ratio, bound[i], seconds);
      if (shift > 0) continue;
      error[i] = ratio - 1;
      point((double)w, error[i], seconds);
    }
  fprintf(data, "\n\n");
  /* Errors of some 1e-5 are rounding and have no order: then it is their size that is judged. */
  const double largest = fmax(fabs(error[1]), fmax(fabs(error[2]), fabs(error[3])));
  snprintf(name, sizeof name, "slit, 4 to 16 wide: exact but for rounding%s", moving());
  if (largest < EXACT)
    report(name, 1, 1 + largest, EXACT, 0);
  else
    report_least("slit, order from 4 to 16 wide", 2, log(fabs(error[1] / error[3])) / log(4), 0.1,
                 0);
  if (fluid != PASS_EULERIAN) return;
  /* exact lattice theory */
  static const struct {
    enum pass_wall wall;
    const char *name;
    size_t width;
    double theory;
  } table[] = {{PASS_ADAMI, "adami", 2, 0.58},    {PASS_ADAMI, "adami", 4, 0.147},
               {PASS_ADAMI, "adami", 8, 0.037},   {PASS_ADAMI, "adami", 16, 0.0095},
               {PASS_FROZEN, "frozen", 2, 2.16},  {PASS_FROZEN, "frozen", 4, 0.934},
               {PASS_FROZEN, "frozen", 8, 0.430}, {PASS_FROZEN, "frozen", 16, 0.206},
               {PASS_FROZEN, "frozen", 32, 0.100}};
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    const double ratio = slit(table[i].wall, table[i].width, 0.5, &seconds);
    snprintf(name, sizeof name, "slit %zu wide, %s walls", table[i].width, table[i].name);
    report(name, 1 + table[i].theory, ratio, 0.015, seconds);
    point((double)table[i].width, ratio - 1, seconds);
    if (i == 3) fprintf(data, "\n\n");
  }
  fprintf(data, "\n\n");
}

/* Turned by atan(4/7) = 29.7 degrees, the nearest that repeats in a small box. */
static void turned_slits(void) {
  static const double width[] = {4, 8, 16}, bound[] = {0.06, 0.03, 0.015};
  static const size_t size[] = {65, 97, 193};
  const double length = hypot(7, 4), along[3] = {-4 / length, 0, 7 / length};
  for (int i = 0; i < 3; i++) {
    const double w = width[i], period = (double)size[i] / length;
    const double p[4] = {w, period, 7 / length, 4 / length};
    struct lattice l =
        test_geometry(2, (const size_t[3]){size[i], 1, size[i]}, DX, test_turned_slit, p);
    char name[64];
    double seconds;
    const double k = permeability(&l, fluid, along, w, &seconds);
    const double exact = w * w * w / 12 / period;
    snprintf(name, sizeof name, "slit %g wide, turned 30 degrees%s", w, moving());
    report(name, exact, k, bound[i], seconds);
    point(w, k / exact - 1, seconds);
  }
  fprintf(data, "\n\n");
}

/* p0: half the width, p1: the middle. */
static double duct(const double at[3], const double p[4]) {
  double d[2];
  for (int a = 0; a < 2; a++) d[a] = p[0] - fabs(at[a] - p[1]);
  return d[0] < 0 && d[1] < 0 ? -hypot(d[0], d[1]) : fmin(d[0], d[1]);
}
/* A ball of radius p0 in the middle of a box of p1. */
static double ball(const double at[3], const double p[4]) {
  return sqrt(pow(at[0] - p[1] / 2, 2) + pow(at[1] - p[1] / 2, 2) + pow(at[2] - p[1] / 2, 2)) -
         p[0];
}
static double cylinder(const double at[3], const double p[4]) {
  return hypot(at[0] - p[1] / 2, at[2] - p[1] / 2) - p[0];
}

static void ducts(void) {
  for (int w = 8; w <= 16; w *= 2) {
    const double p[4] = {w / 2.0, w / 2.0 + 3, 0, 0};
    struct lattice l =
        test_geometry(3, (const size_t[3]){(size_t)w + 6, (size_t)w + 6, 4}, DX, duct, p);
    char name[64];
    double seconds;
    const double k = permeability(&l, fluid, (const double[3]){0, 0, 1}, w, &seconds);
    snprintf(name, sizeof name, "square duct %d wide%s", w, moving());
    report(name, pow(w, 4) * 0.421731 / 12 / pow(w + 6, 2), k, w == 8 ? 0.03 : 0.01, seconds);
  }
}

static void arrays(void) {
  /* verification.md; k/a^2 = 2 / (9 c K) and k / L^2 = 1 / (F / mu U) */
  static const double spheres[][2] = {{0.125, 4.29159}, {0.216, 7.4419}, {0.45, 28.08}};
  static const double cylinders[][2] = {{0.05, 15.5578}, {0.1, 24.8317}, {0.2, 51.5270},
                                        {0.3, 102.881},  {0.4, 217.894}, {0.5, 532.548}};
  const double along[3] = {1, 0, 0};
  char name[64];
  double seconds;
  for (int i = 0; i < 3; i++) {
    for (size_t n = 12; n <= 24; n += n / 2 > 6 ? 8 : 4) {
      const double c = spheres[i][0], radius = cbrt(0.75 * c / M_PI) * (double)n;
      struct lattice l = test_geometry(3, (const size_t[3]){n, n, n}, DX, ball,
                                       (const double[4]){radius, (double)n});
      const double exact = 2 * radius * radius / (9 * c * spheres[i][1]);
      const double k = permeability(&l, fluid, along, sqrt(exact), &seconds) / exact;
      snprintf(name, sizeof name, "spheres c = %g, %zu a side%s", c, n, moving());
      if (n == 24)
        report(name, 1, k, 0.01, seconds);
      else
        printf("  %s: k %.4f of the reference, %.2f s\n", name, k, seconds);
      point((double)n, k - 1, seconds);
    }
    fprintf(data, "\n\n");
  }
  for (int i = 0; i < 6; i++) {
    const double c = cylinders[i][0], n = 48, exact = n * n / cylinders[i][1];
    struct lattice l = test_geometry(2, (const size_t[3]){48, 1, 48}, DX, cylinder,
                                     (const double[4]){sqrt(c / M_PI) * n, n});
    const double k = permeability(&l, fluid, along, sqrt(exact), &seconds);
    snprintf(name, sizeof name, "cylinders c = %g, 48 a side%s", c, moving());
    report(name, exact, k, 0.01, seconds);
  }
}

/* Morris, Fox, Zhu 1997: a cylinder of radius .02 m in a periodic box of .1 m; Re 1 and .03. */
static void morris_lattice(void) {
  static const double nu[] = {1e-6, 1e-4}, force[] = {1.5e-7, 5e-5},
                      mean[] = {4.9422e-5, 1.64741e-4};
  static const double fastest[] = {1.14125e-4, 3.80415e-4};
  for (int i = 0; i < 2; i++) {
    const double n = 50, dx = 0.1 / n, started = clock_seconds();
    struct lattice l =
        test_geometry(2, (const size_t[3]){50, 1, 50}, dx, cylinder, (const double[4]){0.2 * n, n});
    struct march m = {.wall = fluid,
                      .nu = nu[i],
                      .force = {force[i]},
                      .end = 2 * 0.1 * 0.1 / nu[i],
                      .sound = fmax(2 * nu[i] / (2.9 * dx / 3), 10 * fastest[i]),
                      .tolerance = TOLERANCE};
    const double u = test_march(&l, &m, NULL);
    test_lattice_free(&l);
    char name[64];
    snprintf(name, sizeof name, "Morris lattice, case %c, mean velocity%s", 'A' + i, moving());
    report(name, mean[i], u, 0.02, clock_seconds() - started);
  }
}

/* A sand: k against method stokes on the same walls; with the sound speed doubled; with a tenth of
 * the force, for as long a time, so that moving particles hardly leave their sites. */
static void pinning(const char *name, struct lattice *l, double gap) {
  const double dx = l->spacing[0], nu = 1e-5, g = 98.0665, started = clock_seconds();
  struct march m = {.wall = fluid,
                    .nu = nu,
                    .force = {0, 0, -g},
                    .end = 6 * gap * gap * dx * dx / nu,
                    .sound = 1.2};
  struct stokes_solver s;
  double k_stokes = NAN, travel;
  if (stokes_solver_build(l, NULL, 2.9 * dx, WALL_SUBVOXEL, nu, m.force, &s) == STATUS_OK &&
      stokes_solver_run(&s, &(struct stokes_goal){.residual = 1e-6}) == STATUS_OK) {
    k_stokes = -s.mean[2] * s.velocity_unit / g * 9.80665;
    stokes_solver_free(&s);
  }
  char title[96];
  size_t closed = 0;
  bool flows;
  if (fluid == PASS_EULERIAN && percolation_close(l, m.force, &closed, &flows) != STATUS_OK)
    log_pending_error();
  const double first = clock_seconds(), k = test_march(l, &m, &travel) / g * 9.80665;
  printf("  %s%s: the fluid has moved by %.2f spacings\n", name, moving(), travel);
  snprintf(title, sizeof title, "%s, against stokes%s", name, moving());
  report(title, k_stokes, k, 0.01, clock_seconds() - first);
  m.sound *= 2;
  snprintf(title, sizeof title, "%s, sound speed doubled%s", name, moving());
  report(title, k, test_march(l, &m, NULL) / g * 9.80665, 0.03, clock_seconds() - first);
  m.sound /= 2;
  m.force[2] /= 10;
  snprintf(title, sizeof title, "%s, a tenth of the force%s", name, moving());
  report(title, k, test_march(l, &m, NULL) / g * 98.0665, 0.03, clock_seconds() - started);
  test_lattice_free(l);
}

static void sands(const char *folder) {
  static const double balls[4] = {24, 5, 24, 7};
  struct lattice l = test_geometry(3, (const size_t[3]){24, 24, 24}, 5e-5, test_balls, balls);
  pinning("balls at random, 24 a side", &l, wcsph_gap(&l));
  char path[1024];
  const size_t n[3] = {60, 60, 61}, voxels = n[0] * n[1] * n[2];
  const bool periodic[3] = {true, true, true};
  snprintf(path, sizeof path, "%s/sand/sand_m61_e0725_60x60x61.raw", folder);
  FILE *file = fopen(path, "rb");
  uint8_t *solid = malloc(voxels);
  if (file != NULL && solid != NULL && fread(solid, 1, voxels, file) == voxels) {
    l = test_lattice(3, n[0], n[1], n[2], 46.64e-6, 46.64e-6, 46.64e-6);
    for (size_t s = 0; s < voxels; s++) l.kind[s] = solid[s] ? SITE_WALL : SITE_FLUID;
    distance_from_faces(l.size, l.spacing, periodic, 0, l.size[2], solid, l.wall_distance);
    test_recount(&l);
    pinning("sand 60x60x61", &l, wcsph_gap(&l));
  } else {
    skip("sand 60x60x61", NAN, 0.03);
  }
  if (file != NULL) fclose(file);
  free(solid);
}

static void plot(const char *folder) {
  char command[4096];
  snprintf(
      command, sizeof command,
      "gnuplot -e \"set terminal svg size 900,600; set output '%s/pores.svg'; set logscale xy; "
      "set xlabel 'particles across'; set ylabel 'relative error'; set format y '%%g'; "
      "plot for [i=0:6] '%s/pores.dat' index i using 1:2 with linespoints title "
      "word('slit adami frozen turned spheres.125 spheres.216 spheres.45', i + 1)\"",
      folder, folder);
  if (system(command) != 0) printf("no plot: gnuplot is missing\n");
}

int main(int argc, char **argv) {
  const char *out = argc > 1 ? argv[1] : "pores.json";
  char folder[1024], path[1100];
  snprintf(folder, sizeof folder, "%s", out);
  char *slash = strrchr(folder, '/');
  if (slash != NULL)
    *slash = '\0';
  else
    snprintf(folder, sizeof folder, ".");
  snprintf(path, sizeof path, "%s/pores.dat", folder);
  rows_open(out);
  data = fopen(path, "w");
  if (!data) {
    fprintf(stderr, "verify_pores: cannot write to %s\n", folder);
    return 1;
  }
  for (int pass = 0; pass < 2; pass++) {
    fluid = pass == 0 ? PASS_EULERIAN : PASS_SUBVOXEL;
    slits();
    turned_slits();
    ducts();
    arrays();
    morris_lattice();
    sands(argc > 2 ? argv[2] : "../shared/data");
  }
  fclose(data);
  plot(folder);
  return rows_close();
}
