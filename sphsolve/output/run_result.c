#include "sphsolve/output/recorder.h"

#include <math.h>

#include "common/memory.h"
#include "common/ranks.h"

void result_from_darcy(const struct scene *scene, const double darcy_velocity[3],
                       struct run_result *result) {
  double along = 0, square = 0;
  for (int a = 0; a < 3; a++) {
    result->darcy_velocity[a] = darcy_velocity[a];
    along += darcy_velocity[a] * scene->driving[a];
    square += scene->driving[a] * scene->driving[a];
  }
  double driving = sqrt(square);
  result->k = result->intrinsic_permeability = NAN;
  if (!(driving > 0)) return;
  along /= driving;
  result->k = along / scene_hydraulic_gradient(scene);
  result->intrinsic_permeability = along * scene->fluid.viscosity / scene->fluid.density / driving;
}

/* Maximum over the ranks, and sum, of the communication between ranks. */
void recorder_count_traffic(struct recorder *recorder) {
  const struct ranks_traffic t = ranks_traffic(); // NOLINT: nothing to read for one rank
  if (!RANKS) return;
  recorder_set_fact(recorder, "ranks", ranks_count());
  recorder_set_fact(recorder, "ghost_messages", ranks_sum((double)t.messages));
  recorder_set_fact(recorder, "ghost_bytes", ranks_sum((double)t.bytes));
  recorder_set_fact(recorder, "ghost_bytes_most", ranks_max((double)t.bytes));
  recorder_set_fact(recorder, "gathered_bytes", ranks_sum((double)t.gathered_bytes));
  recorder_set_fact(recorder, "reductions", ranks_max((double)t.reductions));
  recorder_set_measured(recorder, "waiting_seconds", ranks_max(t.seconds));
  recorder_set_measured(recorder, "busy_seconds", ranks_sum(t.busy));
  recorder_set_measured(recorder, "busy_seconds_most", ranks_max(t.busy));
  recorder_set_measured(recorder, "memory_peak_bytes_all", ranks_sum((double)memory_peak()));
}
