#include <stdbool.h>

#include "sphsolve/solute/flow_internal.h"

enum status solute_flow_coarsen(const struct solute_flow *fine, struct solute_flow *c) {
  enum status status = STATUS_OK;
  int n[3];
  double spacing[3];
  for (int a = 0; a < 3; a++) {
    const bool halved = fine->n[a] > 1;
    if (halved && fine->n[a] % 2 != 0)
      return FAIL(STATUS_INPUT, "%d cells along %c cannot be taken two by two", fine->n[a],
                  "xyz"[a]);
    n[a] = halved ? fine->n[a] / 2 : 1;
    spacing[a] = (halved ? 2 : 1) * fine->spacing[a];
  }
  TRY(solute_flow_allocate(n, spacing, c));
  c->viscosity = fine->viscosity, c->density = fine->density;
  c->isolated = fine->isolated, c->correction = fine->correction;
  const int by[3] = {fine->n[0] > 1 ? 2 : 1, fine->n[1] > 1 ? 2 : 1, fine->n[2] > 1 ? 2 : 1};
  for (int a = 0; a < 3; a++) c->origin[a] = fine->origin[a] + 0.5 * (by[a] - 1) * fine->spacing[a];
  const float share = 1.0f / (float)(by[0] * by[1] * by[2]);
  for (int k = 0; k < fine->n[2]; k++)
    for (int j = 0; j < fine->n[1]; j++)
      for (int i = 0; i < fine->n[0]; i++) {
        const size_t from = solute_flow_at(fine, i, j, k);
        const int x[3] = {i, j, k};
        const size_t at = solute_flow_at(c, i / by[0], j / by[1], k / by[2]);
        c->distance[at] += share * fine->distance[from];
        c->volume[at] += share * fine->volume[from];
        for (int a = 0; a < 3; a++) {
          if (x[a] % by[a] != 0) continue;
          c->aperture[a][at] += share * (float)by[a] * fine->aperture[a][from];
          c->velocity[a][at] += share * (float)by[a] * fine->velocity[a][from];
        }
      }
  solute_flow_measure(c);
  c->grain_size = fine->grain_size;
cleanup:
  if (status != STATUS_OK) solute_flow_free(c);
  return status;
}
