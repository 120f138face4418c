#include "sphsolve/output/image.h"

#include <stdio.h>

#include "common/image_file.h"
#include "common/memory.h"
#include "common/output_guard.h"
#include "common/snapshot_file.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/geometry/thin_wall.h"

struct field {
  const char *name, *unit, *description;
  size_t components;
};

static enum status write_field(struct h5_file *file, const struct lattice *lattice,
                               const struct field *field, const float *values) {
  enum status status = STATUS_OK;
  char path[64];
  const size_t dims[4] = {lattice->size[2], lattice->size[1], lattice->size[0], field->components};
  snprintf(path, sizeof path, "/VTKHDF/PointData/%s", field->name);
  TRY(h5_write(file, path, H5_F32, field->components > 1 ? 4 : 3, dims, values, true));
  TRY(h5_write_attribute_text(file, path, "unit", field->unit));
  TRY(h5_write_attribute_text(file, path, "description", field->description));
cleanup:
  return status;
}

/* Soil with pores smaller than the sites: porosity, permeability, and the power of its drag,
 * viscosity v^2 / k. */
static enum status write_soil(struct h5_file *file, const struct lattice *lattice, double viscosity,
                              size_t count, const uint64_t *site, const float *velocity) {
  enum status status = STATUS_OK;
  static const struct field fields[] = {
      {"micro_porosity", "1", "porosity of soil with pores below the voxel; 0 elsewhere", 1},
      {"micro_permeability", "m^2", "its permeability; 0 elsewhere", 1},
      {"micro_power", "W/m^3", "power that the drag of such soil takes; 0 elsewhere", 1}};
  float *power = NULL;
  TRY(memory_allocate(&power, lattice->count, sizeof *power, "the flow as an image"));
  for (size_t i = 0; i < count; i++) {
    const float *v = velocity + 3 * i;
    const double square =
        (double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2];
    if (lattice_is_soil(lattice, site[i]))
      power[site[i]] = (float)(viscosity * square / (double)lattice->micro_permeability[site[i]]);
  }
  TRY(write_field(file, lattice, &fields[0], lattice->micro_porosity));
  TRY(write_field(file, lattice, &fields[1], lattice->micro_permeability));
  TRY(write_field(file, lattice, &fields[2], power));
cleanup:
  memory_free(&power);
  return status;
}

static enum status write_thin_walls(struct h5_file *file, const struct lattice *lattice) {
  enum status status = STATUS_OK;
  uint8_t *closed = NULL;
  static const char path[] = "/VTKHDF/PointData/thin_walls";
  const size_t dims[3] = {lattice->size[2], lattice->size[1], lattice->size[0]};
  TRY(thin_wall_closed_faces(lattice, &closed));
  if (closed == NULL) return STATUS_OK;
  TRY(h5_write(file, path, H5_U8, 3, dims, closed, true));
  TRY(h5_write_attribute_text(file, path, "unit", "1"));
  TRY(h5_write_attribute_text(file, path, "description",
                              "1 + 2 + 4: a thin wall closes the face between this site and the "
                              "next one along x, y, z"));
cleanup:
  memory_free(&closed);
  return status;
}

enum status image_write(const char *prefix, const struct lattice *lattice, double viscosity,
                        double time, int64_t step, uint64_t flow, size_t count,
                        const uint64_t *site, const float *velocity, const float *pressure) {
  enum status status = STATUS_OK;
  static const struct field fields[] = {
      {"velocity", "m/s", "velocity; walls are at rest", 3},
      {"pressure", "Pa", "pressure without the part that drives the flow; 0 in walls", 1},
      {"wall_distance", "m", "signed distance to the wall, positive in the pore", 1}};
  const float *sources[] = {velocity, pressure};
  struct h5_file *file = NULL;
  float *values = NULL;
  char path[4096];
  snprintf(path, sizeof path, "%s-image.hdf", prefix);
  TRY(output_allow(path));
  TRY(h5_create(path, &file));
  TRY(h5_write_attribute(file, "/", "time", H5_F64, 1, &time));
  TRY(h5_write_attribute(file, "/", "step", H5_I64, 1, &step));
  TRY(flow_hash_write(file, "/", flow));
  TRY(image_file_begin(file, lattice->size, lattice->spacing, lattice->origin));
  for (size_t f = 0; f < 2; f++) {
    const size_t n = fields[f].components;
    TRY(memory_allocate(&values, n * lattice->count, sizeof *values, "the flow as an image"));
    for (size_t i = 0; i < count; i++)
      for (size_t c = 0; c < n; c++) values[n * site[i] + c] = sources[f][n * i + c];
    TRY(write_field(file, lattice, &fields[f], values));
    memory_free(&values);
  }
  if (lattice->wall_distance != NULL)
    TRY(write_field(file, lattice, &fields[2], lattice->wall_distance));
  TRY(write_thin_walls(file, lattice));
  if (lattice->micro_porosity != NULL)
    TRY(write_soil(file, lattice, viscosity, count, site, velocity));
  status = h5_commit(file);
  file = NULL;
cleanup:
  h5_close(file);
  memory_free(&values);
  return status;
}
