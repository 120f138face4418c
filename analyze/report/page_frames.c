/* Water and soil at up to six times, in the vertical plane x, z through the middle of the domain.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analyze/report/page_cells.h"
#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"
#include "common/snapshot_file.h"
#include "common/units.h"

enum { FRAMES = 6, SIDE = 240 /* largest number of cells along an axis */ };
/* What is in a cell. */
enum { NOTHING = 0, WATER = 1, WET_SOIL = 2, WALL = 3 };

/* Particles drift apart by up to a spacing, and those of soil are wider than a cell: a cell between
 * two filled ones is filled too. */
static void fill_holes(const size_t size[2], float *value, uint8_t *kind) {
  const size_t n = size[0] * size[1];
  for (size_t c = 0; c < n; c++) {
    const size_t across = c % size[0], steps[2] = {1, size[0]};
    const bool inside[2] = {across > 0 && across + 1 < size[0], c >= size[0] && c + size[0] < n};
    for (int d = 0; d < 2 && isnan(value[c]); d++) {
      if (!inside[d]) continue;
      value[c] = 0.5f * (value[c - steps[d]] + value[c + steps[d]]); /* NAN if either is */
      if (!isnan(value[c])) kind[c] = kind[c - steps[d]];
    }
  }
}

/* Walls as the run began, where there is nothing else. */
static void add_walls(const struct run *run, const struct plane *plane, uint8_t *kind) {
  for (size_t c = 0; run->solid != NULL && c < plane->size[0] * plane->size[1]; c++)
    if (kind[c] == NOTHING &&
        run->solid[plane_site(run, plane, c % plane->size[0], c / plane->size[0])] != 0)
      kind[c] = WALL;
}

/* Reads the values of one time into value[cells], NAN where there is nothing, and the kinds. */
static enum status read_frame(const struct run *run, const struct plane *plane, size_t shot,
                              const char *field, float *value, json_t *picture) {
  enum status status = STATUS_OK;
  struct snapshot snapshot = {0};
  const size_t cells = plane->size[0] * plane->size[1];
  const double reach = run->size[1] > 1 ? run->spacing[1] : INFINITY;
  const bool unsaturated = strcmp(field, "saturation") == 0;
  char path[8192];
  double *values = NULL, *porosity = NULL;
  size_t *cell = NULL;
  float *mean = NULL, *open = NULL;
  uint8_t *kind = NULL;
  if (snprintf(path, sizeof path, "%s%s", run->folder, run->snapshot_names[shot]) >=
      (int)sizeof path)
    TRY_FAIL(STATUS_INPUT, "%s: the name of a snapshot is too long", run->path);
  TRY(snapshot_open(path, &snapshot));
  TRY(plane_cells(plane, snapshot.points, snapshot.count, reach, &cell));
  TRY(snapshot_read(&snapshot, field, 1, &values));
  TRY(cells_mean(cell, snapshot.count, values, 1, cells, &mean));
  if (!unsaturated) {
    TRY(snapshot_read(&snapshot, "porosity", 1, &porosity));
    TRY(cells_mean(cell, snapshot.count, porosity, 1, cells, &open));
  }
  TRY(memory_allocate(&kind, cells, 1, "a picture"));
  for (size_t c = 0; c < cells; c++)
    if (!isnan(mean[c])) kind[c] = unsaturated || open[c] < 0.999f ? WET_SOIL : WATER;
  for (int pass = 0; pass < 2; pass++) fill_holes(plane->size, mean, kind);
  add_walls(run, plane, kind);
  memcpy(value, mean, cells * sizeof *value);
  json_array_append_new(json_object_get(picture, "kinds"), encode_bytes(kind, cells));
  json_array_append_new(json_object_get(picture, "times_s"),
                        json_number(run->snapshot_times[shot]));
cleanup:
  snapshot_close(&snapshot);
  memory_free(&values);
  memory_free(&porosity);
  memory_free(&cell);
  memory_free(&mean);
  memory_free(&open);
  memory_free(&kind);
  return status;
}

enum status picture_frames(const struct run *run, json_t *pictures) {
  enum status status = STATUS_OK;
  const bool unsaturated = strcmp(run->method, "richards") == 0;
  const char *field = unsaturated ? "saturation" : "pressure";
  const size_t n = run->snapshot_count < FRAMES ? run->snapshot_count : FRAMES;
  const struct plane plane = plane_along(run, 0, 2, SIDE);
  const size_t cells = plane.size[0] * plane.size[1];
  float *values = NULL;
  double high = 1.0;
  json_t *picture = json_pack("{s:s,s:[I,I],s:o,s:o,s:[],s:[],s:[]}", "value", field, "size",
                              (json_int_t)plane.size[0], (json_int_t)plane.size[1], "cell_m",
                              json_numbers(plane.cell, 2), "low_m", json_numbers(plane.low, 2),
                              "times_s", "kinds", "values");
  if (n == 0 ||
      (!unsaturated && strcmp(run->method, "isph") != 0 && strcmp(run->method, "darcy") != 0))
    goto cleanup;
  TRY(memory_allocate(&values, n * cells, sizeof *values, "a picture"));
  for (size_t i = 0; i < n; i++) {
    const size_t shot = n == 1 ? 0 : i * (run->snapshot_count - 1) / (n - 1);
    TRY(read_frame(run, &plane, shot, field, values + i * cells, picture));
  }
  /* The scale of pressure shows no less than what a spacing of water weighs. */
  if (!unsaturated) {
    TRY(cells_high(values, n * cells, &high));
    high = fmax(high, run->density * GRAVITY_STANDARD * run->spacing[2]);
  }
  for (size_t i = 0; i < n; i++)
    json_array_append_new(json_object_get(picture, "values"),
                          encode_field(values + i * cells, cells, 0.0, high));
  json_object_set(pictures, "frames", picture);
cleanup:
  json_decref(picture);
  memory_free(&values);
  return status;
}
