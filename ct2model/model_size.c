#include "ct2model/model_size.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "ct2model/constants.h"

/* Size in cubic voxels with the shortest edge of the scan's voxels, the default without --size. */
static size_t size_of_cubes(const struct pipeline *pipeline, int axis) {
  const double *voxel = pipeline->region.voxel;
  const double edge = fmin(fmin(voxel[0], voxel[1]), voxel[2]);
  const size_t n = pipeline->region.size[axis];
  if (pipeline->request->filter == FILTER_NONE || voxel[axis] < edge * (1.0 + 1e-3)) return n;
  return (size_t)fmax(1.0, round((double)n * voxel[axis] / edge));
}

/* Finds the smallest size, from `nx` up to that of the scan, whose voxels are cubes to within a
 * tenth. */
static void advise_cubes(const size_t in[3], const double voxel[3], size_t nx, size_t size[3]) {
  double edge[3] = {0.0};
  do {
    size[0] = nx;
    edge[0] = voxel[0] * (double)in[0] / (double)nx;
    for (int a = 1; a < 3; a++) {
      size[a] = (size_t)fmax(1.0, round((double)in[a] * voxel[a] / edge[0]));
      edge[a] = voxel[a] * (double)in[a] / (double)size[a];
    }
  } while (fmax(fmax(edge[0], edge[1]), edge[2]) >
               CUBE_RATIO_MOST * fmin(fmin(edge[0], edge[1]), edge[2]) &&
           nx++ < in[0]);
}

/* Ratio of the longest to the shortest voxel edge above which the scan is refused: slices far apart
 * tell little of the pores between them, and cubes would be as many times more voxels than the scan
 * has. */
#define EDGE_RATIO_MOST 10.0
static enum status check_interpolation(const size_t in[3], const double voxel[3],
                                       const size_t out[3]) {
  const double least = fmin(fmin(voxel[0], voxel[1]), voxel[2]);
  const double most = fmax(fmax(voxel[0], voxel[1]), voxel[2]);
  if (most > EDGE_RATIO_MOST * least) {
    size_t cubes[3];
    advise_cubes(in, voxel, (size_t)fmax(1.0, round((double)in[0] * voxel[0] / most)), cubes);
    return FAIL(
        STATUS_INPUT,
        "voxels of %.4g x %.4g x %.4g um are %.3g times as long as wide, and what lies "
        "between slices so far apart is not known; --size %zux%zux%zu makes voxels as large "
        "as they are long, --size %zux%zux%zu cubes of the short edge, drawn in between",
        voxel[0] * 1e6, voxel[1] * 1e6, voxel[2] * 1e6, most / least, cubes[0], cubes[1], cubes[2],
        out[0], out[1], out[2]);
  }
  if (most > EDGE_RATIO_WARNED * least)
    log_warning("the scan's voxels are %.3g times as long as wide: what lies between is drawn from "
                "neighbours, and k may be too low, by as much as the part scan of its error says",
                most / least);
  return STATUS_OK;
}

enum status model_size_choose(struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  size_t in[3], out[3]; /* in the axes of the model, as --size */
  double voxel[3], spacing[3];
  for (int a = 0; a < 3; a++) {
    in[a] = pipeline->region.size[pipeline->place[a]];
    voxel[a] = pipeline->region.voxel[pipeline->place[a]];
    out[a] = request->size_given ? request->size[a] : size_of_cubes(pipeline, pipeline->place[a]);
    pipeline->size[pipeline->place[a]] = out[a];
    spacing[a] = voxel[a] * (double)in[a] / (double)out[a];
  }
  for (int a = 0; pipeline->distances && !request->size_given && a < 3; a++)
    if (in[a] == 1)
      return FAIL(STATUS_INPUT,
                  "%s: one %s is no volume to flow through; give the whole stack (a folder, or all "
                  "files), or say that one layer is meant with --size %zux%zux%zu",
                  pipeline->stack.files[0].path, a == 2 ? "slice" : "row of voxels", out[0], out[1],
                  out[2]);
  if (request->filter == FILTER_NONE && memcmp(in, out, sizeof in) != 0)
    return FAIL(STATUS_USAGE,
                "--filter none keeps all %zux%zux%zu voxels, but --size is %zux%zux%zu; leave "
                "--size out or use --filter area",
                in[0], in[1], in[2], out[0], out[1], out[2]);
  if (request->filter == FILTER_BICUBIC_POINT && spacing[0] > 2.0 * voxel[0])
    log_warning("bicubic-point does not antialias: at a reduction of %.3g the void ratio still "
                "matches, but many voxels are wrong and the surface is far too large; use bicubic",
                spacing[0] / voxel[0]);
  if (request->size_given && (out[0] > in[0] || out[1] > in[1] || out[2] > in[2]))
    log_warning(
        "--size %zux%zux%zu is finer than the scan's own %zux%zux%zu voxels: it adds voxels, "
        "but no detail",
        out[0], out[1], out[2], in[0], in[1], in[2]);
  if (!request->size_given && memcmp(in, out, sizeof in) != 0) {
    if (pipeline->distances) {
      const enum status status = check_interpolation(in, voxel, out);
      if (status != STATUS_OK) return status;
    }
    log_info("voxels of %.4g x %.4g x %.4g um become cubes: %zux%zux%zu", voxel[0] * 1e6,
             voxel[1] * 1e6, voxel[2] * 1e6, out[0], out[1], out[2]);
  } else if (fabs(spacing[1] / spacing[0] - 1.0) > 1e-3 ||
             fabs(spacing[2] / spacing[0] - 1.0) > 1e-3) {
    const double ny = (double)in[1] * voxel[1] / spacing[0];
    const double nz = (double)in[2] * voxel[2] / spacing[0];
    size_t cubes[3];
    advise_cubes(in, voxel, out[0], cubes);
    const double least = fmin(fmin(spacing[0], spacing[1]), spacing[2]);
    const double most = fmax(fmax(spacing[0], spacing[1]), spacing[2]);
    char text[160];
    snprintf(text, sizeof text, "model voxels of %.4g x %.4g x %.4g um are", spacing[0] * 1e6,
             spacing[1] * 1e6, spacing[2] * 1e6);
    if (pipeline->distances && most > MODEL_LONGEST_EDGE * least)
      return FAIL(STATUS_USAGE,
                  "%s too far from cubes to be solved (%.3g times as long as wide, %g at most); "
                  "--size %zux%zux%zu would make cubes",
                  text, most / least, MODEL_LONGEST_EDGE, cubes[0], cubes[1], cubes[2]);
    log_warning(
        "%s not cubic; --size %zux%zux%zu%s would keep them so", text, cubes[0], cubes[1], cubes[2],
        fabs(ny - round(ny)) + fabs(nz - round(nz)) > 1e-3 ? " with a --crop to match" : "");
  }
  return STATUS_OK;
}
