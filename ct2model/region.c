#include "ct2model/region.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

size_t region_batch(const struct region *region) {
  const double bytes = 32e6;
  double slice = (double)region->size[0] * (double)region->size[1] * sizeof(float);
  double n = floor(bytes / slice);
  return n < 4.0 ? 4 : n > 64.0 ? 64 : (size_t)n;
}

static enum status read_one(const struct region *region, size_t z, float *whole, float *out) {
  const struct stack *stack = region->stack;
  enum status status = stack_read(stack, region->origin[2] + z, whole);
  if (status != STATUS_OK) return status;
  float scale = (float)region->scale;
  for (size_t y = 0; y < region->size[1]; y++) {
    const float *row = whole + (region->origin[1] + y) * stack->size[0] + region->origin[0];
    for (size_t x = 0; x < region->size[0]; x++) {
      float grey = scale * row[x];
      if (!isfinite(grey)) {
        char name[160];
        stack_slice_name(stack, region->origin[2] + z, name, sizeof name);
        return FAIL(STATUS_INPUT,
                    "%s: pixel %zu,%zu is not a number; crop it away (--crop) or mend the slice",
                    name, region->origin[0] + x, region->origin[1] + y);
      }
      out[y * region->size[0] + x] = grey;
    }
  }
  return STATUS_OK;
}

enum status region_read(const struct region *region, const size_t *numbers, size_t n, float *out) {
  enum status status = STATUS_OK;
  size_t pixels = region->stack->size[0] * region->stack->size[1];
#pragma omp parallel
  {
    float *whole = NULL;
    enum status mine = memory_allocate(&whole, pixels, sizeof *whole, "a slice");
#pragma omp for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
      if (mine == STATUS_OK)
        mine = read_one(region, numbers[i], whole, out + i * region->size[0] * region->size[1]);
    }
    memory_free(&whole);
    if (mine != STATUS_OK) {
#pragma omp critical
      status = mine;
    }
  }
  return status;
}
