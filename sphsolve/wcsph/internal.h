/* A wcsph run between its parts: the march (method.c), its steps (step.c), the watch over it
 * (watch.c) and what it leaves in files (output.c). */
#ifndef TOSUI_SPHSOLVE_WCSPH_INTERNAL_H
#define TOSUI_SPHSOLVE_WCSPH_INTERNAL_H

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
  double wall_speed;   /* m/s, the largest */
  double row_interval; /* s; NAN: each sample */
  double pore_width;   /* m */
  double diameter;     /* m: hydraulic, of the pores; 0 without walls */
  double direction[3]; /* of the force, or of the first moving wall */
  double started;
};

/* Of a Darcy velocity, m/s. */
static inline double wcsph_reynolds(const struct wcsph_run *run, const double darcy[3]) {
  const struct lattice *l = run->lattice;
  return reynolds_number(darcy, (double)l->fluid_count / l->bulk_count, run->diameter,
                         run->plan->context.kinematic_viscosity);
}

static inline double wcsph_run_time(const struct wcsph_run *run) {
  return wcsph_time(&run->state);
}

/* One step and what follows it; *due: a sample is, never where the run went back instead. */
enum status wcsph_step(struct wcsph_run *run, bool *due);
/* Takes a sample of the Darcy velocity; whether it has settled. */
enum status wcsph_sample(struct wcsph_run *run, struct monitor_verdict *verdict);
struct monitor_verdict wcsph_verdict(const struct wcsph_run *run);
/* Sums the conservation budget now. */
enum status wcsph_budget_now(struct wcsph_run *run);

/* Looks at the state, keeps it if it is good, goes back if it is not (*again). */
enum status wcsph_watch(struct wcsph_run *run, bool *again);
/* Back to the last good state with half the step; after three times the run ends with that state in
 * its checkpoint. `what` went wrong at `time`. */
enum status wcsph_step_back(struct wcsph_run *run, double time, const char *what);
/* The step at which end_time is reached with the present dt. */
void wcsph_set_last_step(struct wcsph_run *run);
/* The effect that limits the present dt. */
const char *wcsph_limiting_effect(const struct wcsph_run *run);

/* A row of the history from the sums at hand; all particles; the state, and the same read back
 * (*resumed: there was one). Collective. */
enum status wcsph_write_row(struct wcsph_run *run, const struct wcsph_totals *totals);
enum status wcsph_write_snapshot(struct wcsph_run *run);
enum status wcsph_write_checkpoint(struct wcsph_run *run);
enum status wcsph_read_checkpoint(struct wcsph_run *run, bool *resumed);

#endif
