#include "sphsolve/isph/copy.h"

#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/particles.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/wall.h"

enum { ARRAYS = ISPH_FIELDS + ISPH_EFFECTS + 5 };

/* The arrays of a state that are copied: per own particle, per boundary particle, per region. */
static size_t copied_arrays(const struct isph *s, void *array[ARRAYS], size_t bytes[ARRAYS]) {
  const size_t own = s->local.end - s->local.begin;
  struct isph_kept state;
  size_t n = 0;
  isph_fields_kept(s, &state);
  for (; n < state.count; n++) {
    const size_t size = state.field[n].size;
    bytes[n] = own * size;
    array[n] = own > 0 ? isph_field_data(s, &state.field[n]) + s->local.begin * size : NULL;
  }
#define ADD(member, count)                                                                         \
  do {                                                                                             \
    array[n] = (count) > 0 ? s->member : NULL;                                                     \
    bytes[n++] = (count) * sizeof *s->member;                                                      \
  } while (0)
  ADD(boundary_position, s->on.moving_walls || s->on.open_sides ? s->boundary_count : 0);
  ADD(wall_boxes, s->wall_box_count);
  ADD(soil_offset, s->scene->region_count);
  ADD(column_front, s->column_count);
  ADD(wells, s->well_count);
  for (size_t k = 0; k < s->on.active_count; k++) ADD(own_numbers[k], isph_own_count(s, k));
#undef ADD
  return n;
}

enum status isph_copy_state(const struct isph *s, struct isph_copy *copy) {
  enum status status = STATUS_OK;
  void *array[ARRAYS];
  size_t bytes[ARRAYS], total = 0, used = 0, n = copied_arrays(s, array, bytes);
  for (size_t i = 0; i < n; i++) total += bytes[i];
  TRY(memory_resize(&copy->block, total, 1, "a state to go back to"));
  for (size_t i = 0; i < n; i++) {
    if (array[i]) memcpy(copy->block + used, array[i], bytes[i]);
    used += bytes[i];
  }
  copy->count = s->local.end - s->local.begin;
  copy->time = s->time, copy->viscosity_most = s->viscosity_most;
  copy->step = s->step;
  copy->next_id = s->next_id;
  copy->passed = s->passed;
  copy->budget = s->budget;
  copy->counts[0] = s->lost_count, copy->counts[1] = s->left_count;
  copy->counts[2] = s->entered_count;
cleanup:
  return status;
}

void isph_copy_pressure(const struct isph *s, struct isph_copy *copy) {
  void *array[ARRAYS];
  size_t bytes[ARRAYS], used = 0, n = copied_arrays(s, array, bytes);
  for (size_t i = 0; i < n; i++) {
    if (array[i] != NULL && array[i] == (void *)(s->pressure + s->local.begin))
      memcpy(copy->block + used, array[i], bytes[i]);
    used += bytes[i];
  }
}

enum status isph_restore_state(struct isph *s, const struct isph_copy *copy) {
  enum status status = STATUS_OK;
  void *array[ARRAYS];
  size_t bytes[ARRAYS], used = 0;
  TRY(isph_reserve(s, copy->count));
  s->count = s->local.end = copy->count;
  s->local.begin = 0;
  size_t n = copied_arrays(s, array, bytes);
  for (size_t i = 0; i < n; i++) {
    if (array[i]) memcpy(array[i], copy->block + used, bytes[i]);
    used += bytes[i];
  }
  s->time = copy->time, s->viscosity_most = copy->viscosity_most;
  s->step = copy->step;
  s->next_id = copy->next_id;
  s->passed = copy->passed;
  s->budget = copy->budget;
  s->lost_count = copy->counts[0], s->left_count = copy->counts[1];
  s->entered_count = copy->counts[2];
  isph_apply_tables(s, 0);
  isph_open_update_dry(s, false);
  isph_wall_move(s, 0);
  TRY(isph_sort_walls(s));
  TRY(isph_refresh(s));
cleanup:
  return status;
}

void isph_copy_free(struct isph_copy *copy) {
  memory_free(&copy->block);
}
