#include "sphsolve/geometry/lattice.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/side_distance.h"
#include "common/memory.h"
#include "common/model_file.h"
#include "common/node_memory.h"
#include "common/provenance.h"
#include "common/ranks.h"
#include "sphsolve/geometry/distance.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/scene/scene_geometry.h"

/* Makes the sign of each distance agree with the kind of its site, for sites [first, end), so that
 * no method divides by a distance of the wrong sign. */
static void sign_distances(struct lattice *lattice, size_t first, size_t end) {
  double spacing = cbrt(lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2]);
  float least = (float)(1e-3 * spacing);
#pragma omp parallel for schedule(static)
  for (size_t i = first; i < end; i++) {
    float *d = &lattice->wall_distance[i];
    *d = lattice->kind[i] == SITE_WALL ? fminf(*d, -least) : fmaxf(*d, least);
  }
}

/* First site of each rank, [ranks + 1]: the planes of a lattice divided evenly. */
static enum status divide_planes(const size_t size[3], size_t **start) {
  const size_t ranks = (size_t)ranks_count();
  const enum status status = memory_allocate(start, ranks + 1, sizeof **start, "the lattice");
  for (size_t r = 0; r <= ranks && status == STATUS_OK; r++)
    (*start)[r] = size[2] * r / ranks * size[0] * size[1];
  return status;
}

/* Wall distances of a model that contains none: from its grain fraction, otherwise from the voxel
 * faces. Collective. */
static enum status find_distances(const struct voxel_model *model, float **distance) {
  enum status status = STATUS_OK;
  size_t *start = NULL;
  TRY(node_allocate(distance, model_site_count(model), sizeof **distance, "wall distances"));
  TRY(divide_planes(model->size, &start));
  const size_t plane = model->size[0] * model->size[1];
  const size_t first = start[ranks_own()] / plane, end = start[ranks_own() + 1] / plane;
  if (model->grain_fraction != NULL)
    TRY(ranks_agree(distance_from_fraction(model->size, model->spacing, model->periodic, first, end,
                                           model->grain_fraction, *distance)));
  else
    distance_from_faces(model->size, model->spacing, model->periodic, first, end, model->solid,
                        *distance);
  node_share(*distance, start, sizeof **distance);
cleanup:
  memory_free(&start);
  return status;
}

/* Finds the axes along which the model does not match itself at the periodic boundary. */
static void find_mismatched_axes(const struct scene *scene, const struct voxel_model *model,
                                 struct model_facts *facts) {
  const double *force = scene->driving;
  if (facts->sides_stated) return;
  for (int a = 0; a < 2; a++) facts->unlike[a] = facts->sides_wrapped && model->size[a] > 1;
  facts->unlike[2] = model->periodic[2] && model_cut_pores(model, 2) > 0.0;
  facts->flow_cut = facts->unlike[2] && force[0] == 0.0 && force[1] == 0.0;
  for (int a = 0; a < 2; a++)
    if (force[a] != 0.0 && force[1 - a] == 0.0 && force[2] == 0.0)
      facts->flow_cut = facts->unlike[a] && model->periodic[a] && model_cut_pores(model, a) > 0.0;
}

/* Copies `model` into the lattice, with `layers` walls on both sides of axes that do not repeat. */
static enum status from_model(const struct scene *scene, int layers, struct lattice *lattice) {
  enum status status = STATUS_OK;
  struct voxel_model model;
  float *inner = NULL;
  size_t *start = NULL;
  status = model_read(scene->model_path, &model);
  if (status == STATUS_INPUT && scene->line_of[AT_MODEL] > 0)
    error_context(status, "%s:%d: model.file", scene->path, scene->line_of[AT_MODEL]);
  TRY(status);
  TRY(model_facts_read(scene->model_path, &lattice->model));
  double least = fmin(fmin(model.spacing[0], model.spacing[1]), model.spacing[2]);
  double most = fmax(fmax(model.spacing[0], model.spacing[1]), model.spacing[2]);
  if (most > MODEL_LONGEST_EDGE * least)
    TRY_FAIL(STATUS_INPUT,
             "%s: voxels of %g x %g x %g m are too far from cubes; choose --size so that "
             "they are about as wide as high",
             scene->model_path, model.spacing[0], model.spacing[1], model.spacing[2]);
  lattice->dimensions = 3;
  lattice->model.count = model_site_count(&model);
  lattice->model.voxel = cbrt(model.spacing[0] * model.spacing[1] * model.spacing[2]);
  lattice->bulk_count = (double)lattice->model.count;
  find_mismatched_axes(scene, &model, &lattice->model);
  size_t pad[3], count = 1;
  bool padded = false;
  for (int a = 0; a < 3; a++) {
    pad[a] = model.periodic[a] ? 0 : (size_t)layers;
    padded = padded || pad[a] > 0;
    lattice->spacing[a] = model.spacing[a];
    lattice->size[a] = model.size[a] + 2 * pad[a];
    lattice->origin[a] = (0.5 - (double)pad[a]) * model.spacing[a];
    if (!size_multiply(count, lattice->size[a], &count))
      TRY_FAIL(STATUS_INPUT, "%s: too many voxels", scene->model_path);
  }
  lattice->count = count;
  TRY(node_allocate(&lattice->kind, count, 1, "the lattice"));
  if (model.micro_porosity != NULL) {
    TRY(node_allocate(&lattice->micro_porosity, count, sizeof(float), "the soil"));
    TRY(node_allocate(&lattice->micro_permeability, count, sizeof(float), "the soil"));
  }
  if (model.wall_distance == NULL) TRY(find_distances(&model, &inner));
  const float *source = model.wall_distance != NULL ? model.wall_distance : inner;
  memory_free(&model.grain_fraction);
  TRY(node_allocate(&lattice->wall_distance, count, sizeof *lattice->wall_distance,
                    "wall distances"));
  TRY(divide_planes(lattice->size, &start));
  const size_t plane = lattice->size[0] * lattice->size[1];
  const size_t first = start[ranks_own()] / plane, last = start[ranks_own() + 1] / plane;
#pragma omp parallel for schedule(static)
  for (size_t k = first; k < last; k++)
    for (size_t j = 0; j < lattice->size[1]; j++)
      for (size_t i = 0; i < lattice->size[0]; i++) {
        size_t at = (k * lattice->size[1] + j) * lattice->size[0] + i, xyz[3] = {i, j, k};
        /* Depth of the site in the added walls, distance to the nearest closed side, and the
         * nearest voxel. */
        double depth = 0, room = INFINITY;
        size_t near[3];
        for (int a = 0; a < 3; a++) {
          size_t n = model.size[a];
          near[a] = xyz[a] < pad[a] ? 0 : xyz[a] - pad[a] < n ? xyz[a] - pad[a] : n - 1;
          double x = ((double)xyz[a] - (double)pad[a] + 0.5) * model.spacing[a];
          double outside = fmax(-x, x - (double)n * model.spacing[a]);
          if (!model.periodic[a] && outside > 0) depth = fmax(depth, outside);
          if (!model.periodic[a] && outside <= 0) room = fmin(room, -outside);
        }
        size_t from = (near[2] * model.size[1] + near[1]) * model.size[0] + near[0];
        lattice->kind[at] = SITE_WALL;
        if (depth > 0) {
          lattice->wall_distance[at] = (float)-depth;
          continue;
        }
        bool grain = model.solid[from] != 0;
        lattice->kind[at] = grain ? SITE_WALL : SITE_FLUID;
        if (lattice->micro_porosity != NULL) {
          lattice->micro_porosity[at] = model.micro_porosity[from];
          lattice->micro_permeability[at] = model.micro_permeability[from];
        }
        double d = source[from];
        if (padded && !grain) d = fmin(d, room);
        lattice->wall_distance[at] = (float)d;
      }
  const size_t own = start[ranks_own()], end = start[ranks_own() + 1];
  sign_distances(lattice, own, end);
  node_share(lattice->kind, start, 1);
  node_share(lattice->wall_distance, start, sizeof *lattice->wall_distance);
  if (lattice->micro_porosity != NULL) {
    node_share(lattice->micro_porosity, start, sizeof *lattice->micro_porosity);
    node_share(lattice->micro_permeability, start, sizeof *lattice->micro_permeability);
  }
cleanup:
  MEMORY_FREE(&start, &inner);
  model_free(&model);
  return status;
}

/* Number of sites whose centres lie inside a length. */
static size_t sites_in(double length, double spacing) {
  double n = floor(length / spacing + 0.5 - 1e-9);
  return n < 1 ? 1 : (size_t)fmin(n, 0x1p50);
}

static bool box_holds(const double box[6], const double x[3], int dimensions) {
  for (int a = 0; a < 3; a++) {
    if (dimensions == 2 && a == 1) continue;
    if (!(x[a] > box[a] && x[a] < box[a + 3])) return false;
  }
  return true;
}

/* Kind and region of a point: those of the last region that contains it. Soil is a property of
 * space, water is what fills it: a water region fills its volume, inside or outside soil, and a
 * later porous region does not remove the water. Soil outside water regions is dry unless it is
 * `saturated` or has a curve, which says how wet it is; if all soil is saturated by default, it is
 * wet unless the region says `saturated = false`. */
static void classify_point(const struct scene *scene, const double x[3], bool all_saturated,
                           uint8_t *kind, uint16_t *region) {
  bool water = false;
  *kind = SITE_EMPTY;
  *region = 0;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *candidate = &scene->regions[r];
    if (!box_holds(candidate->box, x, scene->dimensions)) continue;
    switch (candidate->type) {
    case REGION_WATER:
      water = true;
      *kind = SITE_FLUID;
      break;
    case REGION_WALL:
      water = false;
      *kind = SITE_WALL;
      break;
    case REGION_EMPTY:
      water = false;
      *kind = SITE_EMPTY;
      break;
    case REGION_POROUS:
      *kind = water || candidate->saturated || candidate->retention.given ||
                      (all_saturated && !candidate->dry)
                  ? SITE_FLUID
                  : SITE_EMPTY;
      break;
    case REGION_INFLOW:
    case REGION_WELL:
    case REGION_DRAIN:
    case REGION_RAIN:
    case REGION_ABSORBING:
      continue; /* they fill nothing */
    }
    *region = (uint16_t)(r + 1);
  }
}

/* Whether soil is saturated by default: there can be no free surface if there is no water region,
 * or if the domain is periodic along the driving force. */
static bool saturated_by_default(const struct scene *scene) {
  for (int a = 0; a < 3; a++)
    if (scene->periodic[a] && scene->driving[a] != 0) return true;
  return !scene_has_region(scene, REGION_WATER);
}

/* Sets the sites of planes [first, end); returns whether any site of the lattice is empty.
 * Collective. */
static bool fill_sites(const struct scene *scene, const size_t pad[3], const size_t inner[3],
                       bool all_saturated, size_t first, size_t end, struct lattice *lattice) {
  bool empty = false;
  for (size_t k = first; k < end; k++)
    for (size_t j = 0; j < lattice->size[1]; j++)
      for (size_t i = 0; i < lattice->size[0]; i++) {
        size_t at = (k * lattice->size[1] + j) * lattice->size[0] + i, xyz[3] = {i, j, k};
        double x[3];
        bool outside = false;
        for (int a = 0; a < 3; a++) {
          x[a] = lattice->origin[a] + (double)xyz[a] * scene->spacing;
          outside = outside || xyz[a] < pad[a] || xyz[a] >= pad[a] + inner[a];
        }
        if (outside)
          lattice->kind[at] = SITE_WALL;
        else
          classify_point(scene, x, all_saturated, &lattice->kind[at], &lattice->region[at]);
        empty = empty || lattice->kind[at] == SITE_EMPTY;
      }
  return ranks_any(empty);
}

static double spacing_of_a_million(const struct scene *scene) {
  double sites = 1e6, volume = 1.0;
  for (int a = 0; a < 3; a++)
    if (scene->dimensions == 3 || a != 1) volume *= scene->domain_size[a];
  return pow(volume / sites, 1.0 / scene->dimensions);
}

/* A wall that is thinner than the spacing may have no site in it. Bodies other than boxes are made
 * of sites. */
static void find_thin_walls(const struct scene *scene, struct lattice *lattice) {
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    const double thickness = scene_region_thickness(scene, region);
    if (region->type == REGION_WALL && region->is_part) lattice->shapes = scene;
    if (region->type != REGION_WALL || region->is_part ||
        !(thickness < (1.0 + 1e-6) * scene->spacing))
      continue;
    lattice->thinnest = lattice->boxes ? fmin(lattice->thinnest, thickness) : thickness;
    lattice->boxes = lattice->shapes = scene;
  }
}

static enum status from_domain(const struct scene *scene, int layers, struct lattice *lattice) {
  enum status status = STATUS_OK;
  size_t pad[3], inner[3], count = 1, *start = NULL;
  lattice->dimensions = scene->dimensions;
  lattice->bulk_count = 1;
  for (int a = 0; a < 3; a++) {
    lattice->spacing[a] = scene->spacing;
    inner[a] = sites_in(scene->domain_size[a], scene->spacing);
    double length = (double)inner[a] * scene->spacing;
    if (scene->periodic[a] && fabs(length - scene->domain_size[a]) > 1e-3 * scene->spacing)
      TRY(scene_error(scene, AT_SIZE,
                      "the periodic length %g m in %c is no whole number of spacings (%g m); %g m "
                      "would be",
                      scene->domain_size[a], 'x' + a, scene->spacing, length));
    pad[a] = scene->periodic[a] ? 0 : (size_t)layers;
    lattice->size[a] = inner[a] + 2 * pad[a];
    lattice->origin[a] = (0.5 - (double)pad[a]) * scene->spacing;
    const double sites = scene->domain_size[a] / scene->spacing;
    lattice->bulk_count *= fabs(sites - (double)inner[a]) < 1e-6 ? (double)inner[a] : sites;
    if (!size_multiply(count, lattice->size[a], &count) || count > (size_t)1 << 40 ||
        !memory_has_room(count, sizeof *lattice->kind + sizeof *lattice->region))
      TRY(scene_error(scene, AT_SPACING, "%g m makes too many points; \"%.2g m\" makes a million",
                      scene->spacing, spacing_of_a_million(scene)));
  }
  lattice->count = count;
  TRY(node_allocate(&lattice->kind, count, 1, "the lattice"));
  TRY(node_allocate(&lattice->region, count, sizeof *lattice->region, "the lattice"));
  TRY(divide_planes(lattice->size, &start));
  const size_t from = start[ranks_own()], to = start[ranks_own() + 1];
  const size_t plane = lattice->size[0] * lattice->size[1], first = from / plane, end = to / plane;
  find_thin_walls(scene, lattice);
  bool wall = lattice->shapes != NULL;
  /* With all soil saturated first: if that leaves no site empty, there is no free surface and soil
   * stays saturated. */
  if (fill_sites(scene, pad, inner, true, first, end, lattice) && !saturated_by_default(scene))
    fill_sites(scene, pad, inner, false, first, end, lattice);
  for (size_t at = from; at < to; at++) wall = wall || lattice->kind[at] == SITE_WALL;
  node_share(lattice->kind, start, 1);
  node_share(lattice->region, start, sizeof *lattice->region);
  if (ranks_any(wall)) {
    TRY(node_allocate(&lattice->wall_distance, count, sizeof *lattice->wall_distance,
                      "wall distances"));
    for (size_t at = from; at < to; at++) {
      const size_t row = at / lattice->size[0];
      const size_t site[3] = {at % lattice->size[0], row % lattice->size[1],
                              row / lattice->size[1]};
      double x[3];
      for (int a = 0; a < 3; a++) x[a] = lattice->origin[a] + (double)site[a] * scene->spacing;
      lattice->wall_distance[at] = (float)distance_to_boxes(scene, x);
    }
    sign_distances(lattice, from, to);
    node_share(lattice->wall_distance, start, sizeof *lattice->wall_distance);
  }
cleanup:
  memory_free(&start);
  return status;
}

enum status lattice_build(const struct scene *scene, int wall_layers, struct lattice *lattice) {
  enum status status = STATUS_OK;
  *lattice = (struct lattice){0};
  if (*scene->model_path)
    TRY(from_model(scene, wall_layers, lattice));
  else
    TRY(from_domain(scene, wall_layers, lattice));
  size_t fluid = 0, wall = 0;
#pragma omp parallel for schedule(static) reduction(+ : fluid, wall)
  for (size_t i = 0; i < lattice->count; i++) {
    fluid += lattice->kind[i] == SITE_FLUID;
    wall += lattice->kind[i] == SITE_WALL;
  }
  lattice->fluid_count = fluid, lattice->wall_count = wall;
  if (lattice->shapes != NULL) TRY(thin_wall_find_faces(lattice));
cleanup:
  if (status != STATUS_OK) lattice_free(lattice);
  return status;
}

void lattice_free(struct lattice *lattice) {
  MEMORY_FREE(&lattice->kind, &lattice->wall_distance, &lattice->region, &lattice->micro_porosity,
              &lattice->micro_permeability, &lattice->cut);
  if (lattice->own_surface) lattice_free(lattice->own_surface);
  memory_free(&lattice->own_surface);
}

/* Distances lie first in the file, then regions. */
enum status lattice_spill_distances(struct lattice *l, const char *beside,
                                    struct lattice_spill *spill) {
  enum status status = STATUS_OK;
  /* Arrays shared by several ranks stay in memory. */
  if (l->wall_distance == NULL || ranks_count() > 1) return STATUS_OK;
  if (spill->file.file == NULL) TRY(scratch_open(beside, &spill->file));
  TRY(scratch_write(&spill->file, 0, l->wall_distance, l->count * sizeof *l->wall_distance));
  memory_free(&l->wall_distance);
  spill->distances = true;
cleanup:
  return status;
}

enum status lattice_spill_regions(struct lattice *l, const char *beside,
                                  struct lattice_spill *spill) {
  enum status status = STATUS_OK;
  if (l->region == NULL || ranks_count() > 1) return STATUS_OK;
  if (spill->file.file == NULL) TRY(scratch_open(beside, &spill->file));
  TRY(scratch_write(&spill->file, l->count * sizeof *l->wall_distance, l->region,
                    l->count * sizeof *l->region));
  memory_free(&l->region);
  spill->regions = true;
cleanup:
  return status;
}

enum status lattice_restore(struct lattice *l, struct lattice_spill *spill) {
  enum status status = STATUS_OK;
  const size_t distances = l->count * sizeof *l->wall_distance;
  if (spill->distances) {
    TRY(memory_allocate(&l->wall_distance, l->count, sizeof *l->wall_distance, "wall distances"));
    TRY(scratch_read(&spill->file, 0, l->wall_distance, distances));
  }
  if (spill->regions) {
    TRY(memory_allocate(&l->region, l->count, sizeof *l->region, "the lattice"));
    TRY(scratch_read(&spill->file, distances, l->region, l->count * sizeof *l->region));
  }
cleanup:
  scratch_close(&spill->file);
  return status;
}

static size_t count_differences(const uint8_t *a, const uint8_t *b, size_t n) {
  uint32_t unlike = 0;
  for (size_t i = 0; i < n; i++) unlike += a[i] != b[i];
  return unlike;
}

bool lattice_holds_fluid(const struct lattice *lattice) {
  return lattice->wall_count > 0 || lattice->cut != NULL || lattice->micro_porosity != NULL;
}

void lattice_count_faces(const struct lattice *lattice, size_t faces[3]) {
  const size_t *n = lattice->size, rows = n[1] * n[2];
  size_t x = 0, y = 0, z = 0;
#pragma omp parallel for schedule(static) reduction(+ : x, y, z)
  for (size_t row = 0; row < rows; row++) {
    const size_t j = row % n[1], k = row / n[1];
    const uint8_t *own = lattice->kind + row * n[0];
    x += count_differences(own, own + 1, n[0] - 1) + (own[0] != own[n[0] - 1]);
    y += count_differences(own, lattice->kind + (k * n[1] + (j + 1) % n[1]) * n[0], n[0]);
    z += count_differences(own, lattice->kind + ((k + 1) % n[2] * n[1] + j) * n[0], n[0]);
  }
  faces[0] = x, faces[1] = y, faces[2] = z;
}
