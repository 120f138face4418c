#include "ct2model/scan/slice_check.h"

#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/provenance.h"

/* Fraction of pixels that differ from their left neighbour above which a slice is noisy: nearly all
 * differ where there is noise of a grey level or more, but only those at edges in labels and in
 * images without noise. */
#define DIFFERENT_FRACTION 0.5

enum status slice_check_start(size_t count, struct slice_check *check) {
  enum status status = STATUS_OK;
  *check = (struct slice_check){.count = count};
  TRY(memory_allocate(&check->hash, count, sizeof *check->hash, "hashes of slices"));
  TRY(memory_allocate(&check->constant, count, sizeof *check->constant, "hashes of slices"));
cleanup:
  return status;
}

void slice_check_end(struct slice_check *check) {
  MEMORY_FREE(&check->hash, &check->constant);
}

void slice_check_add(struct slice_check *check, size_t z, const struct pixel_rows *rows,
                     const size_t size[2]) {
  const size_t pixel = pixel_size(rows->type), row = size[0] * pixel;
  const char *first = rows->first;
  uint64_t hash = 0;
  bool constant = true;
  for (size_t y = 0; y < size[1]; y++) {
    const char *at = first + y * rows->stride;
    const uint64_t pair[2] = {hash, hash_bytes(at, row)};
    hash = hash_bytes(pair, sizeof pair);
    constant =
        constant && memcmp(at, first, pixel) == 0 && memcmp(at, at + pixel, row - pixel) == 0;
  }
  check->hash[z] = hash;
  check->constant[z] = constant;
}

/* The nearest slice before z of which z is a copy; z if there is none. */
static size_t copied_from(const struct slice_check *check, size_t z) {
  for (size_t d = 1; d <= z; d++)
    if (check->hash[z] == check->hash[z - d]) return z - d;
  return z;
}

static enum status is_noisy(const struct region *region, size_t z, float *slice, bool *noisy) {
  enum status status = STATUS_OK;
  const size_t nx = region->size[0], n = nx * region->size[1];
  size_t unlike = 0;
  TRY(region_read(region, &z, 1, slice));
  for (size_t i = 0; i < n; i++) unlike += i % nx > 0 && slice[i] != slice[i - 1]; // NOLINT: nx > 0
  *noisy = (double)unlike > DIFFERENT_FRACTION * (double)n;
cleanup:
  return status;
}

/* The nearest slice to z with more than one grey; `count` if there is none. */
static size_t varied_neighbour(const struct slice_check *check, size_t z) {
  for (size_t d = 1; d < check->count; d++) {
    if (z >= d && !check->constant[z - d]) return z - d;
    if (z + d < check->count && !check->constant[z + d]) return z + d;
  }
  return check->count;
}

enum status slice_check_warn(const struct slice_check *check, const struct region *region) {
  enum status status = STATUS_OK;
  const size_t n = check->count;
  size_t copies = 0, copy = 0, constants = 0, constant = 0;
  char name[2][80];
  float *slice = NULL;
  bool noisy = false;
  for (size_t z = n; z-- > 0;) {
    if (check->constant[z]) {
      constants++;
      constant = z;
    } else if (copied_from(check, z) < z) {
      copies++;
      copy = z;
    }
  }
  if (copies == 0 && (constants == 0 || constants == n)) goto cleanup;
  TRY(memory_allocate(&slice, region->size[0] * region->size[1], sizeof *slice, "a slice"));
  if (copies > 0) TRY(is_noisy(region, copy, slice, &noisy));
  if (copies > 0 && noisy) {
    stack_slice_name(region->stack, region->origin[2] + copy, name[0], sizeof name[0]);
    stack_slice_name(region->stack, region->origin[2] + copied_from(check, copy), name[1],
                     sizeof name[1]);
    log_warning("%zu of %zu slices are copies, noise and all, of another (first: %s of %s): "
                "pores do not run through them as in the specimen, and k is false; mend the stack, "
                "or leave them "
                "out with --crop",
                copies, n, name[0], name[1]);
  }
  if (constants == 0 || constants == n) goto cleanup;
  TRY(is_noisy(region, varied_neighbour(check, constant), slice, &noisy));
  if (noisy) {
    stack_slice_name(region->stack, region->origin[2] + constant, name[0], sizeof name[0]);
    log_warning("%zu of %zu slices are of one grey (first: %s): no scan, but a gap or a plate in "
                "the model; mend the stack, or leave them out with --crop",
                constants, n, name[0]);
  }
cleanup:
  memory_free(&slice);
  return status;
}
