#include "ct2model/describe.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/hdf5_file.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/units.h"
#include "ct2model/readers/stack.h"
#include "ct2model/scanner/fields.h"

static bool is_model(const char *path) {
  static const unsigned char SIGNATURE[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  unsigned char head[8] = {0};
  struct stat info;
  FILE *file = stat(path, &info) == 0 && S_ISREG(info.st_mode) ? fopen(path, "rb") : NULL;
  if (file == NULL) return false;
  size_t got = fread(head, 1, sizeof head, file);
  fclose(file);
  return got == sizeof head && memcmp(head, SIGNATURE, sizeof head) == 0;
}

/* ---- a model ---- */

static void print_number(struct h5_file *file, const char *name, const char *label, json_t *out) {
  double value;
  if (!h5_attribute_exists(file, "/model", name)) return;
  if (h5_read_attribute(file, "/model", name, H5_F64, 1, &value) != STATUS_OK) {
    error_clear();
    return;
  }
  if (out != NULL)
    json_put_number(out, name, value);
  else if (isfinite(value))
    printf("  %-22s %.6g\n", label, value);
}

/* Prints the void ratio within the walls, if these were set to enclose the measured one; that of
 * the voxels differs. */
static void print_within_walls(struct h5_file *file) {
  const double voxels = h5_attribute_or_nan(file, "/model", "void_ratio");
  const double walls = h5_attribute_or_nan(file, "/model", "void_ratio_measured") +
                       h5_attribute_or_nan(file, "/model", "void_ratio_error");
  if (fabs(walls - voxels) > 1e-6) printf("  %-22s %.6g\n", "within the walls", walls);
}

/* Prints the properties of the scanner as `build` does; all are unknown if the file has no such
 * group. */
static void describe_scanner(struct h5_file *file, json_t *out) {
  const bool known = h5_exists(file, "/scanner");
  json_t *object = out != NULL ? json_object() : NULL;
  for (size_t i = 0; i < scanner_field_count; i++) {
    const struct scanner_field *field = &scanner_fields[i];
    const double value = known ? h5_attribute_or_nan(file, "/scanner", field->attribute) : NAN;
    if (object != NULL)
      json_put_number(object, field->key, value);
    else if (field->label != NULL && isfinite(value))
      printf("  %-22s %.4g\n", field->label, field->shown * value);
  }
  if (object != NULL) json_object_set_new(out, "scanner", object);
}

static enum status describe_model(const char *path, json_t *out) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  int rank;
  size_t dims[3];
  double spacing[3];
  TRY(h5_open(path, &file));
  if (!h5_exists(file, "/model/solid"))
    TRY_FAIL(STATUS_INPUT, "%s: an HDF5 file without /model/solid: not a model", path);
  TRY(h5_shape(file, "/model/solid", 3, &rank, dims));
  if (rank != 3) TRY_FAIL(STATUS_INPUT, "%s: /model/solid has %d dimensions, not 3", path, rank);
  TRY(h5_read_attribute(file, "/model", "spacing", H5_F64, 3, spacing));
  const double voxel[3] = {spacing[2], spacing[1], spacing[0]}; /* along x, y, z */
  bool walls = h5_exists(file, "/model/wall_distance");
  bool fraction = h5_exists(file, "/model/grain_fraction");
  bool micro = h5_exists(file, "/model/micro_porosity");
  if (out != NULL) {
    json_object_set_new(out, "kind", json_string("model"));
    json_object_set_new(
        out, "size",
        json_pack("[I,I,I]", (json_int_t)dims[2], (json_int_t)dims[1], (json_int_t)dims[0]));
    json_object_set_new(out, "spacing_m", json_numbers(voxel, 3));
    json_object_set_new(out, "wall_distance", json_boolean(walls));
    json_object_set_new(out, "grain_fraction", json_boolean(fraction));
    json_object_set_new(out, "micro_pores", json_boolean(micro));
  } else {
    char text[40];
    quantity_format(voxel[0], "m", text, sizeof text);
    printf("%s: voxel model, %zux%zux%zu voxels of %s%s%s%s\n", path, dims[2], dims[1], dims[0],
           text, walls ? ", wall distances" : "", fraction ? ", grain fractions" : "",
           micro ? ", soil with pores below the voxel" : "");
  }
  print_number(file, "void_ratio", "void ratio, by voxels", out);
  print_number(file, "void_ratio_measured", "measured", out);
  print_number(file, "void_ratio_scan", "by the scan's edges", out);
  print_number(file, "void_ratio_scan_uncertainty", "its uncertainty", out);
  if (out == NULL) print_within_walls(file);
  print_number(file, "threshold", "threshold", out);
  if (out != NULL)
    print_number(file, "mirror_plane", NULL, out);
  else if (h5_attribute_or_nan(file, "/model", "mirror_plane") >= 0)
    printf("  %-22s %.0f\n", "mirrored about layer",
           h5_attribute_or_nan(file, "/model", "mirror_plane") + 1);
  print_number(file, "connected_porosity", "connected porosity", out);
  print_number(file, "micro_voxels", "soil, of the voxels", out);
  print_number(file, "micro_porosity_mean", "porosity of soil", out);
  print_number(file, "micro_permeability_mean", "permeability of soil m^2", out);
  print_number(file, "isolated_pores", "isolated pores", out);
  print_number(file, "specific_surface", "specific surface 1/m", out);
  describe_scanner(file, out);
  if (out == NULL && h5_attribute_exists(file, "/provenance", "command_line")) {
    char *line = NULL;
    TRY(h5_read_attribute_text(file, "/provenance", "command_line", &line));
    printf("  made by                %s\n", line);
    memory_free(&line);
  }
cleanup:
  h5_close(file);
  return status;
}

/* ---- a stack ---- */

static enum status describe_stack(const char *const *paths, size_t count,
                                  const struct request *request, json_t *out) {
  struct stack stack;
  enum status status = stack_open(paths, count, &request->raw, &stack);
  if (status != STATUS_OK) return status;
  double voxel[3];
  stack_compare_voxel(&stack, request->voxel, request->has_slice_distance);
  for (int d = 0; d < 3; d++)
    voxel[d] = isnan(request->voxel[d]) ? stack.voxel[d] : request->voxel[d];
  const char *source = isnan(request->voxel[0]) ? stack.voxel_source : "--voxel-size";
  if (out != NULL) {
    json_object_set_new(out, "kind", json_string("stack"));
    json_object_set_new(out, "format", json_string(stack.files[0].reader->name));
    json_object_set_new(out, "files", json_integer((json_int_t)stack.file_count));
    json_object_set_new(out, "size",
                        json_pack("[I,I,I]", (json_int_t)stack.size[0], (json_int_t)stack.size[1],
                                  (json_int_t)stack.size[2]));
    json_object_set_new(out, "type", json_string(pixel_name(stack.type)));
    json_object_set_new(out, "voxel_size_m", json_numbers(voxel, 3));
  } else {
    double bytes = (double)stack.size[0] * (double)stack.size[1] * (double)stack.size[2] *
                   (double)pixel_size(stack.type);
    printf("%s: %s stack, %zux%zux%zu voxels in %zu file%s, %s, %.4g MB of pixels\n", paths[0],
           stack.files[0].reader->name, stack.size[0], stack.size[1], stack.size[2],
           stack.file_count, stack.file_count == 1 ? "" : "s", pixel_name(stack.type),
           bytes * 1e-6);
    char text[3][40];
    for (int d = 0; d < 3; d++) quantity_format(voxel[d], "m", text[d], sizeof text[d]);
    if (!isfinite(voxel[0]))
      printf("  voxel size             not in the file: give --voxel-size\n");
    else if (isfinite(voxel[2]))
      printf("  voxel size             %s x %s x %s (%s)\n", text[0], text[1], text[2], source);
    else
      printf("  pixel size             %s x %s (%s); slice distance unknown\n", text[0], text[1],
             source);
    if (stack.file_count > 1)
      printf("  slices                 %s ... %s\n", stack.files[0].path,
             stack.files[stack.file_count - 1].path);
  }
  stack_close(&stack);
  return STATUS_OK;
}

enum status describe_files(const struct options *options, const struct request *request) {
  enum status status = STATUS_OK;
  size_t n = options_operand_count(options), images = 0;
  const char **paths = NULL;
  json_t *list = options_json(options) ? json_array() : NULL;
  TRY(memory_allocate(&paths, n, sizeof *paths, "file names"));
  for (size_t i = 0; i < n; i++) {
    const char *path = options_operand(options, i);
    if (!is_model(path)) {
      paths[images++] = path;
      continue;
    }
    json_t *out = list != NULL ? json_pack("{s:o}", "path", json_text(path)) : NULL;
    if (list != NULL) json_array_append_new(list, out);
    TRY(describe_model(path, out));
  }
  if (images > 0) { /* all images together are one stack */
    json_t *out = list != NULL ? json_pack("{s:o}", "path", json_text(paths[0])) : NULL;
    if (list != NULL) json_array_append_new(list, out);
    TRY(describe_stack(paths, images, request, out));
  }
  if (list != NULL) {
    json_t *root = json_pack("{s:O}", "files", list);
    char *text = json_dumps(root, JSON_INDENT(2));
    json_decref(root);
    if (text == NULL) TRY_FAIL(STATUS_RUN, "out of memory");
    puts(text);
    free(text);
  }
cleanup:
  json_decref(list);
  memory_free(&paths);
  return status;
}
