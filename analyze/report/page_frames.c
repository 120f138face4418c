/* Water and soil at up to six times: a grid of cells in the vertical plane x, z through the middle
 * of the domain, filled by the points of snapshots. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"
#include "common/snapshot_file.h"
#include "common/statistics.h"
#include "common/units.h"

enum { FRAMES = 6, SIDE = 240 /* largest number of cells along an axis */ };
/* What is in a cell. */
enum { NOTHING = 0, WATER = 1, WET_SOIL = 2, WALL = 3 };

struct grid {
  const struct run *run;
  size_t size[2]; /* x, z */
  double cell[2]; /* m */
  float *value, *count;
  uint8_t *kind;
  double *all; /* values of all frames so far, for the colour scale */
  size_t all_count;
};

static void choose_grid(const struct run *run, struct grid *grid) {
  const size_t most = run->size[0] > run->size[2] ? run->size[0] : run->size[2];
  const size_t every = (most + SIDE - 1) / SIDE;
  grid->run = run;
  for (int k = 0; k < 2; k++) {
    const int d = 2 * k;
    grid->size[k] = (run->size[d] + every - 1) / every;
    grid->cell[k] = run->spacing[d] * (double)every;
  }
}

static size_t clamp_index(double at, size_t size) {
  return (size_t)fmin(fmax(floor(at), 0.0), (double)size - 1.0);
}

static size_t cell_of(const struct grid *grid, const double point[3]) {
  const struct run *run = grid->run;
  const size_t i = clamp_index((point[0] - run->origin[0]) / grid->cell[0] + 0.5, grid->size[0]);
  const size_t k = clamp_index((point[2] - run->origin[2]) / grid->cell[1] + 0.5, grid->size[1]);
  return k * grid->size[0] + i;
}

/* Particles drift apart by up to a spacing, and those of soil are wider than a cell: a cell between
 * two filled ones is filled too. */
static void fill_holes(const struct grid *grid) {
  const size_t nx = grid->size[0], nz = grid->size[1];
  for (size_t k = 0; k < nz; k++)
    for (size_t i = 0; i < nx; i++) {
      const size_t c = k * nx + i;
      const size_t pairs[2][2] = {{c - 1, c + 1}, {c - nx, c + nx}};
      const bool inside[2] = {i > 0 && i + 1 < nx, k > 0 && k + 1 < nz};
      for (int p = 0; p < 2 && grid->kind[c] == NOTHING; p++) {
        if (!inside[p] || !(grid->count[pairs[p][0]] > 0) || !(grid->count[pairs[p][1]] > 0))
          continue;
        grid->kind[c] = grid->kind[pairs[p][0]];
        grid->value[c] = 0.5f * (grid->value[pairs[p][0]] + grid->value[pairs[p][1]]);
      }
    }
  for (size_t c = 0; c < nx * nz; c++)
    if (grid->kind[c] != NOTHING) grid->count[c] = 1.0f;
}

/* Walls as the run began, where there is nothing else. */
static void add_walls(const struct grid *grid) {
  const struct run *run = grid->run;
  const size_t y = run->size[1] / 2;
  if (run->solid == NULL) return;
  for (size_t z = 0; z < run->size[2]; z++)
    for (size_t x = 0; x < run->size[0]; x++) {
      const size_t i = x * grid->size[0] / run->size[0], k = z * grid->size[1] / run->size[2];
      const size_t c = k * grid->size[0] + i;
      if (run->solid[(z * run->size[1] + y) * run->size[0] + x] != 0 && grid->kind[c] == NOTHING)
        grid->kind[c] = WALL;
    }
}

static enum status read_frame(struct grid *grid, struct snapshot *snapshot, bool unsaturated) {
  enum status status = STATUS_OK;
  const struct run *run = grid->run;
  const size_t cells = grid->size[0] * grid->size[1];
  double *values = NULL, *porosity = NULL;
  const double middle = run->origin[1] + 0.5 * (double)(run->size[1] - 1) * run->spacing[1];
  memset(grid->value, 0, cells * sizeof *grid->value);
  memset(grid->count, 0, cells * sizeof *grid->count);
  memset(grid->kind, NOTHING, cells);
  TRY(snapshot_read(snapshot, unsaturated ? "saturation" : "pressure", 1, &values));
  if (!unsaturated) TRY(snapshot_read(snapshot, "porosity", 1, &porosity));
  for (size_t i = 0; i < snapshot->count; i++) {
    const double *point = &snapshot->points[3 * i];
    if (run->size[1] > 1 && fabs(point[1] - middle) > run->spacing[1]) continue;
    const size_t c = cell_of(grid, point);
    const bool soil = porosity == NULL || porosity[i] < 0.999;
    grid->value[c] += (float)values[i];
    grid->count[c] += 1.0f;
    grid->kind[c] = soil ? WET_SOIL : WATER;
  }
  for (size_t c = 0; c < cells; c++) {
    if (!(grid->count[c] > 0)) continue;
    grid->value[c] /= grid->count[c];
    grid->all[grid->all_count++] = (double)grid->value[c];
  }
  for (int pass = 0; pass < 2; pass++) fill_holes(grid);
  for (size_t c = 0; c < cells; c++)
    if (grid->kind[c] == NOTHING) grid->value[c] = NAN;
  add_walls(grid);
cleanup:
  memory_free(&values);
  memory_free(&porosity);
  return status;
}

static enum status open_snapshot(const struct run *run, size_t shot, struct snapshot *snapshot) {
  char path[8192];
  if (snprintf(path, sizeof path, "%s%s", run->folder, run->snapshot_names[shot]) >=
      (int)sizeof path)
    return FAIL(STATUS_INPUT, "%s: the name of a snapshot is too long", run->path);
  return snapshot_open(path, snapshot);
}

static enum status add_frame(struct grid *grid, size_t shot, bool unsaturated, float *kept,
                             json_t *picture) {
  enum status status = STATUS_OK;
  struct snapshot snapshot = {0};
  const size_t cells = grid->size[0] * grid->size[1];
  TRY(open_snapshot(grid->run, shot, &snapshot));
  TRY(read_frame(grid, &snapshot, unsaturated));
  memcpy(kept, grid->value, cells * sizeof *kept);
  json_array_append_new(json_object_get(picture, "kinds"), encode_bytes(grid->kind, cells));
  json_array_append_new(json_object_get(picture, "times_s"),
                        json_number(grid->run->snapshot_times[shot]));
cleanup:
  snapshot_close(&snapshot);
  return status;
}

enum status picture_frames(const struct run *run, json_t *pictures) {
  enum status status = STATUS_OK;
  json_t *picture = NULL;
  const bool unsaturated = strcmp(run->method, "richards") == 0;
  const size_t n = run->snapshot_count < FRAMES ? run->snapshot_count : FRAMES;
  struct grid grid = {0};
  float *kept = NULL;
  if (n == 0 ||
      (!unsaturated && strcmp(run->method, "isph") != 0 && strcmp(run->method, "darcy") != 0))
    return STATUS_OK;
  choose_grid(run, &grid);
  const size_t cells = grid.size[0] * grid.size[1];
  TRY(memory_allocate(&grid.value, cells, sizeof *grid.value, "a picture"));
  TRY(memory_allocate(&grid.count, cells, sizeof *grid.count, "a picture"));
  TRY(memory_allocate(&grid.kind, cells, 1, "a picture"));
  TRY(memory_allocate(&grid.all, n * cells, sizeof *grid.all, "a picture"));
  TRY(memory_allocate(&kept, n * cells, sizeof *kept, "a picture"));
  picture = json_pack("{s:s,s:[I,I],s:o,s:o,s:[],s:[],s:[]}", "value",
                      unsaturated ? "saturation" : "pressure", "size", (json_int_t)grid.size[0],
                      (json_int_t)grid.size[1], "cell_m", json_numbers(grid.cell, 2), "origin_m",
                      json_numbers((double[2]){run->origin[0], run->origin[2]}, 2), "times_s",
                      "kinds", "values");
  for (size_t i = 0; i < n; i++) {
    const size_t shot = n == 1 ? 0 : i * (run->snapshot_count - 1) / (n - 1);
    TRY(add_frame(&grid, shot, unsaturated, kept + i * cells, picture));
  }
  /* The scale of pressure shows no less than what a spacing of water weighs. */
  double high = 1.0;
  if (!unsaturated && grid.all_count > 0) TRY(quantile_find(grid.all, grid.all_count, 0.99, &high));
  if (!unsaturated) high = fmax(high, run->density * GRAVITY_STANDARD * run->spacing[2]);
  for (size_t i = 0; i < n; i++)
    json_array_append_new(json_object_get(picture, "values"),
                          encode_field(kept + i * cells, cells, 0.0, high));
  json_object_set(pictures, "frames", picture);
cleanup:
  json_decref(picture);
  memory_free(&grid.value);
  memory_free(&grid.count);
  memory_free(&grid.kind);
  memory_free(&grid.all);
  memory_free(&kept);
  return status;
}
