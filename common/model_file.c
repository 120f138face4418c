#include "common/model_file.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "common/image_file.h"
#include "common/memory.h"
#include "common/provenance.h"

size_t model_site_count(const struct voxel_model *model) {
  return model->size[0] * model->size[1] * model->size[2];
}

double model_porosity(const struct voxel_model *model) {
  const size_t count = model_site_count(model);
  double voids = 0.0;
  for (size_t i = 0; i < count; i++) {
    if (model->solid[i]) continue;
    const bool soil = model->micro_porosity != NULL && model->micro_porosity[i] > 0.0f;
    voids += soil ? (double)model->micro_porosity[i] : 1.0;
  }
  return voids / (double)count;
}

struct micro_summary micro_summary(const struct voxel_model *model) {
  const size_t count = model_site_count(model);
  double soils = 0.0, porosity = 0.0, logarithm = 0.0;
  for (size_t i = 0; i < count; i++) {
    if (!(model->micro_porosity[i] > 0.0f)) continue;
    soils += 1.0;
    porosity += (double)model->micro_porosity[i];
    logarithm += log((double)model->micro_permeability[i]);
  }
  if (soils == 0.0) return (struct micro_summary){0};
  return (struct micro_summary){soils / (double)count, porosity / soils, exp(logarithm / soils)};
}

void model_free(struct voxel_model *model) {
  MEMORY_FREE(&model->micro_porosity, &model->micro_permeability, &model->solid,
              &model->wall_distance, &model->grain_fraction);
}

static enum status read_optional_field(struct h5_file *file, const char *name,
                                       const struct voxel_model *model, double low, double high,
                                       float **values) {
  enum status status = STATUS_OK;
  size_t dims[3];
  *values = NULL;
  if (!h5_exists(file, name)) return STATUS_OK;
  TRY(h5_read_together(file, name, H5_F32, 3, dims, values));
  for (int a = 0; a < 3; a++)
    if (dims[a] != model->size[2 - a])
      TRY_FAIL(STATUS_INPUT, "%s: %s is %zux%zux%zu, but /model/solid is %zux%zux%zu (z, y, x)",
               h5_path(file), name, dims[0], dims[1], dims[2], model->size[2], model->size[1],
               model->size[0]);
  size_t count = model_site_count(model);
  const double slack = 1e-5 * (high - low); /* tolerance for rounding of sums */
  size_t beyond = 0;
#pragma omp parallel for schedule(static) reduction(+ : beyond)
  for (size_t i = 0; i < count; i++) beyond += !((*values)[i] >= low && (*values)[i] <= high);
  for (size_t i = 0; i < count && beyond > 0; i++) {
    if ((*values)[i] >= low && (*values)[i] <= high) continue;
    if (!((*values)[i] >= low - slack && (*values)[i] <= high + slack))
      TRY_FAIL(STATUS_INPUT, "%s: %s holds %g at x=%zu y=%zu z=%zu; %g to %g is possible",
               h5_path(file), name, (double)(*values)[i], i % model->size[0],
               i / model->size[0] % model->size[1], i / model->size[0] / model->size[1], low, high);
    (*values)[i] = fminf(fmaxf((*values)[i], (float)low), (float)high);
  }
cleanup:
  return status;
}

static enum status read_optional_number(struct h5_file *file, const char *attribute, double low,
                                        double high, double *value) {
  enum status status = STATUS_OK;
  *value = NAN;
  if (!h5_attribute_exists(file, "/model", attribute)) return STATUS_OK;
  TRY(h5_read_attribute(file, "/model", attribute, H5_F64, 1, value));
  if (*value < low || *value > high)
    TRY_FAIL(STATUS_INPUT, "%s: /model: %s is %g; %g to %g is possible", h5_path(file), attribute,
             *value, low, high);
cleanup:
  return status;
}

/* Largest distance, in voxels, that is as good as none: distances are zeros, or not in metres. */
#define DISTANCE_NONE 1e-3
/* Share of a phase's voxels that may lie on the wrong side of the wall by more than a voxel. */
#define DISTANCE_STRAY 0.01

/* Wall distances of the wrong sign or unit would silently give a wrong k. Pores and grains are
 * judged apart: of a tight sample most voxels are grain. A voxel that the wall cuts may have either
 * sign. */
static enum status check_distances(const char *path, const struct voxel_model *model,
                                   size_t grains) {
  static const char *const PHASES[] = {"pores", "grains"};
  const size_t count = model_site_count(model), all[2] = {count - grains, grains};
  size_t wrong[2] = {0}, far[2] = {0};
  double widest = 0;
  float nearest = INFINITY, largest[2] = {0};
  for (int a = 0; a < 3; a++) widest = fmax(widest, model->spacing[a]);
#pragma omp parallel for schedule(static) reduction(+ : wrong[ : 2], far[ : 2]) \
    reduction(min : nearest) reduction(max : largest[ : 2])
  for (size_t i = 0; i < count; i++) {
    const float d = model->wall_distance[i], size = fabsf(d);
    const int phase = model->solid[i];
    const bool other = phase ? d > 0 : d < 0;
    wrong[phase] += other;
    far[phase] += other && (double)size > widest;
    nearest = size < nearest ? size : nearest;
    largest[phase] = size > largest[phase] ? size : largest[phase];
  }
  for (int phase = 0; phase < 2; phase++) {
    if (2 * wrong[phase] > all[phase] || (double)far[phase] > DISTANCE_STRAY * (double)all[phase])
      return FAIL(
          STATUS_INPUT,
          "%s: /model/wall_distance has the wrong sign in %zu of %zu voxels of the %s: it is "
          "positive in the pores (solid 0) and negative in the grains",
          path, wrong[phase], all[phase], PHASES[phase]);
    if (all[phase] > 0 && all[1 - phase] > 0 && (double)largest[phase] < DISTANCE_NONE * widest)
      return FAIL(STATUS_INPUT,
                  "%s: /model/wall_distance is nowhere beyond %g m in the %s, %.2g voxels: metres "
                  "from the middle of a voxel to the surface are wanted",
                  path, (double)largest[phase], PHASES[phase], (double)largest[phase] / widest);
  }
  if (grains > 0 && grains < count && (double)nearest > 2 * widest)
    return FAIL(
        STATUS_INPUT,
        "%s: /model/wall_distance is nowhere below %g m, %.3g voxels: metres from the middle "
        "of a voxel to the surface are wanted",
        path, (double)nearest, (double)nearest / widest);
  return STATUS_OK;
}

/* Porosity and permeability of soil must be given together, and only outside of grains. A pore as
 * wide as a voxel has a permeability of some tenths of the voxel's squared edge; soil with a
 * permeability above the squared edge has pores that should be resolved. */
static enum status check_micro(const char *path, const struct voxel_model *model) {
  static const char NAMES[] = "/model/micro_porosity and /model/micro_permeability";
  const double voxel = cbrt(model->spacing[0] * model->spacing[1] * model->spacing[2]);
  const size_t count = model_site_count(model);
  if (model->micro_porosity == NULL && model->micro_permeability == NULL) return STATUS_OK;
  if (model->micro_porosity == NULL || model->micro_permeability == NULL)
    return FAIL(STATUS_INPUT, "%s: has one of %s; both are wanted", path, NAMES);
  for (size_t i = 0; i < count; i++) {
    const double n = (double)model->micro_porosity[i], k = (double)model->micro_permeability[i];
    const size_t x = i % model->size[0], y = i / model->size[0] % model->size[1],
                 z = i / model->size[0] / model->size[1];
    if (n == 0.0 && k == 0.0) continue;
    if (model->solid[i])
      return FAIL(STATUS_INPUT, "%s: %s are not 0 in the grain at x=%zu y=%zu z=%zu", path, NAMES,
                  x, y, z);
    if (!(n > 0.0 && n < 1.0 && k > 0.0))
      return FAIL(STATUS_INPUT,
                  "%s: porosity %g, permeability %g m^2 at x=%zu y=%zu z=%zu in %s: soil has a "
                  "porosity between 0 and 1 and a permeability above 0, all else has 0 of both",
                  path, n, k, x, y, z, NAMES);
    if (k > voxel * voxel)
      return FAIL(
          STATUS_INPUT,
          "%s: /model/micro_permeability is %g m^2 at x=%zu y=%zu z=%zu, more than the "
          "square of a voxel, %.3g m^2: such pores are wider than voxels; take them as pore",
          path, k, x, y, z, voxel * voxel);
  }
  return STATUS_OK;
}

enum status model_read(const char *path, struct voxel_model *model) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  size_t dims[3], grains = 0;
  double spacing[3];
  int periodic[3] = {1, 1, 1};
  *model = (struct voxel_model){.mirror_plane = -1};
  TRY(h5_open(path, &file));
  TRY(provenance_check(file));
  if (!h5_exists(file, "/model/solid"))
    TRY_FAIL(STATUS_INPUT, "%s: has no /model/solid; is it a model (ct2model build)?", path);
  TRY(h5_read_together(file, "/model/solid", H5_U8, 3, dims, &model->solid));
  for (int a = 0; a < 3; a++) {
    model->size[a] = dims[2 - a];
    if (dims[a] == 0 || dims[a] > 1u << 20)
      TRY_FAIL(STATUS_INPUT, "%s: /model/solid is %zux%zux%zu: impossible", path, dims[0], dims[1],
               dims[2]);
  }
  size_t count = model_site_count(model), unknown = 0;
#pragma omp parallel for schedule(static) reduction(+ : grains, unknown)
  for (size_t i = 0; i < count; i++) {
    grains += model->solid[i];
    unknown += model->solid[i] > 1;
  }
  for (size_t i = 0; i < count && unknown > 0; i++)
    if (model->solid[i] > 1)
      TRY_FAIL(STATUS_INPUT, "%s: /model/solid holds %d; only 0 (pore) and 1 (grain) are possible",
               path, model->solid[i]);
  if (!h5_attribute_exists(file, "/model", "spacing"))
    TRY_FAIL(STATUS_INPUT, "%s: /model has no attribute 'spacing' (m; z, y, x)", path);
  TRY(h5_read_attribute(file, "/model", "spacing", H5_F64, 3, spacing));
  if (h5_attribute_exists(file, "/model", "periodic"))
    TRY(h5_read_attribute(file, "/model", "periodic", H5_I32, 3, periodic));
  if (h5_attribute_exists(file, "/model", "mirror_plane"))
    TRY(h5_read_attribute(file, "/model", "mirror_plane", H5_I32, 1, &model->mirror_plane));
  for (int a = 0; a < 3; a++) {
    model->spacing[a] = spacing[2 - a];
    model->periodic[a] = periodic[2 - a] != 0;
    if (periodic[a] != 0 && periodic[a] != 1)
      TRY_FAIL(STATUS_INPUT, "%s: /model: periodic holds %d; 0 and 1 are possible", path,
               periodic[a]);
    if (!(spacing[a] > 0 && spacing[a] < 1e3))
      TRY_FAIL(STATUS_INPUT, "%s: spacing %g m: metres, greater than 0, are wanted", path,
               spacing[a]);
  }
  TRY(read_optional_number(file, "void_ratio_measured", 0.0, 1e4, &model->void_ratio_measured));
  TRY(read_optional_number(file, "threshold", -FLT_MAX, FLT_MAX, &model->threshold));
  /* Counted rather than read: the attribute is informative only and may belong to another model. */
  model->void_ratio = grains > 0 ? (double)(count - grains) / (double)grains : INFINITY;
  TRY(read_optional_field(file, "/model/micro_porosity", model, 0, 1, &model->micro_porosity));
  TRY(read_optional_field(file, "/model/micro_permeability", model, 0, 1,
                          &model->micro_permeability));
  TRY(check_micro(path, model));
  if (model->micro_porosity != NULL) {
    const double n = model_porosity(model);
    model->void_ratio = n / (1.0 - n);
  }
  TRY(read_optional_field(file, "/model/wall_distance", model, -1e6, 1e6, &model->wall_distance));
  if (model->wall_distance != NULL) TRY(check_distances(path, model, grains));
  TRY(read_optional_field(file, "/model/grain_fraction", model, 0, 1, &model->grain_fraction));
cleanup:
  h5_close(file);
  if (status != STATUS_OK) model_free(model);
  return status;
}

double model_void_ratio_error(struct h5_file *file) {
  const double told = h5_attribute_or_nan(file, "/model", "void_ratio_error");
  if (isfinite(told)) return told;
  return h5_attribute_or_nan(file, "/model", "void_ratio") -
         h5_attribute_or_nan(file, "/model", "void_ratio_measured");
}

enum status model_write(struct h5_file *file, const struct voxel_model *model) {
  enum status status = STATUS_OK;
  size_t dims[3] = {model->size[2], model->size[1], model->size[0]};
  double spacing[3] = {model->spacing[2], model->spacing[1], model->spacing[0]};
  int periodic[3] = {model->periodic[2], model->periodic[1], model->periodic[0]};
  TRY(h5_write(file, "/model/solid", H5_U8, 3, dims, model->solid, true));
  if (model->wall_distance != NULL)
    TRY(h5_write(file, "/model/wall_distance", H5_F32, 3, dims, model->wall_distance, true));
  if (model->grain_fraction != NULL)
    TRY(h5_write(file, "/model/grain_fraction", H5_F32, 3, dims, model->grain_fraction, true));
  if (model->micro_porosity != NULL) {
    TRY(h5_write(file, "/model/micro_porosity", H5_F32, 3, dims, model->micro_porosity, true));
    TRY(h5_write(file, "/model/micro_permeability", H5_F32, 3, dims, model->micro_permeability,
                 true));
  }
  TRY(h5_write_attribute(file, "/model", "spacing", H5_F64, 3, spacing));
  TRY(h5_write_attribute(file, "/model", "periodic", H5_I32, 3, periodic));
  TRY(h5_write_attribute(file, "/model", "mirror_plane", H5_I32, 1, &model->mirror_plane));
  TRY(h5_write_attribute(file, "/model", "void_ratio", H5_F64, 1, &model->void_ratio));
  TRY(h5_write_attribute(file, "/model", "void_ratio_measured", H5_F64, 1,
                         &model->void_ratio_measured));
  TRY(h5_write_attribute(file, "/model", "threshold", H5_F64, 1, &model->threshold));

  /* A point at each voxel centre. */
  double origin[3] = {model->spacing[0] / 2, model->spacing[1] / 2, model->spacing[2] / 2};
  TRY(image_file_begin(file, model->size, model->spacing, origin));
  TRY(h5_soft_link(file, "/model/solid", "/VTKHDF/PointData/solid"));
  if (model->wall_distance != NULL)
    TRY(h5_soft_link(file, "/model/wall_distance", "/VTKHDF/PointData/wall_distance"));
  if (model->grain_fraction != NULL)
    TRY(h5_soft_link(file, "/model/grain_fraction", "/VTKHDF/PointData/grain_fraction"));
  if (model->micro_porosity != NULL) {
    TRY(h5_soft_link(file, "/model/micro_porosity", "/VTKHDF/PointData/micro_porosity"));
    TRY(h5_soft_link(file, "/model/micro_permeability", "/VTKHDF/PointData/micro_permeability"));
  }
cleanup:
  return status;
}
