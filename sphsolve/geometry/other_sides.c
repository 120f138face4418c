#include "sphsolve/geometry/other_sides.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/side_distance.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/geometry/soil.h"

/* Index of the original of a mirrored site. */
static size_t mirror_source(size_t i, size_t n) {
  return i < n ? i : 2 * n - 1 - i;
}

/* Whether a wall without sites separates a site from a neighbour. */
static bool is_beside_cut(const struct lattice *l, size_t site) {
  if (l->cut == NULL) return false;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  bool beside = l->cut[site] != 0;
  for (int a = 0; a < 3; a++) {
    const size_t at = site / stride[a] % l->size[a];
    beside |= thin_wall_on_face(l, site + (at > 0 ? 0 : l->size[a] * stride[a]) - stride[a], a);
  }
  return beside;
}

/* Wall distances from the inside of the sample only; the neighbourhood beyond a side is unknown. */
static enum status distances_inside(const struct lattice *wrapped, const bool axes[3],
                                    float **distance) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(distance, wrapped->count, sizeof **distance, "a lattice"));
  memcpy(*distance, wrapped->wall_distance, wrapped->count * sizeof **distance);
  side_distance_unwrap(wrapped->size, wrapped->spacing, axes, *distance);
  for (size_t i = 0; i < wrapped->count; i++)
    if (!isfinite((*distance)[i])) {
      /* No wall site nearby inside: keeps its distance, but at least one spacing, or to a wall
       * without sites. */
      const float old = wrapped->wall_distance[i];
      if (!is_beside_cut(wrapped, i))
        (*distance)[i] = copysignf(fmaxf(fabsf(old), (float)wrapped->spacing[0]), old);
      else
        (*distance)[i] = old;
    }
cleanup:
  return status;
}

enum status lattice_mirror_sides(const struct lattice *wrapped, const bool axes[3],
                                 struct lattice *mirrored) {
  enum status status = STATUS_OK;
  const size_t *n = wrapped->size;
  size_t copies = 1;
  float *distance = NULL;
  *mirrored = *wrapped;
  mirrored->kind = NULL, mirrored->wall_distance = NULL, mirrored->region = NULL;
  mirrored->micro_porosity = mirrored->micro_permeability = NULL;
  mirrored->cut = NULL, mirrored->own_surface = NULL;
  TRY(distances_inside(wrapped, axes, &distance));
  for (int a = 0; a < 3; a++)
    if (axes[a]) {
      if (wrapped->surface != NULL)
        mirrored->folded[a] =
            (size_t)lround((double)n[a] * wrapped->spacing[a] /
                           ((double)wrapped->surface->size[a] * wrapped->surface->spacing[a]));
      mirrored->size[a] *= 2;
      mirrored->model.unlike[a] = false;
      copies *= 2;
    }
  mirrored->y_mirrored = axes[1];
  mirrored->count = copies * wrapped->count;
  mirrored->bulk_count = (double)copies * wrapped->bulk_count;
  mirrored->fluid_count = copies * wrapped->fluid_count;
  mirrored->wall_count = copies * wrapped->wall_count;
  TRY(memory_allocate(&mirrored->kind, mirrored->count, 1, "a lattice"));
  TRY(memory_allocate(&mirrored->wall_distance, mirrored->count, sizeof *distance, "a lattice"));
  if (wrapped->micro_porosity != NULL) TRY(lattice_soil_allocate(mirrored));
  for (size_t at = 0; at < mirrored->count; at++) {
    const size_t i = at % mirrored->size[0], j = at / mirrored->size[0] % mirrored->size[1];
    const size_t k = at / mirrored->size[0] / mirrored->size[1];
    const size_t from =
        (mirror_source(k, n[2]) * n[1] + mirror_source(j, n[1])) * n[0] + mirror_source(i, n[0]);
    mirrored->kind[at] = wrapped->kind[from];
    mirrored->wall_distance[at] = distance[from];
    lattice_soil_copy(wrapped, from, mirrored, at);
  }
  if (wrapped->cut) TRY(thin_wall_find_faces(mirrored));
cleanup:
  memory_free(&distance);
  if (status != STATUS_OK) lattice_free(mirrored);
  return status;
}

enum status lattice_mirror_flow(const struct scene *scene, struct lattice *lattice) {
  enum status status = STATUS_OK;
  struct lattice wrapped = *lattice;
  const struct model_facts *model = &wrapped.model;
  const bool axes[3] = {scene->driving[0] != 0.0, scene->driving[1] != 0.0, false};
  if (!model->flow_cut || !model->z_mirrored || axes[0] == axes[1]) return STATUS_OK;
  TRY(lattice_mirror_sides(&wrapped, axes, lattice));
  lattice->model.flow_cut = false;
  memcpy(lattice->model.mirrored, axes, sizeof axes);
  lattice_free(&wrapped);
cleanup:
  if (status != STATUS_OK) *lattice = wrapped;
  return status;
}

/* Distance from the centre of site i to the nearer side, negative in the wall beyond the n-th site;
 * the wall of `all` - n sites ends where the periodic sample begins again. */
static double distance_to_side(size_t i, size_t n, size_t all, double spacing) {
  const double x = (double)i + 0.5, outside = fmin(x - (double)n, (double)all - x);
  return spacing * (i < n ? fmin(x, (double)n - x) : -outside);
}

enum status lattice_close_sides(const struct lattice *wrapped, size_t layers,
                                struct lattice *closed) {
  enum status status = STATUS_OK;
  const size_t *n = wrapped->size;
  float *distance = NULL;
  *closed = *wrapped;
  closed->kind = NULL, closed->wall_distance = NULL, closed->region = NULL;
  closed->micro_porosity = closed->micro_permeability = NULL;
  closed->cut = NULL, closed->own_surface = NULL;
  TRY(distances_inside(wrapped, (const bool[3]){true, true, false}, &distance));
  closed->size[0] = n[0] + layers, closed->size[1] = n[1] + layers;
  closed->count = closed->size[0] * closed->size[1] * n[2];
  closed->wall_count += closed->count - wrapped->count;
  TRY(memory_allocate(&closed->kind, closed->count, 1, "a lattice"));
  TRY(memory_allocate(&closed->wall_distance, closed->count, sizeof *distance, "a lattice"));
  if (wrapped->micro_porosity != NULL) TRY(lattice_soil_allocate(closed));
  for (size_t at = 0; at < closed->count; at++) {
    const size_t i = at % closed->size[0], j = at / closed->size[0] % closed->size[1];
    const size_t k = at / closed->size[0] / closed->size[1];
    const double side = fmin(distance_to_side(i, n[0], closed->size[0], wrapped->spacing[0]),
                             distance_to_side(j, n[1], closed->size[1], wrapped->spacing[1]));
    closed->kind[at] = SITE_WALL;
    closed->wall_distance[at] = (float)side;
    if (side < 0.0) continue;
    const size_t from = (k * n[1] + j) * n[0] + i;
    closed->kind[at] = wrapped->kind[from];
    closed->wall_distance[at] = fminf(distance[from], (float)side);
    lattice_soil_copy(wrapped, from, closed, at);
  }
  if (wrapped->cut) TRY(thin_wall_find_faces(closed));
cleanup:
  memory_free(&distance);
  if (status != STATUS_OK) lattice_free(closed);
  return status;
}
