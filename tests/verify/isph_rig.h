/* What verify_isph and verify_seepage share: a scene written as a user would write it, through
 * scene, lattice and plan, advanced to a time, and its results. Each program includes this once. */
#ifndef TOSUI_TESTS_VERIFY_ISPH_RIG_H
#define TOSUI_TESTS_VERIFY_ISPH_RIG_H

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/error.h"
#include "common/json_number.h"
#include "common/log.h"
#include "sphsolve/isph/section.h"
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/method.h"
#include "sphsolve/scene/scene_read.h"
#include "sphsolve/isph/create.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"
#include "sphsolve/isph/switches.h"

static json_t *results;
static char scene_file[] = "/tmp/verify_isph_XXXXXX";
static const char *fluid_more = ""; /* further settings of the fluid */
static const char *const *wanted;
static int wanted_count;

struct run {
  struct scene scene;
  struct lattice lattice;
  struct plan plan;
  struct isph s;
};

/* Through a plane at x, m^3/s. */
static inline double flux_at(const struct isph *s, double x) {
  return isph_section_flux(s, &(struct flux_plane){.axis = 0, .position = x});
}

/* Pa. */
static inline double pressure_at(const struct isph *s, const double point[3]) {
  double number[GAUGE_NUMBERS];
  isph_read_gauge(s, point, number);
  return number[0];
}

static inline double rms_velocity(const struct isph *s) {
  double sum = 0;
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a++) sum += s->velocity[i][a] * s->velocity[i][a];
  return sqrt(sum / (double)s->count);
}

/* The rms velocity, m/s, that is in none of the first sloshing modes of a tank of the given width
 * and depth: the modes' amplitudes by least squares. */
static inline double rms_beside_modes(const struct isph *s, double width, double depth) {
  enum { MODES = 6 };
  double m[MODES][MODES + 1] = {{0}}, amplitude[MODES], sum = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < s->count; i++) {
      const double *x = s->position[i];
      double u[MODES], w[MODES], left[2] = {s->velocity[i][0], s->velocity[i][2]};
      for (int n = 0; n < MODES; n++) {
        const double k = (n + 1) * M_PI / width;
        u[n] = -cosh(k * x[2]) / sinh(k * depth) * sin(k * x[0]);
        w[n] = sinh(k * x[2]) / sinh(k * depth) * cos(k * x[0]);
      }
      for (int n = 0; n < MODES && pass == 0; n++) {
        for (int q = 0; q < MODES; q++) m[n][q] += u[n] * u[q] + w[n] * w[q];
        m[n][MODES] += u[n] * left[0] + w[n] * left[1];
      }
      for (int n = 0; n < MODES && pass == 1; n++)
        left[0] -= amplitude[n] * u[n], left[1] -= amplitude[n] * w[n];
      if (pass == 1) sum += left[0] * left[0] + left[1] * left[1];
    }
    for (int p = 0; p < MODES && pass == 0; p++)
      for (int q = 0; q < MODES; q++)
        for (int c = MODES; q != p && c >= p; c--) m[q][c] -= m[p][c] * m[q][p] / m[p][p];
    for (int n = 0; n < MODES; n++) amplitude[n] = m[n][MODES] / m[n][n];
  }
  return sqrt(sum / (double)s->count);
}

static void give_up(void) {
  fprintf(stderr, "verification: %s\n", error_message());
  exit(1);
}

static void start(struct run *run, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  FILE *file = fopen(scene_file, "w");
  if (file == NULL) exit(1);
  fprintf(file,
          "fluids = ( { name = \"water\"; density = \"1000 kg/m^3\"; "
          "viscosity = \"1e-3 Pa s\"; %s } );\n",
          fluid_more);
  vfprintf(file, format, arguments);
  fclose(file);
  va_end(arguments);
  struct isph_switches on;
  if (scene_read(scene_file, NULL, 0, &run->scene) ||
      lattice_build(&run->scene, plan_wall_layers(&run->scene), &run->lattice) ||
      plan_make(&run->scene, &run->lattice, &method_isph, "verification", 1, &run->plan))
    give_up();
  if (isph_switches_of(&run->plan, &on) || isph_create(&run->scene, &run->lattice, &on, &run->s))
    give_up();
}

/* .6 m of water long in a tank of a given length, H deep, before a gate lifted at the median speed
 * of Lobovsky, Botia-Vera, Castellana, Mas-Soler, Souto-Iglesias 2014, J. Fluids Struct. 48. The
 * walls slip or hold. */
static inline void start_gated_dam(struct run *run, double wide, double depth, double dx,
                                   bool slip) {
  start(run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "isph = { wall = { slip = %s; }; };\n"
        "domain = { size = [\"%.9g m\", \"%g m\"]; spacing = \"%g m\"; periodic = [false, "
        "false]; };\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.6 m\", \"%g m\"]; },\n"
        "{ type = \"wall\"; box = [\"0.6 m\", \"0\", \"%g m\", \"%g m\"]; velocity = [\"0\", "
        "\"%g m/s\"]; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
        slip ? "true" : "false", wide, 1.5 * depth, dx, depth, .6 + 2 * dx, 1.2 * depth,
        depth < .5 ? 3.46 : 4.53);
}

static void finish(struct run *run) {
  isph_free(&run->s);
  lattice_free(&run->lattice);
  scene_free(&run->scene);
}

static inline void advance(struct run *run, double until) {
  while (run->s.time < until - 1e-9) {
    const char *limit;
    double dt = isnan(run->plan.dt) ? isph_stable_dt(&run->s, &limit) : run->plan.dt;
    dt = fmin(dt, until - run->s.time);
    if (isph_advance(&run->s, dt)) give_up();
  }
}

static bool case_wanted(const char *name) {
  for (int i = 0; i < wanted_count; i++)
    if (!strncmp(name, wanted[i], strlen(wanted[i]))) return true;
  return wanted_count == 0;
}

static void record(const char *status, const char *name, double reference, double measured,
                   double bound, double started) {
  double seconds = clock_seconds() - started;
  printf("%-4s %-52s reference %-11.5g measured %-11.5g bound %-9.3g %6.1f s\n", status, name,
         reference, measured, bound, seconds);
  fflush(stdout);
  json_array_append_new(results,
                        json_pack("{s:s, s:s, s:f, s:o, s:f, s:f}", "case", name, "status", status,
                                  "reference", reference, "measured", json_number(measured),
                                  "bound", bound, "seconds", seconds));
}

/* `bound`: largest |measured - reference|. */
static void report(const char *name, double reference, double measured, double bound,
                   double started) {
  record(fabs(measured - reference) <= bound ? "pass" : "fail", name, reference, measured, bound,
         started);
}

/* What is shown, and not judged. */
static inline void show(const char *name, double reference, double measured, double started) {
  record("skip", name, reference, measured, 0, started);
}

struct verify_case {
  const char *name;
  void (*run)(void);
};

/* The main of both: PROGRAM RESULTS.json [CASE...]. */
static int run_cases(int argc, char **argv, const struct verify_case *cases, size_t n) {
  if (argc < 2) return fprintf(stderr, "usage: %s RESULTS.json [CASE...]\n", argv[0]), 2;
  wanted = (const char *const *)argv + 2;
  wanted_count = argc - 2;
  log_start("verification", LOG_NORMAL);
  results = json_array();
  int handle = mkstemp(scene_file);
  if (handle < 0) return 1;
  close(handle);
  for (size_t i = 0; i < n; i++)
    if (case_wanted(cases[i].name)) cases[i].run();
  unlink(scene_file);
  int failed = json_dump_file(results, argv[1], JSON_INDENT(1) | JSON_REAL_PRECISION(9));
  json_decref(results);
  return failed ? 1 : 0;
}

#endif
