#include "analyze/seepage/asked_heads.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Spacings. Still water that stands a whole number of rows high has its head within .02, but beside
 * walls; a shallow one out of which rows do not go, and which ends amid one, is up to .4 off. */
#define MET 0.1

static bool is_water(const struct head_field *f, size_t c) {
  return f->soil[c] == REGION_NONE && f->wall[c] == REGION_NONE && !isnan(f->head[c]);
}

static bool holds(const struct head_region *window, const struct head_field *f, size_t c) {
  const double x = head_field_x(f, c % f->nx), z = head_field_z(f, c / f->nx);
  return x > window->low[0] && x < window->high[0] && z > window->low[1] && z < window->high[1];
}

/* Marks cell c as of the body; whether it is one more. */
static bool take(const struct head_field *f, size_t c, unsigned char *body, size_t *list,
                 size_t *count) {
  if (body[c] || !is_water(f, c)) return false;
  body[c] = 1;
  list[(*count)++] = c;
  return true;
}

/* The free water that a window reaches: its cells in `list`. */
static size_t find_body(const struct head_field *f, const struct head_region *window,
                        unsigned char *body, size_t *list) {
  size_t count = 0;
  memset(body, 0, f->nx * f->nz);
  for (size_t c = 0; c < f->nx * f->nz; c++)
    if (holds(window, f, c)) take(f, c, body, list, &count);
  for (size_t n = 0; n < count; n++) {
    const size_t c = list[n], i = c % f->nx, k = c / f->nx;
    if (i > 0) take(f, c - 1, body, list, &count);
    if (i + 1 < f->nx) take(f, c + 1, body, list, &count);
    if (k > 0) take(f, c - f->nx, body, list, &count);
    if (k + 1 < f->nz) take(f, c + f->nx, body, list, &count);
  }
  return count;
}

/* Whether a window of another head, or of one that changes, reaches that water too. */
static bool is_shared(const struct head_field *f, const struct head_region *window,
                      const size_t *list, size_t count) {
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *other = &f->regions[r];
    if (strcmp(other->type, "inflow") != 0 || other->head == window->head) continue;
    for (size_t n = 0; n < count; n++)
      if (holds(other, f, list[n])) return true;
  }
  return false;
}

/* Still water has one head; that beside a wall is off by as much as its few particles tell. */
static void ask_water(const struct head_field *f, const struct head_region *window,
                      const size_t *list, size_t count, struct asked_heads *asked) {
  double mean = 0, square = 0;
  for (size_t n = 0; n < count; n++) mean += f->head[list[n]] / (double)count;
  for (size_t n = 0; n < count; n++) square += pow(f->head[list[n]] - mean, 2) / (double)count;
  if (sqrt(square) > MET * f->dz) return;
  for (size_t n = 0; n < count; n++) asked->head[list[n]] = window->head;
  const double off = fabs(mean - window->head);
  if (off <= MET * f->dz || (!asked->met && off <= fabs(asked->found - asked->asked))) return;
  asked->met = false;
  asked->window = window->number, asked->found = mean, asked->asked = window->head;
}

/* A drain holds max(0, rho g (head - z)); cells whose pressure is below that it does not reach. */
static void ask_drain(const struct head_field *f, const struct head_region *drain, double *head) {
  for (size_t c = 0; c < f->nx * f->nz; c++) {
    const double held = fmax(drain->head, head_field_z(f, c / f->nx));
    if (holds(drain, f, c) && f->head[c] > held - MET * f->dz) head[c] = held;
  }
}

enum status asked_heads_find(const struct head_field *f, struct asked_heads *asked) {
  enum status status = STATUS_OK;
  const size_t cells = f->nx * f->nz;
  unsigned char *body = NULL;
  size_t *list = NULL;
  *asked = (struct asked_heads){.met = true};
  TRY(memory_allocate(&asked->head, cells, sizeof *asked->head, "heads"));
  TRY(memory_allocate(&body, cells, sizeof *body, "free water"));
  TRY(memory_allocate(&list, cells, sizeof *list, "free water"));
  memcpy(asked->head, f->head, cells * sizeof *asked->head);
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *region = &f->regions[r];
    if (isnan(region->head)) continue;
    if (!strcmp(region->type, "drain")) ask_drain(f, region, asked->head);
    if (strcmp(region->type, "inflow") != 0) continue;
    const size_t count = find_body(f, region, body, list);
    if (count > 0 && !is_shared(f, region, list, count)) ask_water(f, region, list, count, asked);
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
