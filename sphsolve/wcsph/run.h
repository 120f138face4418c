/* State of a wcsph run, shared by the time loop (method.c), its steps (step.c), the watchdog
 * (watch.c) and the output (output.c). */
#ifndef TOSUI_SPHSOLVE_WCSPH_RUN_H
#define TOSUI_SPHSOLVE_WCSPH_RUN_H

#include "sphsolve/output/recorder.h"
#include "sphsolve/wcsph/state.h"
#include "sphsolve/plan/reynolds.h"

struct wcsph_run {
  const struct scene *scene;
  const struct plan *plan;
  const struct lattice *lattice;
  struct recorder *recorder;
  struct wcsph_state state;
  struct wcsph_copy copy;
  int64_t last_step;
  double wall_speed;   /* m/s, largest wall velocity */
  double row_interval; /* s; NAN: each sample */
  double pore_width;   /* m */
  double diameter;     /* m: hydraulic diameter of the pores; 0 without walls */
  double direction[3]; /* of the force, or of the first moving wall */
  double started;
};

/* Reynolds number of a Darcy velocity (m/s). */
static inline double wcsph_reynolds(const struct wcsph_run *run, const double darcy[3]) {
  const struct lattice *l = run->lattice;
  return reynolds_number(darcy, (double)l->fluid_count / l->bulk_count, run->diameter,
                         run->plan->context.kinematic_viscosity);
}

static inline double wcsph_run_time(const struct wcsph_run *run) {
  return wcsph_time(&run->state);
}

/* Computes one step and what is due after it; *due: a sample is due, which is false if the run
 * returned to an earlier state. */
enum status wcsph_step(struct wcsph_run *run, bool *due);
/* Takes a sample of the Darcy velocity and judges its steadiness. */
enum status wcsph_sample(struct wcsph_run *run, struct monitor_verdict *verdict);
struct monitor_verdict wcsph_verdict(const struct wcsph_run *run);
/* Takes a sample of the conservation budget. */
enum status wcsph_budget_now(struct wcsph_run *run);

/* Checks the state; keeps a good one, returns to the kept one if it is bad (*again). */
enum status wcsph_watch(struct wcsph_run *run, bool *again);
/* Returns to the last good state with half the step; after three times the run ends with that state
 * in its checkpoint. `what`: the failure at `time`. */
enum status wcsph_step_back(struct wcsph_run *run, double time, const char *what);
/* Sets the step at which end_time is reached with the present dt. */
void wcsph_set_last_step(struct wcsph_run *run);
/* The effect that limits the present dt. */
const char *wcsph_limiting_effect(const struct wcsph_run *run);

/* Write a row of the history from `totals`; a snapshot; a checkpoint; and read a checkpoint
 * (*resumed: there was one). Collective. */
enum status wcsph_write_row(struct wcsph_run *run, const struct wcsph_totals *totals);
enum status wcsph_write_snapshot(struct wcsph_run *run);
enum status wcsph_write_checkpoint(struct wcsph_run *run);
enum status wcsph_read_checkpoint(struct wcsph_run *run, bool *resumed);

#endif
