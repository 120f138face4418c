/* Case `fall` of verify_isph. */
#ifndef TOSUI_TESTS_VERIFY_FREE_FALL_H
#define TOSUI_TESTS_VERIFY_FREE_FALL_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/verify/isph_rig.h"

/* Water falls through soil (M15 section 5 in 2-D): when its front touches the bottom, against the
 * balance of a plug, (H + C_r s) q' = G g (H + s) - eps s (a q + b q^2), s' = q/eps, G = 1/eps in
 * the soil with `m15`. */
static double plug(double eps, bool paper, double depth, double head, double until) {
  double d = .01, cr = 1 + .34 * (1 - eps) / eps, q = 0, s = 1e-9, t = 0, dt = 1e-5;
  double a = 1000 * 1e-6 * pow(1 - eps, 2) / (pow(eps, 3) * d * d);
  double b = 1.1 * (1 - eps) / (pow(eps, 3) * d), scale = paper ? 1 : 1 / eps;
  for (; s < fmin(until, depth); t += dt) {
    double over = head - eps * s;
    q += dt * (9.81 * (over + s) - scale * eps * s * (a * q + b * q * q)) / (over + scale * cr * s);
    s += dt * q / eps;
  }
  return t;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Where the front of water in soil stands by its volume, which is what a plug's balance knows: the
 * lowest `n` particles, a row of the lattice, fill the soil to a height of `row` = spacing/eps. In
 * whatever order they stand, evenly they have their mean half of that above the front. The lowest
 * one is no measure of it: by its own half size it stands .5 (1/eps - eps^-1/2) spacings behind a
 * front of even rows, .8 at eps .3, and up to as much before one in disorder. */
static double front_by_volume(const struct isph *s, size_t n, double row) {
  double *z = malloc(s->count * sizeof *z), sum = 0;
  if (z == NULL) exit(1);
  for (size_t i = 0; i < s->count; i++) z[i] = s->position[i][2];
  qsort(z, s->count, sizeof *z, ascending);
  for (size_t i = 0; i < n; i++) sum += z[i];
  free(z);
  return sum / (double)n - .5 * row;
}

/* The last half row at the speed of the one before, the balance's as well: where the last row comes
 * to rest is the wall's affair. */
static double arrival(const double pass[2]) {
  return pass[1] + .5 * (pass[1] - pass[0]);
}

static void free_fall(void) {
  for (int k = 0; k < 16; k++) {
    static const double eps[] = {.3, .4, .5, .8}, depth = .2, head = .2;
    bool paper = k < 8;
    double h = k % 8 < 4 ? .01 : .005, e = eps[k % 4], row = h / e, exact[2];
    /* by the front and by the lowest particle: times, and the place before */
    double pass[2][2] = {{0}}, before[2] = {depth, depth}, last = 0;
    const double level[2] = {row, h};
    struct run run = {0};
    char name[96];
    double started = clock_seconds();
    start(&run,
          "scene = { method = \"isph\"; end_time = \"2 s\"; };\n"
          "domain = { size = [\"0.2 m\", \"0.5 m\"]; spacing = \"%g m\"; periodic = [false, "
          "false]; };\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0.2 m\", \"0.2 m\", \"0.4 m\"]; },\n"
          "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.2 m\"]; porosity = %g; "
          "grain_size = \"1 cm\"; } );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
          "isph = { dt = \"%g s\"; form = \"%s\"; };\n",
          h, e, .1 * h, paper ? "m15" : "akbari");
    while ((pass[0][1] == 0 || pass[1][1] == 0) && run.s.time < 2) {
      double low = INFINITY;
      advance(&run, run.s.time + .1 * h);
      for (size_t i = 0; i < run.s.count; i++)
        low = fmin(low, run.s.position[i][2] - .5 * sqrt(run.s.volume[i]));
      const double now[2] = {front_by_volume(&run.s, (size_t)lround(.2 / h), row), low};
      for (int f = 0; f < 2; f++) {
        for (int m = 0; m < 2; m++) {
          const double at = (1.5 - m) * level[f];
          if (pass[f][m] == 0 && now[f] <= at)
            pass[f][m] = last + (run.s.time - last) * (before[f] - at) / (before[f] - now[f]);
        }
        before[f] = now[f];
      }
      last = run.s.time;
    }
    for (int m = 0; m < 2; m++) exact[m] = plug(e, paper, depth, head, depth - (1.5 - m) * row);
    const double whole = arrival(exact);
    snprintf(name, sizeof name, "free fall through soil: front, %s, eps %g, %g cm",
             paper ? "m15" : "akbari", e, 100 * h);
    report(name, whole, arrival(pass[0]), (h < .0075 ? .03 : .02) * whole, started);
    snprintf(name, sizeof name, "free fall through soil: lowest particle, %s, eps %g, %g cm",
             paper ? "m15" : "akbari", e, 100 * h);
    const double touched = plug(e, paper, depth, head, depth);
    report(name, touched, arrival(pass[1]), .05 * touched, started);
    finish(&run);
  }
}

#endif
