#include "sphsolve/isph/watch.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/speed_forecast.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/window.h"
#include "sphsolve/isph/constants.h"

/* The watchdog's bound on the kernel sum (sum of V W, 1 in the bulk). The other bounds are one
 * spacing per step, and the pressure solve's own bound on its residual. */
#define KERNEL_SUM_MAX 2.0
/* Bound on the speed over isph_speed_most; jets of an impact reach some 5 times that. Without this
 * bound the time step, which shortens as the fastest particle speeds up, would follow a diverging
 * one towards 0, and no other bound would be reached. */
#define SPEED_RATIO_MAX 100.0

double isph_given_speed(const struct isph *s) {
  double speed = isph_prescribed_speed(s->scene);
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    /* Torricelli; NAN, which fmax ignores, if there is no fall */
    if (region->boundary == BOUNDARY_HEAD)
      speed = fmax(speed, sqrt(2 * s->scene->driving[2] * -region->head));
  }
  return speed;
}

/* Adds up the speeds of a fall through the whole domain, or of acceleration along a periodic axis
 * for the time of the run; of a head without gravity, which is then a pressure; and of a drop of
 * one particle that its surface tension contracts. */
double isph_speed_most(const struct isph *s) {
  const double *f = s->force, force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  double square = 0, head = 0, speed = isph_given_speed(s);
  bool round = false;
  for (int a = 0; a < 3; a++) {
    const double length = s->high[a] - s->low[a];
    if (s->dimensions == 3 || a != 1) square += length * length;
    round = round || (s->periodic[a] && f[a] != 0);
  }
  for (size_t k = 0; k < s->side_count; k++)
    if (s->sides[k].kind == BOUNDARY_OPEN_HEAD) head = fmax(head, fabs(s->sides[k].head));
  speed += sqrt(2 * force * sqrt(square)) + (round ? force * s->time : 0);
  speed += sqrt(2 * GRAVITY_STANDARD * head);
  speed += sqrt(s->scene->fluid.surface_tension / (s->density * s->spacing));
  return speed / s->soil_porosity_least;
}

/* The particle with the largest value, first on a rank, then on all. */
struct leader {
  double value, position[3], kernel_sum, square;
  uint64_t id;
};

/* PRESSED: the densest away from windows; HIGHEST: the nearest to the lid. */
enum { DENSEST, FASTEST, PRESSED, HIGHEST, LEADERS };

/* The side that is the lid of the domain: the axis along which the force acts, whose side against
 * it is closed and holds no water at the start; -1 if there is none. */
static int lid_axis(const struct isph *s) {
  const int a = scene_axis_along(s->force);
  const bool up = s->force[a] < 0;
  if (!s->on.surface || s->periodic[a] || s->force[a] == 0) return -1;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *r = &s->scene->regions[k];
    const double gap = up ? s->high[a] - r->box[a + 3] : r->box[a] - s->low[a];
    if ((r->type == REGION_WATER || r->type == REGION_INFLOW) && gap < s->spacing) return -1;
  }
  return a;
}

/* How near a place is to the lid, in spacings: 1 where they touch, 0 from a spacing on. */
static double near_lid(const struct isph *s, int axis, const double x[3]) {
  if (axis < 0) return 0;
  const double gap = s->force[axis] < 0 ? s->high[axis] - x[axis] : x[axis] - s->low[axis];
  return fmax(0, 1 - gap / s->spacing);
}

static enum status find_leaders(struct leader leaders[LEADERS]) {
  enum status status = STATUS_OK;
  struct leader *all = NULL;
  size_t n = 0;
  TRY(isph_gather(leaders, LEADERS, sizeof *leaders, &all, &n));
  for (size_t k = 0; k < n; k++)
    if (k < LEADERS || all[k].value > leaders[k % LEADERS].value) leaders[k % LEADERS] = all[k];
cleanup:
  memory_free(&all);
  return status;
}

enum status isph_check_bounds(struct isph *s, double dt, double *used, struct isph_trip *trip) {
  enum status status = STATUS_OK;
  struct watch_reading reading = {{0}};
  const double *f = s->force;
  struct leader leaders[LEADERS] = {{0}};
  const int lid = s->lid_reached ? -1 : lid_axis(s);
  double squares;
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *v = s->velocity[i], *x = s->position[i];
      double eps = s->porosity != NULL ? s->porosity[i] : 1;
      double square = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (eps * eps);
      const double dense = s->kernel_sum[i];
      const bool pressed = dense > leaders[PRESSED].value && !isph_window_is_near(s, x);
      const double values[LEADERS] = {dense, square, pressed ? dense : 0, near_lid(s, lid, x)};
      sum += square;
      for (int k = 0; k < LEADERS; k++)
        if (values[k] > leaders[k].value)
          leaders[k] =
              (struct leader){values[k], {x[0], x[1], x[2]}, s->kernel_sum[i], square, s->id[i]};
    }
    s->sums[c][0] = sum;
  }
  isph_sum_chunks(s, 1, &squares);
  TRY(find_leaders(leaders));
  const double *lost = s->fastest_lost;
  if (lost[0] * lost[0] > leaders[FASTEST].value)
    leaders[FASTEST] = (struct leader){
        lost[0] * lost[0], {lost[1], lost[2], lost[3]}, 0, lost[0] * lost[0], (uint64_t)lost[4]};
  const double fastest = sqrt(leaders[FASTEST].value), most = isph_speed_most(s);
  if (leaders[PRESSED].value > KERNEL_SUM_WARN && s->kernel_sum_peak == 0)
    log_warning(
        "t = %.4g s: water is pressed to %.3g of its density at (%.4g, %.4g, %.4g) m; pressures "
        "there mean nothing: walls or inflows leave it less room than it needs, or are too "
        "fast for the spacing",
        s->time, leaders[PRESSED].value, leaders[PRESSED].position[0], leaders[PRESSED].position[1],
        leaders[PRESSED].position[2]);
  if (leaders[PRESSED].value > KERNEL_SUM_WARN)
    s->kernel_sum_peak = fmax(s->kernel_sum_peak, leaders[PRESSED].value);
  if (leaders[HIGHEST].value >= 0.5) {
    const double *x = leaders[HIGHEST].position;
    s->lid_reached = true;
    log_warning("t = %.4g s: water strikes the top of the domain at (%.4g, %.4g, %.4g) m, a closed "
                "lid; make domain.size larger unless a lid is meant",
                s->time, x[0], x[1], x[2]);
  }
  reading.used[WATCH_DENSITY] = (leaders[DENSEST].value - 1) / (KERNEL_SUM_MAX - 1);
  reading.used[WATCH_VELOCITY] = fastest * dt / s->spacing;
  if (fastest > SPEED_RATIO_MAX * most && most > 0) reading.used[WATCH_VELOCITY] = INFINITY;
  if (s->total > 0)
    reading.used[WATCH_ENERGY] =
        watchdog_energy(&s->dog, sqrt(squares / (double)s->total), s->time,
                        sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), isph_given_speed(s),
                        WATCH_ENERGY_FLOOR * s->spacing / dt);
  reading.used[WATCH_RESIDUAL] = s->solve.residual / (1e3 * s->scene->isph.tolerance);
  trip->bound = watchdog_worst(&reading, used);
  const struct leader *first = &leaders[trip->bound == WATCH_DENSITY ? DENSEST : FASTEST];
  memcpy(trip->position, first->position, sizeof trip->position);
  trip->kernel_sum = first->kernel_sum;
  if (s->total == 0) goto cleanup;
  int n = snprintf(trip->what, sizeof trip->what,
                   "%s: particle %llu at (%.4g, %.4g, %.4g) m, kernel sum %.3g, speed %.3g m/s",
                   watchdog_name(trip->bound), (unsigned long long)first->id, first->position[0],
                   first->position[1], first->position[2], first->kernel_sum, sqrt(first->square));
  if (trip->bound == WATCH_VELOCITY && fastest > SPEED_RATIO_MAX * most && most > 0)
    snprintf(trip->what + n, sizeof trip->what - (size_t)n,
             ", where forces, heads and walls give %.3g m/s at most", most);
cleanup:
  return status;
}

/* Describes a place: "in the soil regions[1]", "in free water beside the soil regions[1]", "in free
 * water". */
static void name_place(const struct isph *s, const double x[3], char *text, size_t size) {
  double nearest = s->scene->isph.support_ratio * s->spacing;
  size_t beside = s->scene->region_count;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    double square = 0;
    if (region->type != REGION_POROUS) continue;
    for (int a = 0; a < 3; a++) {
      if (s->dimensions == 2 && a == 1) continue;
      const double y = x[a] - s->soil_offset[k][a];
      const double out = fmax(0, fmax(region->box[a] - y, y - region->box[a + 3]));
      square += out * out;
    }
    if (sqrt(square) <= nearest) nearest = sqrt(square), beside = k;
  }
  if (beside == s->scene->region_count)
    snprintf(text, size, "in free water");
  else
    snprintf(text, size, "in %s regions[%zu]",
             nearest > 0 ? "free water beside the soil" : "the soil", beside);
}

/* Advice to the user. */
static const char *remedy_of(const struct isph *s, const struct isph_trip *trip) {
  const bool unsolved = !(s->solve.residual <= 1e3 * s->scene->isph.tolerance);
  if (unsolved && s->on.soil)
    return "neighbours differ too much in how freely water moves, as beside soil so fine that it "
           "holds the water; make it a wall, or its grain_size larger";
  if (s->scene->shifting == SWITCH_OFF)
    return "without shifting particles clump; leave effects.shifting at \"auto\"";
  if (!isnan(s->scene->isph.dt))
    return "the time step is too long for these speeds; use isph.dt = \"auto\"";
  if (trip->bound == WATCH_DENSITY)
    return "water has less room than it needs; give what walls and inflows press a way out, or let "
           "them go slower";
  if (!s->on.relaxation)
    return "without relaxation water thins out and crowds; leave isph.alpha as it is";
  if (!s->on.surface && trip->kernel_sum > 0 && trip->kernel_sum < KERNEL_SUM_GAP)
    return "the water has a gap there that none fills; use a smaller domain.spacing";
  return "the spacing is too coarse for what drives the water here; use a smaller domain.spacing "
         "or a smaller isph.dt";
}

/* The fastest wall that moves within the domain, NULL if there is none. */
static const struct region *piston_of(const struct isph *s) {
  const struct region *piston = NULL;
  double fastest = 0;
  for (size_t b = 1; b < s->wall_box_count; b++) {
    const struct isph_wall_box *box = &s->wall_boxes[b];
    const double speed = isph_region_speed(s->scene, box->region);
    if (isph_wall_is_inside(s, box) && speed > fastest) fastest = speed, piston = box->region;
  }
  return piston;
}

enum status isph_step_back(struct isph *s, const struct isph_copy *copy, double dt,
                           const struct isph_trip *trip, struct recorder *recorder) {
  enum status status = STATUS_OK;
  const double time = s->time;
  const char *remedy = remedy_of(s, trip);
  const size_t backs = recorder_step_log(recorder)->back_count;
  const bool go_on = watchdog_trip(&s->dog, time, backs);
  const struct region *piston = piston_of(s);
  char saved[4200] = "", place[96] = "", pushed[192] = "";
  if (piston != NULL)
    snprintf(pushed, sizeof pushed,
             "regions[%zu], a wall that moves at %.3g m/s, may leave water no room: let it go "
             "slower, or end the run before; else ",
             piston->number, isph_region_speed(s->scene, piston));
  if (trip->bound != WATCH_RESIDUAL) name_place(s, trip->position, place, sizeof place);
  if (s->dog.kept) {
    TRY(isph_restore_state(s, copy));
    TRY(recorder_go_back(recorder, copy->time));
  }
  if (go_on) {
    struct step_back back = {.time = time, .back_to = copy->time, .dt = dt / 2};
    snprintf(back.cause, sizeof back.cause, "%s", trip->what);
    log_warning("t = %.4g s: %s; back to t = %.4g s, time steps halved to %.3g s", time, trip->what,
                copy->time, back.dt);
    TRY(step_log_back(recorder_step_log(recorder), &back));
    goto cleanup;
  }
  if (s->dog.kept) {
    TRY(isph_write_checkpoint(s, recorder));
    snprintf(saved, sizeof saved, "; %s holds the last good state, t = %.4g s",
             recorder_checkpoint_name(recorder), copy->time);
  }
  status = FAIL(STATUS_NUMERIC,
                "step %lld, t = %.4g s: %s%s%s, after %zu halvings of the time step "
                "(now %.3g s): %s%s%s",
                (long long)s->step, time, trip->what, *place ? ", " : "", place, backs, dt, pushed,
                remedy, saved);
cleanup:
  return status;
}
