#include "sphsolve/isph/boundaries.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/state.h"

int isph_boundary_layers(const struct isph *s) {
  return (int)ceil(s->support_max / s->spacing - 1e-9);
}

enum status isph_boundary_add(struct isph *s, size_t *capacity, const double x[3],
                              enum boundary_kind kind, size_t box, double volume) {
  if (s->boundary_count == *capacity) {
    size_t n = *capacity < 1024 ? 1024 : 2 * *capacity;
    enum status status =
        memory_resize(&s->boundary_position, n, sizeof *s->boundary_position, "walls");
    if (status == STATUS_OK)
      status = memory_resize(&s->boundary_kind, n, sizeof *s->boundary_kind, "walls");
    if (status == STATUS_OK)
      status = memory_resize(&s->boundary_box, n, sizeof *s->boundary_box, "walls");
    if (status == STATUS_OK && (s->on.open_sides || s->wall_box_count > 1))
      status = memory_resize(&s->boundary_volume, n, sizeof *s->boundary_volume, "walls");
    if (status != STATUS_OK) return status;
    *capacity = n;
  }
  size_t j = s->boundary_count++;
  memcpy(s->boundary_position[j], x, sizeof(double[3]));
  s->boundary_kind[j] = (uint8_t)kind;
  s->boundary_box[j] = (uint16_t)box;
  if (s->boundary_volume != NULL) s->boundary_volume[j] = volume;
  return STATUS_OK;
}

enum status isph_boundary_trim(struct isph *s) {
  enum status status = STATUS_OK;
  const size_t n = s->boundary_count;
  TRY(memory_resize(&s->boundary_position, n, sizeof *s->boundary_position, "walls"));
  TRY(memory_resize(&s->boundary_kind, n, sizeof *s->boundary_kind, "walls"));
  TRY(memory_resize(&s->boundary_box, n, sizeof *s->boundary_box, "walls"));
  if (s->side_count > 0)
    TRY(memory_allocate(&s->boundary_pressure, n, sizeof *s->boundary_pressure, "walls"));
  if (s->boundary_volume != NULL)
    TRY(memory_resize(&s->boundary_volume, n, sizeof *s->boundary_volume, "walls"));
cleanup:
  return status;
}
