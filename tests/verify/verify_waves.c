/* Waves by method isph: before an absorbing side, and one that lets them out, against the linear
 * equations of long waves; what a channel does between an inflow and such a side; what waves keep
 * of their energy, standing and made by a piston. Usage: verify_waves RESULTS.json [CASE...] all
 * cases, or those whose names start with CASE */
#include "tests/verify/isph_rig.h"

#include "sphsolve/isph/energy.h"

/* A hump and a trough, each .96 m long and HEIGHT high, at the closed side of a tank DEPTH deep,
 * become a wave some 2 m long. PROBE: where its velocity is read, beyond them and before the
 * absorbing region, which begins at EDGE and is as long as the rest of the tank. */
#define DEPTH 0.2
#define HEIGHT 0.02
#define LENGTH 0.96
#define PROBE 3.0
#define EDGE 4.0
#define TANK 6.0
#define LONG 10.0
#define READ 0.02
enum { READINGS = 400 };

/* What is at the far end of the tank: a closed side, with an absorbing region before it or without;
 * or an open one, whose head is fixed or lets waves out. */
enum end { CLOSED, ABSORBING, FIXED, RADIATING };

/* By staggered differences: du/dt = -g d eta/dx - gamma u, d eta/dt = -h du/dx; on an open side eta
 * = 0 or sqrt(h/g) (u - u_m). velocity [READINGS], m/s. */
static void theory(double tank, enum end end, double *velocity) {
  enum { PER_METRE = 100, MOST = 10 * PER_METRE };
  static double eta[MOST], u[MOST + 1];
  const double g = 9.81, c = sqrt(g * DEPTH), dx = 1.0 / PER_METRE;
  const int n = (int)lround(tank * PER_METRE), probe = (int)lround(PROBE * PER_METRE);
  const int steps = 8;
  const double dt = READ / steps;
  double mean = 0;
  for (int i = 0; i < n; i++) {
    const double x = (i + .5) * dx;
    eta[i] = x < LENGTH ? HEIGHT : x < 2 * LENGTH ? -HEIGHT : 0;
    u[i] = u[i + 1] = 0;
  }
  for (int r = 0; r < READINGS; r++) {
    for (int k = 0; k < steps; k++) {
      for (int i = 1; i < n; i++) {
        const double way = fmax(0, (i * dx - EDGE) / (TANK - EDGE));
        const double half = end == ABSORBING ? .5 * dt * 10 * c / (TANK - EDGE) * way * way : 0;
        u[i] = (u[i] * (1 - half) - dt * g * (eta[i] - eta[i - 1]) / dx) / (1 + half);
      }
      const double raised = end == RADIATING ? sqrt(DEPTH / g) * (u[n] - mean) : 0;
      if (end >= FIXED) u[n] -= dt * g * (raised - eta[n - 1]) / (dx / 2);
      mean += dt * c / (4 * tank) * (u[n] - mean);
      for (int i = 0; i < n; i++) eta[i] -= dt * DEPTH * (u[i + 1] - u[i]) / dx;
    }
    velocity[r] = u[probe];
  }
}

static void measured(double tank, enum end end, double dx, double *velocity) {
  struct run run = {0};
  char side[160] = "";
  const double probe[3] = {PROBE, 0, DEPTH / 4};
  if (end >= FIXED)
    snprintf(
        side, sizeof side,
        ", { type = \"inflow\"; box = [\"%g m\", \"0\", \"%g m\", \"0.4 m\"]; head = \"%g m\"; "
        "radiates = %s; }",
        tank - dx, tank, DEPTH, end == RADIATING ? "true" : "false");
  if (end == ABSORBING)
    snprintf(side, sizeof side,
             ", { type = \"absorbing\"; box = [\"%g m\", \"0\", \"%g m\", \"%g m\"]; }", EDGE, TANK,
             DEPTH);
  start(&run,
        "scene = { method = \"isph\"; end_time = \"10 s\"; };\n"
        "domain = { size = [\"%g m\", \"0.4 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
        "};\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%g m\", \"%g m\"]; },\n"
        "{ type = \"water\"; box = [\"%g m\", \"0\", \"%g m\", \"%g m\"]; },\n"
        "{ type = \"water\"; box = [\"%g m\", \"0\", \"%g m\", \"%g m\"]; }%s );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
        tank, dx, LENGTH, DEPTH + HEIGHT, LENGTH, 2 * LENGTH, DEPTH - HEIGHT, 2 * LENGTH, tank,
        DEPTH, side);
  for (int r = 0; r < READINGS; r++) {
    double number[GAUGE_NUMBERS];
    advance(&run, (r + 1) * READ);
    isph_read_gauge(&run.s, probe, number);
    velocity[r] = number[1];
  }
  finish(&run);
}

/* The standard deviation of the difference of two records over that of the second. */
static double apart(const double *a, const double *b) {
  double difference[2] = {0}, wave[2] = {0};
  for (int r = 0; r < READINGS; r++) {
    const double d = a[r] - b[r];
    difference[0] += d / READINGS, difference[1] += d * d / READINGS;
    wave[0] += b[r] / READINGS, wave[1] += b[r] * b[r] / READINGS;
  }
  return sqrt((difference[1] - difference[0] * difference[0]) / (wave[1] - wave[0] * wave[0]));
}

/* What comes back of the wave: the velocity less that in a tank so long that nothing does by then.
 */
static void absorbing(void) {
  double side[READINGS], far[READINGS];
  theory(TANK, ABSORBING, side);
  theory(LONG, CLOSED, far);
  const double reference = apart(side, far);
  for (int fine = 0; fine < 2; fine++) {
    const double started = clock_seconds(), dx = fine ? .01 : .02;
    char name[96];
    measured(LONG, CLOSED, dx, far);
    measured(TANK, ABSORBING, dx, side);
    snprintf(name, sizeof name, "absorbing side: what comes back, spacing %g mm", 1e3 * dx);
    report(name, reference, apart(side, far), .03, started);
    measured(TANK, CLOSED, dx, side);
    snprintf(name, sizeof name, "closed side: what comes back, spacing %g mm", 1e3 * dx);
    show(name, 1, apart(side, far), started);
  }
}

/* The same of an open side that lets waves out, and of one of fixed head, which reflects all; the
 * long tank ends at such a side too, since water with windows is never calm. */
static void radiating(void) {
  double side[READINGS], far[READINGS], reference[2];
  theory(LONG, CLOSED, far);
  for (int k = 0; k < 2; k++)
    theory(TANK, k ? RADIATING : FIXED, side), reference[k] = apart(side, far);
  for (int fine = 0; fine < 2; fine++) {
    const double dx = fine ? .01 : .02;
    char name[96];
    measured(LONG, FIXED, dx, far);
    for (int k = 0; k < 2; k++) {
      const double started = clock_seconds();
      measured(TANK, k ? RADIATING : FIXED, dx, side);
      snprintf(name, sizeof name, "side %s: what comes back, spacing %g mm",
               k ? "that radiates" : "of fixed head", 1e3 * dx);
      if (k)
        report(name, reference[k], apart(side, far), .05, started);
      else
        show(name, reference[k], apart(side, far), started);
    }
  }
}

/* A channel 2 m long and .15 m deep between an inflow, which starts at once in water at rest, and a
 * side of given head: how far the heads in it are from that level at most, over it, from `since`
 * to 30 s; and their mean. */
static double outlet_heads(double speed, double dx, bool radiates, double *mean) {
  enum { GAUGES = 3 };
  const double level = .15, since = 20, until = 30;
  struct run run = {0};
  double worst = 0, sum = 0;
  int reads = 0;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"99 s\"; };\n"
      "domain = { size = [\"2 m\", \"0.3 m\"]; spacing = \"%g m\"; periodic = [false, false]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"2 m\", \"%g m\"]; },\n"
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"%g m\"]; flux = \"%g m/s\"; },\n"
      "{ type = \"inflow\"; box = [\"1.99 m\", \"0\", \"2 m\", \"0.3 m\"]; head = \"%g m\"; "
      "radiates = %s; } );\n"
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
      dx, level, level, speed, level, radiates ? "true" : "false");
  while (run.s.time < until) { /* no step is cut short, after which a pressure is too high */
    const char *limit;
    if (isph_advance(&run.s, isph_stable_dt(&run.s, &limit))) give_up();
    for (int k = 0; k < GAUGES && run.s.time > since; k++, reads++) {
      const double at[3] = {.2 + .8 * k, 0, level / 3};
      const double head = at[2] + pressure_at(&run.s, at) / (9.81 * run.s.density);
      worst = fmax(worst, fabs(head / level - 1)), sum += head;
    }
  }
  finish(&run);
  *mean = sum / reads;
  return worst;
}

static void outlet(void) {
  for (int n = 0; n < 6; n++) {
    const double started = clock_seconds(), speed = n < 3 ? .05 : .2, dx = n % 3 == 1 ? .01 : .015;
    const bool radiates = n % 3 < 2;
    double mean;
    char name[96];
    const double worst = outlet_heads(speed, dx, radiates, &mean);
    snprintf(name, sizeof name, "%s, %g m/s, spacing %g mm: heads at most off by",
             radiates ? "outlet that radiates" : "outlet of fixed head", speed, 1e3 * dx);
    if (radiates)
      report(name, 0, worst, .02, started);
    else
      show(name, 0, worst, started);
    snprintf(name, sizeof name, "%s, %g m/s, spacing %g mm: their mean over the head",
             radiates ? "outlet that radiates" : "outlet of fixed head", speed, 1e3 * dx);
    if (radiates) report(name, 1, mean / .15, .01, started);
  }
}

/* Half a standing wave between walls a metre apart, a metre deep: by how much the energy of 1 J/m
 * that it has at a height of 2 cm changes a period; that of an ideal fluid stays as it is. */
static void standing(void) {
  static const struct {
    int rows, periods;
    double bound;
  } tanks[] = {{20, 20, .005}, {40, 10, .002}};
  const double k = M_PI, omega = sqrt(9.81 * k * tanh(k)), period = 2 * M_PI / omega;
  for (size_t n = 0; n < sizeof tanks / sizeof *tanks; n++) {
    const double started = clock_seconds(), speed = .02 * omega / sinh(k);
    double first = 0, most = 0;
    struct run run = {0};
    char name[96];
    start(&run,
          "scene = { method = \"isph\"; end_time = \"100 s\"; };\n"
          "domain = { size = [\"1 m\", \"1.2 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\nisph = { wall = { slip = true; }; };\n"
          "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"1 m\", \"1 m\"]; velocity = "
          "[\"1 mm/s\", \"0\"]; } );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          1.0 / tanks[n].rows);
    for (size_t i = 0; i < run.s.count; i++) {
      const double *x = run.s.position[i];
      run.s.velocity[i][0] = -speed * cosh(k * x[2]) * sin(k * x[0]);
      run.s.velocity[i][2] = speed * sinh(k * x[2]) * cos(k * x[0]);
    }
    for (int p = 0; p <= tanks[n].periods; p++) {
      most = 0;
      while (run.s.time < (p + 1) * period) {
        const char *limit;
        if (isph_advance(&run.s, isph_stable_dt(&run.s, &limit))) give_up();
        most = fmax(most, isph_kinetic_energy(&run.s));
      }
      if (p == 0) first = most;
    }
    snprintf(name, sizeof name, "standing wave: change of energy a period, %d rows", tanks[n].rows);
    report(name, 0, pow(most / first, 1.0 / tanks[n].periods) - 1, tanks[n].bound, started);
    finish(&run);
  }
}

/* A piston makes a solitary wave of .3 of the depth h of 10 cm (Goring 1978: the wall has the
 * velocity c eta/(h + eta) of the water before it). By how much the energy of the water changes
 * while the wave runs a dozen depths, from a quarter of a second after the piston has stopped on;
 * nothing acts on it. */
static void piston_wave(void) {
  enum { KNOTS = 41 };
  const double h = .1, high = .03, k = sqrt(3 * high / (4 * h * h * h)),
               c = sqrt(9.81 * (h + high));
  const double lead = 3.8 + high / h, stop = 2 / (k * c) * lead;
  for (int rows = 10; rows <= 20; rows += 10) {
    const double started = clock_seconds();
    double at = 0, energy[2];
    char times[KNOTS * 16] = "", speeds[KNOTS * 32] = "", name[96];
    size_t t = 0, v = 0;
    struct run run = {0};
    for (int n = 0; n < KNOTS; n++) {
      const double time = stop * n / (KNOTS - 1),
                   eta = high / pow(cosh(k * (c * time - at) - lead), 2);
      const double speed = n == 0 || n == KNOTS - 1 ? 0 : c * eta / (h + eta);
      at += speed * stop / (KNOTS - 1);
      t += (size_t)snprintf(times + t, sizeof times - t, "%s\"%.5g s\"", n ? "," : "", time);
      v += (size_t)snprintf(speeds + v, sizeof speeds - v, "%s\"%.5g m/s\",\"0\"", n ? "," : "",
                            speed);
    }
    start(&run,
          "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
          "domain = { size = [\"4 m\", \"0.2 m\"]; spacing = \"%g m\"; periodic = [false, false]; "
          "};\nisph = { wall = { slip = true; }; };\n"
          "regions = ( { type = \"water\"; box = [\"0.3 m\", \"0\", \"4 m\", \"0.1 m\"]; },\n"
          "{ type = \"wall\"; box = [\"0.2 m\", \"0\", \"0.3 m\", \"0.2 m\"]; times = [%s]; "
          "velocity = [%s]; } );\n"
          "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
          h / rows, times, speeds);
    const double rest = isph_potential_energy(&run.s);
    for (int n = 0; n < 2; n++) {
      advance(&run, stop + .25 + 1.2 * n);
      energy[n] = isph_kinetic_energy(&run.s) + isph_potential_energy(&run.s) - rest;
    }
    snprintf(name, sizeof name, "wave by a piston: change of energy in 12 depths, %d rows", rows);
    report(name, 0, energy[1] / energy[0] - 1, rows == 10 ? .005 : .002, started);
    finish(&run);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"absorbing", absorbing},
                                             {"radiating", radiating},
                                             {"outlet", outlet},
                                             {"standing", standing},
                                             {"piston", piston_wave}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
