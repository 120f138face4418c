/* Impacts of free water on walls by method isph against measurements. Usage:
 * verify_impacts RESULTS.json [CASE...]     all cases, or those whose names start with CASE */
#include <time.h>

#include "tests/verify/isph_rig.h"

/* Sensors of `impact`, what is read of a run (their peaks, and the impulse at the first), the most
 * runs of a dam, the most steps of one. */
enum { SENSORS = 3, READ = SENSORS + 1, RUNS = 25, STEPS = 4000 };

struct dam {
  double depth, spacing; /* m */
  double lasts;          /* the impulse is read for so long after the arrival, s */
  int runs;              /* odd */
};

/* The largest mean over `width` (s) of sensor k of `record` (rows of time, its step, pressures). */
static double peak_of(double (*record)[2 + SENSORS], int steps, int k, double width) {
  double most = 0, sum = 0, time = 0;
  for (int n = 0, first = 0; n < steps; n++) {
    sum += record[n][2 + k] * record[n][1], time += record[n][1];
    for (; time - record[first][1] >= width; first++)
      sum -= record[first][2 + k] * record[first][1], time -= record[first][1];
    most = fmax(most, time >= width ? sum / time : 0);
  }
  return most;
}

/* Displaces the water by up to a thousandth of a spacing along x and z, uniformly: the numbers of
 * Steele, Lea, Flood 2014 (OOPSLA, splitmix64), which each seed has its own of. */
static void displace(struct isph *s, uint64_t seed) {
  uint64_t state = seed << 32;
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a += 2) {
      uint64_t z = state += 0x9e3779b97f4a7c15;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
      z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
      s->position[i][a] +=
          1e-3 * s->spacing * (2 * ldexp((double)((z ^ (z >> 31)) >> 11), -53) - 1);
    }
  if (isph_refresh(s)) give_up();
}

/* The peaks (Pa, means over 2 ms) by sensors 3, 15 and 30 mm above the floor on the wall 1.01 m
 * before the gate, and the impulse (Pa s) at the lowest, of one run. */
static void run_impact(const struct dam *dam, uint64_t seed, double read[READ]) {
  static const double above[SENSORS] = {.003, .015, .03};
  static double record[STEPS][2 + SENSORS];
  const double wall = dam->spacing * round(1.61 / dam->spacing);
  double arrival = INFINITY, impulse = 0;
  int steps = 0;
  struct run run = {0};
  const clock_t begun = clock();
  start_gated_dam(&run, wall, dam->depth, dam->spacing);
  displace(&run.s, seed);
  while (run.s.time < fmin(3.4 * sqrt(dam->depth / 9.81), arrival + 1.1 * dam->lasts) &&
         steps < STEPS) {
    const char *limit;
    const double dt = isph_stable_dt(&run.s, &limit);
    if (isph_advance(&run.s, dt)) give_up();
    record[steps][0] = run.s.time, record[steps][1] = dt;
    for (int k = 0; k < SENSORS; k++)
      record[steps][2 + k] = pressure_at(&run.s, (double[3]){wall, 0, above[k]});
    if (record[steps][2] > .05 * 9810 * dam->depth) arrival = fmin(arrival, run.s.time);
    if (run.s.time <= arrival + dam->lasts && isfinite(arrival)) impulse += record[steps][2] * dt;
    steps++;
  }
  for (int k = 0; k < SENSORS; k++) read[k] = peak_of(record, steps, k, .002);
  read[SENSORS] = impulse;
  printf("     start %d: peaks %.0f, %.0f, %.0f Pa, impulse %.0f Pa s, %d steps, %.0f s\n",
         (int)seed, read[0], read[1], read[2], impulse, steps,
         (double)(clock() - begun) / CLOCKS_PER_SEC);
  fflush(stdout);
  finish(&run);
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Reports the median of `runs` values against the middle of `range`, with that as bound, and shows
 * the least and the most; judged only if `judged`. */
static void report_median(const char *name, const double range[2], double *values, int runs,
                          bool judged, double started) {
  char row[128];
  const double middle = .5 * (range[0] + range[1]), bound = .5 * (range[1] - range[0]);
  qsort(values, (size_t)runs, sizeof *values, ascending);
  snprintf(row, sizeof row, "%s, median of %d", name, runs);
  if (judged)
    report(row, middle, values[runs / 2], bound, started);
  else
    show(row, middle, values[runs / 2], started);
  snprintf(row, sizeof row, "%s, least of %d", name, runs);
  show(row, range[0], values[0], started);
  snprintf(row, sizeof row, "%s, most of %d", name, runs);
  show(row, range[1], values[runs - 1], started);
}

/* Medians of displaced starts, as those of the repetitions: single runs are chaotic. Peaks: the
 * range from the 2.5th to the 97.5th percentile of a hundred repetitions (table 2, H = .3 m); a
 * peak rises and falls within 3 ms, and means over 2 ms are read here, so that the strike of one
 * particle is none. Impulses at 3 mm from the arrival on: H = .3 m, .45 of sqrt(H/g) of the record
 * of figure 18, whose peak is their median; .6 m, their median impulse, over their median times of
 * rise and fall, 7 and 104 ms (section 5.2.3). No scatter of impulses was found: a tenth, as that
 * of the peaks at 15 and 30 mm. */
static void report_impact(const struct dam *dam, const double (*peaks)[2], bool judged,
                          double seen) {
  static const char *const places[] = {"peak at 3 mm, Pa", "peak at 15 mm, Pa", "peak at 30 mm, Pa",
                                       "impulse at 3 mm, Pa s"};
  const double started = clock_seconds(), impulse[2] = {.9 * seen, 1.1 * seen};
  double read[RUNS][READ], values[RUNS];
  for (int n = 0; n < dam->runs; n++) run_impact(dam, (uint64_t)n + 1, read[n]);
  for (int k = 0; k < READ; k++) {
    char name[96];
    const double *range = k == SENSORS ? impulse : peaks[k];
    if (range[0] <= 0) continue;
    for (int n = 0; n < dam->runs; n++) values[n] = read[n][k];
    snprintf(name, sizeof name, "impact: %s, H %g m, %g mm", places[k], dam->depth,
             1e3 * dam->spacing);
    report_median(name, range, values, dam->runs, k == SENSORS || judged, started);
  }
}

static void low_impact(void) {
  static const double peaks[SENSORS][2] = {{7506, 13098}, {5326, 6331}, {3979, 4962}};
  report_impact(&(struct dam){.3, .005, .45 * sqrt(.3 / 9.81), 25}, peaks, true, 406);
}

static void high_impact(void) {
  static const double peaks[SENSORS][2] = {{18569, 18569}};
  report_impact(&(struct dam){.6, .0075, .111, 11}, peaks, false, 1274);
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"low", low_impact}, {"high", high_impact}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
