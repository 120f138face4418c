#include "sphsolve/darcy/open_water.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/geometry/thin_wall.h"

struct fill {
  const struct scene *scene;
  const struct lattice *l;
  const struct region *window;
  double highest, lowest; /* m: heads of the window */
  size_t *stack;          /* a place is put there at most once from each of its sides */
  uint16_t *region;
  size_t crest; /* a place from which the water flows down; l->count: none */
};

static double centre_of(const struct lattice *l, size_t at) {
  return l->origin[2] + (double)(at / (l->size[0] * l->size[1])) * l->spacing[2];
}

/* Whether a site is an open place whose lower end is below the highest head. */
static bool is_below(const struct fill *f, size_t at) {
  const double low = centre_of(f->l, at) - 0.5 * f->l->spacing[2];
  return domain_is_open(f->scene, f->l, at) && low < f->highest - 1e-9 * f->l->spacing[2];
}

static bool is_at_window(const struct fill *f, size_t at) {
  const struct lattice *l = f->l;
  for (int side = 0; side < 6; side++) {
    double x[3];
    if (lattice_beyond(f->scene->periodic, l, at, side / 2, side % 2 == 0) != l->count) continue;
    if (l->dimensions == 2 && side / 2 == 1) continue;
    domain_place(l, at, x);
    const struct region *window = domain_window_at(f->scene, l, x, side / 2, side % 2 == 0);
    if (window != NULL && window->first == f->window->first) return true;
  }
  return false;
}

static enum status refuse_two(const struct fill *f, size_t at) {
  return FAIL(STATUS_INPUT,
              "%s:%d: the water of this window and that of line %d fill the same place; if it is "
              "one water leave one of them out, else put soil or a wall between them that is a "
              "spacing higher than both heads",
              f->scene->path, f->window->line, f->scene->regions[f->region[at] - 1].line);
}

static enum status refuse_crest(const struct fill *f, size_t at) {
  double x[3];
  domain_place(f->l, at, x);
  return FAIL(STATUS_INPUT,
              "%s:%d: at the higher of its heads the water of this window flows over the crest at "
              "(%g, %g, %g) m, at the lower ones it does not reach what is behind, whose level "
              "nothing says; keep all its heads below that height or above it, or close that space "
              "with a wall",
              f->scene->path, f->window->line, x[0], x[1], x[2] - 0.5 * f->l->spacing[2]);
}

/* Fills what can be reached from a place through places that are no higher. What is lower than the
 * way to it lies behind a crest, which water less than half a spacing deep does not flow over. */
static enum status fill_from(struct fill *f, size_t from) {
  const struct lattice *l = f->l;
  const uint16_t number = (uint16_t)(f->window->first + 1);
  const size_t plane = l->size[0] * l->size[1], top = from / plane;
  size_t count = 0;
  f->stack[count++] = from;
  while (count > 0) {
    const size_t at = f->stack[--count];
    if (f->region[at] == number) continue;
    if (f->region[at] != 0) return refuse_two(f, at);
    f->region[at] = number;
    for (int side = 0; side < 6; side++) {
      const int axis = side / 2;
      const bool low = side % 2 == 0, down = axis == 2 && low;
      const size_t next = lattice_beyond(f->scene->periodic, l, at, axis, low);
      if (next == l->count || next / plane > top || f->region[next] == number ||
          !is_below(f, next) || thin_wall_on_face(l, low ? next : at, axis))
        continue;
      if (down && !(centre_of(l, at) < f->highest)) continue;
      if (down && !(centre_of(l, at) < f->lowest)) return refuse_crest(f, at);
      if (down && f->crest == l->count) f->crest = at;
      f->stack[count++] = next;
    }
  }
  return STATUS_OK;
}

static enum status fill_window(struct fill *f) {
  const struct lattice *l = f->l;
  const struct region *window = f->window;
  const uint16_t number = (uint16_t)(window->first + 1);
  const size_t plane = l->size[0] * l->size[1];
  const bool table = window->table.count > 0;
  enum status status = STATUS_OK;
  f->highest = table ? -INFINITY : window->head, f->lowest = table ? INFINITY : window->head;
  for (size_t k = 0; k < window->table.count; k++) {
    f->highest = fmax(f->highest, window->table.value[k][0]);
    f->lowest = fmin(f->lowest, window->table.value[k][0]);
  }
  /* From below, so that each place is reached by the lowest way. */
  for (size_t at = 0; at < l->count && status == STATUS_OK; at++)
    if (f->region[at] != number && is_below(f, at) &&
        (is_at_window(f, at) ||
         (at >= plane && f->region[at - plane] == number && !thin_wall_on_face(l, at - plane, 2))))
      status = fill_from(f, at);
  return status;
}

enum status open_water_find(const struct scene *scene, const struct lattice *l, bool tell,
                            uint16_t **region) {
  enum status status = STATUS_OK;
  struct fill f = {.scene = scene, .l = l};
  TRY(memory_allocate(region, l->count, sizeof **region, "free water"));
  TRY(memory_allocate(&f.stack, 6 * l->count + 1, sizeof *f.stack, "free water"));
  f.region = *region;
  for (size_t r = 0; r < scene->region_count; r++) {
    f.window = &scene->regions[r], f.crest = l->count;
    if (f.window->first != r || f.window->type != REGION_INFLOW ||
        f.window->boundary != BOUNDARY_HEAD)
      continue;
    TRY(fill_window(&f));
    if (!tell || f.crest == l->count) continue;
    double x[3];
    domain_place(l, f.crest, x);
    log_warning("%s:%d: the water of this window flows over (%.4g, %.4g, %.4g) m, and stands at "
                "its head in the lower space behind as well",
                scene->path, f.window->line, x[0], x[1], x[2] - 0.5 * l->spacing[2]);
  }
cleanup:
  memory_free(&f.stack);
  if (status != STATUS_OK) memory_free(region);
  return status;
}
