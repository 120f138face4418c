/* Dispersion and conduction in pores by method solute's closure problem, against exact solutions.
 *   verify_solute [FILE.json]
 * writes FILE.json (a list of case, status, reference, measured, bound, seconds). Measured is what
 * is compared with the reference; bound the largest relative error that passes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "sphsolve/solute/closure.h"
#include "sphsolve/solute/curve.h"
#include "tests/verify/rows.h"

static const double pi = 3.14159265358979323846;
/* A body given by its distance and its flow; lengths in units of the box. */
struct body {
  double centre[3], radius, along[3]; /* `along`: unit vector of the flow */
};

static double across(const struct body *b, const double x[3]) {
  double square = 0, along = 0;
  for (int a = 0; a < 3; a++) {
    square += pow(x[a] - b->centre[a], 2);
    along += (x[a] - b->centre[a]) * b->along[a];
  }
  return sqrt(fmax(square - along * along, 0));
}

/* Between two planes normal to x, 2 radius apart. */
static double slit_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  return b->radius - fabs(x[0] - b->centre[0]);
}
static void slit_velocity(const void *context, const double x[3], double u[3]) {
  const struct body *b = context;
  const double y = (x[0] - b->centre[0]) / b->radius;
  for (int a = 0; a < 3; a++) u[a] = 1.5 * (1 - y * y) * b->along[a];
}

static double tube_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  return b->radius - across(b, x);
}
static void tube_velocity(const void *context, const double x[3], double u[3]) {
  const struct body *b = context;
  const double r = across(b, x) / b->radius;
  for (int a = 0; a < 3; a++) u[a] = 2 * (1 - r * r) * b->along[a];
}

static double cylinder_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  return hypot(x[0] - b->centre[0], x[1] - b->centre[1]) - b->radius;
}
static double ball_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  double square = 0;
  for (int a = 0; a < 3; a++) square += pow(x[a] - b->centre[a], 2);
  return sqrt(square) - b->radius;
}

static double nowhere(const void *context, const double x[3]) {
  (void)context, (void)x;
  return 1;
}
/* Two layers of half the box, at 3 and 1. */
static void layer_velocity(const void *context, const double x[3], double u[3]) {
  (void)context;
  u[0] = u[1] = 0;
  u[2] = x[0] < 0.5 ? 3 : 1;
}

/* D_L / D against 1 + (U length / D)^2 / factor, at Pe .1 to 1000. */
static void taylor(const char *name, int cells, const int n[3], const struct body *body,
                   double (*distance)(const void *, const double *),
                   void (*velocity)(const void *, const double *, double *), double length,
                   double factor) {
  const double h[3] = {1.0 / cells, 1.0 / cells, 1.0 / cells};
  struct solute_flow flow;
  struct solute_closure closure;
  must(solute_flow_build(n, h, distance, velocity, body, &flow));
  must(solute_closure_build(&flow, 0, &closure));
  for (double peclet = 0.1; peclet < 2000; peclet *= 10) {
    struct solute_dispersion d;
    char label[120];
    const double started = clock_seconds();
    must(solute_closure_solve(&closure, flow.speed * length / peclet, 1e-6, &d));
    snprintf(label, sizeof label, "%s, Pe %g, %d cells across", name, peclet,
             (int)round(2 * body->radius * cells));
    report(label, 1 + peclet * peclet / factor, d.longitudinal, 0.01, clock_seconds() - started);
  }
  solute_closure_free(&closure);
  solute_flow_free(&flow);
}

static void slits_and_tubes(void) {
  const struct body slit = {{0.503, 0, 0}, 0.437, {0, 0, 1}};
  const struct body tube = {{0.503, 0.497, 0}, 0.45, {0, 0, 1}};
  for (int cells = 16; cells <= 32; cells *= 2)
    taylor("slit, D_L = 1 + Pe^2/210", cells, (int[3]){cells, 1, 4}, &slit, slit_distance,
           slit_velocity, 2 * slit.radius, 210);
  taylor("tube, D_L = 1 + Pe^2/48", 32, (int[3]){32, 32, 4}, &tube, tube_distance, tube_velocity,
         tube.radius, 48);
  const struct body layers = {{0, 0, 0}, 0.5, {0, 0, 1}};
  taylor("two layers, D_L = 1 + Pe^2/12", 32, (int[3]){32, 1, 4}, &layers, nowhere, layer_velocity,
         0.25, 12);
}

/* A slit whose walls lie at 45 degrees to the axes x and z, in a periodic box: the flow crosses the
 * faces of the lattice at an angle. Walls where x - z is 0 or .5 of the box. */
static double turned_distance(const void *context, const double x[3]) {
  (void)context;
  double y = x[0] - x[2] - floor(x[0] - x[2]);
  return (0.25 - fabs(y - 0.5)) * sqrt(0.5);
}
static void turned_velocity(const void *context, const double x[3], double u[3]) {
  const double y = turned_distance(context, x) / (0.5 * sqrt(0.5)); /* 0 .. .5 of the gap */
  u[0] = u[2] = 6 * y * (1 - y);
  u[1] = 0;
}

/* The limit of two lattices, as a run gives it, and whether the error it states holds. */
static void turned_slits(void) {
  const int n[3] = {64, 1, 64};
  const double h[3] = {1.0 / 64, 1.0 / 64, 1.0 / 64}, gap = 0.5 * sqrt(0.5);
  static struct solute_result r;
  struct solute_flow flow;
  const double started = clock_seconds();
  must(solute_flow_build(n, h, turned_distance, turned_velocity, NULL, &flow));
  r.length = gap;
  for (double peclet = 0.1; peclet < 2000; peclet *= 10) r.peclet[r.count++] = peclet;
  static struct solute_state state;
  memset(&state, 0, sizeof state);
  must(solute_curve_by_closure(&flow, &state, &r));
  const double seconds = (clock_seconds() - started) / r.count;
  for (int i = 0; i < r.count; i++) {
    const struct solute_estimate *e = &r.closure[i].value;
    const double exact = 1 + r.peclet[i] * r.peclet[i] / 210;
    char label[120];
    snprintf(label, sizeof label, "slit at 45 degrees, Pe %g, from 23 and 11 cells across",
             r.peclet[i]);
    report(label, exact, e->longitudinal, 0.01, seconds);
    snprintf(label, sizeof label, "the same, within the error that is stated");
    report(label, exact, e->longitudinal, e->longitudinal_error, seconds);
  }
  solute_flow_free(&flow);
}

/* How many of what is stated of slits and tubes holds, in boxes where no order shows: from 6 to 13
 * cells across, walls anywhere in their cells; widths on which nothing was fixed. */
static void few_cells(const char *name, double (*distance)(const void *, const double *),
                      void (*velocity)(const void *, const double *, double *), bool flat) {
  static struct solute_result r;
  static struct solute_state state;
  const double started = clock_seconds();
  int held = 0, count = 0;
  double stated = 0, off = 0;
  for (double width = 6.2; width < 13; width += 1.15)
    for (double place = 0.1; place < 1; place += 0.27) {
      const int cells = (int)ceil(width) + 2, n[3] = {cells, flat ? 1 : cells, 12};
      const double h[3] = {1.0 / cells, 1.0 / cells, 1.0 / cells}, half = 0.5 * width / cells;
      const struct body body = {
          {0.5 + (place - 0.5) / cells, 0.5 + (1.7 * place - 0.8) / cells, 0}, half, {0, 0, 1}};
      struct solute_flow flow;
      must(solute_flow_build(n, h, distance, velocity, &body, &flow));
      memset(&state, 0, sizeof state);
      r.length = flat ? 2 * half : half;
      r.count = 0;
      for (double peclet = 2; peclet < 500; peclet *= 12) r.peclet[r.count++] = peclet;
      must(solute_curve_by_closure(&flow, &state, &r));
      for (int i = 0; i < r.count; i++, count++) {
        const struct solute_estimate *e = &r.closure[i].value;
        const double exact = 1 + r.peclet[i] * r.peclet[i] / (flat ? 210 : 48);
        held += fabs(e->longitudinal - exact) <= e->longitudinal_error * e->longitudinal;
        stated += e->longitudinal_error, off += fabs(e->longitudinal / exact - 1);
      }
      solute_flow_free(&flow);
    }
  char label[120];
  snprintf(label, sizeof label, "%s of few cells, errors that hold (mean %.2g %%, off by %.2g %%)",
           name, 100 * stated / count, 100 * off / count);
  report(label, count, held, 0.05, clock_seconds() - started);
}

static double conducted(int cells, bool flat, double (*distance)(const void *, const double *),
                        const struct body *body, double *seconds) {
  const int n[3] = {cells, cells, flat ? 1 : cells};
  const double h[3] = {1.0 / cells, 1.0 / cells, 1.0 / cells}, started = clock_seconds();
  struct solute_flow flow;
  struct solute_closure closure;
  struct solute_dispersion d;
  must(solute_flow_build(n, h, distance, NULL, body, &flow));
  must(solute_closure_build(&flow, 0, &closure));
  must(solute_closure_solve(&closure, INFINITY, 1e-6, &d));
  const double conductivity = flow.porosity * d.tensor[0][0];
  solute_closure_free(&closure);
  solute_flow_free(&flow);
  *seconds = clock_seconds() - started;
  return conductivity;
}

/* Square array of cylinders that conduct nothing, fraction f of the plane: multipoles of orders 1,
 * 3, 5, ... and lattice sums S_n of (x + i y)^-n, S_2 = pi (Rayleigh 1892; Perrins, McKenzie,
 * McPhedran 1979, Proc. R. Soc. Lond. A 369, 207). */
static double cylinders_exact(double f) {
  enum { ORDERS = 12, FAR = 60 };
  double sums[4 * ORDERS] = {0}, a[ORDERS][ORDERS + 1];
  sums[2] = pi;
  for (int n = 4; n < 4 * ORDERS; n += 4)
    for (int i = -FAR; i <= FAR; i++)
      for (int j = -FAR; j <= FAR; j++)
        if (i != 0 || j != 0) sums[n] += cos(n * atan2(j, i)) * pow(hypot(i, j), -n);
  const double radius = sqrt(f / pi);
  for (int p = 0; p < ORDERS; p++) {
    const int k = 2 * p + 1;
    for (int q = 0; q < ORDERS; q++) {
      const int m = 2 * q + 1;
      const double choose = exp(lgamma(m + k) - lgamma(k + 1) - lgamma(m));
      a[p][q] = choose * sums[m + k] + (p == q ? pow(radius, -2 * k) : 0);
    }
    a[p][ORDERS] = p == 0;
  }
  for (int p = 0; p < ORDERS; p++)
    for (int q = p + 1; q < ORDERS; q++)
      for (int c = ORDERS; c >= p; c--) a[q][c] -= a[q][p] / a[p][p] * a[p][c];
  for (int p = ORDERS - 1; p >= 0; p--) {
    for (int q = p + 1; q < ORDERS; q++) a[p][ORDERS] -= a[p][q] * a[q][ORDERS];
    a[p][ORDERS] /= a[p][p];
  }
  return 1 - 2 * pi * a[0][ORDERS];
}

/* Simple cubic array of spheres that conduct nothing (Sangani, Acrivos 1983, Proc. R. Soc. Lond. A
 * 386, 263, eq. 21; their expansion of the multipoles of McPhedran, McKenzie 1978). */
static double spheres_exact(double f) {
  double l[6];
  for (int n = 1; n < 6; n++) l[n] = -(2.0 * n - 1) / (2 * n);
  const double bend = 1.3047 * l[2] * pow(f, 10.0 / 3) * (1 + 0.2305 * l[3] * pow(f, 11.0 / 3)) /
                      (1 - 0.4054 * l[2] * pow(f, 7.0 / 3));
  return 1 - 3 * f /
                 (-1 / l[1] + f + bend + 0.07231 * l[3] * pow(f, 14.0 / 3) +
                  0.1526 * l[4] * pow(f, 6) + 0.0105 * l[5] * pow(f, 22.0 / 3));
}

static void arrays(void) {
  char label[120];
  double seconds;
  for (double f = 0.2; f < 0.65; f += 0.2)
    for (int cells = 16; cells <= 64; cells *= 2) {
      const struct body body = {{0.503, 0.489, 0}, sqrt(f / pi), {0, 0, 1}};
      const double k = conducted(cells, true, cylinder_distance, &body, &seconds);
      snprintf(label, sizeof label, "conduction past cylinders of %g, %d cells", f, cells);
      report(label, cylinders_exact(f), k, 0.01, seconds);
    }
  for (double f = 0.15; f < 0.5; f += 0.15)
    for (int cells = 16; cells <= 32; cells *= 2) {
      const struct body body = {{0.503, 0.489, 0.5}, cbrt(0.75 * f / pi), {0, 0, 1}};
      const double k = conducted(cells, false, ball_distance, &body, &seconds);
      snprintf(label, sizeof label, "conduction past spheres of %g, %d cells", f, cells);
      report(label, spheres_exact(f), k, 0.01, seconds);
    }
}

int main(int argc, char **argv) {
  log_start("verify_solute", LOG_QUIET);
  rows_open(argc > 1 ? argv[1] : "solute.json");
  slits_and_tubes();
  turned_slits();
  few_cells("slits", slit_distance, slit_velocity, true);
  few_cells("tubes", tube_distance, tube_velocity, false);
  arrays();
  return rows_close();
}
