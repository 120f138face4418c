/* The three methods behind one signature. They share lattice, plan and recorder, nothing else. */
#ifndef TOSUI_SPHSOLVE_PLAN_METHOD_H
#define TOSUI_SPHSOLVE_PLAN_METHOD_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/scene/scene.h"

/* Run to the end (steady, end_time, or a signal). `result` is filled also when interrupted. The
 * lattice is afterwards what it was; meanwhile a method may set parts of it aside. */
enum status wcsph_run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                      struct recorder *recorder, struct run_result *result);
enum status stokes_run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                       struct recorder *recorder, struct run_result *result);
enum status isph_run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                     struct recorder *recorder, struct run_result *result);

#endif
