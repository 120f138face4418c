/* A scene of methods richards or darcy, read from text as a user would write it, and marched by
 * hand; for test and verification programs. */
#ifndef TOSUI_TESTS_UNIT_RICHARDS_SCENE_H
#define TOSUI_TESTS_UNIT_RICHARDS_SCENE_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/error.h"
#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/method.h"
#include "sphsolve/darcy/output.h"
#include "sphsolve/darcy/sites.h"
#include "sphsolve/darcy/step.h"
#include "sphsolve/scene/scene_read.h"

struct run {
  struct scene scene;
  struct lattice lattice;
  struct plan plan;
  struct richards s;
};

static inline void must_be_well(enum status status) {
  if (status == STATUS_OK) return;
  fprintf(stderr, "richards: %s\n", error_message());
  abort();
}

__attribute__((format(printf, 2, 3))) static inline void start(struct run *run, const char *format,
                                                               ...) {
  char path[] = "/tmp/test_richards_XXXXXX";
  va_list arguments;
  FILE *file = fdopen(mkstemp(path), "w");
  if (file == NULL) abort();
  fputs("fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n", file);
  va_start(arguments, format);
  vfprintf(file, format, arguments);
  va_end(arguments);
  fclose(file);
  memset(run, 0, sizeof *run);
  must_be_well(scene_read(path, NULL, 0, &run->scene));
  unlink(path);
  must_be_well(lattice_build(&run->scene, 0, &run->lattice));
  const struct method *method = domain_is_full(&run->scene) ? &method_darcy : &method_richards;
  must_be_well(plan_make(&run->scene, &run->lattice, method, "test", 1, &run->plan));
  must_be_well(richards_create(&run->scene, &run->lattice, &run->s));
}

static inline void finish(struct run *run) {
  richards_free(&run->s);
  lattice_free(&run->lattice);
  scene_free(&run->scene);
}

/* To a time, which a step ends at; how it ended. */
static inline enum status try_advance(struct run *run, double time) {
  double dt;
  enum status status = STATUS_OK;
  while (status == STATUS_OK && run->s.time < time) status = richards_advance(&run->s, time, &dt);
  richards_evaluate(&run->s, run->s.time);
  return status;
}
static inline void advance(struct run *run, double time) {
  must_be_well(try_advance(run, time));
}

/* What is open of the water, over all that was there and came. */
static inline double water_open(const struct richards *s) {
  return fabs(richards_water(s) - s->start - richards_net_inflow(s)) / (s->start + s->in);
}

/* A column of soil, one site wide, `length` m high, with gravity unless it is lying. */
#define GRAVITY "force = { gravity = [\"0\", \"-9.80665 m/s^2\"]; };\n"
static inline void start_column(struct run *run, double length, double spacing, const char *soil,
                                const char *more) {
  start(run,
        "scene = { end_time = \"1000 d\"; };\n"
        "domain = { size = [\"%.12g m\", \"%.12g m\"]; spacing = \"%.12g m\"; "
        "periodic = [true, false]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"%.12g m\", \"%.12g m\"]; %s } "
        "%s );\n" GRAVITY,
        spacing, length, spacing, spacing, length, soil, more);
}

#endif
