#include "sphsolve/darcy/open_water.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/geometry/thin_wall.h"

/* Whether a site is an empty place whose lower end is below a height. */
static bool is_below(const struct lattice *l, size_t at, double height) {
  const size_t k = at / (l->size[0] * l->size[1]);
  const double low = l->origin[2] + ((double)k - 0.5) * l->spacing[2];
  return l->kind[at] == SITE_EMPTY && low < height - 1e-9 * l->spacing[2];
}

static double highest_head(const struct region *region) {
  double most = region->table.count > 0 ? -INFINITY : region->head;
  for (size_t k = 0; k < region->table.count; k++) most = fmax(most, region->table.value[k][0]);
  return most;
}

/* Fills what can be reached from a place beside a window. */
static enum status fill_from(const struct scene *scene, const struct lattice *l, size_t place,
                             uint16_t number, size_t *stack, uint16_t *region) {
  const struct region *window = &scene->regions[number - 1];
  const double height = highest_head(window);
  size_t count = 0;
  if (!is_below(l, place, height) || region[place] == number) return STATUS_OK;
  stack[count++] = place;
  while (count > 0) {
    const size_t at = stack[--count];
    if (region[at] == number) continue;
    if (region[at] != 0)
      return FAIL(STATUS_INPUT,
                  "%s:%d: the water of this window and that of line %d fill the same place; put "
                  "soil or a wall between them, as high as the higher head",
                  scene->path, window->line, scene->regions[region[at] - 1].line);
    region[at] = number;
    for (int axis = 0; axis < 3; axis++)
      for (int side = 0; side < 2; side++) {
        const size_t next = domain_beyond(scene, l, at, axis, side == 0);
        if (next == l->count || region[next] == number || !is_below(l, next, height) ||
            thin_wall_on_face(l, side == 0 ? next : at, axis))
          continue;
        stack[count++] = next;
      }
  }
  return STATUS_OK;
}

enum status open_water_find(const struct scene *scene, const struct lattice *l, uint16_t **region) {
  enum status status = STATUS_OK;
  size_t *stack = NULL;
  TRY(memory_allocate(region, l->count, sizeof **region, "free water"));
  /* each place is put there at most once from each of its sides */
  TRY(memory_allocate(&stack, 6 * l->count + 1, sizeof *stack, "free water"));
  for (size_t at = 0; at < l->count; at++)
    for (int side = 0; side < 6 && l->kind[at] == SITE_EMPTY; side++) {
      const size_t place[3] = {at % l->size[0], at / l->size[0] % l->size[1],
                               at / (l->size[0] * l->size[1])};
      double x[3], share = 0;
      if (domain_beyond(scene, l, at, side / 2, side % 2 == 0) != l->count) continue;
      if (l->dimensions == 2 && side / 2 == 1) continue;
      for (int a = 0; a < 3; a++) x[a] = l->origin[a] + (double)place[a] * l->spacing[a];
      const struct region *window = domain_inflow_at(scene, l, x, side / 2, side % 2 == 0, &share);
      if (window == NULL || window->boundary != BOUNDARY_HEAD) continue;
      TRY(fill_from(scene, l, at, (uint16_t)(window->first + 1), stack, *region));
    }
cleanup:
  memory_free(&stack);
  if (status != STATUS_OK) memory_free(region);
  return status;
}
