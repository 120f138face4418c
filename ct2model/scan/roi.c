#include "ct2model/scan/roi.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

enum status roi_parse(const char *text, struct roi *roi) {
  int used = -1;
  double *v = roi->value;
  *roi = (struct roi){.kind = ROI_NONE};
  if (strncmp(text, "mask:", 5) == 0 && text[5] != '\0') {
    roi->kind = ROI_MASK;
    roi->path = text + 5;
    return STATUS_OK;
  }
  if (sscanf(text, "box:%lf,%lf,%lf,%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &v[3], &v[4], &v[5],
             &used) == 6 &&
      used > 0 && text[used] == '\0' && v[3] > 0.0 && v[4] > 0.0 && v[5] > 0.0)
    roi->kind = ROI_BOX;
  else if (sscanf(text, "cylinder:%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &used) == 3 && used > 0 &&
           text[used] == '\0' && v[2] > 0.0)
    roi->kind = ROI_CYLINDER;
  bool finite = true;
  for (int i = 0; i < 6; i++) finite = finite && isfinite(v[i]);
  if (roi->kind != ROI_NONE && finite) return STATUS_OK;
  return FAIL(STATUS_USAGE,
              "--roi %s: write box:X0,Y0,Z0,NX,NY,NZ or cylinder:CX,CY,R (voxels, along z) or "
              "mask:PATH",
              text);
}

static bool is_inside(const struct roi *roi, size_t x, size_t y, size_t z) {
  const double *v = roi->value, at[3] = {(double)x + 0.5, (double)y + 0.5, (double)z + 0.5};
  if (roi->kind == ROI_CYLINDER)
    return (at[0] - v[0]) * (at[0] - v[0]) + (at[1] - v[1]) * (at[1] - v[1]) < v[2] * v[2];
  bool inside = true;
  for (int d = 0; d < 3; d++) inside &= at[d] > v[d] && at[d] < v[d] + v[d + 3];
  return inside;
}

/* Whether the region of interest extends more than half a voxel beyond the scan. */
static bool is_beyond(const struct roi *roi, const struct stack *stack) {
  const double *v = roi->value, half = 0.5;
  bool beyond = false;
  if (roi->kind == ROI_MASK) return false;
  for (int d = 0; d < 3; d++) {
    const double n = (double)stack->size[d];
    if (roi->kind == ROI_BOX)
      beyond |= v[d] < -half || v[d] + v[d + 3] > n + half;
    else if (d < 2)
      beyond |= v[d] - v[2] < -half || v[d] + v[2] > n + half;
  }
  return beyond;
}

static bool is_at_height(const struct roi *roi, size_t z) {
  const double middle = (double)z + 0.5;
  return roi->kind != ROI_BOX || (middle > roi->value[2] && middle < roi->value[2] + roi->value[5]);
}

/* Moves the greys inside to the front of `slice` and returns their number. `mask` is NULL unless
 * the region of interest is a mask. */
static size_t select_inside(const struct roi *roi, const struct stack *stack, size_t z,
                            const float *mask, float *slice) {
  size_t n = 0;
  for (size_t y = 0; y < stack->size[1]; y++) {
    for (size_t x = 0; x < stack->size[0]; x++) {
      size_t i = y * stack->size[0] + x;
      /* What is no data of a mask is outside. */
      if (mask != NULL ? fabsf(mask[i]) > 0.0f : is_inside(roi, x, y, z)) slice[n++] = slice[i];
    }
  }
  return n;
}

/* Opens a mask, which has the size of the stack, or is one slice that applies to all. */
static enum status open_mask(const struct roi *roi, const struct stack *stack, struct stack *mask) {
  enum status status = stack_open(&roi->path, 1, NULL, mask);
  if (status != STATUS_OK) return error_context(status, "--roi");
  if (memcmp(mask->size, stack->size, 2 * sizeof *mask->size) == 0 &&
      (mask->size[2] == stack->size[2] || mask->size[2] == 1))
    return stack_keep_labels(mask, 0);
  return FAIL(STATUS_INPUT,
              "--roi %s: %zux%zux%zu, but the stack is %zux%zux%zu; a mask is as large as the "
              "stack, or one slice that counts for all",
              roi->path, mask->size[0], mask->size[1], mask->size[2], stack->size[0],
              stack->size[1], stack->size[2]);
}

/* Warns if the mask looks like a scan, all of whose voxels but the black ones would count as
 * inside. */
static void warn_of_greys(const struct roi *roi, const float *slice, size_t pixels) {
  enum { LABELS = 32 };
  float seen[LABELS];
  size_t values = 0;
  for (size_t i = 0; i < pixels; i++) {
    size_t v = 0;
    if (isnan(slice[i])) continue;
    while (v < values && seen[v] != slice[i]) v++;
    if (v == LABELS) {
      log_warning("--roi mask:%s holds more than %d greys, as a scan does: all but 0 counts as "
                  "inside; is it the mask?",
                  roi->path, LABELS);
      return;
    }
    if (v == values) seen[values++] = slice[i];
  }
}

enum status roi_count(const struct roi *roi, const struct region *region,
                      struct grey_histogram *histogram) {
  enum status status = STATUS_OK;
  const struct stack *stack = region->stack;
  size_t pixels = stack->size[0] * stack->size[1];
  struct region whole = *region;
  struct stack mask = {0};
  float *slices = NULL, *inside = NULL;
  whole.held = NULL;
  memset(whole.origin, 0, sizeof whole.origin);
  memcpy(whole.size, stack->size, sizeof whole.size);
  if (roi->kind == ROI_MASK) {
    TRY(open_mask(roi, stack, &mask));
    TRY(memory_allocate(&inside, pixels, sizeof *inside, "a slice of the mask"));
    TRY(stack_read(&mask, mask.size[2] / 2, inside));
    warn_of_greys(roi, inside, pixels);
  }
  const size_t batch = region_batch(&whole);
  size_t numbers[64];
  TRY(memory_allocate(&slices, batch * pixels, sizeof *slices, "slices"));
  for (size_t z = 0; z < stack->size[2];) {
    size_t n = 0;
    for (; z < stack->size[2] && n < batch; z++)
      if (is_at_height(roi, z)) numbers[n++] = z;
    TRY(region_read(&whole, numbers, n, slices));
    for (size_t i = 0; i < n; i++) {
      float *slice = slices + i * pixels;
      if (inside != NULL && (numbers[i] == 0 || mask.size[2] > 1))
        TRY(stack_read(&mask, numbers[i], inside));
      grey_histogram_add(histogram, slice, select_inside(roi, stack, numbers[i], inside, slice));
    }
  }
  if (histogram->total == 0)
    TRY_FAIL(STATUS_INPUT,
             "--roi: no voxel of the stack is inside; it has %zux%zux%zu, and --roi "
             "is in pixels",
             stack->size[0], stack->size[1], stack->size[2]);
  if (roi->kind == ROI_MASK && histogram->total == (uint64_t)pixels * stack->size[2])
    log_warning("--roi mask:%s: no voxel of it is 0, which is outside: all of the scan counts",
                roi->path);
  if (is_beyond(roi, stack))
    log_warning(
        "--roi reaches beyond the scan (%zux%zux%zu voxels): the %.0f %% of the scan's voxels "
        "that lie inside it count",
        stack->size[0], stack->size[1], stack->size[2],
        100.0 * (double)histogram->total / ((double)pixels * (double)stack->size[2]));
cleanup:
  stack_close(&mask);
  MEMORY_FREE(&slices, &inside);
  return status;
}
