/* Slices of the scan at its own voxels, the greys of an image of few, and the edge response; curves
 * and the wall at any threshold are made of them in the page (survey_page.js). */
#include "ct2model/survey_page.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/json_number.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/page_encode.h"
#include "common/provenance.h"
#include "ct2model/report.h"

#define ASSETS                                                                                     \
  ASSET(page, "survey_page.html")                                                                  \
  ASSET(style, "page.css")                                                                         \
  ASSET(charts, "page_charts.js")                                                                  \
  ASSET(maps, "page_maps.js")                                                                      \
  ASSET(scan, "page_scan.js")                                                                      \
  ASSET(script, "survey_page.js")                                                                  \
  ASSET(dygraph, "dygraph.min.js")                                                                 \
  ASSET(dygraph_style, "dygraph.min.css")
#include "common/page_assets.h"

enum { SLICES = 5, SIDE = 400 /* most voxels a side */, LABELS = 12 /* most greys of labels */ };

/* A part of a slice as {"low", "high", "bytes"}, from voxel `from` on, each `every`-th one. */
static json_t *encode_part(const struct pipeline *pipeline, const float *slice,
                           const size_t from[2], const size_t size[2], size_t every, float *part) {
  const struct sweep_table *table = &pipeline->table;
  for (size_t y = 0; y < size[1]; y++)
    for (size_t x = 0; x < size[0]; x++) {
      const size_t row = from[1] + every * y;
      const float grey = slice[row * pipeline->region.size[0] + from[0] + every * x];
      part[y * size[0] + x] = (float)pipeline_grey(pipeline, (double)grey);
    }
  return encode_field(part, size[0] * size[1], table->threshold[0],
                      table->threshold[table->count - 1]);
}

/* "slices": the middle of some slices, voxel by voxel. "whole": the middle one in all its width, if
 * that is more than the others show. */
static enum status add_slices(const struct pipeline *pipeline, json_t *pictures) {
  enum status status = STATUS_OK;
  const struct region *region = &pipeline->region;
  const size_t *n = region->size, pixels = n[0] * n[1], corner[2] = {0, 0};
  const size_t count = n[2] < SLICES ? n[2] : SLICES, most = n[0] > n[1] ? n[0] : n[1];
  const size_t every = (most + SIDE - 1) / SIDE;
  size_t from[2], size[2], whole[2];
  float *slice = NULL, *part = NULL;
  for (int d = 0; d < 2; d++) {
    size[d] = n[d] < SIDE ? n[d] : SIDE;
    from[d] = (n[d] - size[d]) / 2;
    whole[d] = n[d] / every;
  }
  TRY(memory_allocate(&slice, pixels, sizeof *slice, "a slice"));
  TRY(memory_allocate(&part, (size_t)SIDE * SIDE, sizeof *part, "a slice"));
  json_t *numbers = json_array(), *greys = json_array();
  json_object_set_new(pictures, "slices",
                      json_pack("{s:[I,I],s:[I,I],s:o,s:o}", "size", (json_int_t)size[0],
                                (json_int_t)size[1], "from", (json_int_t)from[0],
                                (json_int_t)from[1], "number", numbers, "grey", greys));
  for (size_t i = 0; i < count; i++) {
    const size_t z = (2 * i + 1) * n[2] / (2 * count);
    TRY(region_read(region, &z, 1, slice));
    json_array_append_new(numbers, json_integer((json_int_t)(region->origin[2] + z + 1)));
    json_array_append_new(greys, encode_part(pipeline, slice, from, size, 1, part));
  }
  if (every > 1)
    json_object_set_new(
        pictures, "whole",
        json_pack("{s:[I,I],s:I,s:o}", "size", (json_int_t)whole[0], (json_int_t)whole[1], "every",
                  (json_int_t)every, "grey",
                  encode_part(pipeline, pipeline->middle, corner, whole, every, part)));
cleanup:
  MEMORY_FREE(&slice, &part);
  return status;
}

/* "labels": the greys of an image that holds few, and how much of it each fills. */
static void add_labels(const struct pipeline *pipeline, json_t *data) {
  const struct grey_histogram *histogram = &pipeline->histogram;
  json_t *labels = json_array();
  for (size_t i = 0; i < histogram->bins && json_array_size(labels) <= LABELS; i++) {
    const double grey = histogram->low + histogram->width * ((double)i + 0.5);
    if (histogram->counts[i] > 0)
      json_array_append_new(
          labels, json_pack("{s:f,s:f}", "label", pipeline_grey(pipeline, grey), "fraction",
                            (double)histogram->counts[i] / (double)histogram->total));
  }
  if (json_array_size(labels) <= LABELS)
    json_object_set_new(data, "labels", labels);
  else
    json_decref(labels);
}

static void add_edge(const struct scanner *scanner, json_t *data) {
  double distance[EDGE_BINS], response[EDGE_BINS];
  if (!scanner->known) return;
  for (size_t i = 0; i < EDGE_BINS; i++) {
    distance[i] = edge_bin_distance(i) * scanner->unit;
    response[i] = scanner->response.sum[i] / scanner->response.count[i];
  }
  json_object_set_new(data, "edge",
                      json_pack("{s:o,s:o}", "distance_m", json_numbers(distance, EDGE_BINS),
                                "response", json_numbers(response, EDGE_BINS)));
}

enum status survey_page_write(const struct pipeline *pipeline, const struct options *options) {
  enum status status = STATUS_OK;
  const struct asset assets[] = {ASSETS};
  json_t *data = report_json(pipeline, options), *pictures = json_object(), *inputs = json_array();
  json_object_set_new(data, "pictures", pictures);
  json_object_set_new(data, "inputs", inputs);
  json_object_set_new(data, "version", json_string(TOSUI_VERSION));
  json_object_set_new(data, "command_line", json_text(options_command_line(options)));
  json_object_set_new(data, "dark_grains", json_boolean(pipeline->request->dark_grains));
  for (size_t i = 0; i < options_operand_count(options); i++)
    json_array_append_new(inputs, json_text(options_operand(options, i)));
  add_labels(pipeline, data);
  if (!pipeline->unsized) add_edge(&pipeline->scanner, data);
  TRY(add_slices(pipeline, pictures));
  TRY(page_write(pipeline->request->output, assets, sizeof assets / sizeof *assets, data));
cleanup:
  json_decref(data);
  return status;
}
