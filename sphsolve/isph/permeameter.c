#include "sphsolve/isph/permeameter.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/units.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/march/monitor.h"

/* Whether a box spans the domain along all axes but `axis` (3: along every axis). */
static bool spans(const struct isph *s, const double low[3], const double high[3], int axis) {
  bool all = true;
  for (int a = 0; a < 3; a++) {
    double near = 1e-6 * s->spacing;
    if (a != axis && !(s->dimensions == 2 && a == 1))
      all = all && low[a] <= s->low[a] + near && high[a] >= s->high[a] - near;
  }
  return all;
}

/* The column of a permeameter: two opposite sides, each with a given head on the whole of it, and
 * soil in layers across. */
struct column {
  int axis;
  double gradient; /* difference of head over the length of soil */
  double fall;     /* difference of head, m, signed along the axis */
  double inertia;  /* m: inertial length of the water set in motion, sum of length / porosity */
  double soil[2];  /* where its longest layer begins and ends, m */
  double porosity; /* porosity of that layer */
};

/* Finds the column; false if the scene is no such column. */
static bool find_column(const struct isph *s, struct column *column) {
  int *axis = &column->axis;
  const struct isph_open_side *sides = s->sides;
  if (s->side_count != 2 || s->wall_box_count > 1 || s->on.surface) return false;
  *axis = sides[0].axis;
  if (sides[0].region->table.count > 0 || sides[1].region->table.count > 0) return false;
  bool facing = sides[1].axis == *axis && sides[0].inward * sides[1].inward < 0;
  for (int k = 0; k < 2; k++)
    facing = facing && sides[k].kind == BOUNDARY_OPEN_HEAD &&
             spans(s, sides[k].low, sides[k].high, *axis);
  if (!facing) return false;
  double length = 0, done = s->low[*axis];
  column->inertia = s->high[*axis] - s->low[*axis];
  column->soil[0] = column->soil[1] = 0;
  while (done < s->high[*axis]) { /* from soil to soil along the axis */
    double from = s->high[*axis], to = from, porosity = 1;
    for (size_t k = 0; k < s->scene->region_count; k++) {
      const struct region *region = &s->scene->regions[k];
      if (region->type != REGION_POROUS || !(region->box[*axis + 3] > done)) continue;
      if (!spans(s, region->box, region->box + 3, *axis)) return false;
      if (fmax(region->box[*axis], done) < from)
        from = fmax(region->box[*axis], done), to = region->box[*axis + 3],
        porosity = region->porosity;
    }
    done = fmin(to, s->high[*axis]);
    length += done - from;
    if (done - from > column->soil[1] - column->soil[0])
      column->soil[0] = from, column->soil[1] = done, column->porosity = porosity;
    column->inertia += (done - from) * (1 / porosity - 1);
  }
  column->fall = (sides[0].head - sides[1].head) * sides[0].inward;
  column->gradient = column->fall / length;
  return length > 0 && column->fall != 0;
}

/* Number of relaxation times after which k is meaningful; before, the water is still accelerating.
 */
#define RELAXATIONS_MIN 10.0

/* Steadiness of the flow. The momentum balance of the water,
 *   inertia dv/dt = drive (1 - v / v_inf),
 * relaxes with the time inertia v_inf / drive if friction is linear in v, and faster otherwise.
 * Returns false if the run is too short for that. Otherwise sets the error of steadiness of v, the
 * mean of the second half, from the change between the third and the fourth quarter and from the
 * growth that is still to come; and the error of averaging, from `sampling`, the 95 % error of that
 * mean (NAN if k is not a mean). */
static bool find_steadiness(const struct isph *s, double v, double third, double fourth,
                            double sampling, double inertia, double drive,
                            struct run_result *result) {
  const double relaxation = fabs(v) * inertia / drive, drift = fourth - third;
  if (!(s->time > RELAXATIONS_MIN * relaxation)) {
    log_warning("%s: no k: the flow has not settled after %.3g s; let scene.end_time be ten times "
                "as long",
                s->scene->path, s->time);
    return false;
  }
  result->error.steadiness =
      hypot(isfinite(drift) ? drift / v : 0, monitor_relaxation_deficit(s->time, relaxation));
  result->error.averaging = fabs(sampling / v);
  result->k_error =
      hypot(result->error.steadiness, isfinite(sampling) ? result->error.averaging : 0);
  return true;
}

/* Mean of 1 / porosity over the bulk volume of the particles. Collective. */
static double mean_inertia(const struct isph *s) {
  double total[2];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double volume = 0, inertia = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      volume += s->volume[i];
      inertia += s->volume[i] / (s->porosity ? s->porosity[i] : 1);
    }
    s->sums[c][0] = volume;
    s->sums[c][1] = inertia;
  }
  isph_sum_chunks(s, 2, total);
  return total[0] > 0 ? total[1] / total[0] : 1;
}

/* In a periodic box full of water k = v / i along the force is already known; only its errors are
 * found here. */
static void find_periodic(const struct isph *s, const struct recorder *recorder,
                          struct run_result *result) {
  const double *force = s->scene->driving, drive = sqrt(dot(force, force));
  double direction[3], third[3], fourth[3];
  if (!(drive > 0) || !s->porosity) return;
  for (int a = 0; a < 3; a++) direction[a] = force[a] / drive;
  recorder_mean_velocity(recorder, 0.5 * s->time, 0.75 * s->time, third);
  recorder_mean_velocity(recorder, 0.75 * s->time, s->time, fourth);
  if (!find_steadiness(s, dot(direction, result->darcy_velocity), dot(direction, third),
                       dot(direction, fourth), NAN, mean_inertia(s), drive, result))
    result->k = result->intrinsic_permeability = NAN;
}

enum status isph_find_k(const struct isph *s, const struct plan *plan,
                        const struct recorder *recorder, struct run_result *result) {
  const struct scene *scene = plan->context.scene;
  bool round = !plan->context.has_surface && !plan->context.has_inflow;
  const double *g = scene->gravity;
  struct column column;
  for (int a = 0; a < 3; a++) round = round && (scene->driving[a] == 0 || scene->periodic[a]);
  if (round) {
    find_periodic(s, recorder, result);
    return STATUS_OK;
  }
  result->k = result->intrinsic_permeability = NAN;
  if (!find_column(s, &column)) return STATUS_OK;
  double strength = sqrt(dot(g, g));
  if (!(strength > 0)) strength = GRAVITY_STANDARD;
  const double middle = 0.5 * s->time, late = 0.75 * s->time;
  const double v = recorder_mean(recorder, COLUMN_VELOCITY, middle, s->time);
  double sampling;
  const double along[3] = {1, 0, 0};
  enum status status =
      recorder_sampling(recorder, COLUMN_VELOCITY, along, middle, s->time, &sampling);
  if (status != STATUS_OK) return status;
  if (!find_steadiness(s, v, recorder_mean(recorder, COLUMN_VELOCITY, middle, late),
                       recorder_mean(recorder, COLUMN_VELOCITY, late, s->time), sampling,
                       column.inertia, strength * fabs(column.fall), result))
    return STATUS_OK;
  if (!(v * column.gradient > 0)) {
    log_warning("%s: no k: the water does not flow from the higher head to the lower; does one lie "
                "below its side, where no water stands?",
                scene->path);
    result->k_error = result->error.steadiness = result->error.averaging = NAN;
    return STATUS_OK;
  }
  memset(result->darcy_velocity, 0, sizeof result->darcy_velocity);
  result->darcy_velocity[column.axis] = v;
  result->k = v / column.gradient;
  result->hydraulic_gradient[column.axis] = column.gradient;
  result->error.resolution = plan->expected.error;
  result->intrinsic_permeability = result->k * s->kinematic_viscosity / strength;
  return STATUS_OK;
}

bool isph_column_velocity(const struct isph *s, double *velocity) {
  struct column column;
  if (!find_column(s, &column)) return false;
  /* Clear of the smoothed ends, or the middle half of a layer that is too short for that. */
  const double length = column.soil[1] - column.soil[0];
  const double h =
      0.5 * s->scene->isph.support_ratio * s->spacing * pow(column.porosity, -1.0 / s->dimensions);
  const double clear = fmin(2 * h, 0.25 * length);
  const double from = column.soil[0] + clear, to = column.soil[1] - clear;
  double total[2];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[2] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double x = s->position[i][column.axis];
      const double weight =
          s->volume[i] * (kernel_integral((x - from) / h) - kernel_integral((x - to) / h));
      sum[0] += weight, sum[1] += weight * s->velocity[i][column.axis];
    }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, 2, total);
  *velocity = total[0] > 0 ? total[1] / total[0] : 0;
  return true;
}
