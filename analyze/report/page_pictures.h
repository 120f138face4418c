/* The pictures of the page as JSON, a file each (page_internal.h says what they show). Without
 * something to show *picture stays NULL. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_PICTURES_H
#define TOSUI_ANALYZE_REPORT_PAGE_PICTURES_H

#include <jansson.h>
#include <stdbool.h>

#include "analyze/report/page_model.h"
#include "analyze/run_file.h"
#include "common/model_file.h"

/* "size" [x, y, z] cells of "cell_m"; "grains" four bits a cell; "lines" points of each streamline,
 * "points" 16 bits each of x, y, z in 1/500 cell and speed over "speed_high" (m/s) times 65535;
 * with `paths`, "paths" four bits a cell: the water that carries half of the flow. */
enum status picture_flow(const struct run *run, const struct particles *particles, bool paths,
                         json_t **picture);

/* Fields (encode_field) at "size" points of "spacing_m" in a plane through the middle, across
 * "normal": "distance" to the walls in spacings, "speed" m/s, "direction" two a point, "pressure"
 * Pa about its mean, "soil" 1 in soil with pores below the voxel. */
enum status picture_plane(const struct run *run, const struct particles *particles,
                          const struct voxel_model *model, json_t **picture);

/* The middle slice of the scan: "grey" and, at the same points, "distance" to the model's walls in
 * their "size" pixels; without a scan the model's middle layer. */
enum status picture_slice(const struct page_model *facts, const struct voxel_model *model,
                          json_t **picture);

/* Up to six times of a run whose water moves in space: "times_s", and for each "cells": for a cell
 * of the grid 255 for nothing, else its value; see page_frames.c. */
enum status picture_frames(const struct run *run, json_t **picture);

/* "diameter_m" and "finer", the share of the grains where no larger ball fits: page_grains.c. Stays
 * NULL without walls, or with grains of a voxel or two. */
enum status grain_sizes(const struct voxel_model *model, json_t **sizes);

/* Trilinear value of a field of the model at a position (m, from the model's corner); periodic. */
double picture_model_value(const struct voxel_model *model, const float *field, const double at[3]);

#endif
