/* Both stages have the same matrix coefficients; each is solved by Newton's method. */
#include "sphsolve/darcy/step.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/edges.h"
#include "sphsolve/darcy/pond.h"
#include "sphsolve/darcy/saturated.h"

/* d theta/dt by the fluxes; `size`: sum of the absolute values of its terms, times the cell's open
 * share. */
static void sum_fluxes(const struct richards *s, double *rate, double *size) {
  const double scale = 1 / s->spacing;
  memset(rate, 0, s->count * sizeof *rate);
  memset(size, 0, s->count * sizeof *size);
  for (size_t f = 0; f < s->face_count; f++) {
    const struct richards_face *face = &s->faces[f];
    const struct flux *flux = &s->face_flux[f];
    rate[face->i] -= scale * flux->q;
    rate[face->j] += scale * flux->q;
    size[face->i] += scale * fabs(flux->di) * (fabs(s->h[face->i]) + s->spacing);
    size[face->j] += scale * fabs(flux->dj) * (fabs(s->h[face->j]) + s->spacing);
  }
  for (size_t e = 0; e < s->edge_count; e++) {
    const size_t i = s->edges[e].site;
    rate[i] += scale * s->edge_flux[e].q;
    size[i] +=
        scale * (fabs(s->edge_flux[e].di) * (fabs(s->h[i]) + s->spacing) + fabs(s->edge_flux[e].q));
  }
  for (size_t i = 0; i < s->count; i++) rate[i] /= richards_volume(s, i);
}

/* Adds to the diagonal of each site the derivatives of its fluxes that have the sign of a
 * diffusion, times `scale`; `against`: the sum of the others' sizes. */
static void add_diffusion(struct richards *s, double scale, double *against) {
  struct rows *rows = &s->rows;
  memset(against, 0, s->count * sizeof *against);
  for (size_t f = 0; f < s->face_count; f++) {
    const uint32_t site[2] = {s->faces[f].i, s->faces[f].j};
    const double fall[2] = {scale * s->face_flux[f].di, -scale * s->face_flux[f].dj};
    for (int k = 0; k < 2; k++) {
      if (fall[k] > 0)
        rows->value[rows->diagonal[site[k]]] += fall[k];
      else
        against[site[k]] -= fall[k];
    }
  }
  for (size_t e = 0; e < s->edge_count; e++)
    rows->value[rows->diagonal[s->edges[e].site]] += scale * fmax(-s->edge_flux[e].di, 0);
}

/* At the edge of saturation, mostly for n < 2 or where the spacing is many times 1/alpha, the flux
 * between two places may increase with the head that it flows to. Where these derivatives outweigh
 * half of all others of a site, Newton's method would diverge with them on the diagonal, and a
 * share of the derivative by suction alone is used instead. */
static void assemble(struct richards *s, double dt) {
  struct rows *rows = &s->rows;
  const double scale = dt / s->spacing;
  double *against = s->change; /* overwritten by the solution */
  memset(rows->value, 0, rows->start[rows->count] * sizeof *rows->value);
  for (size_t i = 0; i < s->count; i++)
    rows->value[rows->diagonal[i]] = richards_volume(s, i) * s->now[i].capacity;
  add_diffusion(s, scale, against);
  for (size_t i = 0; i < s->count; i++)
    against[i] = against[i] > SLOPE_AGAINST * rows->value[rows->diagonal[i]] ? 1 : 0;
  for (size_t f = 0; f < s->face_count; f++) {
    const struct richards_face *face = &s->faces[f];
    const uint32_t site[2] = {face->i, face->j};
    const size_t beside[2] = {face->ji, face->ij};
    const double fall[2] = {scale * s->face_flux[f].di, -scale * s->face_flux[f].dj};
    for (int k = 0; k < 2; k++) {
      const uint32_t i = site[k];
      const double by_suction = scale * SLOPE_MIN * s->soils[s->soil[i]].conductivity[face->axis] *
                                s->now[i].k / s->spacing;
      const double by = fall[k] > 0 || against[i] == 0 ? fall[k] : by_suction;
      if (!(fall[k] > 0)) rows->value[rows->diagonal[i]] += by;
      rows->value[beside[k]] -= by;
    }
  }
  for (size_t i = 0; i < s->count; i++) rows->value[rows->diagonal[i]] *= 1 + STORAGE_MIN;
  richards_pond_assemble(s);
}

/* Head of a site after a Newton step `change`. `diagonal`: of the matrix; `near`: the height over
 * which gravity's share of a flux counts as much as suction's, m. */
static double updated_head(const struct retention *soil, const struct retention_state *state,
                           double diagonal, double near, double change) {
  const double saturation = state->saturation;
  const double range = soil->theta_s - soil->theta_r, fluxes = diagonal - state->capacity;
  const bool dry = saturation < SATURATION_SWITCH;
  if (state->h < 0 && (dry || state->capacity > fluxes)) {
    const double more = state->capacity * change / range;
    const double wanted = fmax(saturation + more, DRIED_SHARE * saturation);
    if (dry || wanted < 1)
      return retention_head(soil, dry ? fmin(wanted, SATURATION_WETTED_MAX) : wanted);
    /* It becomes saturated, and the remaining change is under pressure. */
    const double left = diagonal * change - (soil->theta_s - state->theta);
    return fluxes > 0 ? fmax(left, 0) / fluxes : 0;
  }
  if (state->h >= 0 && state->h + change < 0) /* below 0 storage contributes as well */
    return fmax(
        state->h + change,
        retention_head(soil, fmax(1 + fluxes * (state->h + change) / range, SATURATION_DRIED_MIN)));
  double h = state->h + change;
  if (soil->alpha * state->h < -RETENTION_STRAIGHT && state->slope * near > 1) {
    /* For n < 2, k falls as (alpha |h|)^(n-1), which is changed in proportion. */
    const double power = fmin(soil->n - 1, 1), ratio = 1 + power * change / state->h;
    if (ratio > 0) h = state->h * pow(ratio, 1 / power);
  }
  return fmax(h, retention_head(soil, SATURATION_DRIED_MIN));
}

/* Evaluates the residual of the balance at `time`. Returns the largest over its tolerance, and the
 * sum of squares; NAN if there is no number. */
static double find_residual(struct richards *s, double dt, double time, double *rate,
                            double *squares) {
  double most = 0;
  richards_evaluate(s, time);
  sum_fluxes(s, rate, s->term_size);
  *squares = 0;
  for (size_t i = 0; i < s->count; i++) {
    s->residual[i] = richards_volume(s, i) * (s->target[i] + dt * rate[i] - s->now[i].theta);
    const double share =
        fabs(s->residual[i]) / (RESIDUAL_TOLERANCE + RESIDUAL_ROUNDING * dt * s->term_size[i]);
    if (!(share <= most)) most = share;
    *squares += s->residual[i] * s->residual[i];
  }
  return most;
}

/* Newton's method for theta(h) - target - dt div = 0 at `time`. Returns false if it does not
 * converge. */
static bool solve(struct richards *s, double dt, double time, double *rate) {
  const double near = -s->pull[2] * s->spacing;
  double squares, last;
  double most = find_residual(s, dt, time, rate, &squares);
  for (int round = 0; !(most <= 1); round++) {
    if (round == NEWTON_MAX || !isfinite(squares)) return false;
    assemble(s, dt);
    const double linear =
        fmin(fmax(LINEAR_TOLERANCE_SHARE / most, LINEAR_TOLERANCE_MIN), LINEAR_TOLERANCE_MAX);
    if (!rows_solve(&s->rows, FILL_IN_SHARE, s->residual, linear, s->change, &s->linear_total))
      return false;
    memcpy(s->from, s->now, s->count * sizeof *s->from);
    last = squares;
    for (int halving = 0;; halving++) {
#pragma omp parallel for schedule(static) if (s->count > RICHARDS_SERIAL_MAX)
      for (size_t i = 0; i < s->count; i++)
        s->h[i] = updated_head(&s->soils[s->soil[i]], &s->from[i],
                               s->rows.value[s->rows.diagonal[i]] / richards_volume(s, i), near,
                               ldexp(s->change[i], -halving));
      most = find_residual(s, dt, time, rate, &squares);
      if (round < HALVING_FROM || halving == HALVINGS_MAX || squares < last || most <= 1) break;
    }
    s->iterations++;
  }
  return true;
}

/* The largest error of a step, over its tolerance: the difference to the implicit Euler method,
 * which is of order 1. */
static double error_of(const struct richards *s, double dt) {
  double most = 0;
  for (size_t i = 0; i < s->count; i++) {
    const struct retention *soil = &s->soils[s->soil[i]];
    most = fmax(most, fabs(s->second[i] - s->first[i]) / (soil->theta_s - soil->theta_r));
  }
  most = fmax(most, richards_pond_difference(s) / s->spacing);
  return (1 - SDIRK_GAMMA) * dt * most / s->tolerance;
}

/* Adds what sources have given to an edge, of which `into` went into the soil, m^3.
 * What is left of rain runs off; of a flux, which may be negative, it did not come. */
static void add_given(struct richards *s, const struct richards_edge *edge, const double weight[2],
                      const double time[2], double into) {
  double covered[2] = {0};
  for (size_t k = 0; k < edge->source_count; k++) {
    const struct richards_source *source = &s->sources[edge->source + k];
    const bool rain = source->region->type == REGION_RAIN;
    double given = 0;
    for (int stage = 0; stage < 2; stage++)
      if (!richards_is_covered(s, edge, time[stage]))
        given += weight[stage] * richards_source_at(source, time[stage]);
    (rain ? s->rained : s->entered)[source->region->first] += given;
    covered[rain] += source->share;
    into -= given;
  }
  const bool rain = covered[1] > 0 && (into < 0 || !(covered[0] > 0));
  for (size_t k = 0; k < edge->source_count; k++) {
    const struct richards_source *source = &s->sources[edge->source + k];
    const double part = into * source->share / covered[rain];
    if ((source->region->type == REGION_RAIN) != rain) continue;
    if (rain)
      s->ran_off[source->region->first] -= part;
    else
      s->entered[source->region->first] += part;
  }
}

/* Adds the flow through the boundary faces to the balance, with the weights of the stages, `last`
 * that of the second; for rates that are linear in time these are exact. */
static void update_balance(struct richards *s, double from, double dt, double last) {
  const double area = s->spacing * s->spacing;
  const double time[2] = {from + SDIRK_GAMMA * dt, from + dt},
               weight[2] = {area * dt * (1 - last), area * dt * last};
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    const double q[2] = {s->edge_first[e], s->edge_flux[e].q};
    double came = weight[0] * q[0] + weight[1] * q[1], given = came;
    *(came > 0 ? &s->in : &s->out) += fabs(came);
    if (edge->pool > 0) continue;
    if (edge->region != NULL) {
      given = 0;
      for (int stage = 0; stage < 2 && edge->source_count > 0; stage++)
        if (!richards_is_covered(s, edge, time[stage])) given += weight[stage] * fmax(q[stage], 0);
      s->entered[edge->region->first] += came - given;
    }
    if (edge->source_count > 0)
      add_given(s, edge, weight, time, given);
    else if (edge->region == NULL)
      s->seeped -= came;
  }
  richards_pond_balance(s, weight, time);
}

static bool try_step(struct richards *s, double dt) {
  memcpy(s->target, s->water, s->count * sizeof *s->target);
  s->iterations = 0;
  richards_pond_begin(s, dt);
  if (!solve(s, SDIRK_GAMMA * dt, s->time + SDIRK_GAMMA * dt, s->first)) return false;
  for (size_t e = 0; e < s->edge_count; e++) s->edge_first[e] = s->edge_flux[e].q;
  for (size_t i = 0; i < s->count; i++) s->target[i] += (1 - SDIRK_GAMMA) * dt * s->first[i];
  richards_pond_second(s, dt);
  return solve(s, SDIRK_GAMMA * dt, s->time + dt, s->second);
}

static enum status no_step_found(const struct richards *s, double dt) {
  size_t worst = 0;
  double x[3];
  for (size_t i = 0; i < s->count; i++)
    if (fabs(s->residual[i]) > fabs(s->residual[worst])) worst = i;
  richards_place(s, worst, x);
  struct retention_state at;
  retention_at(&s->soils[s->soil[worst]], s->before[worst], &at);
  const bool dry = retention_saturation(&s->soils[s->soil[worst]], at.theta) < SATURATION_SWITCH;
  return FAIL(STATUS_NUMERIC,
              "at t = %.6g s no step as long as %.2g s can be solved; it fails first at (%.4g, "
              "%.4g, %.4g) m, pressure head %.4g m: %s; else another domain.spacing may help",
              s->time, dt, x[0], x[1], x[2], s->before[worst],
              dry ? "soil so dry is wetted in too steep a front, so let it begin wetter, by a "
                    "pressure_head closer to 0"
                  : "soil that is full all round takes no more water, so let some out or bring "
                    "less, by a head or rain in place of a flux");
}

/* Soil that is full has no storage: the flow at the end of a step does not depend on its length. */
static enum status advance_full(struct richards *s, double until, double *taken) {
  *taken = isfinite(until) ? until - s->time : 0;
  for (size_t e = 0; e < s->edge_count; e++) s->edge_first[e] = s->edge_flux[e].q;
  s->step++;
  if (s->changes) {
    const enum status status = richards_saturated_solve(s, s->time + *taken);
    if (status != STATUS_OK) return status;
  }
  update_balance(s, s->time, *taken, 0.5);
  s->time += *taken;
  return STATUS_OK;
}

enum status richards_advance(struct richards *s, double until, double *taken) {
  if (s->full) return advance_full(s, until, taken);
  const double left = until - s->time;
  double dt = fmin(s->next_dt, left);
  if (dt < left && dt > 0.5 * left) dt = 0.5 * left;
  memcpy(s->before, s->h, s->count * sizeof *s->before);
  richards_share_wells(s);
  for (;;) {
    const bool found = try_step(s, dt);
    const double error = found ? error_of(s, dt) : INFINITY;
    s->iterations_total += s->iterations;
    if (error <= 1) {
      double growth = error > 0 ? STEP_SAFETY / sqrt(error) : STEP_GROWTH_MAX;
      if (s->iterations > NEWTON_SLOW) growth = fmin(growth, 1);
      /* A step cut short by the time at which it has to end is no reason against longer ones. */
      const double next = dt * fmin(growth, STEP_GROWTH_MAX);
      s->next_dt = dt < s->next_dt && growth >= 1 ? fmax(next, s->next_dt) : next;
      break;
    }
    s->refused++;
    memcpy(s->h, s->before, s->count * sizeof *s->h);
    richards_pond_back(s);
    dt *= isfinite(error) ? fmax(STEP_SAFETY / sqrt(error), STEP_SHRINK_MIN) : STEP_SHRINK_MIN;
    s->next_dt = dt;
    if (!(dt > STEP_MIN * fmax(s->time, 1 / s->fastest))) return no_step_found(s, dt);
  }
  s->short_steps =
      dt < SHORT_STEP * fmax(s->time, 1 / s->fastest) && dt < left ? s->short_steps + 1 : 0;
  if (s->short_steps > SHORT_STEPS_MAX) return no_step_found(s, 2 * dt);
  update_balance(s, s->time, dt, SDIRK_GAMMA);
  s->rate = 0;
  for (size_t i = 0; i < s->count; i++) {
    const struct retention *soil = &s->soils[s->soil[i]];
    /* The residual of Newton's method is carried over into the next step. */
    s->water[i] = s->target[i] + SDIRK_GAMMA * dt * s->second[i];
    s->rate = fmax(s->rate, fabs(s->second[i]) / (soil->theta_s - soil->theta_r));
  }
  s->rate = fmax(s->rate, richards_pond_rate(s, dt) / s->spacing);
  richards_pond_end(s);
  s->rate_most = fmax(s->rate_most, s->rate);
  s->time = dt >= left * (1 - 1e-9) ? until : s->time + dt;
  s->step++;
  *taken = dt;
  return STATUS_OK;
}
