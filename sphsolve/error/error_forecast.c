#include "sphsolve/error/error_forecast.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/error/scan_error.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/geometry/throat_width.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/constants.h"

/* Largest number of edges per face, times the mean pore width, of straight walls: bars across the
 * flow have 1 or more, a duct has none. */
#define EDGES_PER_FACE_MAX 0.5

/* Whether a wall site has fluid neighbours along more than one axis. */
static bool is_edge(const struct lattice *l, const size_t step[3], size_t site) {
  int axes = 0;
  for (int a = 0; a < 3; a++) {
    // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): a lattice has sites along every axis
    const size_t at = site / step[a] % l->size[a], round = (l->size[a] - 1) * step[a];
    const size_t next = at + 1 == l->size[a] ? site - round : site + step[a];
    const size_t last = at == 0 ? site + round : site - step[a];
    axes += l->kind[next] == SITE_FLUID || l->kind[last] == SITE_FLUID;
  }
  return axes > 1;
}

/* Sums over the faces between sites of two kinds. */
struct face_sums {
  double count, half, surface, outer, middle;
};

/* Between neighbouring sites the distance changes by the component n_a of the normal, and a unit of
 * surface has n_a such faces: d + depth is the surface area that belongs to this face. */
static void add_face(const struct lattice *l, double unit, size_t site, size_t next,
                     struct face_sums *sums) {
  const size_t fluid = l->kind[site] == SITE_FLUID ? site : next, wall = site + next - fluid;
  const double d = (double)l->wall_distance[fluid] / unit;
  const double depth = -(double)l->wall_distance[wall] / unit;
  sums->count += 1.0;
  sums->half += fabs(d - 0.5) < 1e-3;
  sums->surface += d + depth;
  sums->outer += (d + depth) * depth;
  sums->middle += (d + depth) * 0.5 * (depth - d);
}

/* Adds the faces between `count` sites from `site` on and those from `next` on. Few kinds differ,
 * so eight are compared at once. */
static void add_faces(const struct lattice *l, double unit, size_t site, size_t next, size_t count,
                      struct face_sums *sums) {
  const uint8_t *own = l->kind + site, *other = l->kind + next;
  for (size_t i = 0; i < count; i++) {
    if (i + 8 <= count && memcmp(own + i, other + i, 8) == 0)
      i += 7;
    else if (own[i] != other[i])
      add_face(l, unit, site + i, next + i, sums);
  }
}

/* From the kinds, distances and faces of the lattice. */
static void pore_shape_find(const struct scene *scene, const struct lattice *l,
                            struct pore_shape *shape) {
  const size_t *n = l->size, step[3] = {1, n[0], n[0] * n[1]}, rows = n[1] * n[2];
  const double unit =
      l->dimensions == 2 ? l->spacing[0] : cbrt(l->spacing[0] * l->spacing[1] * l->spacing[2]);
  struct face_sums sums = {0};
  double before = 0.0, behind = 0.0, edges = 0.0;
  int axes = 0;
  bool across = false;
  *shape = (struct pore_shape){
      .width = INFINITY, .open = INFINITY, .throat = INFINITY, .grain = INFINITY};
  if (l->wall_count == 0) return;
  for (int a = 0; a < 3; a++) {
    const double counted = sums.count;
    for (size_t row = 0; row < rows; row++) {
      const size_t site = row * n[0], round = (n[a] - 1) * step[a];
      const bool last = a == 0 || (a == 1 ? row % n[1] : row / n[1]) + 1 == n[a];
      if (a == 0) add_faces(l, unit, site, site + 1, n[0] - 1, &sums);
      if (a == 0 && l->kind[site + round] != l->kind[site])
        add_face(l, unit, site + round, site, &sums);
      if (a > 0) add_faces(l, unit, site, last ? site - round : site + step[a], n[0], &sums);
    }
    axes += sums.count > counted;
    across = across || (sums.count > counted && scene->driving[a] != 0.0);
  }
  const double faces = sums.count, surface = sums.surface;
  if (!(surface > 0.0)) return;
  const double fluid = (double)l->fluid_count;
  const bool boxes = !*scene->model_path;
  /* -d ln S per spacing: for grains between that of spheres (2/3) and cylinders (1/2); for pores
   * along the force that of a tube; for boxes from the number of sites on both sides of the
   * walls. */
  double shrinks = across ? 0.6 * surface / (l->bulk_count - fluid) : -0.5 * surface / fluid;
  const bool sharp = boxes || sums.half > 0.9 * faces;
  for (size_t site = 0; site < l->count && sharp; site++) {
    const double d = (double)l->wall_distance[site] / unit;
    before += l->kind[site] == SITE_FLUID && d < 1.0;
    behind += l->kind[site] == SITE_WALL && d > -1.0;
    edges += l->kind[site] == SITE_WALL && is_edge(l, step, site);
  }
  shape->straight = sharp && edges / faces * 4.0 * fluid / surface < EDGES_PER_FACE_MAX;
  if (shape->straight) shrinks = log(before / behind);
  shape->width = shape->open = 4.0 * fluid / surface;
  if (l->micro_porosity != NULL) {
    double soil = 0.0;
    for (size_t site = 0; site < l->count; site++) soil += lattice_is_soil(l, site);
    shape->open = 4.0 * (fluid - soil) / surface;
  }
  if (!boxes) shape->grain = 2.0 * (l->bulk_count - fluid) / surface;
  int main_axis = 0;
  for (int a = 1; a < 3; a++)
    if (fabs(scene->driving[a]) > fabs(scene->driving[main_axis])) main_axis = a;
  shape->dimensions = l->dimensions;
  shape->ways = fluid / (double)n[main_axis] / pow(shape->width, l->dimensions - 1);
  shape->slope = fmax(3.0 * surface / fluid + 2.0 * shrinks, surface / fluid);
  shape->outer = sums.outer / surface;
  shape->middle = sums.middle / surface;
  shape->sharp = sharp;
  shape->flat = sharp && axes == 1;
}

/* Part of the narrowest way, of `width` spacings, as computed from a solution by
 * error/cascade_add.c, with the number of independent ways and the curvature of the walls
 * of a mean pore and grain: spheres of radius R have 2 V / S = 2/3 R. */
static double narrow_ways(const struct pore_shape *shape, double refined) {
  const double width = shape->throat * refined, radius = 1.5 * shape->grain * refined;
  if (!isfinite(width) || shape->flat) return 0.0;
  const double unknown =
      shape->sharp ? 1.0 : fmin(1.0, fmax(CRITICAL_WIDTH_SMOOTH / width, 1.0 / radius));
  return fmin(1.0, unknown * 0.5 * shape->dimensions / (width * sqrt(fmax(1.0, shape->ways))));
}

/* In terms of q, the slope of ln k per spacing; errors of sands differ by a factor of 2 at the same
 * q (make tradeoff). */
struct error_forecast error_forecast_of(const struct pore_shape *shape, const struct method *method,
                                        enum wall_scheme wall, double refined) {
  struct error_forecast e = {NAN, NAN, NAN, "no walls"};
  const double width = shape->open * refined;
  const double q = shape->slope / refined * (shape->width / shape->open);
  const char *how = "walls from the wall distance";
  double more = 0.0, less = 0.0, both;
  if (!(q > 0.0)) return e;
  /* Error common to all wall schemes: narrow pores. */
  if (shape->flat && wall == WALL_SUBVOXEL) {
    more = method->error_flat;
    how = method->error_flat_why;
  } else if (shape->straight) {
    if (wall == WALL_SUBVOXEL) less = ERROR_CORNERS * q * q * q;
    how = "straight walls and corners";
  } else if (shape->sharp) {
    more = ERROR_EDGES / width;
    how = "walls are voxel faces, full of edges: first order";
  } else {
    more = method->error_narrow * pow(q, method->error_narrow_order);
    less = ERROR_ANGLE * q + method->error_uneven * q * q;
  }
  if (wall == WALL_FROZEN) {
    /* Change of k of a slit: (1 + shift / half width)^3. */
    const double shift = shape->outer * (shape->sharp ? 1.0 : ERROR_FROZEN_SHARE);
    more = (1.0 + more) * pow(1.0 + q * shift / 3.0, 3.0) - 1.0;
    how = "frozen walls stand back";
  } else if (wall == WALL_ADAMI) {
    more = (1.0 + more) * (1.0 + ERROR_ADAMI_SECOND * q * q + fmax(0.0, q * shape->middle)) - 1.0;
    less += fmax(0.0, -q * shape->middle) + (shape->sharp ? 0.0 : ERROR_ADAMI_PLACE * q);
    how = "adami walls: half-way between points";
  }
  const double ways = narrow_ways(shape, refined);
  both = fmin(more, less);
  e.pores = hypot(more, less);
  e.error = fmax(e.pores, ways);
  const bool exact = shape->flat && wall == WALL_SUBVOXEL;
  e.least = !exact && fmax(more, less) > 4.0 * both ? fabs(more - less) : 0.0;
  int length = snprintf(e.why, sizeof e.why, "mean pore 4 V/S = %.2g points; %s%s", width, how,
                        exact || e.least > 0.0 ? "" : "; of parts with unlike signs");
  if (ways == e.error && ways > 0.0)
    snprintf(e.why + length, sizeof e.why - (size_t)length, "; the narrowest way has %.2g points",
             shape->throat * refined);
  return e;
}

/* Error of k by the void ratio and by the threshold, where d ln k/d e is `slope`. */
static double threshold_error(const struct model_facts *model, double slope) {
  const double by_void_ratio = slope * model->void_ratio_error;
  const double by_threshold = slope / model->threshold_slope * model->threshold_uncertainty;
  return hypot(isfinite(by_void_ratio) ? by_void_ratio : 0.0,
               isfinite(by_threshold) ? by_threshold : 0.0);
}

double error_expected_rest(const struct plan *plan) {
  return hypot(isfinite(plan->expected_scan) ? plan->expected_scan : 0.0, plan->expected_threshold);
}

enum status error_expect(struct plan *plan) {
  enum status status = STATUS_OK;
  const struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  const struct lattice *lattice = context->lattice;
  pore_shape_find(scene, lattice, &plan->shape);
  if (context->driving > 0.0 && (*scene->model_path || lattice->boxes != NULL)) {
    TRY(throat_width_find(lattice, scene->driving, &plan->shape.throat));
    plan->shape.throat /= context->spacing;
  }
  const struct scan_quality *scan = &lattice->model.scan;
  /* Soil narrows the pores, but the blur does not move its surface: the geometric mean of both
   * widths. */
  const double width = sqrt(plan->shape.width * plan->shape.open) * context->spacing;
  const double n = (double)lattice->fluid_count / lattice->bulk_count;
  const double slope = (1.0 - n) * (3.0 / n - 1.0); /* d ln k/d e from Kozeny and Carman */
  if (isfinite(width) && scan->known)
    plan->expected_scan = hypot(scan_error(scan, scan_change_expected(scan, width), width),
                                scan->void_ratio_error * slope);
  if (isfinite(width)) plan->expected_threshold = threshold_error(&lattice->model, slope);
cleanup:
  return status;
}
