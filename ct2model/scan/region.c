#include "ct2model/scan/region.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

size_t region_batch(const struct region *region) {
  const double bytes = 32e6;
  double slice = (double)region->size[0] * (double)region->size[1] * sizeof(float);
  double n = floor(bytes / slice);
  return n < 4.0 ? 4 : n > 64.0 ? 64 : (size_t)n;
}

static bool is_whole(const struct region *region) {
  return region->size[0] == region->stack->size[0] && region->size[1] == region->stack->size[1];
}

static enum status read_one(const struct region *region, size_t z, float *whole, float *out) {
  const struct stack *stack = region->stack;
  if (is_whole(region)) whole = out; /* in place */
  enum status status = stack_read(stack, region->origin[2] + z, whole);
  if (status != STATUS_OK) return status;
  float scale = (float)region->scale;
  for (size_t y = 0; y < region->size[1]; y++) {
    const float *row = whole + (region->origin[1] + y) * stack->size[0] + region->origin[0];
    for (size_t x = 0; x < region->size[0]; x++) {
      float grey = scale * row[x];
      if (!isfinite(grey)) {
        char name[160];
        const char *field = stack_no_data(stack, region->origin[2] + z);
        stack_slice_name(stack, region->origin[2] + z, name, sizeof name);
        return FAIL(STATUS_INPUT,
                    "%s: pixel %zu,%zu is no %s%s; crop it away (--crop) or repair %s", name,
                    region->origin[0] + x, region->origin[1] + y,
                    field == NULL ? "finite number" : "measurement, as the file says by its ",
                    field == NULL ? "" : field, field == NULL ? "the slice" : "that");
      }
      out[y * region->size[0] + x] = grey;
    }
  }
  return region->correction == NULL ? STATUS_OK : region->correction->apply(region, out);
}

bool region_has_levels(const struct region *region) {
  return region->held == NULL && region->correction == NULL && region->stack->has_levels;
}

size_t region_buffer_size(const struct region *region) {
  const struct stack *stack = region->stack;
  size_t whole = stack->size[0] * stack->size[1], part = region->size[0] * region->size[1];
  if (region->held != NULL) return 0;
  if (region_has_levels(region)) return whole * pixel_size(stack->type);
  return (is_whole(region) ? whole : whole + part) * sizeof(float);
}

enum status region_read_rows(const struct region *region, size_t z, void *buffer,
                             struct pixel_rows *rows) {
  const struct stack *stack = region->stack;
  const size_t whole = region->held == NULL ? stack->size[0] * stack->size[1] : 0;
  if (region_has_levels(region)) {
    const size_t bytes = pixel_size(stack->type);
    *rows = (struct pixel_rows){
        (char *)buffer + (region->origin[1] * stack->size[0] + region->origin[0]) * bytes,
        stack->size[0] * bytes, stack->type, (float)region->scale};
    return stack_read_stored(stack, region->origin[2] + z, buffer);
  }
  if (region->held != NULL) {
    const size_t row = region->size[0] * pixel_size(region->held_type);
    *rows = (struct pixel_rows){(const char *)region->held + z * row * region->size[1], row,
                                region->held_type, 1.0f};
    return STATUS_OK;
  }
  *rows = (struct pixel_rows){buffer, region->size[0] * sizeof(float), PIXEL_F32, 1.0f};
  float *slice = is_whole(region) ? buffer : (float *)buffer + whole;
  rows->first = slice;
  return read_one(region, z, buffer, slice);
}

/* Reads columns first[0] on and rows first[1] on, size[0] x size[1], of n slices, whose numbers are
 * numbers[i] or, if that is NULL, follow first[2]. */
static enum status read_slices(const struct region *region, const size_t *numbers, size_t n,
                               const size_t first[3], const size_t size[3], const size_t pitch[2],
                               float *out) {
  enum status status = STATUS_OK;
#pragma omp parallel
  {
    char *buffer = NULL;
    struct pixel_rows rows;
    enum status thread_status = memory_allocate(&buffer, region_buffer_size(region), 1, "a slice");
#pragma omp for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
      const size_t z = numbers != NULL ? numbers[i] : first[2] + i;
      if (thread_status == STATUS_OK) thread_status = region_read_rows(region, z, buffer, &rows);
      if (thread_status == STATUS_OK)
        rows.first = (const char *)rows.first + first[0] * pixel_size(rows.type);
      for (size_t y = 0; y < size[1] && thread_status == STATUS_OK; y++)
        pixel_rows_read(&rows, first[1] + y, size[0], out + i * pitch[1] + y * pitch[0]);
    }
    memory_free(&buffer);
    if (thread_status != STATUS_OK) {
#pragma omp critical
      status = thread_status;
    }
  }
  return status;
}

enum status region_read(const struct region *region, const size_t *numbers, size_t n, float *out) {
  const size_t pitch[2] = {region->size[0], region->size[0] * region->size[1]};
  return read_slices(region, numbers, n, (const size_t[3]){0, 0, 0}, region->size, pitch, out);
}

enum status region_read_box(const struct region *region, const size_t first[3],
                            const size_t size[3], const size_t pitch[2], float *out) {
  return read_slices(region, NULL, size[2], first, size, pitch, out);
}

enum status region_turn(struct region *region, int axis, float **store) {
  enum status status = STATUS_OK;
  const struct region from = *region;
  size_t plane = from.size[0] * from.size[1], batch = region_batch(&from), numbers[64];
  size_t stride[3]; /* stride in the turned region of a step along x, y, z of the scan */
  float *slices = NULL, *turned = NULL;
  struct progress progress;
  progress_start(&progress, "preparing", "slices", (double)from.size[2]);
  /* The turned z is `axis`, its x the next axis, its y the one after. */
  for (int d = 0; d < 3; d++) {
    int source = (axis + 1 + d) % 3;
    region->size[d] = from.size[source];
    region->voxel[d] = from.voxel[source];
    stride[source] = d == 0 ? 1 : d == 1 ? region->size[0] : region->size[0] * region->size[1];
  }
  TRY(memory_allocate(&slices, batch * plane, sizeof *slices, "slices"));
  TRY(memory_allocate(&turned, plane * from.size[2], sizeof *turned, "the turned scan"));
  for (size_t z = 0; z < from.size[2]; z += batch) {
    size_t n = from.size[2] - z < batch ? from.size[2] - z : batch;
    for (size_t i = 0; i < n; i++) numbers[i] = z + i;
    TRY(region_read(&from, numbers, n, slices));
    for (size_t i = 0; i < n * plane; i++)
      turned[(z + i / plane) * stride[2] + i % plane / from.size[0] * stride[1] +
             i % from.size[0] * stride[0]] = slices[i];
    progress_update(&progress, (double)(z + n), NULL);
  }
  progress_end(&progress);
  *store = turned;
  region->held = turned;
  region->held_type = PIXEL_F32;
cleanup:
  memory_free(&slices);
  if (status != STATUS_OK) memory_free(&turned);
  return status;
}
