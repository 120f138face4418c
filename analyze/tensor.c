#include "analyze/tensor.h"

#include <math.h>
#include <string.h>

#include "analyze/product.h"
#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/units.h"

static enum status read_part(struct h5_file *file, const char *name, int rank, double *values) {
  enum status status = STATUS_OK;
  size_t dims[2] = {0, 3};
  double *read = NULL;
  TRY(h5_read(file, name, H5_F64, rank, dims, &read));
  if (dims[0] != 3 || dims[1] != 3)
    TRY_FAIL(STATUS_INPUT, "%s: %s is not of three directions", h5_path(file), name);
  memcpy(values, read, (rank == 2 ? 9 : 3) * sizeof *values);
cleanup:
  memory_free(&read);
  return status;
}

enum status tensor_read(const struct run *run, struct tensor *tensor, bool *found) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  double area[9];
  *found = false;
  *tensor = (struct tensor){0};
  TRY(h5_open(run->path, &file));
  if (!h5_exists(file, "/run/tensor")) goto cleanup;
  TRY(read_part(file, "/run/tensor/k", 2, tensor->k));
  TRY(read_part(file, "/run/tensor/k_low", 2, tensor->low));
  TRY(read_part(file, "/run/tensor/k_high", 2, tensor->high));
  TRY(read_part(file, "/run/tensor/permeability", 2, area));
  TRY(read_part(file, "/run/tensor/principal", 1, tensor->principal));
  TRY(read_part(file, "/run/tensor/principal_low", 1, tensor->principal_low));
  TRY(read_part(file, "/run/tensor/principal_high", 1, tensor->principal_high));
  TRY(read_part(file, "/run/tensor/axes", 2, tensor->axes));
  TRY(h5_read_attribute(file, "/run/tensor", "mirrored", H5_I32, 3, tensor->mirrored));
  TRY(h5_read_attribute(file, "/run/tensor", "voxel", H5_F64, 1, &tensor->voxel));
  tensor->asymmetry = h5_attribute_or_nan(file, "/run/tensor", "asymmetry");
  for (int i = 0; i < 9; i += 4)
    if (tensor->k[i] != 0) tensor->to_area = area[i] / tensor->k[i];
  *found = true;
cleanup:
  h5_close(file);
  return status;
}

static const struct {
  const char *name, *key;
  double per; /* unit in m/s or m^2; 0: voxel^2 */
  bool area;
} units[] = {{"cm/s", "k_cm_per_s", 100, false},
             {"m/s", "k_m_per_s", 1, false},
             {"m^2", "permeability_m2", 1, true},
             {"darcy", "permeability_darcy", 1 / DARCY, true},
             {"voxel^2", "permeability_voxel2", 0, true}};
enum { UNITS = sizeof units / sizeof *units, CM_PER_S = 0, M_PER_S = 1 };

static double in_unit(const struct tensor *t, int u, double k) {
  const double per = units[u].per > 0 ? units[u].per : 1 / (t->voxel * t->voxel);
  return k * per * (units[u].area ? t->to_area : 1);
}

static json_t *matrix(const struct tensor *t, int u, const double k[9]) {
  json_t *rows = json_array();
  for (int i = 0; i < 3; i++) {
    const double row[3] = {in_unit(t, u, k[3 * i]), in_unit(t, u, k[3 * i + 1]),
                           in_unit(t, u, k[3 * i + 2])};
    json_array_append_new(rows, json_numbers(row, 3));
  }
  return rows;
}

/* Origin of the mirror symmetry along an axis, in tensor.mirrored. */
enum { BY_MODEL = 1, BY_RUN = 2 };

/* Writes `before` and the axes with one of two values, "x, y", if there are any. */
static bool list_axes(const struct tensor *t, int value, int other, const char *before,
                      FILE *stream) {
  bool found = false;
  for (int a = 0; a < 3; a++)
    if (t->mirrored[a] == value || t->mirrored[a] == other) {
      fprintf(stream, "%s%c", found ? ", " : before, "xyz"[a]);
      found = true;
    }
  return found;
}

static void write_symmetry(const struct tensor *t, FILE *stream) {
  bool by_run = false;
  for (int a = 0; a < 3; a++) by_run = by_run || t->mirrored[a] == BY_RUN;
  const char *what = by_run ? "Each direction's sample is its own mirror image along "
                            : "The model is its own mirror image along ";
  if (list_axes(t, BY_MODEL, BY_RUN, what, stream)) {
    fputs(": the terms off the diagonal with that axis are zero", stream);
    if (list_axes(t, BY_RUN, BY_RUN, "; along ", stream))
      fputs(" by the run, as pores do not meet where the model wraps round", stream);
    fputs(". ", stream);
    if (list_axes(t, 0, 0, "Along ", stream))
      fputs(
          " it wraps round: unless the sample repeats itself there, the jump at its sides is part "
          "of k. ct2model build --sides mirrored mirrors all axes. ",
          stream);
  }
  if (t->principal_low[0] <= t->principal_high[2])
    fputs("No two principal values differ by more than their errors: the axes mean little. ",
          stream);
  if (!isfinite(t->asymmetry)) return;
  fputs("Mirrored terms (xy and yx, ...) differ by ", stream);
  write_percent(stream, t->asymmetry);
  fputs(" of the mean at most (Onsager: not at all).", stream);
}

json_t *tensor_json(const struct tensor *t) {
  json_t *object = json_object(), *list = json_array(), *mirrored = json_array();
  for (int u = 0; u < UNITS; u++) json_object_set_new(object, units[u].key, matrix(t, u, t->k));
  json_object_set_new(object, "k_low_m_per_s", matrix(t, M_PER_S, t->low));
  json_object_set_new(object, "k_high_m_per_s", matrix(t, M_PER_S, t->high));
  json_put_number(object, "asymmetry", t->asymmetry);
  for (int p = 0; p < 3; p++) {
    json_t *one = json_pack("{s:o,s:o,s:o}", "axis", json_numbers(t->axes + 3 * p, 3),
                            "k_low_m_per_s", json_number(t->principal_low[p]), "k_high_m_per_s",
                            json_number(t->principal_high[p]));
    for (int u = 0; u < UNITS; u++)
      json_object_set_new(one, units[u].key, json_number(in_unit(t, u, t->principal[p])));
    json_array_append_new(list, one);
    if (t->mirrored[p]) json_array_append_new(mirrored, json_stringn(&"xyz"[p], 1));
  }
  json_object_set_new(object, "principal", list);
  json_object_set_new(object, "mirrored", mirrored);
  struct text note = {0};
  if (text_start(&note) == STATUS_OK) {
    write_symmetry(t, note.stream);
    if (text_finish(&note) == STATUS_OK) json_object_set_new(object, "note", json_text(note.data));
  }
  error_clear();
  text_free(&note);
  return object;
}

void tensor_summary(const struct tensor *t, FILE *stream) {
  fputs("  tensor, cm/s (rows: flow along x, y, z; columns: gradient)\n", stream);
  for (int i = 0; i < 3; i++)
    fprintf(stream, "    %12.4g %12.4g %12.4g\n", 100 * t->k[3 * i], 100 * t->k[3 * i + 1],
            100 * t->k[3 * i + 2]);
  for (int p = 0; p < 3; p++) {
    const double *a = t->axes + 3 * p;
    fprintf(stream, "  principal value along (%.3f, %.3f, %.3f): %.4g to %.4g cm/s\n   ", a[0],
            a[1], a[2], 100 * t->principal_low[p], 100 * t->principal_high[p]);
    for (int u = 0; u < UNITS; u++)
      fprintf(stream, " %s%.4g %s", u > 0 ? "= " : "", in_unit(t, u, t->principal[p]),
              units[u].name);
    fputc('\n', stream);
  }
  fputs("  ", stream);
  write_symmetry(t, stream);
  fputc('\n', stream);
}
