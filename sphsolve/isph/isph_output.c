#include "sphsolve/isph/isph_output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/isph_kernel.h"
#include "sphsolve/isph/isph_ranks.h"

static double domain_volume(const struct isph *s) {
  return (s->high[0] - s->low[0]) * (s->high[1] - s->low[1]) * (s->high[2] - s->low[2]);
}

void isph_darcy_velocity(const struct isph *s, double velocity[3]) {
  velocity[0] = velocity[1] = velocity[2] = 0;
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a++) velocity[a] += s->volume[i] * s->velocity[i][a];
  for (int a = 0; a < 3; a++) velocity[a] *= s->thickness / domain_volume(s);
}

double isph_reynolds(const struct isph *s, const double velocity[3]) {
  double grain = 0;
  for (size_t k = 0; k < s->scene->region_count; k++)
    if (s->scene->regions[k].type == REGION_POROUS)
      grain = fmax(grain, s->scene->regions[k].grain_size);
  if (!(grain > 0) || !(s->viscosity > 0)) return NAN;
  return sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]) *
         grain / s->viscosity;
}

/* Solves the n x n system m x = b in place by Gauss elimination with pivoting; false if singular.
 */
static bool solve_small(int n, double m[4][4], double b[4]) {
  for (int c = 0; c < n; c++) {
    int pivot = c;
    for (int r = c + 1; r < n; r++)
      if (fabs(m[r][c]) > fabs(m[pivot][c])) pivot = r;
    if (!(fabs(m[pivot][c]) > 1e-6)) return false;
    for (int k = 0; k < n; k++) {
      double swap = m[c][k];
      m[c][k] = m[pivot][k], m[pivot][k] = swap;
    }
    double swap = b[c];
    b[c] = b[pivot], b[pivot] = swap;
    for (int r = c + 1; r < n; r++) {
      double f = m[r][c] / m[c][c];
      for (int k = c; k < n; k++) m[r][k] -= f * m[c][k];
      b[r] -= f * b[c];
    }
  }
  for (int c = n - 1; c >= 0; c--) {
    for (int k = c + 1; k < n; k++) b[c] -= m[c][k] * b[k];
    b[c] /= m[c][c];
  }
  return true;
}

/* Separation of x from the nearest image of particle i, in units of its support; r < 1 counts. */
static double scaled_separation(const struct isph *s, size_t i, const double point[3],
                                double r[3]) {
  double square = 0;
  for (int a = 0; a < 3; a++) {
    r[a] = s->position[i][a] - point[a];
    if (s->dimensions == 2 && a == 1) r[a] = 0;
    if (s->periodic[a]) {
      double length = s->high[a] - s->low[a];
      r[a] -= length * round(r[a] / length);
    }
    r[a] /= s->support[i];
    square += r[a] * r[a];
  }
  return sqrt(square);
}

double isph_pressure_at(const struct isph *s, const double point[3]) {
  double m[4][4] = {{0}}, b[4] = {0}, sum = 0, sum_p = 0, filled = 0;
  int axis[3] = {0, s->dimensions == 3 ? 1 : 2, 2}, n = s->dimensions == 3 ? 4 : 3;
  for (size_t i = 0; i < s->count; i++) {
    double r[3], w, slope, length = scaled_separation(s, i, point, r);
    if (length >= 1) continue;
    isph_kernel(s->scene->isph.kernel, s->dimensions, length, 1, &w, &slope);
    double basis[4] = {1, r[axis[0]], r[axis[1]], r[axis[2]]};
    for (int p = 0; p < n; p++) {
      b[p] += w * basis[p] * s->pressure[i];
      for (int q = 0; q < n; q++) m[p][q] += w * basis[p] * basis[q];
    }
    sum += w, sum_p += w * s->pressure[i];
    filled += w * s->volume[i] / pow(s->support[i], s->dimensions);
  }
  if (filled < 0.1) return 0;
  for (int p = 0; p < n; p++) {
    b[p] /= sum;
    for (int q = 0; q < n; q++) m[p][q] /= sum;
  }
  return solve_small(n, m, b) ? b[0] : sum_p / sum;
}

/* The part of the kernel that reaches beyond a side of the domain is made up for. */
double isph_plane_flux(const struct isph *s, int axis, double position) {
  double flux = 0;
  for (size_t i = 0; i < s->count; i++) {
    double r = s->position[i][axis] - position, length = s->high[axis] - s->low[axis];
    double h = 0.5 * s->support[i], within = 1;
    if (s->periodic[axis])
      r -= length * round(r / length);
    else
      within = kernel_integral((s->high[axis] - position) / h) -
               kernel_integral((s->low[axis] - position) / h);
    flux += s->volume[i] * s->velocity[i][axis] * kernel_w(KERNEL_CUBIC, 1, fabs(r), h) /
            fmax(within, 0.5);
  }
  return flux * s->thickness;
}

enum status isph_add_columns(const struct isph *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  char name[64];
  TRY(recorder_add_column(recorder, "potential_energy", "J", 1));
  TRY(recorder_add_column(recorder, "velocity_rms", "m/s", 1));
  TRY(recorder_add_column(recorder, "front_low", "m", 3));
  TRY(recorder_add_column(recorder, "front_high", "m", 3));
  TRY(recorder_add_column(recorder, "iterations", "1", 1));
  TRY(recorder_add_column(recorder, "particles", "1", 1));
  for (int t = 0; t < LEDGER_TERMS; t++) {
    if (!ledger_is_on(&s->account, t)) continue;
    snprintf(name, sizeof name, "work_%s", ledger_name(t));
    TRY(recorder_add_column(recorder, name, "J", 1));
  }
  for (size_t k = 0; k < s->scene->region_count; k++) {
    static const char *const kinds[] = {"water", "porous", "wall", "inflow", "empty"};
    snprintf(name, sizeof name, "volume_in_region_%zu_%s", k + 1, kinds[s->scene->regions[k].type]);
    TRY(recorder_add_column(recorder, name, "m^3", 1));
  }
  for (size_t k = 0; k < s->scene->gauge_count; k++) {
    snprintf(name, sizeof name, "pressure_%s", s->scene->gauges[k].name);
    TRY(recorder_add_column(recorder, name, "Pa", 1));
  }
  for (size_t k = 0; k < s->scene->plane_count; k++) {
    snprintf(name, sizeof name, "flux_%s", s->scene->planes[k].name);
    TRY(recorder_add_column(recorder, name, "m^3/s", 1));
  }
cleanup:
  return status;
}

/* Volume of water (not of bulk) in a region's box, where its soil is now. A particle counts by as
 * much of it, a cube of its bulk volume, as is inside; water at a side of the domain is inside of
 * what touches that side. (By its middle alone, whole rows come and go: .04 of the water in a tank
 * 12 particles across.) */
static double volume_in_region(const struct isph *s, size_t k) {
  const struct region *region = &s->scene->regions[k];
  double volume = 0, near = 1e-6 * s->spacing;
  for (size_t i = 0; i < s->count; i++) {
    double size = s->dimensions == 3 ? cbrt(s->volume[i]) : sqrt(s->volume[i]), inside = 1;
    for (int a = 0; a < 3; a++) {
      if (s->dimensions == 2 && a == 1) continue;
      double low = region->box[a], high = region->box[a + 3];
      double x = s->position[i][a] - s->soil_offset[k][a];
      double from = low <= s->low[a] + near ? -INFINITY : low,
             to = high >= s->high[a] - near ? INFINITY : high;
      inside *= fmax(0, fmin(x + 0.5 * size, to) - fmax(x - 0.5 * size, from)) / size;
    }
    volume += inside * s->mass[i] / s->density;
  }
  return volume * s->thickness;
}

enum status isph_write_row(const struct isph *s, struct recorder *recorder, double dt) {
  struct history_row row = {.time = s->time, .step = s->step, .dt = dt};
  double *extra = NULL, squares = 0, potential = 0;
  size_t n = 12 + LEDGER_TERMS + s->scene->region_count + s->scene->gauge_count + s->scene->plane_count, c = 0;
  enum status status = memory_allocate(&extra, n, sizeof *extra, "a row of the history");
  if (status != STATUS_OK) return status;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  double filling = 0, most = 0;
  for (size_t i = 0; i < s->count; i++) {
    const double *x = s->position[i], *v = s->velocity[i];
    double eps = s->porosity != NULL ? s->porosity[i] : 1, square = 0;
    double size = s->dimensions == 3 ? cbrt(s->volume[i]) : sqrt(s->volume[i]);
    row.mass += s->mass[i];
    for (int a = 0; a < 3; a++) {
      double pore = v[a] / eps;
      square += pore * pore;
      row.momentum[a] += s->mass[i] * pore;
      potential -= s->mass[i] * s->force[a] * x[a];
      low[a] = fmin(low[a], x[a] - 0.5 * size), high[a] = fmax(high[a], x[a] + 0.5 * size);
    }
    row.kinetic_energy += 0.5 * s->mass[i] * square;
    squares += square;
    filling += s->filling[i];
    most = fmax(most, s->filling[i]);
  }
  double scale = s->thickness, count = (double)(s->count > 0 ? s->count : 1);
  row.mass *= scale, row.kinetic_energy *= scale;
  for (int a = 0; a < 3; a++) row.momentum[a] *= scale;
  row.density_max = s->density * most;
  row.density_mean = s->density * filling / count;
  isph_darcy_velocity(s, row.darcy_velocity);
  row.reynolds = isph_reynolds(s, row.darcy_velocity);
  extra[c++] = potential * scale;
  extra[c++] = sqrt(squares / count);
  for (int a = 0; a < 3; a++) extra[c++] = low[a];
  for (int a = 0; a < 3; a++) extra[c++] = high[a];
  extra[c++] = s->solve.iterations;
  extra[c++] = (double)s->count;
  for (int t = 0; t < LEDGER_TERMS; t++)
    if (ledger_is_on(&s->account, t)) extra[c++] = s->account.sums.work[t];
  for (size_t k = 0; k < s->scene->region_count; k++) extra[c++] = volume_in_region(s, k);
  for (size_t k = 0; k < s->scene->gauge_count; k++)
    extra[c++] = isph_pressure_at(s, s->scene->gauges[k].at);
  for (size_t k = 0; k < s->scene->plane_count; k++)
    extra[c++] = isph_plane_flux(s, s->scene->planes[k].axis, s->scene->planes[k].position);
  status = recorder_row(recorder, &row, extra);
  memory_free(&extra);
  return status;
}

/* In the order of the particles' numbers, so that snapshots can be compared line by line; each rank
 * writes a run of lines. */
enum status isph_write_snapshot(const struct isph *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  const size_t first = s->count * own / ranks, n = s->count * (own + 1) / ranks - first;
  double(*points)[3] = NULL, (*velocity)[3] = NULL, *pressure = NULL, *density = NULL;
  double *porosity = NULL, *surface = NULL, *volume = NULL;
  uint64_t *id = NULL;
  uint32_t *place = NULL;
  if (s->on.surface) isph_gather(s, s->surface);
  TRY(memory_allocate(&points, n, sizeof *points, "a snapshot"));
  TRY(memory_allocate(&velocity, n, sizeof *velocity, "a snapshot"));
  TRY(memory_allocate(&pressure, n, sizeof *pressure, "a snapshot"));
  TRY(memory_allocate(&density, n, sizeof *density, "a snapshot"));
  TRY(memory_allocate(&porosity, n, sizeof *porosity, "a snapshot"));
  TRY(memory_allocate(&surface, n, sizeof *surface, "a snapshot"));
  TRY(memory_allocate(&volume, n, sizeof *volume, "a snapshot"));
  TRY(memory_allocate(&id, n, sizeof *id, "a snapshot"));
  TRY(memory_allocate(&place, s->next_id, sizeof *place, "a snapshot"));
  for (size_t i = 0; i < s->count; i++) place[s->id[i]] = (uint32_t)i + 1;
  size_t line = 0;
  for (uint64_t number = 0; number < s->next_id; number++) {
    if (place[number] == 0 || line++ < first || line > first + n) continue;
    size_t i = place[number] - 1, k = line - 1 - first;
    memcpy(points[k], s->position[i], sizeof *points);
    memcpy(velocity[k], s->velocity[i], sizeof *velocity);
    pressure[k] = s->pressure[i];
    density[k] = s->density * s->filling[i];
    porosity[k] = s->porosity != NULL ? s->porosity[i] : 1;
    surface[k] = s->surface != NULL ? s->surface[i] : 0;
    volume[k] = s->volume[i] * s->thickness;
    id[k] = number;
  }
  struct snapshot_field fields[] = {
      {"velocity", "m/s", "Darcy velocity", H5_F64, 3, velocity, NULL, NULL},
      {"pressure", "Pa", "pressure", H5_F64, 1, pressure, NULL, NULL},
      {"density", "kg/m^3", "water density times filling, sum of V W", H5_F64, 1, density, NULL, NULL},
      {"porosity", "1", "porosity at the particle", H5_F64, 1, porosity, NULL, NULL},
      {"surface", "1", "0 inside, 1 at the free surface", H5_F64, 1, surface, NULL, NULL},
      {"volume", "m^3", "bulk volume", H5_F64, 1, volume, NULL, NULL},
      {"id", "1", "number of the particle", H5_U64, 1, id, NULL, NULL}};
  const struct snapshot_field at = {.type = H5_F64, .components = 3, .data = points};
  TRY(recorder_snapshot(recorder, s->time, s->step, n, &at, sizeof fields / sizeof *fields,
                        fields));
cleanup:
  memory_free(&points);
  memory_free(&velocity);
  memory_free(&pressure);
  memory_free(&density);
  memory_free(&porosity);
  memory_free(&surface);
  memory_free(&volume);
  memory_free(&id);
  memory_free(&place);
  return status;
}

enum status isph_write_checkpoint(const struct isph *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  const size_t first = s->share.begin, own = s->share.end - first;
  size_t vectors[2] = {own, 3}, regions[2] = {s->scene->region_count, 3};
  size_t walls[2] = {s->boundary_count, 3};
  TRY(recorder_checkpoint_begin(recorder, &file));
  TRY(h5_write_share(file, "/state/position", H5_F64, 2, vectors, s->position + first, true));
  TRY(h5_write_share(file, "/state/velocity", H5_F64, 2, vectors, s->velocity + first, true));
  TRY(h5_write_share(file, "/state/pressure", H5_F64, 1, &own, s->pressure + first, true));
  TRY(h5_write_share(file, "/state/mass", H5_F64, 1, &own, s->mass + first, true));
  TRY(h5_write_share(file, "/state/id", H5_U64, 1, &own, s->id + first, true));
  TRY(h5_write(file, "/state/soil_offset", H5_F64, 2, regions, s->soil_offset, false));
  if (s->boundary_count > 0)
    TRY(h5_write(file, "/state/wall_position", H5_F64, 2, walls, s->boundary_position, true));
  if (s->column_count > 0)
    TRY(h5_write(file, "/state/column_front", H5_F64, 1, &s->column_count, s->column_front, false));
  double boxes[6];
  for (size_t b = 1; b < s->wall_box_count; b++) {
    char name[64];
    size_t six = 6;
    memcpy(boxes, s->wall_boxes[b].low, 3 * sizeof *boxes);
    memcpy(boxes + 3, s->wall_boxes[b].high, 3 * sizeof *boxes);
    snprintf(name, sizeof name, "/state/box_%zu", b);
    TRY(h5_write(file, name, H5_F64, 1, &six, boxes, false));
  }
  double numbers[] = {s->time, s->lost_mass, s->left_mass, s->entered_mass, s->thickest};
  int64_t counts[] = {s->step, (int64_t)s->next_id, (int64_t)s->lost_count, (int64_t)s->left_count,
                      (int64_t)s->entered_count};
  TRY(h5_write_attribute(file, "/state", "numbers", H5_F64, 5, numbers));
  TRY(h5_write_attribute(file, "/state", "counts", H5_I64, 5, counts));
  size_t losses[2] = {LEDGER_LOSSES, 6};
  TRY(h5_write(file, "/state/losses", H5_F64, 2, losses, s->losses, true));
  TRY(ledger_account_write(&s->account, sizeof s->account, file, "/state/account"));
  double dog[] = {s->dog.halvings, s->dog.trip_time, (double)s->calm_from};
  double solve[] = {s->solve.iterations, s->solve.iterations_total, s->solve.solves,
                    s->solve.residual};
  TRY(h5_write_attribute(file, "/state", "solve", H5_F64, 4, solve));
  TRY(h5_write_attribute(file, "/state", "settling", H5_F64, 4, &s->settling));
  TRY(h5_write_attribute(file, "/state", "watchdog", H5_F64, 3, dog));
  status = recorder_checkpoint_commit(recorder, file); /* takes the file over */
  file = NULL;
cleanup:
  h5_close(file);
  return status;
}

/* Reads a dataset of `count` rows of `width` numbers into an array that is there already. */
static enum status read_into(struct h5_file *file, const char *name, enum h5_type type,
                             size_t count, size_t width, void *to) {
  enum status status = STATUS_OK;
  size_t dims[2] = {0, 1};
  void *data = NULL;
  TRY(h5_read(file, name, type, width > 1 ? 2 : 1, dims, &data));
  if (dims[0] != count || dims[1] != width)
    TRY_FAIL(STATUS_INPUT, "%s: %s is of another scene; remove the file to start anew",
             h5_path(file), name);
  if (count > 0) memcpy(to, data, count * width * h5_type_size(type));
cleanup:
  memory_free(&data);
  return status;
}

enum status isph_read_checkpoint(struct isph *s, struct h5_file *file) {
  enum status status = STATUS_OK;
  size_t dims[2];
  int rank;
  double numbers[5], dog[3], solve[4];
  int64_t counts[5];
  TRY(h5_shape(file, "/state/position", 2, &rank, dims));
  if (rank != 2 || dims[1] != 3) TRY_FAIL(STATUS_INPUT, "%s: is damaged", h5_path(file));
  TRY(isph_reserve(s, dims[0]));
  s->count = dims[0];
  TRY(read_into(file, "/state/position", H5_F64, s->count, 3, s->position));
  TRY(read_into(file, "/state/velocity", H5_F64, s->count, 3, s->velocity));
  TRY(read_into(file, "/state/pressure", H5_F64, s->count, 1, s->pressure));
  TRY(read_into(file, "/state/mass", H5_F64, s->count, 1, s->mass));
  TRY(read_into(file, "/state/id", H5_U64, s->count, 1, s->id));
  TRY(read_into(file, "/state/soil_offset", H5_F64, s->scene->region_count, 3, s->soil_offset));
  if (s->boundary_count > 0)
    TRY(read_into(file, "/state/wall_position", H5_F64, s->boundary_count, 3,
                  s->boundary_position));
  if (s->column_count > 0)
    TRY(read_into(file, "/state/column_front", H5_F64, s->column_count, 1, s->column_front));
  for (size_t b = 1; b < s->wall_box_count; b++) {
    char name[64];
    double box[6];
    snprintf(name, sizeof name, "/state/box_%zu", b);
    TRY(read_into(file, name, H5_F64, 6, 1, box));
    memcpy(s->wall_boxes[b].low, box, 3 * sizeof *box);
    memcpy(s->wall_boxes[b].high, box + 3, 3 * sizeof *box);
  }
  TRY(h5_read_attribute(file, "/state", "numbers", H5_F64, 5, numbers));
  TRY(h5_read_attribute(file, "/state", "counts", H5_I64, 5, counts));
  TRY(h5_read_attribute(file, "/state", "watchdog", H5_F64, 3, dog));
  TRY(h5_read_attribute(file, "/state", "solve", H5_F64, 4, solve));
  TRY(h5_read_attribute(file, "/state", "settling", H5_F64, 4, &s->settling));
  s->dog.halvings = (int)dog[0], s->dog.trip_time = dog[1], s->calm_from = (int64_t)dog[2];
  s->solve.iterations = (int)solve[0], s->solve.iterations_total = (int)solve[1];
  s->solve.solves = (int)solve[2], s->solve.residual = solve[3];
  s->time = numbers[0], s->lost_mass = numbers[1], s->left_mass = numbers[2];
  s->entered_mass = numbers[3], s->thickest = numbers[4];
  s->step = counts[0], s->next_id = (uint64_t)counts[1], s->lost_count = (size_t)counts[2];
  s->left_count = (size_t)counts[3], s->entered_count = (size_t)counts[4];
  TRY(read_into(file, "/state/losses", H5_F64, LEDGER_LOSSES, 6, s->losses));
  isph_wall_move(s, 0);
  TRY(isph_sort_walls(s));
  TRY(isph_refresh(s));
  TRY(ledger_account_read(&s->account, sizeof s->account, file, "/state/account"));
cleanup:
  return status;
}
