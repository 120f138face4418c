#include "analyze/seepage/asked_heads.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Tolerance of heads, in spacings. Still water with a depth of a whole number of particle rows has
 * its head within 0.02, except beside walls. The head of a shallow one that ends within a row is up
 * to 0.4 off. */
#define HEAD_TOLERANCE 0.1

static bool is_water(const struct head_field *f, size_t c) {
  return f->soil[c] == REGION_NONE && f->wall[c] == REGION_NONE && !isnan(f->head[c]);
}

static bool contains_cell(const struct head_region *window, const struct head_field *f, size_t c) {
  const double x = head_field_x(f, c % f->nx), z = head_field_z(f, c / f->nx);
  return x > window->low[0] && x < window->high[0] && z > window->low[1] && z < window->high[1];
}

/* Adds cell c to a connected body of water; false if it is not free water or already included. */
static bool add_cell(const struct head_field *f, size_t c, unsigned char *body, size_t *list,
                     size_t *count) {
  if (body[c] || !is_water(f, c)) return false;
  body[c] = 1;
  list[(*count)++] = c;
  return true;
}

/* Lists the cells of the free water connected to a window; returns their number. */
static size_t find_body(const struct head_field *f, const struct head_region *window,
                        unsigned char *body, size_t *list) {
  size_t count = 0;
  memset(body, 0, f->nx * f->nz);
  for (size_t c = 0; c < f->nx * f->nz; c++)
    if (contains_cell(window, f, c)) add_cell(f, c, body, list, &count);
  for (size_t n = 0; n < count; n++) {
    const size_t c = list[n], i = c % f->nx, k = c / f->nx;
    if (i > 0) add_cell(f, c - 1, body, list, &count);
    if (i + 1 < f->nx) add_cell(f, c + 1, body, list, &count);
    if (k > 0) add_cell(f, c - f->nx, body, list, &count);
    if (k + 1 < f->nz) add_cell(f, c + f->nx, body, list, &count);
  }
  return count;
}

/* Whether another window, with a different or changing head, is connected to the same water. */
static bool is_shared(const struct head_field *f, const struct head_region *window,
                      const size_t *list, size_t count) {
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *other = &f->regions[r];
    if (strcmp(other->type, "inflow") != 0 || other->head == window->head) continue;
    for (size_t n = 0; n < count; n++)
      if (contains_cell(other, f, list[n])) return true;
  }
  return false;
}

/* Prescribes the head of a window in its water, if that is still: the standard deviation of its
 * heads is within the tolerance. Beside walls the heads are less accurate, with few particles. */
static void prescribe_water_head(const struct head_field *f, const struct head_region *window,
                                 const size_t *list, size_t count, struct asked_heads *asked) {
  double mean = 0, square = 0;
  for (size_t n = 0; n < count; n++) mean += f->head[list[n]] / (double)count;
  for (size_t n = 0; n < count; n++) square += pow(f->head[list[n]] - mean, 2) / (double)count;
  if (sqrt(square) > HEAD_TOLERANCE * f->dz) return;
  for (size_t n = 0; n < count; n++) asked->head[list[n]] = window->head;
  const double off = fabs(mean - window->head);
  if (off <= HEAD_TOLERANCE * f->dz ||
      (!asked->reached && off <= fabs(asked->found - asked->prescribed)))
    return;
  asked->reached = false;
  asked->window = window->number, asked->found = mean, asked->prescribed = window->head;
}

/* A drain prescribes the pressure max(0, rho g (head - z)), except in cells with a lower
 * pressure. */
static void prescribe_drain_head(const struct head_field *f, const struct head_region *drain,
                                 double *head) {
  for (size_t c = 0; c < f->nx * f->nz; c++) {
    const double held = fmax(drain->head, head_field_z(f, c / f->nx));
    if (contains_cell(drain, f, c) && f->head[c] > held - HEAD_TOLERANCE * f->dz) head[c] = held;
  }
}

enum status asked_heads_find(const struct head_field *f, struct asked_heads *asked) {
  enum status status = STATUS_OK;
  const size_t cells = f->nx * f->nz;
  unsigned char *body = NULL;
  size_t *list = NULL;
  *asked = (struct asked_heads){.reached = true};
  TRY(memory_allocate(&asked->head, cells, sizeof *asked->head, "heads"));
  TRY(memory_allocate(&body, cells, sizeof *body, "free water"));
  TRY(memory_allocate(&list, cells, sizeof *list, "free water"));
  memcpy(asked->head, f->head, cells * sizeof *asked->head);
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *region = &f->regions[r];
    if (isnan(region->head)) continue;
    if (!strcmp(region->type, "drain")) prescribe_drain_head(f, region, asked->head);
    if (strcmp(region->type, "inflow") != 0) continue;
    const size_t count = find_body(f, region, body, list);
    if (count > 0 && !is_shared(f, region, list, count))
      prescribe_water_head(f, region, list, count, asked);
  }
cleanup:
  memory_free(&body);
  memory_free(&list);
  if (status != STATUS_OK) asked_heads_free(asked);
  return status;
}

void asked_heads_free(struct asked_heads *asked) {
  memory_free(&asked->head);
}
