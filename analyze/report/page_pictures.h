/* The pictures of the page, a file each: objects that page_maps.js or page_solid.js draws. Each
 * adds itself to a JSON object by its name, if there is something to show. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_PICTURES_H
#define TOSUI_ANALYZE_REPORT_PAGE_PICTURES_H

#include <jansson.h>
#include <stdbool.h>

#include "analyze/run_file.h"
#include "common/model_file.h"

/* "flow": "size" [x, y, z] cells of "cell_m"; "grains" four bits a cell; "lines" points of each
 * streamline, "points" 16 bits each of x, y, z in 1/500 cell and speed over "speed_high" (m/s)
 * times 65535; with `paths`, "paths" four bits a cell: the water that carries half of the flow. */
enum status picture_flow(const struct run *run, const struct particles *particles, bool paths,
                         json_t *pictures);

/* "plane": fields (encode_field) at "size" points of "spacing_m" in a plane through the middle,
 * across "normal": "distance" to the walls in spacings, "speed" m/s, "direction" two a point,
 * "pressure" Pa about its mean, "soil" 1 in soil with pores below the voxel. */
enum status picture_plane(const struct run *run, const struct particles *particles,
                          const struct voxel_model *model, json_t *pictures);

/* "slice": the middle slice of the scan of the model in the file at `path`: "grey" and, at the same
 * points, "distance" to the model's walls in their "size" pixels. */
enum status picture_slice(const char *path, const struct voxel_model *model, json_t *pictures);

/* "frames": up to six times of a run whose water moves in space: "times_s", and for each the
 * "kinds" and "values" of the cells of a grid; see page_frames.c. */
enum status picture_frames(const struct run *run, json_t *pictures);

/* "grain_sizes": "diameter_m" and "finer", the share of the grains where no larger ball fits:
 * page_grains.c. Nothing without walls, or with grains of a voxel or two. */
enum status grain_sizes(const struct voxel_model *model, json_t *data);

/* Distances to the walls of the model, or by its grain fraction, at points in a plane across
 * axes[2], in steps along axes[0] (positive in pores; clipped by what shows them). `low` is the
 * corner along axes[0] and axes[1] and the place along axes[2], m. False: the model has neither. */
bool picture_walls(const struct voxel_model *model, const int axes[3], const double low[3],
                   const double step[2], const size_t size[2], float *distance);

#endif
