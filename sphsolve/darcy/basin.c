#include "sphsolve/darcy/basin.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/geometry/thin_wall.h"

struct search {
  const struct scene *scene;
  const struct lattice *l;
  uint16_t *open;
  size_t *found, count; /* the sites of the basin; room for all */
  size_t plane;         /* sites in a layer */
  uint16_t number;
};

static enum status not_level(const struct search *s, size_t at) {
  const struct region *region = &s->scene->regions[s->number - 1];
  double x[3];
  domain_place(s->l, at, x);
  return FAIL(STATUS_INPUT,
              "%s:%d: this water would run into the empty space at (%g, %g, %g) m: let it start at "
              "rest, with all space that it reaches full up to one level",
              s->scene->path, region->line, x[0], x[1], x[2]);
}

static enum status two_waters(const struct search *s, const struct region *other) {
  return FAIL(STATUS_INPUT,
              "%s:%d: this water is beside that of line %d; if its level is given there leave this "
              "one out, else put soil or a wall between them",
              s->scene->path, s->scene->regions[s->number - 1].line, other->line);
}

/* Adds a site, and those that it leads to in layers from `foot` to `top`. */
static void flood(struct search *s, size_t from, size_t foot, size_t top) {
  size_t next_out = s->count;
  s->open[from] = s->number, s->found[s->count++] = from;
  while (next_out < s->count) {
    const size_t at = s->found[next_out++];
    for (int side = 0; side < 6; side++) {
      const bool low = side % 2 == 0;
      const size_t next = lattice_beyond(s->scene->periodic, s->l, at, side / 2, low);
      if (next == s->l->count || next / s->plane < foot || next / s->plane > top ||
          s->open[next] != 0 || !domain_is_open(s->scene, s->l, next) ||
          thin_wall_on_face(s->l, low ? next : at, side / 2))
        continue;
      s->open[next] = s->number, s->found[s->count++] = next;
    }
  }
}

/* What is beside the basin's sites from number `first` on, in layers up to `top`: another water, or
 * a window on a side of the domain; NULL: none. */
static const struct region *other_water(const struct search *s, size_t first, size_t top) {
  for (size_t k = first; k < s->count; k++)
    for (int side = 0; side < 6; side++) {
      const bool low = side % 2 == 0;
      const size_t at = s->found[k],
                   next = lattice_beyond(s->scene->periodic, s->l, at, side / 2, low);
      double x[3];
      domain_place(s->l, at, x);
      const struct region *window =
          next == s->l->count ? domain_window_at(s->scene, s->l, x, side / 2, low) : NULL;
      if (window != NULL) return window;
      if (next != s->l->count && next / s->plane <= top && s->open[next] != 0 &&
          s->open[next] != s->number && !thin_wall_on_face(s->l, low ? next : at, side / 2))
        return &s->scene->regions[s->open[next] - 1];
    }
  return NULL;
}

/* Whether the sites from number `first` on lead down to a place that is not of the basin. */
static bool leads_down(const struct search *s, size_t first) {
  for (size_t k = first; k < s->count; k++) {
    const size_t at = s->found[k];
    if (at >= s->plane && s->open[at - s->plane] != s->number &&
        domain_is_open(s->scene, s->l, at - s->plane) && !thin_wall_on_face(s->l, at - s->plane, 2))
      return true;
  }
  return false;
}

/* Raises the level layer by layer, up to the one in which the water would flow over. */
static double find_brim(struct search *s, size_t top) {
  const struct lattice *l = s->l;
  for (size_t layer = top + 1; layer < l->size[2]; layer++) {
    const size_t before = s->count;
    for (size_t k = 0; k < before; k++) {
      const size_t above = s->found[k] + s->plane;
      if (s->found[k] / s->plane + 1 == layer && s->open[above] == 0 &&
          domain_is_open(s->scene, l, above) && !thin_wall_on_face(l, s->found[k], 2))
        flood(s, above, layer, layer);
    }
    if (!leads_down(s, before) && other_water(s, before, layer) == NULL) continue;
    for (; s->count > before; s->count--) s->open[s->found[s->count - 1]] = 0;
    return l->origin[2] + ((double)layer - 0.5) * l->spacing[2];
  }
  return l->origin[2] + ((double)l->size[2] - 0.5) * l->spacing[2];
}

/* Follows the water up where another region of it stands on this one. */
static void rise(struct search *s, size_t *top, double *level) {
  for (size_t k = 0; k < s->count; k++) {
    const size_t above = s->found[k] + s->plane;
    if (s->found[k] / s->plane != *top || above >= s->l->count || s->open[above] != 0 ||
        !domain_is_water(s->scene, s->l, above) || thin_wall_on_face(s->l, s->found[k], 2))
      continue;
    *level = fmax(*level, s->scene->regions[s->l->region[above] - 1].box[5]);
    flood(s, above, 0, ++*top);
    k = SIZE_MAX; /* again from the first, as the top has changed */
  }
}

static enum status find_one(const struct scene *scene, const struct lattice *l,
                            const struct region *region, uint16_t *open, struct basin *basin) {
  enum status status = STATUS_OK;
  struct search s = {.scene = scene,
                     .l = l,
                     .open = open,
                     .plane = l->size[0] * l->size[1],
                     .number = (uint16_t)(region - scene->regions + 1)};
  size_t seed = l->count, top = 0;
  basin->level = -INFINITY;
  for (size_t at = 0; at < l->count; at++) {
    if (!domain_is_water(scene, l, at) || scene->regions[l->region[at] - 1].first != region->first)
      continue;
    if (open[at] != 0 && scene->regions[open[at] - 1].type != REGION_WATER)
      return two_waters(&s, &scene->regions[open[at] - 1]);
    if (seed == l->count) seed = at;
    top = at / s.plane;
    basin->level = fmax(basin->level, scene->regions[l->region[at] - 1].box[5]);
  }
  if (seed == l->count)
    return FAIL(
        STATUS_INPUT,
        "%s:%d: this water holds the middle of no place outside of soil; how wet soil is its "
        "own region says, and free water comes after the soil that it lies in",
        scene->path, region->line);
  if (open[seed] != 0) return STATUS_OK;
  TRY(memory_allocate(&s.found, l->count, sizeof *s.found, "free water"));
  flood(&s, seed, 0, top);
  rise(&s, &top, &basin->level);
  for (size_t k = 0; k < s.count; k++)
    if (!domain_is_water(scene, l, s.found[k])) TRY(not_level(&s, s.found[k]));
  const struct region *other = other_water(&s, 0, top);
  if (other != NULL) TRY(two_waters(&s, other));
  basin->found = true;
  basin->brim = find_brim(&s, top);
cleanup:
  memory_free(&s.found);
  return status;
}

enum status basin_find(const struct scene *scene, const struct lattice *l, uint16_t *open,
                       struct basin *basins) {
  enum status status = STATUS_OK;
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].type == REGION_WATER)
      TRY(find_one(scene, l, &scene->regions[r], open, &basins[r]));
  for (size_t at = 0; at < l->count; at++)
    if (domain_is_water(scene, l, at) && open[at] == 0)
      TRY_FAIL(
          STATUS_INPUT,
          "%s:%d: this water lies in several places that are not connected: give each a region "
          "of its own",
          scene->path, scene->regions[l->region[at] - 1].line);
cleanup:
  return status;
}
