#include "sphsolve/output/tensor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/json_number.h"
#include "common/memory.h"
#include "common/units.h"

/* Sweeps of Jacobi's method; a 3 x 3 matrix needs about five for machine precision. */
#define SWEEPS 12
/* In spacings: wall distances of mirrored sites may differ by rounding. */
#define MIRROR_TOLERANCE 1e-4

/* Relative to the largest principal value: smaller values are rounding errors. */
#define ROUNDING 1e-10

/* Mirror image of site `at` across `axis`. */
static size_t image(const struct lattice *l, const size_t at[3], int axis) {
  size_t to[3] = {at[0], at[1], at[2]};
  to[axis] = l->size[axis] - 1 - at[axis];
  return (to[2] * l->size[1] + to[1]) * l->size[0] + to[0];
}

static bool is_mirrored(const struct lattice *l, int axis) {
  const double slack = MIRROR_TOLERANCE * l->spacing[axis];
  for (size_t site = 0; site < l->count; site++) {
    const size_t at[3] = {site % l->size[0], site / l->size[0] % l->size[1],
                          site / l->size[0] / l->size[1]};
    const size_t other = image(l, at, axis);
    if (l->kind[site] != l->kind[other]) return false;
    if (l->wall_distance != NULL &&
        fabs((double)l->wall_distance[site] - (double)l->wall_distance[other]) > slack)
      return false;
  }
  return true;
}

void tensor_find_mirror(const struct lattice *lattice, int axis, struct tensor *tensor) {
  tensor->voxel = cbrt(lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2]);
  tensor->mirrored[axis] = is_mirrored(lattice, axis);
  tensor->by_run[axis] = lattice->model.mirrored[axis];
}

/* Eigenvalues and unit vectors (rows) of a symmetric matrix, largest first (Jacobi 1846). */
static void principal(const double matrix[3][3], double values[3], double axes[3][3]) {
  double m[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  memcpy(m, matrix, sizeof m);
  for (int sweep = 0; sweep < SWEEPS; sweep++)
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++) {
        if (m[p][q] == 0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
        const double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int i = 0; i < 3; i++) {
          const double a = m[i][p], b = m[i][q];
          m[i][p] = c * a - s * b, m[i][q] = s * a + c * b;
        }
        for (int i = 0; i < 3; i++) {
          const double a = m[p][i], b = m[q][i], x = v[p][i], y = v[q][i];
          m[p][i] = c * a - s * b, m[q][i] = s * a + c * b;
          v[p][i] = c * x - s * y, v[q][i] = s * x + c * y;
        }
      }
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++)
    for (int j = i + 1; j < 3; j++)
      if (m[order[j]][order[j]] > m[order[i]][order[i]]) {
        const int swap = order[i];
        order[i] = order[j], order[j] = swap;
      }
  for (int i = 0; i < 3; i++) {
    const double *axis = v[order[i]];
    int longest = 0;
    for (int a = 1; a < 3; a++)
      if (fabs(axis[a]) > fabs(axis[longest]) + 1e-12) longest = a;
    values[i] = m[order[i]][order[i]];
    for (int a = 0; a < 3; a++) axes[i][a] = (axis[longest] < 0 ? -axis[a] : axis[a]) + 0.0;
  }
}

/* Error of a principal value, to first order dk_p = sum a_i a_j dk_ij: the errors of the diagonal
 * have a common cause and are added; those off it are treated as independent. */
static double principal_error(const double axis[3], double error[3][3]) {
  double together = 0, apart = 0;
  for (int i = 0; i < 3; i++) {
    together += axis[i] * axis[i] * error[i][i];
    for (int j = i + 1; j < 3; j++)
      apart += pow(2 * axis[i] * axis[j] * fmax(error[i][j], error[j][i]), 2);
  }
  return sqrt(together * together + apart);
}

static void assemble(struct tensor *t) {
  double down[3][3], up[3][3], mean = 0, gap = NAN;
  for (int i = 0; i < 3; i++) mean += t->columns[i].velocity[i] / 3;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const struct tensor_column *a = &t->columns[i], *b = &t->columns[j];
      const bool zero = i != j && (t->mirrored[i] || t->mirrored[j]);
      const double ij = b->velocity[i], ji = a->velocity[j];
      /* adding 0 avoids -0; a diagonal term is at least 0, also along a direction without a path */
      t->k[i][j] = zero ? 0 : (i == j ? fmax(0, ij) : 0.5 * (ij + ji)) + 0.0;
      down[i][j] = i == j ? b->low * fabs(ij) : 0;
      up[i][j] = i == j ? b->high * fabs(ij) : 0;
      if (i != j && !zero) {
        /* On one lattice both terms are equal (Onsager 1931): their difference is an error. */
        const double own = fabs(b->finest * ij - a->finest * ji);
        gap = fmax(isnan(gap) ? 0 : gap, own / mean);
        const double relative = fmax(fmax(a->low, b->low), fmax(a->high, b->high));
        down[i][j] = up[i][j] = hypot(relative * fabs(t->k[i][j]), 0.5 * fabs(ij - ji));
      }
      t->low[i][j] = t->k[i][j] - down[i][j];
      t->high[i][j] = t->k[i][j] + up[i][j];
    }
  t->asymmetry = mean > 0 ? gap : NAN;
  principal((const double(*)[3])t->k, t->principal, t->axes);
  for (int p = 0; p < 3; p++) {
    /* Dissipation is positive: negative values, and rounding errors of the largest one, are set to
     * 0. */
    if (t->principal[p] < ROUNDING * t->principal[0]) t->principal[p] = 0;
    t->principal_low[p] = fmax(0, t->principal[p] - principal_error(t->axes[p], down));
    t->principal_high[p] = t->principal[p] + principal_error(t->axes[p], up);
  }
  t->isotropic = t->principal_low[0] <= t->principal_high[2];
}

bool tensor_complete(const struct tensor *tensor) {
  return *tensor->columns[0].path && *tensor->columns[1].path && *tensor->columns[2].path;
}

static void finish_column(const char *prefix, struct tensor *tensor, struct tensor_column *column) {
  snprintf(column->path, sizeof column->path, "%s.hdf", prefix);
  if (tensor_complete(tensor)) assemble(tensor);
}

void tensor_set_column(const struct scene *scene, const double darcy_velocity[3],
                       const struct uncertainty *error, double finest, int axis, const char *prefix,
                       struct tensor *tensor) {
  struct tensor_column *column = &tensor->columns[axis];
  const double gradient = copysign(scene_hydraulic_gradient(scene), scene->driving[axis]);
  for (int a = 0; a < 3; a++) column->velocity[a] = darcy_velocity[a] / gradient;
  uncertainty_total(error, &column->low, &column->high);
  if (isnan(column->low)) column->low = column->high = 0;
  column->finest = finest > 0 ? finest : 1;
  /* nu / g of the scene's fluid. */
  tensor->to_area = scene->fluid.viscosity / scene->fluid.density *
                    scene_hydraulic_gradient(scene) / fabs(scene->driving[axis]);
  finish_column(prefix, tensor, column);
}

/* Whether a record is that of a finished run of this scene and model, on these sites; or, with
 * `wanted`, one whose k has the wanted error, whatever was requested. */
static bool is_finished(struct h5_file *file, const struct scene *scene,
                        const struct lattice *lattice, double wanted) {
  uint64_t size[3] = {0};
  char *text = NULL, *state = NULL, *hash = NULL, of_model[17];
  snprintf(of_model, sizeof of_model, "%016llx", (unsigned long long)lattice->model.hash);
  bool same = h5_exists(file, "/run/scene") &&
              h5_read_text(file, "/run/scene", &text) == STATUS_OK &&
              h5_read_attribute_text(file, "/run", "status", &state) == STATUS_OK &&
              h5_read_attribute_text(file, "/run", "model_hash", &hash) == STATUS_OK &&
              !strcmp(text, scene->text) && !strcmp(hash, of_model) &&
              (!strcmp(state, "converged") || !strcmp(state, "steady") ||
               !strcmp(state, "blocked") || (wanted > 0 && !strcmp(state, "budget")));
  const bool blocked = same && !strcmp(state, "blocked");
  MEMORY_FREE(&text, &state, &hash);
  if (!same) return false;
  int32_t mirrored[3] = {0};
  if (h5_attribute_exists(file, "/run", "mirrored") &&
      h5_read_attribute(file, "/run", "mirrored", H5_I32, 3, mirrored) != STATUS_OK)
    return false;
  for (int a = 0; a < 3; a++)
    if ((mirrored[a] != 0) != lattice->model.mirrored[a]) return false;
  if (wanted > 0) return blocked || h5_attribute_or_nan(file, "/run/error", "total") <= wanted;
  return h5_read_attribute(file, "/run", "size", H5_U64, 3, size) == STATUS_OK &&
         size[0] == lattice->size[0] && size[1] == lattice->size[1] && size[2] == lattice->size[2];
}

bool tensor_read_column(const struct scene *scene, const struct lattice *lattice, double wanted,
                        const char *prefix, int axis, struct tensor *tensor) {
  struct h5_file *file = NULL;
  const struct uncertainty unknown = uncertainty_none();
  double velocity[3];
  char path[4104];
  bool found = false;
  snprintf(path, sizeof path, "%s.hdf", prefix);
  if (access(path, R_OK) != 0) return false;
  if (h5_open_output(path, &file) == STATUS_OK && is_finished(file, scene, lattice, wanted)) {
    struct tensor_column *column = &tensor->columns[axis];
    found = h5_read_attribute(file, "/run", "darcy_velocity", H5_F64, 3, velocity) == STATUS_OK;
    if (found) {
      const double k = h5_attribute_or_nan(file, "/run", "k");
      tensor_set_column(scene, velocity, &unknown,
                        h5_attribute_or_nan(file, "/run", "k_finest") / k, axis, prefix, tensor);
      column->low = fmax(0, h5_attribute_or_nan(file, "/run/error", "total_low"));
      column->high = fmax(0, h5_attribute_or_nan(file, "/run/error", "total_high"));
    }
  }
  error_clear();
  h5_close(file);
  return found;
}

static const struct {
  const char *name;
  double per;      /* units per m/s, or per m^2 */
  bool area;       /* intrinsic permeability */
  const char *key; /* key in JSON */
} units[] = {{"cm/s", 100, false, "k_cm_per_s"},
             {"m/s", 1, false, "k_m_per_s"},
             {"m^2", 1, true, "permeability_m2"},
             {"darcy", 1 / DARCY, true, "permeability_darcy"},
             {"voxel^2", 0, true, "permeability_voxel2"}};
enum { UNITS = sizeof units / sizeof *units };

static double in_unit(const struct tensor *t, size_t u, double k) {
  const double per = units[u].per > 0 ? units[u].per : 1 / (t->voxel * t->voxel);
  return k * per * (units[u].area ? t->to_area : 1);
}

/* "x, y" */
static void list_axes(const bool axes[3], char text[16]) {
  text[0] = '\0';
  for (int a = 0; a < 3; a++)
    if (axes[a]) sprintf(text + strlen(text), "%s%c", *text ? ", " : "", "xyz"[a]);
}

static void print_symmetry(const struct tensor *t) {
  char axes[16], wrapped[16], by_run[16], text[32];
  const bool wraps[3] = {!t->mirrored[0], !t->mirrored[1], !t->mirrored[2]};
  list_axes(t->mirrored, axes);
  list_axes(wraps, wrapped);
  list_axes(t->by_run, by_run);
  if (*axes) {
    const int count = t->mirrored[0] + t->mirrored[1] + t->mirrored[2];
    printf("           %s its own mirror image along %s: %s are zero by symmetry\n",
           *by_run ? "each direction's sample is" : "the model is", axes,
           count > 1 ? "all terms off the diagonal" : "the terms off the diagonal with it");
    if (*by_run)
      printf("           along %s by this run, as pores do not meet where the model wraps round\n",
             by_run);
    if (*wrapped)
      printf("           along %s it wraps round: unless the sample repeats itself there, the jump "
             "at its\n"
             "           sides is part of k; ct2model build --sides mirrored mirrors all axes\n",
             wrapped);
  }
  if (isfinite(t->asymmetry))
    printf("           k_ij and k_ji differ by %s %% of the mean at most (Onsager: not at all)%s\n",
           percent_format(t->asymmetry, text),
           t->asymmetry > 0.01 ? "; solve to a smaller scene.steady_tolerance" : "");
}

void tensor_print(const struct tensor *t) {
  printf("tensor     k in cm/s; rows: flow along x, y, z; columns: gradient\n");
  for (int i = 0; i < 3; i++)
    printf("           %12.4g %12.4g %12.4g\n", 100 * t->k[i][0], 100 * t->k[i][1],
           100 * t->k[i][2]);
  print_symmetry(t);
  for (int p = 0; p < 3; p++) {
    printf("%s along (%.3f, %.3f, %.3f): ", p == 0 ? "principal " : "          ", t->axes[p][0],
           t->axes[p][1], t->axes[p][2]);
    for (size_t u = 0; u < UNITS; u++)
      if (u != 1)
        printf("%s%.4g %s", u > 0 ? ", " : "", in_unit(t, u, t->principal[p]), units[u].name);
    printf(" (%.4g to %.4g cm/s)\n", 100 * t->principal_low[p], 100 * t->principal_high[p]);
  }
  if (t->isotropic)
    printf("           no two of them differ by more than their errors: the axes mean little\n");
}

static json_t *matrix_json(const struct tensor *t, size_t u, const double k[3][3]) {
  json_t *rows = json_array();
  for (int i = 0; i < 3; i++)
    json_array_append_new(rows, json_pack("[f,f,f]", in_unit(t, u, k[i][0]), in_unit(t, u, k[i][1]),
                                          in_unit(t, u, k[i][2])));
  return rows;
}

json_t *tensor_json(const struct tensor *t) {
  json_t *object = json_object(), *zero = json_array(), *files = json_array(), *list = json_array();
  for (size_t u = 0; u < UNITS; u++)
    json_object_set_new(object, units[u].key, matrix_json(t, u, (const double(*)[3])t->k));
  json_object_set_new(object, "k_low_m_per_s", matrix_json(t, 1, (const double(*)[3])t->low));
  json_object_set_new(object, "k_high_m_per_s", matrix_json(t, 1, (const double(*)[3])t->high));
  json_put_number(object, "asymmetry", t->asymmetry);
  for (int p = 0; p < 3; p++) {
    json_t *one =
        json_pack("{s:[f,f,f], s:f, s:f}", "axis", t->axes[p][0], t->axes[p][1], t->axes[p][2],
                  "k_low_m_per_s", t->principal_low[p], "k_high_m_per_s", t->principal_high[p]);
    for (size_t u = 0; u < UNITS; u++)
      json_object_set_new(one, units[u].key, json_real(in_unit(t, u, t->principal[p])));
    json_array_append_new(list, one);
    if (t->mirrored[p]) json_array_append_new(zero, json_stringn(&"xyz"[p], 1));
    json_array_append_new(files, json_string(t->columns[p].path));
  }
  json_object_set_new(object, "principal", list);
  json_object_set_new(object, "isotropic_within_error", json_boolean(t->isotropic));
  json_object_set_new(object, "mirrored", zero);
  json_object_set_new(object, "files", files);
  return object;
}

enum status tensor_write(const struct tensor *t, struct h5_file *file) {
  enum status status = STATUS_OK;
  static const char group[] = "/run/tensor";
  const size_t square[2] = {3, 3}, line[1] = {3};
  double area[3][3];
  const char *paths[3];
  int mirrored[3];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) area[i][j] = t->to_area * t->k[i][j];
    const char *slash = strrchr(t->columns[i].path, '/');
    paths[i] = slash != NULL ? slash + 1 : t->columns[i].path;
    mirrored[i] = t->mirrored[i] ? t->by_run[i] ? 2 : 1 : 0;
  }
  const struct {
    const char *name, *unit;
    int rank;
    const void *data;
  } parts[] = {{"k", "m/s", 2, t->k},
               {"k_low", "m/s", 2, t->low},
               {"k_high", "m/s", 2, t->high},
               {"permeability", "m^2", 2, area},
               {"principal", "m/s", 1, t->principal},
               {"principal_low", "m/s", 1, t->principal_low},
               {"principal_high", "m/s", 1, t->principal_high},
               {"axes", "1", 2, t->axes}};
  TRY(h5_make_group(file, group));
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    char name[64];
    snprintf(name, sizeof name, "%s/%s", group, parts[i].name);
    TRY(h5_write(file, name, H5_F64, parts[i].rank, parts[i].rank == 2 ? square : line,
                 parts[i].data, false));
    TRY(h5_write_attribute_text(file, name, "unit", parts[i].unit));
  }
  TRY(h5_write_attribute(file, group, "asymmetry", H5_F64, 1, &t->asymmetry));
  TRY(h5_write_attribute(file, group, "voxel", H5_F64, 1, &t->voxel));
  TRY(h5_write_attribute(file, group, "mirrored", H5_I32, 3, mirrored));
  TRY(h5_write_texts(file, "/run/tensor/file", 3, paths));
cleanup:
  return status;
}
