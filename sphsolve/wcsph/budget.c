/* At a sample the force and power of every effect are exactly those of the following step
 * (pairs_budget.h). Steps between two samples are integrated by the trapezoidal rule: for steps n
 * .. m-1,
 *
 * dt sum R_k = (t_m - t_n) (R_n + R_m)/2 + dt (R_n - R_m)/2,
 *
 * where the second term excludes the step from t_m on. At first each step is sampled, later one in
 * a quarter of the elapsed steps, up to one in SAMPLE_INTERVAL_MAX: the start-up is resolved from
 * the first step on, and the budget, which costs 0.7 of a step per sample, takes a few per cent of
 * a short run's time and one per cent of a long one's.
 *
 * The sampling error is estimated from the change of the integral when every second sample is
 * omitted: three times too large where rates change smoothly. Where rates are noise of variance
 * s^2, the change over a pair of intervals h has the variance 3/2 h^2 s^2 and the error 2 h^2 s^2,
 * so that three standard deviations are 3 sqrt(4/3) = 3.5 times the root of the sum of the squares.
 * Both are added.
 *
 * The energy is kinetic and elastic. Pressure converts one into the other; its power on the
 * particles is summed, the elastic energy is that of their pressures, and the difference of both is
 * BUDGET_PROJECTION: pressure diffusion, transport by shifting, and the deviation of gradient and
 * divergence from being adjoint. The compression of frozen grains is not included. In the momentum
 * balance this term is the pressure force on the fluid that the walls do not balance. */
#include "sphsolve/wcsph/budget.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/wcsph/constants.h"

void wcsph_budget_begin(const struct engine *engine, uint32_t terms, struct wcsph_budget *budget) {
  const bool walls = engine_has_walls(engine);
  memset(budget, 0, sizeof *budget);
  budget->total.on = terms | 1u << BUDGET_PROJECTION;
  if (walls) budget->total.on |= 1u << BUDGET_WALL_PRESSURE;
  if (walls && engine->settings.viscous) budget->total.on |= 1u << BUDGET_WALL_FRICTION;
  for (int k = 0; k < engine->settings.own_count; k++) {
    budget->total.on |= 1u << (BUDGET_OWN + k);
    snprintf(budget->total.own[k], sizeof budget->total.own[k], "%s", engine->settings.own[k].name);
  }
}

bool wcsph_budget_due(int64_t step) {
  int64_t every = 1;
  while (every < SAMPLE_INTERVAL_MAX && 8 * every <= step) every *= 2;
  return step % every == 0;
}

/* to += the integral over a time `span` in which the rate changes from `from` to `now`. */
static void integrate(size_t count, double *to, const double *from, const double *now, double span,
                      double dt) {
  for (size_t k = 0; k < count; k++)
    to[k] += 0.5 * span * (from[k] + now[k]) + 0.5 * dt * (from[k] - now[k]);
}

static void find_rates(const struct pass_budget *step, const double force[3], double mass,
                       double particles, enum budget_term carried, struct budget_sums *rate) {
  memset(rate, 0, sizeof *rate);
  for (int a = 0; a < 3; a++) {
    rate->impulse[BUDGET_FORCE][a] = mass * particles * force[a];
    rate->impulse[BUDGET_WALL_PRESSURE][a] = mass * step->wall_pressure[a];
    rate->impulse[BUDGET_WALL_FRICTION][a] = mass * step->friction[a];
    rate->impulse[carried][a] = mass * step->shift[a];
    rate->impulse[BUDGET_VISCOSITY][a] = mass * step->viscous[a];
    rate->impulse[BUDGET_PROJECTION][a] = mass * (step->pressure[a] - step->wall_pressure[a]);
  }
  rate->work[BUDGET_FORCE] = mass * step->force_work;
  rate->work[BUDGET_WALL_FRICTION] = mass * step->friction_work;
  rate->work[BUDGET_VISCOSITY] = mass * step->viscous_work;
  rate->work[BUDGET_PROJECTION] = mass * step->pressure_work;
  rate->work[carried] = mass * step->shift_work;
}

enum status wcsph_budget_sample(struct engine *engine, double mass, double time,
                                struct wcsph_budget *budget) {
  enum status status = STATUS_OK;
  struct budget *total = &budget->total;
  struct pass_budget step;
  struct budget_sums rate;
  double all[WCSPH_RATES] = {0}, elastic;
  const double dt = budget->dt; /* time step since the last sample */
  if (budget->samples > 0 && !(time > budget->time)) return STATUS_OK;
  TRY(engine_budget(engine, &step));
  elastic = mass * step.elastic;
  find_rates(&step, engine->settings.force, mass, (double)engine->particles.count,
             engine->settings.wall == PASS_EULERIAN ? BUDGET_ADVECTION : BUDGET_SHIFTING, &rate);
  for (int k = 0; k < engine->settings.own_count; k++) {
    const struct engine_force_sum *own = &engine->own_sum[k];
    for (int a = 0; a < 3; a++) rate.impulse[BUDGET_OWN + k][a] = mass * own->impulse[a];
    rate.work[BUDGET_OWN + k] = mass * own->work;
  }
  for (int t = 0; t < BUDGET_TERMS; t++) {
    for (int a = 0; a < 3; a++) all[a] += rate.impulse[t][a];
    all[3] += rate.work[t];
  }
  const bool first = budget->samples == 0, second = fmod(budget->samples, 2) == 0;
  if (!first) {
    integrate(sizeof rate / sizeof(double), (double *)&total->sums, (const double *)&budget->rate,
              (const double *)&rate, time - budget->time, dt);
    integrate(WCSPH_RATES, budget->every, budget->rate_all, all, time - budget->time, dt);
    total->sums.work[BUDGET_PROJECTION] += elastic - budget->elastic;
  }
  if (second) {
    double without[WCSPH_RATES] = {0};
    if (!first)
      integrate(WCSPH_RATES, without, budget->second_rate, all, time - budget->second_time, dt);
    for (int k = 0; k < WCSPH_RATES; k++) {
      const double differs = without[k] - budget->every[k];
      budget->defect[k] += differs, budget->squares[k] += differs * differs;
      budget->every[k] = 0;
    }
    memcpy(budget->second_rate, all, sizeof all);
    budget->second_time = time;
  }
  for (int a = 0; a < 3; a++) total->momentum[!first][a] = mass * step.momentum[a];
  total->energy[!first] = mass * step.kinetic + elastic;
  double error[WCSPH_RATES];
  for (int k = 0; k < WCSPH_RATES; k++)
    error[k] = fabs(budget->defect[k]) + NOISE_FACTOR * sqrt(budget->squares[k]);
  total->momentum_error = sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
  total->energy_error = error[3];
  budget->rate = rate;
  memcpy(budget->rate_all, all, sizeof all);
  budget->elastic = elastic;
  budget->time = time;
  budget->dt = engine->settings.dt;
  budget->samples++;
cleanup:
  return status;
}
