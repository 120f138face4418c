#include "sphsolve/isph/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/wall_force.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/output/history_columns.h"
#include "sphsolve/plan/reynolds.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/particles.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/section.h"
#include "sphsolve/isph/wall.h"

static double domain_volume(const struct isph *s) {
  return (s->high[0] - s->low[0]) * (s->high[1] - s->low[1]) * (s->high[2] - s->low[2]);
}

/* At edges of soil the volume m/(eps rho) of a particle uses the porosity at its centre, so that
 * the sum of all volumes exceeds the room there is, by some tenths of a particle at each face.
 * Where water fills its room, the mean velocity is therefore that over the sum of volumes. */
void isph_darcy_velocity(const struct isph *s, double velocity[3]) {
  double sum[4];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double own[4] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      for (int a = 0; a < 3; a++) own[a] += s->volume[i] * s->velocity[i][a];
      own[3] += s->volume[i];
    }
    memcpy(s->sums[c], own, sizeof own);
  }
  isph_sum_chunks(s, 4, sum);
  const double counted = isph_fills_room(s) && sum[3] > 0 ? s->room / sum[3] : 1;
  for (int a = 0; a < 3; a++) velocity[a] = sum[a] * counted * s->thickness / domain_volume(s);
}

double isph_reynolds(const struct isph *s, const double velocity[3]) {
  return reynolds_of_soil(s->scene, s->kinematic_viscosity, velocity);
}

/* Volume of water (not bulk volume) in a region's box, where its soil is now. A particle, taken as
 * a cube of its bulk volume, counts by the part that is inside; where the box touches a side of the
 * domain, it extends beyond it. (Counting particles by their centres, whole rows would come and go:
 * .04 of the water in a tank 12 particles across.) */
static double volume_in_region(const struct isph *s, size_t k) {
  const struct region *region = &s->scene->regions[k];
  double volume, near = 1e-6 * s->spacing;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      double size = s->size[i], inside = 1;
      for (int a = 0; a < 3; a++) {
        if (s->dimensions == 2 && a == 1) continue;
        double low = region->box[a], high = region->box[a + 3];
        double x = s->position[i][a] - s->soil_offset[k][a];
        double from = low <= s->low[a] + near ? -INFINITY : low,
               to = high >= s->high[a] - near ? INFINITY : high;
        inside *= fmax(0, fmin(x + 0.5 * size, to) - fmax(x - 0.5 * size, from)) / size;
      }
      sum += inside * s->mass[i] / s->density;
    }
    s->sums[c][0] = sum;
  }
  isph_sum_chunks(s, 1, &volume);
  return volume * s->thickness;
}

/* Sums and extremes over all particles; the sums are in the order in which s->sums has them. */
struct whole {
  double mass, kinetic, potential, momentum[3], squares, kernel_sum; /* the sums */
  double extreme[7]; /* largest position, largest -position, largest kernel_sum */
};

static void sum_up(const struct isph *s, struct whole *whole) {
  double total[8], most[7];
  for (int k = 0; k < 7; k++) most[k] = -INFINITY;
#pragma omp parallel for schedule(static) reduction(max : most[:7])
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[8] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *x = s->position[i], *v = s->velocity[i], m = s->mass[i];
      double eps = s->porosity != NULL ? s->porosity[i] : 1, square = 0;
      double half = 0.5 * s->size[i];
      for (int a = 0; a < 3; a++) {
        double pore = v[a] / eps;
        square += pore * pore;
        sum[2] -= m * s->force[a] * x[a];
        sum[3 + a] += m * pore;
        most[a] = fmax(most[a], x[a] + half);
        most[3 + a] = fmax(most[3 + a], half - x[a]);
      }
      sum[0] += m;
      sum[1] += 0.5 * m * square;
      sum[6] += square;
      sum[7] += s->kernel_sum[i];
      most[6] = fmax(most[6], s->kernel_sum[i]);
    }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, 8, total);
  memcpy(whole, total, sizeof total);
  ranks_max_all(most, 7);
  memcpy(whole->extreme, most, sizeof most);
}

struct row {
  const struct isph *state;
  struct whole whole;
};

static void walk_columns(struct history_columns *columns, const void *row) {
  const struct isph *s = ((const struct row *)row)->state;
  const struct whole *whole = &((const struct row *)row)->whole;
  const struct scene *scene = s->scene;
  const double count = (double)(s->total > 0 ? s->total : 1);
  double low[3], high[3], force[3];
  /* A particle beside a wall is no cube: its extent ends at the wall. */
  for (int a = 0; a < 3; a++)
    low[a] = s->periodic[a] ? -whole->extreme[3 + a] : fmax(-whole->extreme[3 + a], s->low[a]);
  for (int a = 0; a < 3; a++)
    high[a] = s->periodic[a] ? whole->extreme[a] : fmin(whole->extreme[a], s->high[a]);
  history_number(columns, "J", whole->potential * s->thickness, "potential_energy");
  history_number(columns, "m/s", sqrt(whole->squares / count), "velocity_rms");
  history_column(columns, "m", 3, low, "front_low");
  history_column(columns, "m", 3, high, "front_high");
  history_number(columns, "1", s->solve.iterations, "iterations");
  history_number(columns, "1", (double)s->total, "particles");
  for (int t = 0; t < BUDGET_TERMS; t++)
    if (budget_is_on(&s->budget, t))
      history_number(columns, "J", s->budget.sums.work[t], "work_%s", budget_name(&s->budget, t));
  for (size_t k = 0; k < scene->region_count;) {
    const struct region *region = &scene->regions[k];
    double volume = 0;
    for (; k < region->end; k++) volume += volume_in_region(s, k);
    history_number(columns, "m^3", volume, "volume_in_region_%zu_%s", region->number + 1,
                   region_type_names[region->type]);
  }
  for (size_t b = 1; b < s->wall_box_count; b++) {
    if (!isph_wall_has_name(s, b)) continue;
    isph_wall_force(s, b, force);
    history_column(columns, "N", 3, force, "force_%s", s->wall_boxes[b].region->name);
  }
  for (size_t k = 0; k < scene->gauge_count; k++) {
    const char *name = scene->gauges[k].name;
    double read[GAUGE_NUMBERS];
    const size_t n = isph_read_gauge(s, scene->gauges[k].at, read);
    history_number(columns, "Pa", read[0], "pressure_%s", name);
    history_column(columns, "m/s", 3, &read[1], "velocity_%s", name);
    if (n > 4) history_number(columns, "m", read[4], "head_%s", name);
    if (n > 5) history_number(columns, "m", read[5], "level_%s", name);
  }
  for (size_t k = 0; k < scene->plane_count; k++)
    history_number(columns, "m^3/s", isph_section_flux(s, &scene->planes[k]), "flux_%s",
                   scene->planes[k].name);
  for (size_t k = 0; k < s->on.active_count; k++)
    if (s->on.active[k]->columns != NULL) s->on.active[k]->columns(columns, s);
}

enum status isph_add_columns(const struct isph *s, struct recorder *recorder) {
  struct row row = {.state = s};
  sum_up(s, &row.whole);
  return history_columns_declare(recorder, walk_columns, &row);
}

enum status isph_write_row(const struct isph *s, struct recorder *recorder, double dt) {
  struct history_row row = {.time = s->time, .step = s->step, .dt = dt};
  struct row more = {.state = s};
  const struct whole *whole = &more.whole;
  sum_up(s, &more.whole);
  row.mass = whole->mass * s->thickness, row.kinetic_energy = whole->kinetic * s->thickness;
  for (int a = 0; a < 3; a++) row.momentum[a] = whole->momentum[a] * s->thickness;
  row.density_max = s->density * fmax(0, whole->extreme[6]);
  row.density_mean = s->density * whole->kernel_sum / (double)(s->total > 0 ? s->total : 1);
  isph_darcy_velocity(s, row.darcy_velocity);
  row.reynolds = isph_reynolds(s, row.darcy_velocity);
  return history_columns_row(recorder, &row, walk_columns, &more);
}

/* Writes the numbers of thing number n. */
static enum status write_numbers(struct h5_file *file, const char *what, size_t n, size_t count,
                                 const double *kept) {
  char name[64];
  snprintf(name, sizeof name, "/state/%s_%zu", what, n);
  return h5_write(file, name, H5_F64, 1, &count, kept, false);
}

static const char *state_name(char name[64], const struct isph_field *field) {
  snprintf(name, 64, "/state/%s", field->name);
  return name;
}

/* The numbers of a checkpoint. */
#define NUMBERS 18
static void numbers_of(const struct isph *state, struct h5_number numbers[NUMBERS]) {
  struct isph *s = (struct isph *)state; /* written only where a checkpoint is read */
  const struct h5_number all[NUMBERS] = {
      {"time", H5_F64, 1, &s->time},
      {"step", H5_I64, 1, &s->step},
      {"viscosity_most", H5_F64, 1, &s->viscosity_most},
      {"ending_last", H5_F64, 1, &s->ending.last},
      {"ending_steps", H5_I32, 1, &s->ending.steps},
      {"next_id", H5_U64, 1, &s->next_id},
      {"lost", H5_U64, 1, &s->lost_count},
      {"left", H5_U64, 1, &s->left_count},
      {"entered", H5_U64, 1, &s->entered_count},
      {"passed", H5_F64, 4, &s->passed.entered},
      {"watchdog_halvings", H5_I32, 1, &s->dog.halvings},
      {"watchdog_trip", H5_F64, 1, &s->dog.trip_time},
      {"stable_from", H5_I64, 1, &s->stable_from},
      {"iterations", H5_I32, 1, &s->solve.iterations},
      {"iterations_total", H5_I32, 1, &s->solve.iterations_total},
      {"solves", H5_I32, 1, &s->solve.solves},
      {"residual", H5_F64, 1, &s->solve.residual},
      {"settling", H5_F64, 4, &s->settling},
  };
  memcpy(numbers, all, sizeof all);
}

enum status isph_write_checkpoint(const struct isph *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  const size_t first = s->local.begin, own = s->local.end - first;
  size_t regions[2] = {s->scene->region_count, 3};
  struct isph_kept state;
  struct h5_number numbers[NUMBERS];
  char name[64];
  size_t walls[2] = {s->boundary_count, 3};
  TRY(recorder_checkpoint_begin(recorder, &file));
  isph_fields_kept(s, &state);
  for (size_t k = 0; k < state.count; k++) {
    const struct isph_field *field = &state.field[k];
    const size_t dims[2] = {own, (size_t)field->components};
    TRY(h5_write_rows(file, state_name(name, field), field->type, field->components > 1 ? 2 : 1,
                      dims, isph_field_data(s, field) + first * field->size, true));
  }
  TRY(h5_write(file, "/state/soil_offset", H5_F64, 2, regions, s->soil_offset, false));
  if (s->boundary_count > 0)
    TRY(h5_write(file, "/state/wall_position", H5_F64, 2, walls, s->boundary_position, true));
  if (s->column_count > 0)
    TRY(h5_write(file, "/state/column_front", H5_F64, 1, &s->column_count, s->column_front, false));
  for (size_t w = 0; w < s->well_count; w++) {
    const struct isph_well *well = &s->wells[w];
    TRY(write_numbers(file, "well", w, 3, (double[3]){well->taken, well->pending, well->flow}));
  }
  for (size_t k = 0; k < s->on.active_count; k++) {
    const size_t each = (size_t)s->on.active[k]->numbers_each;
    for (size_t n = 0; n * each < isph_own_count(s, k); n++)
      TRY(write_numbers(file, s->on.active[k]->numbers, n, each, s->own_numbers[k] + n * each));
  }
  double boxes[6];
  for (size_t b = 1; b < s->wall_box_count; b++) {
    size_t six = 6;
    memcpy(boxes, s->wall_boxes[b].low, 3 * sizeof *boxes);
    memcpy(boxes + 3, s->wall_boxes[b].high, 3 * sizeof *boxes);
    snprintf(name, sizeof name, "/state/box_%zu", b);
    TRY(h5_write(file, name, H5_F64, 1, &six, boxes, false));
  }
  const double pairs = ranks_sum(s->pair_interactions);
  numbers_of(s, numbers);
  TRY(h5_write_numbers(file, "/state", NUMBERS, numbers));
  TRY(h5_write_attribute(file, "/state", "pairs", H5_F64, 1, &pairs));
  size_t losses[2] = {CONSERVATION_LOSSES, 6};
  TRY(h5_write(file, "/state/losses", H5_F64, 2, losses, s->losses, true));
  TRY(budget_write(&s->budget, sizeof s->budget, file, "/state/account"));
  status = recorder_checkpoint_commit(recorder, file); /* takes the file over */
  file = NULL;
cleanup:
  h5_close(file);
  return status;
}

/* Reads `count` rows, from `first` on, of a dataset of `rows` rows of `width` numbers each into an
 * existing array. */
static enum status read_rows(struct h5_file *file, const char *name, enum h5_type type, size_t rows,
                             size_t first, size_t count, size_t width, void *to) {
  enum status status = STATUS_OK;
  size_t dims[2] = {0, 1};
  int rank;
  void *data = NULL;
  TRY(h5_shape(file, name, 2, &rank, dims));
  if (dims[0] != rows || (rank == 2 ? dims[1] : 1) != width)
    TRY_FAIL(STATUS_INPUT, "%s: %s is of another scene; remove the file to start anew",
             h5_path(file), name);
  if (count == 0) goto cleanup;
  dims[0] = count;
  TRY(h5_read_rows(file, name, type, rank, rows, first, dims, &data));
  memcpy(to, data, count * width * h5_type_size(type));
cleanup:
  memory_free(&data);
  return status;
}

static enum status read_into(struct h5_file *file, const char *name, enum h5_type type,
                             size_t count, size_t width, void *to) {
  return read_rows(file, name, type, count, 0, count, width, to);
}

static enum status read_numbers(struct h5_file *file, const char *what, size_t n, size_t count,
                                double *kept) {
  char name[64];
  snprintf(name, sizeof name, "/state/%s_%zu", what, n);
  return read_into(file, name, H5_F64, count, 1, kept);
}

enum status isph_read_checkpoint(struct isph *s, struct h5_file *file) {
  enum status status = STATUS_OK;
  size_t dims[2];
  int rank;
  double kept[3];
  struct h5_number numbers[NUMBERS];
  struct isph_kept state;
  char name[64];
  TRY(h5_shape(file, "/state/position", 2, &rank, dims));
  if (rank != 2 || dims[1] != 3) TRY_FAIL(STATUS_INPUT, "%s: is damaged", h5_path(file));
  const size_t all = dims[0], ranks = (size_t)ranks_count();
  const size_t first = all * (size_t)ranks_own() / ranks;
  const size_t own = all * ((size_t)ranks_own() + 1) / ranks - first;
  TRY(isph_reserve(s, own));
  s->count = own;
  isph_fields_kept(s, &state);
  for (size_t k = 0; k < state.count; k++)
    TRY(read_rows(file, state_name(name, &state.field[k]), state.field[k].type, all, first, own,
                  (size_t)state.field[k].components, isph_field_data(s, &state.field[k])));
  TRY(read_into(file, "/state/soil_offset", H5_F64, s->scene->region_count, 3, s->soil_offset));
  if (s->boundary_count > 0)
    TRY(read_into(file, "/state/wall_position", H5_F64, s->boundary_count, 3,
                  s->boundary_position));
  if (s->column_count > 0)
    TRY(read_into(file, "/state/column_front", H5_F64, s->column_count, 1, s->column_front));
  for (size_t w = 0; w < s->well_count; w++) {
    struct isph_well *well = &s->wells[w];
    TRY(read_numbers(file, "well", w, 3, kept));
    well->taken = kept[0], well->pending = kept[1], well->flow = kept[2];
  }
  for (size_t k = 0; k < s->on.active_count; k++) {
    const size_t each = (size_t)s->on.active[k]->numbers_each;
    for (size_t n = 0; n * each < isph_own_count(s, k); n++)
      TRY(read_numbers(file, s->on.active[k]->numbers, n, each, s->own_numbers[k] + n * each));
  }
  for (size_t b = 1; b < s->wall_box_count; b++) {
    double box[6];
    snprintf(name, sizeof name, "/state/box_%zu", b);
    TRY(read_into(file, name, H5_F64, 6, 1, box));
    for (int a = 0; a < 3; a++) {
      double *low = &s->wall_boxes[b].mirror_low[a], *high = &s->wall_boxes[b].mirror_high[a];
      if (isfinite(*low)) *low = box[a];
      if (isfinite(*high)) *high = box[a + 3];
    }
    memcpy(s->wall_boxes[b].low, box, 3 * sizeof *box);
    memcpy(s->wall_boxes[b].high, box + 3, 3 * sizeof *box);
  }
  numbers_of(s, numbers);
  TRY(h5_read_numbers(file, "/state", NUMBERS, numbers));
  TRY(read_into(file, "/state/losses", H5_F64, CONSERVATION_LOSSES, 6, s->losses));
  isph_apply_tables(s, 0);
  isph_open_update_dry(s, false);
  isph_wall_move(s, 0);
  TRY(isph_sort_walls(s));
  TRY(isph_refresh(s)); /* finds pairs that were counted before */
  const double pairs = h5_attribute_or_nan(file, "/state", "pairs");
  if (isfinite(pairs)) s->pair_interactions = ranks_own() == 0 ? pairs : 0.0;
  TRY(budget_read(&s->budget, sizeof s->budget, file, "/state/account"));
cleanup:
  return status;
}
