#include "ct2model/surface/wall_distance.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/scan/crossing.h"
#include "ct2model/surface/grey_window.h"
#include "ct2model/resample/resample.h"
#include "ct2model/surface/specks.h"
#include "ct2model/surface/surfels.h"

enum {
  BAND_LAYERS = 4, /* width of the band with exact distances, in model voxels */
  MARGIN = 6,      /* slices on either side of new ones that are searched for islands */
  AREA_BATCH = 8,
  STEP_LEAST = 8 /* fewest new slices at a time */
};
/* Voxels held at a time; a third of it if the scan itself is in memory. */
static const double WINDOW_VOXELS = 24e6;

/* The surface between slices first and first + surfels.size[2] - 1. */
struct piece {
  long first;
  struct surfels surfels;
};

struct walk {
  const struct region *region;
  const struct wall_request *request;
  double factor[3], stretch[3], unit; /* unit: m per stretched voxel */
  double band;                        /* stretched voxels */
  struct grey_window window;
  struct resampler area;
  struct piece *pieces; /* pieces of surface within the band of the next layer, by z */
  size_t piece_count;
  size_t signed_layers, measured_layers;
  uint64_t crossings[3];
};

/* Position of the upper mirror plane, the middle of the last layer, in slices. */
static double mirror_plane(const struct walk *walk) {
  return ((double)walk->request->size[2] - 0.5) * walk->factor[2];
}

static double layer_centre(const struct walk *walk, size_t layer) {
  return ((double)layer + 0.5) * walk->factor[2];
}

/* The piece, and its block, that holds the disc nearest to the previous point. */
struct nearest {
  size_t piece, block;
};

static double largest(const struct surfel_points *points) {
  double most = 0.0;
  for (size_t p = 0; p < SURFELS_POINTS; p++)
    most = points->distance[p] > most ? points->distance[p] : most;
  return most;
}

/* Reduces the distances of the points by those to piece i. Here and below all points lie in one
 * layer. */
static void piece_distances(const struct walk *walk, struct surfel_points *points, size_t i,
                            size_t *block) {
  const struct piece *piece = &walk->pieces[i];
  struct surfel_points local = *points;
  for (size_t p = 0; p < SURFELS_POINTS; p++)
    local.at[2][p] = points->at[2][p] - (double)piece->first * walk->stretch[2];
  double low = 0.5 * walk->stretch[2];
  double high = ((double)piece->surfels.size[2] - 0.5) * walk->stretch[2];
  double gap = fmax(0.0, fmax(low - local.at[2][0], local.at[2][0] - high));
  if (!(gap < largest(points) + 1.0)) return;
  surfels_distances(&piece->surfels, &local, block);
  memcpy(points->distance, local.distance, sizeof points->distance);
}

static void pieces_distances(const struct walk *walk, struct surfel_points *points,
                             struct nearest *near) {
  const struct nearest last = *near;
  if (last.piece < walk->piece_count) piece_distances(walk, points, last.piece, &near->block);
  for (size_t i = 0; i < walk->piece_count; i++) {
    size_t block = SURFELS_NOWHERE;
    if (i == last.piece) continue;
    piece_distances(walk, points, i, &block);
    if (block != SURFELS_NOWHERE) *near = (struct nearest){i, block};
  }
}

/* Distances of points (stretched voxels of the region) to the surface. */
static void wall_distances(const struct walk *walk, struct surfel_points *points,
                           struct nearest *near) {
  pieces_distances(walk, points, near);
  if (!walk->request->mirror) return;
  /* Images by reflection about z = 0 and about the middle of the last layer. */
  const double plane = mirror_plane(walk) * walk->stretch[2], z = points->at[2][0];
  for (int i = 0; i < 2; i++) {
    double away = i == 0 ? z : plane - z;
    if (away > largest(points) + 1.0) continue;
    struct surfel_points image = *points;
    struct nearest beyond = {SURFELS_NOWHERE, SURFELS_NOWHERE};
    for (size_t p = 0; p < SURFELS_POINTS; p++) image.at[2][p] = i == 0 ? -z : 2.0 * plane - z;
    pieces_distances(walk, &image, &beyond);
    for (size_t p = 0; p < SURFELS_POINTS; p++)
      if (!(away > points->distance[p] + 1.0)) points->distance[p] = image.distance[p];
  }
}

static void centre_of(const struct walk *walk, size_t row, size_t x, double point[3]) {
  const size_t *size = walk->request->size;
  const size_t at[3] = {x, row % size[1], row / size[1]};
  for (int d = 0; d < 3; d++) point[d] = ((double)at[d] + 0.5) * walk->factor[d];
}

/* Phases of the voxel centres of one layer, whose slices are in the window: -1 grain, 1 pore. */
static void sign_layer(const struct walk *walk, size_t layer, float *distance) {
  const size_t *size = walk->request->size;
#pragma omp parallel for schedule(static)
  for (size_t row = layer * size[1]; row < (layer + 1) * size[1]; row++) {
    for (size_t x = 0; x < size[0]; x++) {
      double point[3];
      centre_of(walk, row, x, point);
      distance[row * size[0] + x] = grey_window_in_grain(&walk->window, point) ? -1.0f : 1.0f;
    }
  }
}

static void measure_layer(const struct walk *walk, size_t layer, float *distance) {
  const size_t *size = walk->request->size;
  const size_t strips = (size[1] + SURFELS_SIDE - 1) / SURFELS_SIDE;
  const double step = walk->factor[0] * walk->stretch[0], band = walk->band;
#pragma omp parallel for schedule(dynamic)
  for (size_t strip = 0; strip < strips; strip++) {
    double last[SURFELS_SIDE] = {band, band, band, band};
    struct nearest near = {SURFELS_NOWHERE, SURFELS_NOWHERE};
    for (size_t at[3] = {0, strip * SURFELS_SIDE, layer}; at[0] < size[0]; at[0] += SURFELS_SIDE) {
      struct surfel_points points;
      surfel_points_place(at, size, walk->factor, walk->stretch, band, &points);
      wall_distances(walk, &points, &near);
      surfel_points_bound(step, band, last, &points);
      for (size_t p = 0; p < SURFELS_POINTS; p++) {
        const size_t x = at[0] + p % SURFELS_SIDE, y = at[1] + p / SURFELS_SIDE;
        if (x >= size[0] || y >= size[1]) continue;
        float *value = &distance[(layer * size[1] + y) * size[0] + x];
        *value = points.distance[p] < band ? *value * (float)(points.distance[p] * walk->unit)
                                           : INFINITY;
      }
    }
  }
}

/* Adds the surface between slices `from` and `to`, up to the mirror plane, beyond which its image
 * takes over. */
static enum status add_piece(struct walk *walk, long from, long to) {
  enum status status = STATUS_OK;
  if (walk->request->mirror) {
    long last = (long)ceil(mirror_plane(walk) + 0.5) - 1;
    if (to > last) to = last;
  }
  if (to <= from) return STATUS_OK;
  TRY(memory_resize(&walk->pieces, walk->piece_count + 1, sizeof *walk->pieces, "the surface"));
  struct piece *piece = &walk->pieces[walk->piece_count];
  size_t plane = walk->region->size[0] * walk->region->size[1];
  const size_t size[3] = {walk->region->size[0], walk->region->size[1], (size_t)(to - from) + 1};
  piece->first = from;
  const size_t deep = (size_t)(from - walk->window.first);
  TRY(surfels_build(walk->window.field + deep * plane,
                    walk->window.bits + deep * size[1] * walk->window.words, size, walk->stretch,
                    &piece->surfels));
  walk->piece_count++;
cleanup:
  return status;
}

static void drop_pieces(struct walk *walk) {
  double needed = layer_centre(walk, walk->measured_layers) - walk->band / walk->stretch[2] - 2.0;
  size_t kept = 0;
  for (size_t i = 0; i < walk->piece_count; i++) {
    struct piece *piece = &walk->pieces[i];
    if ((double)(piece->first + (long)piece->surfels.size[2]) < needed)
      surfels_end(&piece->surfels);
    else
      walk->pieces[kept++] = *piece;
  }
  walk->piece_count = kept;
}

/* Processes all that the slices up to `end` allow; those up to `done` have been processed. */
static enum status advance(struct walk *walk, long done, long end, struct wall_result *result) {
  enum status status = STATUS_OK;
  const size_t layers = walk->request->size[2];
  bool last = end == walk->window.high - 1;
  long n = (long)walk->region->size[2], z0 = done < 0 ? 0 : done, z1 = last || end > n ? n : end;
  TRY(grey_window_move(&walk->window, done - MARGIN, end + MARGIN));
  if (z1 > z0) grey_window_crossings(&walk->window, (size_t)z0, (size_t)z1, walk->crossings);
  if (!walk->request->distances) goto cleanup;
  if (z1 > z0)
    TRY(grey_window_fractions(&walk->window, (size_t)z0, (size_t)z1, &walk->area,
                              result->grain_fraction));
  TRY(add_piece(walk, done, end));
  long held = walk->window.first + (long)walk->window.depth;
  for (; walk->signed_layers < layers; walk->signed_layers++) {
    if (layer_centre(walk, walk->signed_layers) + 0.5 > (double)held && !last) break;
    sign_layer(walk, walk->signed_layers, result->distance);
  }
  for (; walk->measured_layers < layers; walk->measured_layers++) {
    double reach = layer_centre(walk, walk->measured_layers) + walk->band / walk->stretch[2];
    if (reach > (double)end && !last) break;
    measure_layer(walk, walk->measured_layers, result->distance);
  }
  drop_pieces(walk);
cleanup:
  return status;
}

static enum status walk_start(const struct region *region, const struct wall_request *request,
                              struct walk *walk) {
  enum status status = STATUS_OK;
  double spacing = 0.0, reduction = 1.0;
  *walk = (struct walk){.region = region, .request = request};
  walk->unit = fmin(region->voxel[0], fmin(region->voxel[1], region->voxel[2]));
  for (int d = 0; d < 3; d++) {
    walk->factor[d] = (double)region->size[d] / (double)request->size[d];
    walk->stretch[d] = region->voxel[d] / walk->unit;
    spacing = fmax(spacing, walk->factor[d] * walk->stretch[d]);
    reduction *= walk->factor[d];
  }
  walk->band = fmax(BAND_LAYERS * spacing, 8.0) + 1.0;
  long halo = (long)ceil(walk->band / walk->stretch[2]) + 2, n = (long)region->size[2];
  double room = WINDOW_VOXELS / ((double)region->size[0] * (double)region->size[1]);
  if (region->held != NULL) room /= 3.0;
  room = fmin(fmax(room, STEP_LEAST + 2 * MARGIN + 1), (double)(n + 2 * halo));
  /* Islands far smaller than a model voxel are noise for the model and would falsify the distances
   * around them. */
  TRY(grey_window_start(region, request->threshold, request->contrast, request->mirror,
                        (size_t)fmin(SPECK_MOST, reduction / 8.0), request->mirror ? -1 : -halo,
                        request->mirror ? n + 1 : n + halo, (size_t)room, &walk->window));
  if (request->distances)
    TRY(resampler_start(FILTER_AREA, region->size, request->size, AREA_BATCH, &walk->area));
cleanup:
  return status;
}

static void walk_end(struct walk *walk) {
  for (size_t i = 0; i < walk->piece_count; i++) surfels_end(&walk->pieces[i].surfels);
  memory_free(&walk->pieces);
  resampler_end(&walk->area);
  grey_window_end(&walk->window);
}

enum status wall_measure(const struct region *region, const struct wall_request *request,
                         struct wall_result *result) {
  enum status status = STATUS_OK;
  struct walk walk = {0};
  struct progress progress;
  size_t sites = request->distances ? request->size[0] * request->size[1] * request->size[2] : 0;
  const double *voxel = region->voxel;
  memset(result, 0, sizeof *result);
  TRY(memory_allocate(&result->distance, sites, sizeof *result->distance, "wall distances"));
  TRY(memory_allocate(&result->grain_fraction, sites, sizeof *result->grain_fraction,
                      "grain fractions"));
  TRY(walk_start(region, request, &walk));
  long step = (long)walk.window.room - 2 * MARGIN - 1, last = walk.window.high - 1;
  if (step < 1) step = 1;
  if (request->distances)
    progress_start(&progress, "surface", "slices", (double)(walk.window.high - walk.window.low));
  for (long done = walk.window.low; done < last; done += step) {
    long end = done + step < last ? done + step : last;
    TRY(advance(&walk, done, end, result));
    if (request->distances) progress_update(&progress, (double)(end + 1 - walk.window.low), NULL);
  }
  if (request->distances) progress_end(&progress);
  result->specks = walk.window.specks;
  /* Sums of shares have rounding errors. */
  for (size_t i = 0; request->distances && i < sites; i++)
    result->grain_fraction[i] = fminf(fmaxf(result->grain_fraction[i], 0.0f), 1.0f);
  for (int d = 0; d < 3; d++)
    result->surface_area +=
        0.5 * (double)walk.crossings[d] / CROSSING_UNIT * voxel[(d + 1) % 3] * voxel[(d + 2) % 3];
cleanup:
  walk_end(&walk);
  if (status != STATUS_OK) wall_result_end(result);
  return status;
}

void wall_result_end(struct wall_result *result) {
  MEMORY_FREE(&result->distance, &result->grain_fraction);
}
