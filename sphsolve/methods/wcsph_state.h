/* What a wcsph run carries from step to step, and its checkpoint. */
#ifndef TOSUI_METHODS_WCSPH_STATE_H
#define TOSUI_METHODS_WCSPH_STATE_H

#include "common/hdf5_file.h"
#include "sphsolve/engine/engine.h"
#include "sphsolve/monitor.h"

struct wcsph_state {
  struct engine engine;
  struct monitor monitor;
  int64_t step;
  double next_row; /* s: time of the next history row */
};

/* Sums over the fluid, in an order that no thread count changes. */
struct wcsph_totals {
  double velocity[3]; /* sum, m/s */
  double square;      /* sum of v^2 */
  double density;     /* sum of rho/rho_0 */
  double density_max; /* rho/rho_0 */
  size_t densest;     /* its slot */
  bool finite;
};
enum status wcsph_sum(const struct engine *engine, struct wcsph_totals *totals);

/* /state: everything that a later step depends on; a resumed run goes on bit for bit. */
enum status wcsph_write_state(const struct wcsph_state *state, struct h5_file *file);
enum status wcsph_read_state(struct h5_file *file, struct wcsph_state *state);

#endif
