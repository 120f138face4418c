/* Speed of method isph: a tank of water over soil, and a periodic box half full of soil (two
 * projections a step), stirred. Seconds a step, cost per particle against size, the pressure
 * solve's share, the iterations a solve takes from a cold start and from the last pressure (the
 * second projection of a step always starts from nothing). bench_isph OUT.json
 * [LARGEST]     up to LARGEST particles (1e6)
 *   bench_isph OUT.json [tank|box]     up to BENCH_LARGEST particles (1e6) */
#include <time.h>

#include "common/threads.h"
#include "tests/verify/isph_rig.h"

struct measure {
  double particles, step, cost; /* s by the clock; processor s per particle */
  double share;                 /* of the solve in the step */
  double cold, warm;            /* iterations a solve */
};

static double cpu_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct measure measure(bool tank, int side) {
  enum { SETTLE = 10, STEPS = 4 };
  struct run run = {0};
  struct measure m = {0};
  double length = .01 * side, solves = tank ? 1 : 2;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
      "domain = { size = [\"%g m\", \"%g m\", \"%g m\"]; spacing = \"1 cm\"; periodic = [%s]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0\", \"%g m\", \"%g m\", \"%g m\"]; "
      "},\n"
      "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"%g m\", \"%g m\", \"%g m\"]; porosity = "
      "0.4; "
      "grain_size = \"1 cm\"; } );\n"
      "force = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\n",
      length, length, length + (tank ? .05 : 0), tank ? "false, false, false" : "true, true, true",
      length, length, length, length, length, .01 * (side / 2));
  struct isph *s = &run.s;
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a++)
      s->velocity[i][a] += .05 * sin(4 * M_PI / length * s->position[i][(a + 1) % 3]);
  advance(&run, 1e-3 * SETTLE);
  double cpu = cpu_seconds(), clock = clock_seconds(), solve = s->seconds_solve;
  for (int k = 1; k <= STEPS; k++) {
    advance(&run, 1e-3 * (SETTLE + k));
    m.warm += s->solve.iterations / solves / STEPS;
  }
  m.particles = (double)s->count;
  m.step = (clock_seconds() - clock) / STEPS;
  m.cost = (cpu_seconds() - cpu) / STEPS / m.particles;
  m.share = (s->seconds_solve - solve) / STEPS / m.step;
  memset(s->pressure, 0, s->count * sizeof *s->pressure);
  advance(&run, 1e-3 * (SETTLE + STEPS + 1));
  m.cold = s->solve.iterations / solves;
  finish(&run);
  return m;
}

static void sizes(bool tank) {
  static const int sides[] = {22, 46, 74, 100};
  const char *what = tank ? "tank over soil" : "box half of soil, two projections";
  const char *limit = getenv("BENCH_LARGEST");
  double largest = limit != NULL ? strtod(limit, NULL) : 1e6, least = INFINITY, most = 0;
  double fewest = INFINITY, many = 0;
  char name[128];
  for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
    double started = clock_seconds();
    if (pow(sides[k], 3) > 1.001 * largest) continue;
    struct measure m = measure(tank, sides[k]);
    least = fmin(least, m.cost), most = fmax(most, m.cost);
    fewest = fmin(fewest, m.cold), many = fmax(many, m.cold);
    printf("%-34s %7.0f particles: step %.3f s, %.2f us of processor per particle, solve %.0f %%, "
           "iterations a solve %.1f cold, %.1f warm\n",
           what, m.particles, m.step, 1e6 * m.cost, 100 * m.share, m.cold, m.warm);
    snprintf(name, sizeof name, "isph, %s: warm over cold iterations, %.0f", what, m.particles);
    report(name, 0, m.warm / m.cold, .999, started);
    snprintf(name, sizeof name, "isph, %s: s a step, %.0f particles", what, m.particles);
    report(name, 0, m.step, m.particles * 2 / 4e5, started);
  }
  snprintf(name, sizeof name, "isph, %s: cost per particle, most over least", what);
  report(name, 1, most / least, .3, clock_seconds());
  snprintf(name, sizeof name, "isph, %s: cold iterations a solve, most less least", what);
  report(name, 0, many - fewest, 4, clock_seconds());
}

static void tank(void) {
  sizes(true);
}

static void box(void) {
  sizes(false);
}

/* Threads wait as those of the program: processor seconds of threads that spin are no work. */
int main(int argc, char **argv) {
  threads_wait_asleep(argv);
  static const struct verify_case cases[] = {{"tank", tank}, {"box", box}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
