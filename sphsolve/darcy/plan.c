/* Forecast of the cost of method richards: memory, steps, time. */
#include <math.h>
#include <stdio.h>

#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/method.h"
#include "sphsolve/darcy/state.h"

enum status richards_scales(struct plan *plan) {
  (void)plan; /* neighbours are the six next to a site: no kernel */
  return STATUS_OK;
}

enum status richards_cost(struct plan *plan, int threads) {
  const struct lattice *lattice = plan->context.lattice;
  const double n = (double)lattice->fluid_count;
  enum status status = richards_refuse(&plan->context);
  if (status != STATUS_OK) return status;
  double longest = 0, faces = 0;
  for (int a = 0; a < 3; a++) {
    longest = fmax(longest, (double)lattice->size[a]);
    faces += lattice->size[a] > 1;
  }
  plan->dt = NAN;
  const bool full = domain_is_full(plan->context.scene);
  plan->dt_by = full ? "what is given in time" : "the error of the water content";
  plan->bytes_fluid = 10 * sizeof(double) + SNAPSHOT_BYTES + 2 * sizeof(struct retention_state) +
                      6 + faces * (double)(sizeof(struct richards_face) + sizeof(struct flux)) +
                      (1 + 2 * faces) * 20 + 9 * sizeof(double) + 6 * sizeof(uint32_t);
  plan->bytes_method = n * plan->bytes_fluid + 6 * (double)lattice->count;
  plan->steps = plan->seconds = NAN; /* fronts, levels and rain make steps short for a while */
  if (full) {
    const struct scene *scene = plan->context.scene;
    double solves = 1, rows = scene->end_time / scene->history_interval;
    for (size_t r = 0; r < scene->region_count; r++)
      if (scene->regions[r].table.count > 0) solves = ROWS_USUAL;
    plan->steps = isfinite(rows) ? ceil(rows) : solves;
    if (solves > 1) solves = plan->steps;
    plan->seconds = solves * n * (SECONDS_FULL + SECONDS_FULL_ROUND * longest);
    bool holes = false;
    for (size_t r = 0; r < scene->region_count; r++)
      holes = holes || region_is_sink(&scene->regions[r]);
    plan->bytes_fluid += sizeof(double);
    if (holes) plan->bytes_fluid += 6 * sizeof(float);
    plan->bytes_method = n * plan->bytes_fluid + 4 * (double)lattice->count;
    snprintf(plan->expected.why, sizeof plan->expected.why,
             "layers between sites are exact; halve the spacing for corners and walls");
    return STATUS_OK;
  }
  (void)threads; /* the linear solver runs on one */
  snprintf(plan->expected.why, sizeof plan->expected.why,
           "no k is asked for; halve the spacing to see what is left in a front");
  return STATUS_OK;
}
