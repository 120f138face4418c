#include "common/snapshot_file.h"

#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "common/output_file.h"
#include "common/ranks.h"

static enum status write_field(struct h5_file *file, const char *name, size_t count,
                               const struct snapshot_field *field) {
  enum status status = STATUS_OK;
  void *made = NULL;
  size_t dims[2] = {count, (size_t)field->components};
  if (field->data == NULL && field->fill != NULL) {
    TRY(memory_allocate(&made, count * dims[1], h5_type_size(field->type),
                        "a field of a snapshot"));
    TRY(field->fill(field->context, made));
  }
  const void *data = field->data != NULL ? field->data : made;
  TRY(h5_write_rows(file, name, field->type, field->components > 1 ? 2 : 1, dims, data, true));
cleanup:
  memory_free(&made);
  return status;
}

/* Cells of an UnstructuredGrid, `count` of them on this rank, of `each` points. */
struct cells {
  size_t first, count, each;
  int type;
};
static enum status fill_numbers(const void *context, void *data) {
  const struct cells *cells = context;
  int64_t *numbers = data;
  for (size_t i = 0; i < cells->count; i++)
    numbers[i] = (int64_t)((cells->first + i) * cells->each);
  return STATUS_OK;
}
static enum status fill_types(const void *context, void *data) {
  const struct cells *cells = context;
  if (cells->count > 0) memset(data, cells->type, cells->count);
  return STATUS_OK;
}

enum status snapshot_write_grid(struct h5_file *file, size_t count,
                                const struct snapshot_field *place, size_t each, int type) {
  enum status status = STATUS_OK;
  const int version[2] = {1, 0};
  size_t one = 1, all;
  const struct cells points = {ranks_offset(count, &all), count, 1, type},
                     own = {points.first / each, count / each, each, type};
  struct cells ends = own;
  if (ranks_own() + 1 == ranks_count()) ends.count++;
  const int64_t totals[2] = {(int64_t)all, (int64_t)(all / each)};
  const struct snapshot_field
      numbers = {.type = H5_I64, .components = 1, .fill = fill_numbers, .context = &points},
      offsets = {.type = H5_I64, .components = 1, .fill = fill_numbers, .context = &ends},
      types = {.type = H5_U8, .components = 1, .fill = fill_types, .context = &own};
  TRY(h5_make_group(file, "/VTKHDF"));
  TRY(h5_write_attribute(file, "/VTKHDF", "Version", H5_I32, 2, version));
  TRY(h5_write_attribute_text(file, "/VTKHDF", "Type", "UnstructuredGrid"));
  TRY(write_field(file, "/VTKHDF/Points", count, place));
  TRY(write_field(file, "/VTKHDF/Connectivity", count, &numbers));
  TRY(write_field(file, "/VTKHDF/Offsets", ends.count, &offsets));
  TRY(write_field(file, "/VTKHDF/Types", own.count, &types));
  TRY(h5_write(file, "/VTKHDF/NumberOfPoints", H5_I64, 1, &one, &totals[0], false));
  TRY(h5_write(file, "/VTKHDF/NumberOfCells", H5_I64, 1, &one, &totals[1], false));
  TRY(h5_write(file, "/VTKHDF/NumberOfConnectivityIds", H5_I64, 1, &one, &totals[0], false));
cleanup:
  return status;
}

enum status flow_hash_write(struct h5_file *file, const char *group, uint64_t hash) {
  return hash == 0 ? STATUS_OK : h5_write_attribute(file, group, "flow_hash", H5_U64, 1, &hash);
}

uint64_t flow_hash_read(struct h5_file *file, const char *group) {
  uint64_t hash = 0;
  if (h5_attribute_exists(file, group, "flow_hash") &&
      h5_read_attribute(file, group, "flow_hash", H5_U64, 1, &hash) != STATUS_OK) {
    error_clear();
    hash = 0;
  }
  return hash;
}

enum status flow_hash_check(const char *record_path, uint64_t record, const char *path,
                            struct h5_file *file) {
  const uint64_t own = flow_hash_read(file, "/");
  if (record == 0 || own == 0 || record == own) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: is of another run than %s, one of which could not be written to its end: run "
              "the flow again",
              path, record_path);
}

enum status snapshot_write(const char *path, double time, int64_t step, uint64_t flow, size_t count,
                           const struct snapshot_field *points, size_t field_count,
                           const struct snapshot_field *fields) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(h5_create(path, &file));
  TRY(h5_write_attribute(file, "/", "time", H5_F64, 1, &time));
  TRY(h5_write_attribute(file, "/", "step", H5_I64, 1, &step));
  TRY(flow_hash_write(file, "/", flow));
  TRY(snapshot_write_grid(file, count, points, 1, VTK_VERTEX));
  for (size_t i = 0; i < field_count; i++) {
    const struct snapshot_field *field = &fields[i];
    char name[128];
    snprintf(name, sizeof name, "/VTKHDF/PointData/%s", field->name);
    TRY(write_field(file, name, count, field));
    TRY(h5_write_attribute_text(file, name, "unit", field->unit));
    TRY(h5_write_attribute_text(file, name, "description", field->description));
  }
  status = h5_commit(file);
  file = NULL;
cleanup:
  h5_close(file);
  return status;
}

/* Writes `text` as a JSON string and returns the end; `to` has space for six bytes per byte of
 * `text`. */
static char *quote(char *to, const char *text) {
  *to++ = '"';
  for (; *text != '\0'; text++) {
    if ((unsigned char)*text < ' ') {
      to += sprintf(to, "\\u%04x", (unsigned)*text);
      continue;
    }
    if (*text == '"' || *text == '\\') *to++ = '\\';
    *to++ = *text;
  }
  *to++ = '"';
  return to;
}

enum status series_write(const char *path, size_t count, char *const *names, const double *times) {
  enum status status = STATUS_OK;
  char *text = NULL, *end;
  size_t size = 160;
  for (size_t i = 0; i < count; i++) size += 6 * strlen(names[i]) + 80;
  TRY(memory_allocate(&text, size, 1, "the list of snapshots"));
  end = text + sprintf(text, "{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [\n");
  for (size_t i = 0; i < count; i++) {
    end = quote(end + sprintf(end, "    { \"name\" : "), names[i]);
    end += sprintf(end, ", \"time\" : %.17g }%s\n", times[i], i + 1 < count ? "," : "");
  }
  end += sprintf(end, "  ]\n}\n");
  if (ranks_own() == 0) TRY(output_write(path, text, (size_t)(end - text)));
cleanup:
  memory_free(&text);
  return status;
}

enum status snapshot_open(const char *path, struct snapshot *snapshot) {
  enum status status = STATUS_OK;
  size_t dims[2];
  *snapshot = (struct snapshot){0};
  TRY(h5_open(path, &snapshot->file));
  if (!h5_exists(snapshot->file, "/VTKHDF/Points"))
    TRY_FAIL(STATUS_INPUT, "%s: holds no points; is it a snapshot (OUT-NNNN.hdf)?", path);
  TRY(h5_read_attribute(snapshot->file, "/", "time", H5_F64, 1, &snapshot->time));
  TRY(h5_read(snapshot->file, "/VTKHDF/Points", H5_F64, 2, dims, &snapshot->points));
  if (dims[1] != 3) TRY_FAIL(STATUS_INPUT, "%s: points have %zu coordinates, not 3", path, dims[1]);
  snapshot->count = dims[0];
cleanup:
  if (status != STATUS_OK) snapshot_close(snapshot);
  return status;
}

enum status snapshot_read(struct snapshot *snapshot, const char *field, int components,
                          double **values) {
  enum status status = STATUS_OK;
  char name[128];
  size_t dims[2] = {0, 0};
  *values = NULL;
  snprintf(name, sizeof name, "/VTKHDF/PointData/%s", field);
  TRY(h5_read(snapshot->file, name, H5_F64, components > 1 ? 2 : 1, dims, values));
  if (dims[0] != snapshot->count || (components > 1 && dims[1] != (size_t)components))
    TRY_FAIL(STATUS_INPUT, "%s: %s does not match the points", h5_path(snapshot->file), name);
cleanup:
  if (status != STATUS_OK) memory_free(values);
  return status;
}

void snapshot_close(struct snapshot *snapshot) {
  memory_free(&snapshot->points);
  h5_close(snapshot->file);
  snapshot->file = NULL;
}
