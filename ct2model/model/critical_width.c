#include "ct2model/model/critical_width.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/model/connect.h"

/* The critical diameter of Katz and Thompson (1986, Phys. Rev. B 34: 8179): the largest one at
 * which the pores at least as wide still percolate. The threshold of the distance to the walls is
 * found by bisection, in steps of an eighth of a voxel, up to 64 voxels. */
enum { STEPS = 8, WIDEST = 64 };

static enum status percolates_at(const struct voxel_model *model, size_t layers, float distance,
                                 uint8_t *wide, bool *through) {
  enum status status = STATUS_OK;
  const size_t size[3] = {model->size[0], model->size[1], layers};
  const bool whole = layers == model->size[2];
  const bool periodic[3] = {model->periodic[0], model->periodic[1], model->periodic[2] && whole};
  struct parts parts = {0};
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < size[0] * size[1] * layers; i++)
    wide[i] = model->solid[i] == 0 && model->wall_distance[i] >= distance;
  TRY(parts_find(wide, size, periodic, 1, &parts));
  *through = false;
  for (size_t i = 0; i < parts.count; i++) *through |= parts.parts[i].percolates[2];
cleanup:
  parts_end(&parts);
  return status;
}

enum status critical_width_find(const struct voxel_model *model, size_t layers, double *width) {
  enum status status = STATUS_OK;
  uint8_t *wide = NULL;
  int low = 0, high = STEPS * WIDEST; /* `low` percolates, `high` does not */
  bool through = false;
  *width = 0.0;
  TRY(memory_allocate(&wide, model->size[0] * model->size[1] * layers, 1, "pores by their width"));
  TRY(percolates_at(model, layers, 0.0F, wide, &through));
  while (through && high - low > 1) {
    const int middle = (low + high) / 2;
    bool middle_through = false;
    TRY(percolates_at(model, layers, (float)(0.5 * middle / STEPS * model->spacing[0]), wide,
                      &middle_through));
    *(middle_through ? &low : &high) = middle;
  }
  *width = through ? fmax((double)low, 0.5) / STEPS : 0.0;
cleanup:
  memory_free(&wide);
  return status;
}
