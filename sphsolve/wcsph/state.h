/* State of a wcsph run, and its checkpoint. */
#ifndef TOSUI_SPHSOLVE_WCSPH_STATE_H
#define TOSUI_SPHSOLVE_WCSPH_STATE_H

#include "common/hdf5_file.h"
#include "common/scratch_file.h"
#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/wcsph/budget.h"
#include "sphsolve/march/monitor.h"
#include "sphsolve/march/watchdog.h"

/* Minimum number of samples of the Darcy velocity before a flow may be called steady: the slowest
 * mode of a slit has then decayed to 1e-7. */
#define WCSPH_SAMPLES_LEAST 80

struct wcsph_state {
  struct engine engine;
  struct monitor monitor;
  int64_t step;
  double next_row; /* s: time of the next history row */
  /* The step is that of the plan / 2^halvings; time = time_from + (step - step_from) dt. A sample
   * is due every sample_steps 2^halvings steps, counted from sample_from. */
  int halvings;
  double time_from;
  int64_t step_from, sample_from, sample_steps;
  struct watchdog dog;
  struct wcsph_budget budget;
};
/* Time of the present state, s. */
double wcsph_time(const struct wcsph_state *state);
bool wcsph_sample_due(const struct wcsph_state *state);
/* Halves or doubles the step; doubling is refused (false) except on steps at which a sample can
 * fall. */
void wcsph_halve(struct wcsph_state *state);
bool wcsph_double(struct wcsph_state *state);

/* A copy of the state to return to, on disk next to the results: it is read only after a trip of
 * the watchdog. */
struct wcsph_copy {
  const char *beside; /* path next to which the file is made; owned by the caller */
  struct scratch_file file;
  size_t clusters, samples;
  int64_t step, sample_from;
  double time, moved, speed_max, next_row;
  int halvings;
  struct wcsph_budget budget;
};
/* Stores a copy of the state in the file next to copy->beside. */
enum status wcsph_keep(struct wcsph_state *state, struct wcsph_copy *copy);
/* Restores the copy; the present step is kept unless the copy's was shorter. */
enum status wcsph_go_back(const struct wcsph_copy *copy, struct wcsph_state *state);
void wcsph_copy_free(struct wcsph_copy *copy);

/* Sums over the fluid, in an order independent of the number of threads. */
struct wcsph_totals {
  double velocity[3]; /* sum, m/s */
  double flux[3];     /* sum including the parts next to walls: volume integral / site volume */
  double square;      /* sum of v^2 */
  double density;     /* sum of rho/rho_0 */
  double compression; /* sum of (rho/rho_0 - 1)^2 */
  double density_max; /* rho/rho_0 */
  double density_min, speed_max;
  size_t densest, thinnest, fastest; /* slots */
  bool finite;
};
/* `flux` costs half a step with sub-voxel walls; without it totals.flux is the plain sum. */
enum status wcsph_sum(struct engine *engine, bool flux, struct wcsph_totals *totals);

/* Write and read /state: everything that later steps depend on, so that a resumed run is bitwise
 * identical. */
enum status wcsph_write_state(struct wcsph_state *state, struct h5_file *file);
enum status wcsph_read_state(struct h5_file *file, struct wcsph_state *state);

#endif
