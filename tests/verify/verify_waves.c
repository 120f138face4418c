/* Waves before an absorbing side by method isph against the linear equations of long waves. Usage:
 * verify_waves RESULTS.json [CASE...]     all cases, or those whose names start with CASE */
#include "tests/verify/isph_rig.h"

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

/* By staggered differences: du/dt = -g d eta/dx - gamma u, d eta/dt = -h du/dx. level [READINGS],
 * m. */
static void theory(double tank, bool absorbs, double *velocity) {
  enum { PER_METRE = 100, MOST = 10 * PER_METRE };
  static double eta[MOST], u[MOST + 1];
  const double g = 9.81, c = sqrt(g * DEPTH), dx = 1.0 / PER_METRE;
  const int n = (int)lround(tank * PER_METRE), probe = (int)lround(PROBE * PER_METRE);
  const int steps = 8;
  const double dt = READ / steps;
  for (int i = 0; i < n; i++) {
    const double x = (i + .5) * dx;
    eta[i] = x < LENGTH ? HEIGHT : x < 2 * LENGTH ? -HEIGHT : 0;
    u[i] = u[i + 1] = 0;
  }
  for (int r = 0; r < READINGS; r++) {
    for (int k = 0; k < steps; k++) {
      for (int i = 1; i < n; i++) {
        const double way = fmax(0, (i * dx - EDGE) / (TANK - EDGE));
        const double half = absorbs ? .5 * dt * 10 * c / (TANK - EDGE) * way * way : 0;
        u[i] = (u[i] * (1 - half) - dt * g * (eta[i] - eta[i - 1]) / dx) / (1 + half);
      }
      for (int i = 0; i < n; i++) eta[i] -= dt * DEPTH * (u[i + 1] - u[i]) / dx;
    }
    velocity[r] = u[probe];
  }
}

static void measured(double tank, bool absorbs, double dx, double *velocity) {
  struct run run = {0};
  char side[128] = "";
  const double probe[3] = {PROBE, 0, DEPTH / 4};
  if (absorbs)
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
  theory(TANK, true, side);
  theory(LONG, false, far);
  const double reference = apart(side, far);
  for (int fine = 0; fine < 2; fine++) {
    const double started = clock_seconds(), dx = fine ? .01 : .02;
    char name[96];
    measured(LONG, false, dx, far);
    measured(TANK, true, dx, side);
    snprintf(name, sizeof name, "absorbing side: what comes back, spacing %g mm", 1e3 * dx);
    report(name, reference, apart(side, far), .03, started);
    measured(TANK, false, dx, side);
    snprintf(name, sizeof name, "closed side: what comes back, spacing %g mm", 1e3 * dx);
    show(name, 1, apart(side, far), started);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"absorbing", absorbing}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
