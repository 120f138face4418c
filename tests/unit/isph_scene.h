/* A scene of method isph, read from text, and marched by hand; for test programs with cmocka. */
#ifndef TOSUI_TESTS_UNIT_ISPH_SCENE_H
#define TOSUI_TESTS_UNIT_ISPH_SCENE_H

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sphsolve/isph/gauge.h"
#include "sphsolve/isph/method.h"

struct run {
  struct scene scene;
  struct lattice lattice;
  struct plan plan;
  struct isph s;
};

static inline void start(struct run *run, const char *text) {
  char path[] = "/tmp/test_isph_XXXXXX";
  int handle = mkstemp(path);
  assert_true(handle >= 0);
  FILE *file = fdopen(handle, "w");
  assert_non_null(file);
  /* What stands behind an @ is of the fluid. */
  const char *more = strchr(text, '@');
  fprintf(file,
          "fluids = ( { name = \"water\"; density = \"1000 kg/m^3\"; "
          "viscosity = \"1e-3 Pa s\"; %s } );\n%.*s",
          more ? more + 1 : "", (int)(more ? more - text : (ptrdiff_t)strlen(text)), text);
  fclose(file);
  struct isph_switches on;
  memset(run, 0, sizeof *run);
  assert_int_equal(scene_read(path, NULL, 0, &run->scene), STATUS_OK);
  unlink(path);
  assert_int_equal(lattice_build(&run->scene, 0, &run->lattice), STATUS_OK);
  assert_int_equal(plan_make(&run->scene, &run->lattice, &method_isph, "test", 1, &run->plan),
                   STATUS_OK);
  assert_int_equal(isph_switches_of(&run->plan, &on), STATUS_OK);
  assert_int_equal(isph_create(&run->scene, &run->lattice, &on, &run->s), STATUS_OK);
}

static inline void finish(struct run *run) {
  isph_free(&run->s);
  lattice_free(&run->lattice);
  scene_free(&run->scene);
}

/* Pa. */
static inline double pressure_at(const struct isph *s, const double point[3]) {
  double number[GAUGE_NUMBERS];
  isph_read_gauge(s, point, number);
  return number[0];
}

/* Returns the number of steps. */
static inline int advance(struct run *run, double until) {
  int steps = 0;
  while (run->s.time < until - 1e-9) {
    const char *limit;
    double dt = fmin(isph_stable_dt(&run->s, &limit), until - run->s.time);
    assert_int_equal(isph_advance(&run->s, dt), STATUS_OK);
    steps++;
  }
  return steps;
}

#endif
