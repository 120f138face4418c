/* The middle slice of the scan with the walls that the model has there: the check that everyone
 * makes. */
#include <math.h>
#include <string.h>

#include "analyze/report/page_pictures.h"
#include "common/hdf5_file.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"

#define SLICE_SIDE 400 /* largest number of pixels per side */

/* Axes of the model: the slice is across `normal`, at `height`; lengths of the part that is not a
 * mirror image, m. */
struct slice_axes {
  int normal, across, up;
  double length[3], height;
};

/* First letter of a text about the model; 0 without it. */
static char letter(struct h5_file *file, const char *name) {
  char *text = NULL, first = '\0';
  if (h5_read_attribute_text(file, "/model", name, &text) == STATUS_OK)
    first = text[0];
  else
    error_clear();
  memory_free(&text);
  return first;
}

/* Inside ct2model the mirror axis is the last one, and its slices are across it: that of number
 * n / 2 of the scan is shown, at its middle. */
static struct slice_axes find_axes(struct h5_file *file, const struct voxel_model *model) {
  const char axis = letter(file, "mirror_axis");
  const bool sides = letter(file, "sides") == 'm'; /* mirrored */
  const int normal = axis == 'x' ? 0 : axis == 'y' ? 1 : 2;
  struct slice_axes axes = {.normal = normal, .across = (normal + 1) % 3, .up = (normal + 2) % 3};
  for (int d = 0; d < 3; d++) {
    const bool mirrored = "xyz"[d] == axis || (sides && d < 2);
    const size_t kept = mirrored ? (model->size[d] + 1) / 2 : model->size[d];
    axes.length[d] = (double)kept * model->spacing[d];
  }
  const double length = axes.length[normal];
  const double n = round(length / h5_attribute_or_nan(file, "/model", "voxel_scanned"));
  axes.height = isfinite(n) && n >= 1.0 ? (floor(n / 2.0) + 0.5) * length / n : 0.5 * length;
  return axes;
}

/* Grey values of the pixels by the nearest of the scan. */
static void take_greys(const float *slice, const size_t from[2], const size_t size[2],
                       float *grey) {
  for (size_t j = 0; j < size[1]; j++)
    for (size_t i = 0; i < size[0]; i++)
      grey[j * size[0] + i] = slice[j * from[0] / size[1] * from[1] + i * from[1] / size[0]];
}

static void fit_size(size_t nx, size_t ny, size_t size[2]) {
  const size_t most = nx > ny ? nx : ny;
  const double by = most > SLICE_SIDE ? (double)SLICE_SIDE / (double)most : 1.0;
  size[0] = (size_t)fmax(1.0, round(by * (double)nx));
  size[1] = (size_t)fmax(1.0, round(by * (double)ny));
}

enum status picture_slice(const char *path, const struct voxel_model *model, json_t *pictures) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  float *slice = NULL, *grey = NULL, *distance = NULL;
  size_t from[2], size[2]; /* y, x; x, y */
  TRY(h5_open(path, &file));
  const struct slice_axes axes = find_axes(file, model);
  const double pore = h5_attribute_or_nan(file, "/calibration", "pore_peak");
  const double grain = h5_attribute_or_nan(file, "/calibration", "grain_peak");
  if (!h5_exists(file, "/calibration/slice") || !(fabs(grain - pore) > 0.0)) goto cleanup;
  TRY(h5_read(file, "/calibration/slice", H5_F32, 2, from, &slice));
  if (from[0] == 0 || from[1] == 0) goto cleanup;
  fit_size(from[1], from[0], size);
  const size_t n = size[0] * size[1];
  TRY(memory_allocate(&grey, n, sizeof *grey, "a picture"));
  take_greys(slice, from, size, grey);
  const bool labels = h5_attribute_or_nan(file, "/calibration", "segmented") > 0.0;
  const double margin = labels ? 0.0 : 0.35 * fabs(grain - pore);
  json_t *picture =
      json_pack("{s:[I,I],s:o,s:s#,s:s#,s:o}", "size", (json_int_t)size[0], (json_int_t)size[1],
                "pixel_m", json_number(axes.length[axes.across] / (double)size[0]), "across",
                &"xyz"[axes.across], 1, "up", &"xyz"[axes.up], 1, "grey",
                encode_field(grey, n, fmin(pore, grain) - margin, fmax(pore, grain) + margin));
  json_object_set_new(pictures, "slice", picture);
  TRY(memory_allocate(&distance, n, sizeof *distance, "a picture"));
  const int order[3] = {axes.across, axes.up, axes.normal};
  const double low[3] = {0.0, 0.0, axes.height};
  const double pixel[2] = {axes.length[axes.across] / (double)size[0],
                           axes.length[axes.up] / (double)size[1]};
  if (picture_walls(model, order, low, pixel, size, distance))
    json_object_set_new(picture, "distance", encode_field(distance, n, -2.0, 2.0));
cleanup:
  h5_close(file);
  memory_free(&slice);
  memory_free(&grey);
  memory_free(&distance);
  return status;
}
