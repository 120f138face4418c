/* A scene of method isph, read from text, and marched by hand; for test programs with cmocka. */
#ifndef TOSUI_TESTS_UNIT_ISPH_SCENE_H
#define TOSUI_TESTS_UNIT_ISPH_SCENE_H

#include <math.h>
#include <omp.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/threads.h"
#include "sphsolve/isph/copy.h"
#include "sphsolve/isph/gauge.h"
#include "sphsolve/isph/method.h"
#include "sphsolve/scene/scene_read.h"
#include "sphsolve/isph/create.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/section.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"
#include "sphsolve/isph/switches.h"
#include "sphsolve/solute/walk_random.h"

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

/* Moves the particles of a run that has just begun off their places by up to half of 1e-6 of a
 * spacing, differently for each draw: what follows from that in disordered water is chance. */
static inline void draw_places(struct run *run, uint32_t draw) {
  for (size_t i = 0; i < run->s.count; i++) {
    uint32_t word[4] = {draw, (uint32_t)i};
    philox4x32(word, 0, 0);
    for (int a = 0; a < 3; a += 2)
      run->s.position[i][a] += 1e-6 * run->s.spacing * ((double)random_share(word[a]) - 0.5);
  }
  assert_int_equal(isph_refresh(&run->s), STATUS_OK);
}

static inline void finish(struct run *run) {
  isph_free(&run->s);
  lattice_free(&run->lattice);
  scene_free(&run->scene);
}

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

/* The same bits on one thread, on two, and on one after a state was gone back to: `begin` starts a
 * scene and marches it to where that is kept, `lost` steps of dt are taken back, `steps` follow;
 * `read` gives two numbers of what is tested. */
static inline void same_on_threads_and_back(void (*begin)(struct run *), double dt, int lost,
                                            int steps,
                                            void (*read)(const struct isph *, double[2])) {
  double found[3][4];
  const int threads = omp_get_max_threads();
  for (int k = 0; k < 3; k++) {
    struct run run;
    struct isph_copy copy = {0};
    threads_use(k == 1 ? 2 : 1);
    begin(&run);
    if (k == 2) {
      assert_int_equal(isph_copy_state(&run.s, &copy), STATUS_OK);
      for (int n = 0; n < lost; n++) assert_int_equal(isph_advance(&run.s, dt), STATUS_OK);
      assert_int_equal(isph_restore_state(&run.s, &copy), STATUS_OK);
      isph_copy_free(&copy);
    }
    for (int n = 0; n < steps; n++) assert_int_equal(isph_advance(&run.s, dt), STATUS_OK);
    read(&run.s, found[k]);
    found[k][2] = (double)run.s.count, found[k][3] = 0;
    for (size_t i = 0; i < run.s.count; i++)
      found[k][3] += run.s.position[i][0] * run.s.pressure[i];
    finish(&run);
  }
  threads_use(0);
  omp_set_num_threads(threads);
  assert_memory_equal(found[0], found[1], sizeof found[0]);
  assert_memory_equal(found[0], found[2], sizeof found[0]);
}

#endif
