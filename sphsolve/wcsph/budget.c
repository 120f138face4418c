/* At a sample every effect's force and power are those of the step that comes, exactly
 * (pairs_account.h). Steps between two samples are taken by the trapezium rule: of steps n .. m-1,
 *   dt sum R_k = (t_m - t_n) (R_n + R_m)/2 + dt (R_n - R_m)/2,
 * the second since the step from t_m on is not among them. Each step is sampled at first, then one
 * in a quarter of the steps gone, to one in SPARSE: a start-up is seen from its first step on, and
 * the account, .7 of a step a sample, takes some per cent of a short run's time and one of a long
 * one's. What samples may miss is told by what the integral changes by when every second one is
 * left out: three times too much where rates change smoothly. Where they are noise of variance s^2
 * a pair of intervals h changes by 3/2 h^2 s^2 in the square and misses 2 h^2 s^2, so that three
 * standard deviations are 3 sqrt(4/3) = 3.5 roots of the sum of the squares. The two are added.
 *
 * Energy is kinetic and elastic. Pressure turns one into the other; its power on the particles is
 * summed, the elastic energy is that of their pressures, and what the two differ by is
 * LEDGER_PROJECTION: diffusion of pressure, what shifting carries, and how far gradient and
 * divergence are not each other's adjoint. Frozen grains' own compression is not in it. In momentum
 * it is what pressure gives the fluid beyond what walls take of it. */
#include "sphsolve/wcsph/budget.h"

#include <math.h>
#include <string.h>

#define SPARSE 64
#define NOISE 3.5

void wcsph_account_begin(const struct engine *engine, uint32_t terms,
                         struct wcsph_account *account) {
  const bool walls = engine_has_walls(engine);
  memset(account, 0, sizeof *account);
  account->ledger.on = terms | 1u << LEDGER_PROJECTION;
  if (walls) account->ledger.on |= 1u << LEDGER_WALL_PRESSURE;
  if (walls && engine->settings.viscosity) account->ledger.on |= 1u << LEDGER_WALL_FRICTION;
}

bool wcsph_account_due(int64_t step) {
  int64_t every = 1;
  while (every < SPARSE && 8 * every <= step) every *= 2;
  return step % every == 0;
}

/* `to` += the integral over `span` from the rates `from` to `now`. */
static void integrate(size_t count, double *to, const double *from, const double *now, double span,
                      double dt) {
  for (size_t k = 0; k < count; k++)
    to[k] += 0.5 * span * (from[k] + now[k]) + 0.5 * dt * (from[k] - now[k]);
}

static void take_rates(const struct pass_account *total, const double force[3], double mass,
                       double particles, enum ledger_term carried, struct ledger_sums *rate) {
  memset(rate, 0, sizeof *rate);
  for (int a = 0; a < 3; a++) {
    rate->impulse[LEDGER_FORCE][a] = mass * particles * force[a];
    rate->impulse[LEDGER_WALL_PRESSURE][a] = mass * total->wall_pressure[a];
    rate->impulse[LEDGER_WALL_FRICTION][a] = mass * total->friction[a];
    rate->impulse[carried][a] = mass * total->shift[a];
    rate->impulse[LEDGER_VISCOSITY][a] = mass * total->viscosity[a];
    rate->impulse[LEDGER_PROJECTION][a] = mass * (total->pressure[a] - total->wall_pressure[a]);
  }
  rate->work[LEDGER_FORCE] = mass * total->force_work;
  rate->work[LEDGER_WALL_FRICTION] = mass * total->friction_work;
  rate->work[LEDGER_VISCOSITY] = mass * total->viscosity_work;
  rate->work[LEDGER_PROJECTION] = mass * total->pressure_work;
  rate->work[carried] = mass * total->shift_work;
}

enum status wcsph_account_sample(struct engine *engine, double mass, double time,
                                 struct wcsph_account *account) {
  enum status status = STATUS_OK;
  struct ledger_account *ledger = &account->ledger;
  struct pass_account total;
  struct ledger_sums rate;
  double all[WCSPH_RATES] = {0}, elastic;
  const double dt = account->dt; /* of the steps since the last sample */
  if (account->samples > 0 && !(time > account->time)) return STATUS_OK;
  TRY(engine_account(engine, &total));
  elastic = mass * total.elastic;
  take_rates(&total, engine->settings.force, mass, (double)engine->particles.count,
             engine->settings.wall == PASS_SITES ? LEDGER_ADVECTION : LEDGER_SHIFTING, &rate);
  for (int t = 0; t < LEDGER_TERMS; t++) {
    for (int a = 0; a < 3; a++) all[a] += rate.impulse[t][a];
    all[3] += rate.work[t];
  }
  const bool first = account->samples == 0, second = fmod(account->samples, 2) == 0;
  if (!first) {
    integrate(sizeof rate / sizeof(double), (double *)&ledger->sums, (const double *)&account->rate,
              (const double *)&rate, time - account->time, dt);
    integrate(WCSPH_RATES, account->every, account->rate_all, all, time - account->time, dt);
    ledger->sums.work[LEDGER_PROJECTION] += elastic - account->elastic;
  }
  if (second) {
    double without[WCSPH_RATES] = {0};
    if (!first)
      integrate(WCSPH_RATES, without, account->second_rate, all, time - account->second_time, dt);
    for (int k = 0; k < WCSPH_RATES; k++) {
      const double differs = without[k] - account->every[k];
      account->defect[k] += differs, account->squares[k] += differs * differs;
      account->every[k] = 0;
    }
    memcpy(account->second_rate, all, sizeof all);
    account->second_time = time;
  }
  for (int a = 0; a < 3; a++) ledger->momentum[!first][a] = mass * total.momentum[a];
  ledger->energy[!first] = mass * total.kinetic + elastic;
  double error[WCSPH_RATES];
  for (int k = 0; k < WCSPH_RATES; k++)
    error[k] = fabs(account->defect[k]) + NOISE * sqrt(account->squares[k]);
  ledger->momentum_error = sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
  ledger->energy_error = error[3];
  account->rate = rate;
  memcpy(account->rate_all, all, sizeof all);
  account->elastic = elastic;
  account->time = time;
  account->dt = engine->settings.dt;
  account->samples++;
cleanup:
  return status;
}
