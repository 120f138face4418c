/* Initial placement of the water. */
#include "sphsolve/isph/place.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/particles.h"
#include "sphsolve/isph/wall.h"

/* Free water has a particle on each site of the lattice. In soil a site holds only the fraction eps
 * of that mass; a particle of so little mass would be smaller than those that flow in, and its
 * support too short to reach walls and voids behind a full particle. So the water in soil is
 * divided into particles of the same mass as all others, in rows eps^(-1/dimensions) spacings apart
 * over the box that the soil's wet sites fill. The soil's edge is taken as sharp here: the sum of
 * the masses is then exact, and the smoothed porosity spreads the particles by itself. */

/* The water of a lattice site. */
struct site {
  double x[3], width[3]; /* m; the width 1 along an axis that is not used */
  double porosity, volume;
  size_t porous, water; /* its region of soil and of water; region_count: none */
  const double *velocity;
};

/* The wet sites of one soil within one region of water, and the rows of particles that divide their
 * box. */
struct block {
  double low[3], high[3];
  double porosity, whole; /* `whole`: mass of a full cell */
  const double *velocity;
  int rows[3];
  size_t first; /* index of its first cell; `count`: their number */
  size_t count;
};

struct cell {
  double mass, moment[3]; /* sum of mass times position */
};

struct blocks {
  size_t count;
  struct block *block;
  struct cell *cell;
  uint32_t *of; /* [regions * (regions + 1)]: number + 1 of the block of (porous, water) */
};

static void find_regions(const struct isph *s, struct site *site) {
  static const double still[3] = {0};
  site->porous = site->water = s->scene->region_count;
  site->porosity = 1;
  site->velocity = still;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    bool inside = true;
    for (int a = 0; a < 3; a++)
      if (isph_uses_axis(s, a))
        inside = inside && site->x[a] >= region->box[a] && site->x[a] < region->box[a + 3];
    if (inside && region->type == REGION_POROUS)
      site->porous = region->first, site->porosity = region->porosity;
    if (inside && region->type == REGION_WATER)
      site->water = region->first, site->velocity = region->velocity;
  }
}

static bool boxes_meet(const struct isph *s, const double p[6], const double q[6]) {
  const double near = 1e-6 * s->spacing;
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a) && (p[a] > q[a + 3] - near || q[a] > p[a + 3] - near)) return false;
  return true;
}

static bool is_full(const struct region *region, enum region_type type) {
  return region->type == type && !region->is_part && (type == REGION_WATER || region->saturated);
}

/* The region of water, or else of saturated soil, that alone occupies the place x; NULL if other
 * regions overlap it. */
static const struct region *filled_by(const struct isph *s, const double x[3]) {
  const struct region *regions = s->scene->regions, *found = NULL;
  const size_t n = s->scene->region_count;
  for (size_t k = 0; k < 2 * n && found == NULL; k++) {
    const struct region *region = &regions[k % n];
    bool inside = is_full(region, k < n ? REGION_WATER : REGION_POROUS);
    for (int a = 0; a < 3; a++)
      if (isph_uses_axis(s, a))
        inside = inside && x[a] > region->box[a] && x[a] < region->box[a + 3];
    if (inside) found = region;
  }
  for (size_t k = 0; k < n && found != NULL; k++) {
    const struct region *other = &regions[k];
    const bool cuts =
        other->type == REGION_WATER ||
        (other->type == REGION_POROUS && found->type == REGION_POROUS) ||
        ((other->type == REGION_WALL || other->type == REGION_EMPTY) && other > found);
    if (other != found && cuts && boxes_meet(s, other->box, found->box)) return NULL;
  }
  return found;
}

/* Sites lie at multiples of the spacing from the domain's corner, whatever the box of water. If a
 * box is not a whole number of rows, its rows are stretched over it, so that all of its water is
 * there and evenly spaced. */
static void fit_box(const struct isph *s, const struct lattice *lattice, struct site *site) {
  const struct region *region = filled_by(s, site->x);
  if (region == NULL) return;
  for (int a = 0; a < 3; a++) {
    if (!isph_uses_axis(s, a)) continue;
    const double dx = lattice->spacing[a], low = region->box[a], length = region->box[a + 3] - low;
    const double first = floor((low - lattice->origin[a]) / dx + 1e-9) + 1;
    const double last = ceil((low + length - lattice->origin[a]) / dx - 1e-9) - 1;
    const double rows = fmax(1, last - first + 1), pitch = length / rows;
    const double row = round((site->x[a] - lattice->origin[a]) / dx) - first;
    const double place = low + (row + 0.5) * pitch;
    /* Rows that already fit stay exactly where they are. */
    if (fabs(pitch / dx - 1) < 1e-9 && fabs(place - site->x[a]) < 1e-6 * dx) continue;
    site->x[a] = place;
    site->width[a] = pitch;
    site->volume *= pitch / dx;
  }
}

/* Whether a box of a wall is a part of a site's cell. */
static bool is_cut_by_box(const struct isph *s, const struct site *site) {
  const double near = 1e-6 * s->spacing;
  for (size_t b = 1; b < s->wall_box_count; b++) {
    const struct isph_wall_box *wall = &s->wall_boxes[b];
    bool meets = !wall->region->is_part, covers = true;
    for (int a = 0; a < 3 && meets; a++) {
      if (!isph_uses_axis(s, a)) continue;
      const double low = site->x[a] - 0.5 * site->width[a], high = low + site->width[a];
      meets = wall->low[a] < high - near && wall->high[a] > low + near;
      covers = covers && wall->low[a] < low + near && wall->high[a] > high - near;
    }
    if (meets && !covers) return true;
  }
  return false;
}

/* Whether a wall divides the cell of a site in soil without a surface. */
static bool is_cut(const struct isph *s, const struct site *site) {
  if (s->on.surface || !(site->porosity < 1)) return false;
  if (is_cut_by_box(s, site)) return true;
  if (!s->on.outlines) return false;
  const struct isph_facing facing = isph_outline_facing(s, site->x);
  return facing.box > 0 && fabs(facing.distance) < 0.5 * sqrt(s->dimensions) * s->spacing;
}

/* Calls `take` for the parts of a cell of soil that are not in walls. */
static enum status for_parts(struct isph *s, const struct site *site,
                             enum status (*take)(struct isph *s, const struct site *site,
                                                 void *context),
                             void *context) {
  for (int n = 0; n < OUTLINE_PLACES; n++) {
    struct site part = {.volume = site->volume / OUTLINE_PLACES};
    isph_outline_place(s, site->x, n, part.x);
    for (int a = 0; a < 3; a++)
      part.width[a] = isph_uses_axis(s, a) ? site->width[a] / isph_outline_places(s) : 1;
    find_regions(s, &part);
    if (!(part.porosity < 1) || isph_wall_holds(s, part.x)) continue;
    enum status status = take(s, &part, context);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

/* Calls `take` for each site of water, in their order; stops at the first failure. */
static enum status for_sites(struct isph *s, const struct lattice *lattice,
                             enum status (*take)(struct isph *s, const struct site *site,
                                                 void *context),
                             void *context) {
  double volume = lattice->spacing[0] * lattice->spacing[2];
  if (s->dimensions == 3) volume *= lattice->spacing[1];
  size_t index = 0;
  for (size_t k = 0; k < lattice->size[2]; k++)
    for (size_t j = 0; j < lattice->size[1]; j++)
      for (size_t i = 0; i < lattice->size[0]; i++, index++) {
        const size_t at[3] = {i, j, k};
        struct site site = {.volume = volume};
        for (int a = 0; a < 3; a++) {
          site.x[a] = lattice->origin[a] + (double)at[a] * lattice->spacing[a];
          site.width[a] = isph_uses_axis(s, a) ? lattice->spacing[a] : 1;
        }
        find_regions(s, &site);
        const bool cut = is_cut(s, &site);
        if (lattice->kind[index] != SITE_FLUID && !cut) continue;
        if (!cut) fit_box(s, lattice, &site), find_regions(s, &site);
        enum status status = cut ? for_parts(s, &site, take, context) : take(s, &site, context);
        if (status != STATUS_OK) return status;
      }
  return STATUS_OK;
}

static struct block *block_of(const struct isph *s, const struct blocks *blocks,
                              const struct site *site) {
  const size_t n = s->scene->region_count;
  if (!(site->porosity < 1)) return NULL;
  return &blocks->block[blocks->of[site->porous * (n + 1) + site->water] - 1];
}

/* Finds the block of a site and extends its box by the site. */
static enum status extend_block(struct isph *s, const struct site *site, void *context) {
  struct blocks *blocks = context;
  const size_t n = s->scene->region_count;
  if (!(site->porosity < 1)) return STATUS_OK;
  uint32_t *number = &blocks->of[site->porous * (n + 1) + site->water];
  if (*number == 0) {
    enum status status =
        memory_resize(&blocks->block, blocks->count + 1, sizeof *blocks->block, "regions");
    if (status != STATUS_OK) return status;
    struct block *block = &blocks->block[blocks->count++];
    *block = (struct block){.porosity = site->porosity, .velocity = site->velocity};
    for (int a = 0; a < 3; a++) block->low[a] = INFINITY, block->high[a] = -INFINITY;
    *number = (uint32_t)blocks->count;
  }
  struct block *block = &blocks->block[*number - 1];
  for (int a = 0; a < 3; a++) {
    block->low[a] = fmin(block->low[a], site->x[a] - 0.5 * site->width[a]);
    block->high[a] = fmax(block->high[a], site->x[a] + 0.5 * site->width[a]);
  }
  return STATUS_OK;
}

/* Divides a block into rows along each axis, the shortest first, so that a cell holds as much water
 * as a free particle. */
static void divide_into_rows(const struct isph *s, struct block *block) {
  double volume = pow(s->spacing, s->dimensions) * s->mass_ratio / block->porosity;
  bool divided[3] = {false, false, false};
  block->count = 1;
  block->whole = block->porosity * s->density;
  for (int left = s->dimensions; left > 0; left--) {
    int axis = -1;
    for (int a = 0; a < 3; a++)
      if (isph_uses_axis(s, a) && !divided[a] &&
          (axis < 0 || block->high[a] - block->low[a] < block->high[axis] - block->low[axis]))
        axis = a;
    const double length = block->high[axis] - block->low[axis];
    const double size = pow(volume, 1.0 / left), rows = fmax(1, floor(length / size));
    /* of n and n + 1 rows the one whose pitch is nearer to the size in proportion */
    block->rows[axis] = (int)(length > size * sqrt(rows * (rows + 1)) ? rows + 1 : rows);
    volume /= length / block->rows[axis];
    block->whole *= length / block->rows[axis];
    block->count *= (size_t)block->rows[axis];
    divided[axis] = true;
  }
  if (s->dimensions == 2) block->rows[1] = 1;
}

/* Fraction of the site's length along axis a that lies in row r of the block. */
static double overlap(const struct block *block, const struct site *site, int a, int r) {
  const double pitch = (block->high[a] - block->low[a]) / block->rows[a];
  const double low = fmax(site->x[a] - 0.5 * site->width[a], block->low[a] + r * pitch);
  const double high = fmin(site->x[a] + 0.5 * site->width[a], block->low[a] + (r + 1) * pitch);
  return fmax(0, high - low) / site->width[a];
}

/* Distributes a site's water to the cells that overlap it. */
static enum status distribute_water(struct isph *s, const struct site *site, void *context) {
  const struct blocks *blocks = context;
  const struct block *block = block_of(s, blocks, site);
  if (block == NULL) return STATUS_OK;
  int from[3], to[3];
  for (int a = 0; a < 3; a++) {
    const double pitch = (block->high[a] - block->low[a]) / block->rows[a];
    const double low = (site->x[a] - 0.5 * site->width[a] - block->low[a]) / pitch;
    const double high = (site->x[a] + 0.5 * site->width[a] - block->low[a]) / pitch;
    from[a] = (int)fmax(0, floor(low + 1e-9));
    to[a] = (int)fmin(block->rows[a] - 1, ceil(high - 1e-9) - 1);
  }
  for (int k = from[2]; k <= to[2]; k++)
    for (int j = from[1]; j <= to[1]; j++)
      for (int i = from[0]; i <= to[0]; i++) {
        const int at[3] = {i, j, k};
        double share = site->porosity * s->density * site->volume;
        for (int a = 0; a < 3; a++)
          if (isph_uses_axis(s, a)) share *= overlap(block, site, a, at[a]);
        const size_t row = (size_t)k * (size_t)block->rows[1] + (size_t)j;
        struct cell *cell = &blocks->cell[block->first + row * (size_t)block->rows[0] + (size_t)i];
        cell->mass += share;
        for (int a = 0; a < 3; a++) {
          const double pitch = (block->high[a] - block->low[a]) / block->rows[a];
          const double low = fmax(site->x[a] - 0.5 * site->width[a], block->low[a] + at[a] * pitch);
          const double high =
              fmin(site->x[a] + 0.5 * site->width[a], block->low[a] + (at[a] + 1) * pitch);
          cell->moment[a] += share * (isph_uses_axis(s, a) ? 0.5 * (low + high) : site->x[a]);
        }
      }
  return STATUS_OK;
}

/* Cells that walls or other soil leave less than this share of a full cell are merged with the
 * fullest neighbour. */
#define CELL_SHARE_MIN 0.5

static void merge_slivers(const struct block *block, struct cell *cell) {
  const int *rows = block->rows;
  const size_t stride[3] = {1, (size_t)rows[0], (size_t)rows[0] * (size_t)rows[1]};
  for (size_t c = 0; c < block->count; c++) {
    if (!(cell[c].mass > 0 && cell[c].mass < CELL_SHARE_MIN * block->whole)) continue;
    size_t best = c;
    for (int a = 0; a < 3; a++) {
      const int at = (int)(c / stride[a] % (size_t)rows[a]);
      if (at > 0 && cell[c - stride[a]].mass > cell[best].mass) best = c - stride[a];
      if (at < rows[a] - 1 && cell[c + stride[a]].mass > cell[best].mass) best = c + stride[a];
    }
    if (best == c) continue;
    cell[best].mass += cell[c].mass;
    for (int a = 0; a < 3; a++) cell[best].moment[a] += cell[c].moment[a];
    cell[c].mass = 0;
  }
}

struct filling {
  const struct blocks *blocks;
  size_t first, end; /* this rank's range among all particles */
};

static enum status add(struct isph *s, const struct filling *filling, const double x[3],
                       const double velocity[3], double mass) {
  if (s->next_id >= filling->first && s->next_id < filling->end)
    return isph_add_particle(s, x, velocity, mass);
  s->next_id++;
  return STATUS_OK;
}

static enum status fill_site(struct isph *s, const struct site *site, void *context) {
  const struct filling *filling = context;
  if (site->porosity < 1) return STATUS_OK;
  return add(s, filling, site->x, site->velocity, s->density * site->volume);
}

static enum status count_free(struct isph *s, const struct site *site, void *context) {
  (void)s;
  if (!(site->porosity < 1)) ++*(size_t *)context;
  return STATUS_OK;
}

static enum status find_room(struct isph *s, const struct site *site, void *context) {
  (void)context;
  s->room += site->volume;
  s->mass_ratio = fmax(s->mass_ratio, site->porosity);
  return STATUS_OK;
}

/* All particles have the mass of a site where the porosity is largest: of free water, unless soil
 * fills the domain. */
enum status isph_choose_mass(struct isph *s, const struct lattice *lattice) {
  s->room = 0;
  s->mass_ratio = s->on.soil && !s->on.surface ? 0 : 1;
  enum status status = s->mass_ratio > 0 ? STATUS_OK : for_sites(s, lattice, find_room, NULL);
  if (!(s->mass_ratio > 0)) s->mass_ratio = 1;
  return status;
}

/* Creates the cells of all blocks with their water. */
static enum status make_blocks(struct isph *s, const struct lattice *lattice,
                               struct blocks *blocks) {
  enum status status = STATUS_OK;
  const size_t n = s->scene->region_count;
  size_t cells = 0;
  TRY(memory_allocate(&blocks->of, n * (n + 1), sizeof *blocks->of, "regions"));
  TRY(for_sites(s, lattice, extend_block, blocks));
  for (size_t b = 0; b < blocks->count; b++) {
    divide_into_rows(s, &blocks->block[b]);
    blocks->block[b].first = cells;
    cells += blocks->block[b].count;
  }
  TRY(memory_allocate(&blocks->cell, cells, sizeof *blocks->cell, "water in soil"));
  TRY(for_sites(s, lattice, distribute_water, blocks));
  for (size_t b = 0; b < blocks->count; b++)
    merge_slivers(&blocks->block[b], blocks->cell + blocks->block[b].first);
cleanup:
  return status;
}

/* Each rank takes a contiguous range of the particles. */
enum status isph_place_water(struct isph *s, const struct lattice *lattice) {
  enum status status = STATUS_OK;
  struct blocks blocks = {0};
  struct filling filling = {.blocks = &blocks};
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  size_t total = 0;
  if (s->on.soil) TRY(make_blocks(s, lattice, &blocks));
  TRY(for_sites(s, lattice, count_free, &total));
  for (size_t b = 0; b < blocks.count; b++)
    for (size_t c = 0; c < blocks.block[b].count; c++)
      total += blocks.cell[blocks.block[b].first + c].mass > 0;
  filling.first = total * own / ranks, filling.end = total * (own + 1) / ranks;
  TRY(isph_reserve(s, filling.end > filling.first ? filling.end - filling.first : 1));
  TRY(for_sites(s, lattice, fill_site, &filling));
  for (size_t b = 0; b < blocks.count; b++)
    for (size_t c = 0; c < blocks.block[b].count; c++) {
      const struct cell *cell = &blocks.cell[blocks.block[b].first + c];
      double x[3];
      if (!(cell->mass > 0)) continue;
      for (int a = 0; a < 3; a++) x[a] = cell->moment[a] / cell->mass;
      TRY(add(s, &filling, x, blocks.block[b].velocity, cell->mass));
    }
  s->start_count = total;
cleanup:
  memory_free(&blocks.block);
  memory_free(&blocks.cell);
  memory_free(&blocks.of);
  return status;
}
