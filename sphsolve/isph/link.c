#include "sphsolve/isph/link.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/effects/drag_forchheimer.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/interface.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/soil.h"

/* Speeds of all particles on this rank relative to their soil: isph_links_begin. */
#define SPEEDS(s) ((s)->work[0])

bool isph_links_wanted(const struct scene *scene, bool has_surface) {
  return (!has_surface || isph_soils_differ(scene)) && !scene->isph.porosity_paper;
}

/* Distance from x to the sides of a prism of soil, and whether x is inside; faces on closed sides
 * of the domain do not count. The prism is represented by boxes that form stairs, so the distance
 * is reduced by one spacing. */
static double distance_to_prism(const struct isph *s, size_t k, const double x[3], bool *inside) {
  const struct region *region = &s->scene->regions[k];
  const struct polygon *p = region->polygon;
  const double near = 1e-6 * s->spacing;
  double y[3], least = INFINITY;
  for (int a = 0; a < 3; a++) y[a] = x[a] - s->soil_offset[k][a];
  *inside = false;
  for (int image = 0; image < 9; image++) {
    double at[2];
    bool odd = false, there = true;
    for (int c = 0; c < 2; c++) {
      const int a = p->plane[c], shift = (c == 0 ? image % 3 : image / 3) - 1;
      there = there && (shift == 0 || s->periodic[a]);
      at[c] = y[a] + shift * (s->high[a] - s->low[a]);
    }
    for (size_t i = 0; i < p->count && there; i++) {
      const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
      const double along[2] = {b[0] - a[0], b[1] - a[1]}, to[2] = {at[0] - a[0], at[1] - a[1]};
      const double square = along[0] * along[0] + along[1] * along[1];
      const double t = square > 0 ? (to[0] * along[0] + to[1] * along[1]) / square : 0;
      const double part = fmin(1, fmax(0, t));
      bool closed = false;
      for (int c = 0; c < 2; c++) {
        const int axis = p->plane[c];
        closed = closed || (!s->periodic[axis] && ((fmax(a[c], b[c]) <= s->low[axis] + near) ||
                                                   (fmin(a[c], b[c]) >= s->high[axis] - near)));
      }
      if ((a[1] > at[1]) != (b[1] > at[1]) && at[0] < a[0] + along[0] * (at[1] - a[1]) / along[1])
        odd = !odd;
      if (!closed) least = fmin(least, hypot(to[0] - part * along[0], to[1] - part * along[1]));
    }
    *inside = *inside || odd;
  }
  const double low = region->extent[p->axis], high = region->extent[p->axis + 3];
  if (s->dimensions == 3) {
    const double z = y[p->axis];
    *inside = *inside && z > low && z < high;
    least = fmin(least, fmin(fabs(z - low), fabs(z - high)));
  }
  return least - s->spacing;
}

int32_t isph_ground(const struct isph *s, const double x[3]) {
  int32_t ground = 0;
  double clear = INFINITY; /* distance to the nearest face */
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    if (region->type != REGION_POROUS || (region->is_part && region->first != k)) continue;
    /* part of a body given by its surface: only the extent is checked */
    if (region->is_part && region->polygon == NULL) {
      if (!isph_soil_is_far(s, region->extent, k, s->support_max, x)) clear = 0;
      continue;
    }
    if (region->is_part) {
      bool within;
      const double gap = distance_to_prism(s, k, x, &within);
      clear = within ? gap : fmin(clear, gap);
      if (within) ground = (int32_t)k + 1;
      continue;
    }
    const struct isph_box box = isph_soil_box(s, k, 0, x);
    double inside = INFINITY, square = 0;
    for (int a = 0; a < 3; a++) {
      const double gap = fmax(0, fmax(box.low[a] - x[a], x[a] - box.high[a]));
      inside = fmin(inside, fmin(x[a] - box.low[a], box.high[a] - x[a]));
      square += gap * gap;
    }
    /* A later soil replaces an earlier one. */
    clear = inside > 0 ? inside : fmin(clear, sqrt(square));
    if (inside > 0) ground = (int32_t)k + 1;
  }
  return clear > s->support_max ? ground : GROUND_MIXED;
}

enum status isph_links_create(struct isph *s) {
  return memory_allocate(&s->grounds, s->scene->region_count + 1, sizeof *s->grounds, "regions");
}

void isph_links_begin(struct isph *s) {
  s->grounds[0].of = (struct isph_material){.porosity = 1, .inertia = 1};
  for (size_t k = 0; k < s->scene->region_count; k++) {
    struct isph_ground *ground = &s->grounds[k + 1];
    if (s->scene->regions[k].type != REGION_POROUS) continue;
    ground->place = isph_soil_place(s, k, 0);
    ground->of = isph_material_of(s, &s->scene->regions[k]);
    if (!s->on.drag_linear) ground->of.a = 0;
    if (!s->on.drag_forchheimer) ground->of.b = 0;
  }
  if (!s->on.drag_forchheimer) return;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < s->count; i++) SPEEDS(s)[i] = isph_speed_through_soil(s, i);
}

static void add(const struct isph_material *of, double share, struct isph_material *way) {
  way->porosity += share * of->porosity;
  way->inertia += share * of->inertia;
  way->a += share * of->a;
  way->b += share * of->b;
}

/* Adds the materials on the path x + t step, from <= t <= to, of the regions before `end`. The last
 * region takes precedence: earlier ones, or water, get what it leaves. */
static void add_path(const struct isph *s, size_t end, const double x[3], const double step[3],
                     double from, double to, struct isph_material *way) {
  const double middle[3] = {x[0] + 0.5 * step[0], x[1] + 0.5 * step[1], x[2] + 0.5 * step[2]};
  const double reach = fmax(fabs(step[0]), fmax(fabs(step[1]), fabs(step[2])));
  for (size_t k = end; k-- > 0 && from < to;) {
    const struct region *region = &s->scene->regions[k];
    if (region->type != REGION_POROUS) continue;
    if (region->is_part && isph_soil_is_far(s, region->box, k, reach, x)) continue;
    const struct isph_box box = isph_soil_image(&s->grounds[k + 1].place, middle);
    double enters = from, leaves = to;
    if (!isph_box_clip(&box, x, step, &enters, &leaves)) continue;
    add(&s->grounds[k + 1].of, leaves - enters, way);
    if (from < enters) add_path(s, k, x, step, from, enters, way);
    from = leaves;
  }
  if (from < to) add(&s->grounds[0].of, to - from, way);
}

/* Away from edges all pairs of a particle lie in the same soil. */
static void link_within(const struct isph *s, struct isph_chunk *chunk, size_t i, double dt) {
  const struct isph_material *of = &s->grounds[s->ground[i]].of;
  const double own = of->b > 0 ? SPEEDS(s)[i] : 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const double speed = of->b > 0 ? 0.5 * (own + SPEEDS(s)[chunk->pair[p] & PAIR_MASK]) : 0;
    const double resistance = of->inertia / dt + of->a + 2 * of->b * speed;
    chunk->mobility[p] = (float)(1 / (s->density * resistance));
    chunk->path_porosity[p] = (float)of->porosity;
  }
}

ROW void link_pairs(enum isph_images images, const struct isph *s, struct isph_chunk *chunk,
                    size_t i, double dt, struct isph_links *links) {
  const double *xi = s->position[i], own = s->on.drag_forchheimer ? SPEEDS(s)[i] : 0;
  double level = 0, whole = 0, middle[3] = {0};
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const size_t j = chunk->pair[p] & PAIR_MASK;
    const int32_t ground = s->ground[i] != GROUND_MIXED ? s->ground[i] : s->ground[j];
    struct isph_material way = {0};
    double r[3];
    isph_separation_at(images, s, xi, s->position, chunk->pair[p], r);
    if (ground != GROUND_MIXED) way = s->grounds[ground].of;
    struct isph_leg leg = isph_first_leg(xi, r);
    while (ground == GROUND_MIXED && isph_next_leg(&s->image[chunk->pair[p] >> PAIR_BITS], &leg))
      add_path(s, s->scene->region_count, leg.start, leg.step, leg.from, leg.to, &way);
    const double speed = way.b > 0 ? 0.5 * (own + SPEEDS(s)[j]) : 0;
    const double resistance = way.inertia / dt + way.a + 2 * way.b * speed;
    chunk->mobility[p] = (float)(1 / (s->density * resistance));
    chunk->path_porosity[p] = (float)way.porosity;
    if (s->ground[i] != GROUND_MIXED) continue;
    const double weight = s->volume[j] * (double)chunk->slope[p];
    const double carried = weight * (way.a + way.b * speed) / resistance;
    const double steep = weight * log(resistance);
    level += steep, whole += weight;
    for (int a = 0, k = 0; a < 3; a++) {
      links->normal[a] += steep * r[a], middle[a] += weight * r[a];
      for (int b = a; b < 3; b++, k++) {
        const double moment = r[a] * r[b];
        links->carried[k] += carried * moment, links->all[k] += weight * moment;
        links->inertia[k] += weight * way.inertia * moment;
        links->linear[k] += weight * way.a * moment;
        links->forchheimer[k] += weight * way.b * speed * moment;
      }
    }
  }
  for (int a = 0; a < 3 && whole > 0; a++) links->normal[a] -= level / whole * middle[a];
}

void isph_link(const struct isph *s, struct isph_chunk *chunk, size_t i, double dt,
               struct isph_links *links) {
  memset(links, 0, sizeof *links);
  if (s->ground[i] != GROUND_MIXED)
    link_within(s, chunk, i, dt);
  else
    ISPH_ROW(s, i, link_pairs, s, chunk, i, dt, links);
}

double isph_link_to_wall(const struct isph *s, size_t i, const double x[3], double dt) {
  const double *from = s->position[i], speed = isph_speed_through_soil(s, i);
  const double step[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]}, end = 1e-6;
  struct isph_material way = {0}, last = {0};
  add_path(s, s->scene->region_count, from, step, 0, 1, &way);
  add_path(s, s->scene->region_count, from, step, 1 - end, 1, &last);
  const double all = way.inertia / dt + way.a + 2 * way.b * speed;
  return fmin(1, (last.inertia / dt + last.a + 2 * last.b * speed) / end / all);
}

void isph_links_close(struct isph *s) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      double sum = 0, whole = 0;
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
        const double weight = s->volume[chunk->pair[p] & PAIR_MASK] * (double)chunk->slope[p];
        sum += weight * (double)chunk->mobility[p], whole += weight;
      }
      s->linked_mobility[i] = whole > 0 ? sum / whole : s->mobility[i];
    }
  }
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->linked_mobility)});
}

void isph_link_predict(struct isph *s, size_t i, const struct isph_links *links, const double u[3],
                       double t, double predicted[3]) {
  struct isph_linked *linked = &s->linked[i];
  double *n = linked->normal;
  memset(linked, 0, sizeof *linked);
  if (s->ground[i] != GROUND_MIXED) return;
  memcpy(n, links->normal, sizeof links->normal);
  const double size = sqrt(dot(n, n));
  for (int a = 0; a < 3; a++) n[a] = size > 0 ? n[a] / size : 0;
  const double all = symmetric_along(links->all, n), carried = symmetric_along(links->carried, n);
  if (!(all > 0)) memset(n, 0, sizeof links->normal);
  if (!(all > 0)) return;
  const double keeps = fmin(1, fmax(0, 1 - carried / all));
  const double speed = isph_speed_through_soil(s, i);
  const double left = s->drag_factor[i] * (1 + t * s->drag_b[i] * speed);
  /* What drag has left of u in v*, across the interface of soils and along it; its part along n is
   * replaced. Disorder tilts n: if only what the drag across the interface left were replaced, the
   * velocity along coarse soil before fine would in part count twice, and grow in each step. */
  double kept[3] = {left * u[0], left * u[1], left * u[2]};
  if (s->interface != NULL) {
    const struct isph_interface *along = &s->interface[i];
    isph_interface_turn(along, along->drag_factor * (1 + t * along->drag_b * speed) / left, kept);
  }
  const double change = keeps * dot(u, n) - dot(kept, n);
  for (int a = 0; a < 3; a++) predicted[a] += change * n[a];
  linked->inertia = symmetric_along(links->inertia, n) / all;
  linked->drag_a = symmetric_along(links->linear, n) / all;
  linked->drag_b = symmetric_along(links->forchheimer, n) / all;
}
