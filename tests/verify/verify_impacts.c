/* Impacts of free water on walls by method isph against measurements. Usage:
 * verify_impacts RESULTS.json [CASE...]     all cases, or those whose names start with CASE */
#include <time.h>

#include "tests/verify/isph_rig.h"

#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"

/* Sensors of `impact`, windows of means at the first two, what is read of a run (peaks, the impulse
 * at the first, means), the most runs of a dam, the most steps of one. */
enum {
  SENSORS = 3,
  WINDOWS = 2,
  READ = SENSORS + 1 + 2 * WINDOWS,
  RUNS = 25,
  STEPS = 4000,
};

struct dam {
  double depth, spacing; /* m */
  double lasts;          /* the impulse is read for so long after the arrival, s */
  int runs;              /* odd */
  bool slip;             /* the walls */
};

/* What a number read of a run is held against; no row without a name. */
struct asked {
  const char *name;
  double range[2];
  bool judged;
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

/* The mean of sensor k of `record` over the steps that end from `since` to `until` (s). */
static double mean_of(double (*record)[2 + SENSORS], int steps, int k, double since, double until) {
  double sum = 0, time = 0;
  for (int n = 0; n < steps; n++)
    if (record[n][0] > since && record[n][0] <= until)
      sum += record[n][2 + k] * record[n][1], time += record[n][1];
  return sum / time;
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
 * before the gate, the impulse (Pa s) at the lowest, and means (Pa) at the lowest two, of one run.
 */
static void run_impact(const struct dam *dam, uint64_t seed, double read[READ]) {
  static const double above[SENSORS] = {.003, .015, .03};
  static const double window[WINDOWS + 1] = {.043, .06, .079}; /* from the arrival on, s */
  static double record[STEPS][2 + SENSORS];
  const double wall = dam->spacing * round(1.61 / dam->spacing);
  double arrival = INFINITY, impulse = 0;
  int steps = 0;
  struct run run = {0};
  const clock_t begun = clock();
  start_gated_dam(&run, wall, dam->depth, dam->spacing, dam->slip);
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
  for (int n = 0; n < 2 * WINDOWS; n++) {
    const double *at = &window[n % WINDOWS];
    read[SENSORS + 1 + n] = mean_of(record, steps, n / WINDOWS, arrival + at[0], arrival + at[1]);
  }
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

/* Reports the median of `runs` values against the middle of the range asked, with that as bound,
 * and shows the least and the most. */
static void report_median(const char *name, const struct asked *asked, double *values, int runs,
                          double started) {
  char row[128];
  const double *range = asked->range;
  const double middle = .5 * (range[0] + range[1]), bound = .5 * (range[1] - range[0]);
  qsort(values, (size_t)runs, sizeof *values, ascending);
  snprintf(row, sizeof row, "%s, median of %d", name, runs);
  if (asked->judged)
    report(row, middle, values[runs / 2], bound, started);
  else
    show(row, middle, values[runs / 2], started);
  snprintf(row, sizeof row, "%s, least of %d", name, runs);
  show(row, range[0], values[0], started);
  snprintf(row, sizeof row, "%s, most of %d", name, runs);
  show(row, range[1], values[runs - 1], started);
}

/* Medians of displaced starts, as those of the repetitions: single runs are chaotic. */
static void report_impact(const struct dam *dam, const struct asked asked[READ]) {
  const double started = clock_seconds();
  double read[RUNS][READ], values[RUNS];
  for (int n = 0; n < dam->runs; n++) run_impact(dam, (uint64_t)n + 1, read[n]);
  for (int k = 0; k < READ; k++) {
    char name[96];
    if (asked[k].name == NULL) continue;
    for (int n = 0; n < dam->runs; n++) values[n] = read[n][k];
    snprintf(name, sizeof name, "impact: %s, H %g m, %g mm", asked[k].name, dam->depth,
             1e3 * dam->spacing);
    report_median(name, &asked[k], values, dam->runs, started);
  }
}

#define WITHIN(share, value)                                                                       \
  { (1 - (share)) * (value), (1 + (share)) * (value) }

/* Peaks: the range from the 2.5th to the 97.5th percentile of a hundred repetitions (table 2); a
 * peak rises and falls within 3 ms, and means over 2 ms are read here, so that the strike of one
 * particle is none. Impulse and means: the record of figure 18, whose peak is their median. It has
 * 395 Pa s (trapezoids through its 98 points) in .45 of sqrt(H/g) from the arrival on. No scatter
 * of impulses was found: a tenth, as that of the peaks at 15 and 30 mm. The means tell whether
 * there is friction at the floor: walls that slip are 15 to 31 % above. */
static void low_impact(double spacing, int runs, bool peaks) {
  const struct asked asked[READ] = {
      {"peak at 3 mm, Pa", {7506, 13098}, peaks},
      {"peak at 15 mm, Pa", {5326, 6331}, peaks},
      {"peak at 30 mm, Pa", {3979, 4962}, true},
      {"impulse at 3 mm, Pa s", WITHIN(.1, 395), true},
      {"mean at 3 mm, 43 to 60 ms, Pa", WITHIN(.08, 4190), true},
      {"mean at 3 mm, 60 to 79 ms, Pa", WITHIN(.08, 3700), true},
      {"mean at 15 mm, 43 to 60 ms, Pa", WITHIN(.08, 4440), true},
      {"mean at 15 mm, 60 to 79 ms, Pa", WITHIN(.08, 3700), true},
  };
  report_impact(&(struct dam){.3, spacing, .45 * sqrt(.3 / 9.81), runs, false}, asked);
}

/* A sensor's face is 4.2 mm wide, and the water that strikes the wall is 15 to 25 mm thick.
 * Particles of 5 mm are wider than the face, and three to five of them lie in that water: it
 * pulses, and the medians of both lower peaks are 11 and 12 % above their ranges (shown). So peaks
 * are judged on particles of 2.5 mm; single runs scatter by less than half as much there, and five
 * will do. */
static void coarse_impact(void) {
  low_impact(.005, 25, false);
}
static void fine_impact(void) {
  low_impact(.0025, 5, true);
}

/* Medians of section 5.2.3, shown only: 1274 Pa s is of each run over its own impact time (twice
 * the time from half the peak to the peak, and twice that from there to half the peak), not of the
 * sum of their median times, 7 and 104 ms. With the shape of figure 18 the median peak and times
 * give 1105. What is judged is the impulse with walls that slip, where two methods solve the same
 * equations: interFoam has 1187 (cells of 5 mm, 1.25 by the floor, read as here; the cells of
 * tests/verify/dam_reference 161 .6 slip, twice as wide, have 1152). */
static void high_impact(void) {
  static const struct asked shown[READ] = {{"peak at 3 mm, Pa", {18569, 18569}, false},
                                           [SENSORS] = {"impulse at 3 mm, Pa s",
                                                        {1274, 1274},
                                                        false}},
                            judged[READ] = {[SENSORS] = {"impulse at 3 mm, slip, Pa s",
                                                         WITHIN(.04, 1187), true}};
  report_impact(&(struct dam){.6, .0075, .111, 11, false}, shown);
  report_impact(&(struct dam){.6, .0075, .111, 3, true}, judged);
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {
      {"low", coarse_impact}, {"fine", fine_impact}, {"high", high_impact}};
  return run_cases(argc, argv, cases, sizeof cases / sizeof *cases);
}
