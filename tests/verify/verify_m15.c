/* Reads the runs of scripts/studies/m15 and holds them against the paper, the 1-D balance and the
 * exact state at rest; draws the paper's figures 6 and 7 and the histories. Usage: verify_m15
 * FOLDER; writes FOLDER/results.json, figure-6, figure-7, histories. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/plot.h"
#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/memory.h"

#define SIDE 0.21 /* of the tank, and height of the soil, m */
#define GRAVITY 9.8

struct run {
  char name[32], form[16];
  double eps, spacing, head; /* head: height of the water at the start, m */
  size_t rows;
  double *time, *low, *high, *soil, *potential, *kinetic, *mass, *velocity;
  double seconds, lost;
};

static const char *folder;
static json_t *results;

/* What goes wrong with alpha = 0 is shown, not judged. */
static void report(const struct run *run, const char *what, double reference, double measured,
                   double bound) {
  char name[128];
  const char *status = !strcmp(run->form, "alpha0")          ? "skip"
                       : fabs(measured - reference) <= bound ? "pass"
                                                             : "fail";
  snprintf(name, sizeof name, "%s: %s", run->name, what);
  json_array_append_new(results, json_pack("{s:s, s:s, s:f, s:f, s:f, s:f}", "case", name, "status",
                                           status, "reference", reference, "measured", measured,
                                           "bound", bound, "seconds", run->seconds));
}

static double *column(struct h5_file *file, const char *name, int components, size_t *count) {
  char path[96];
  size_t dims[2] = {0, 1};
  double *values = NULL;
  snprintf(path, sizeof path, "/history/%s", name);
  if (h5_read(file, path, H5_F64, components > 1 ? 2 : 1, dims, &values) != STATUS_OK) return NULL;
  *count = dims[0];
  return values;
}

static void free_run(struct run *run) {
  double **columns[] = {&run->time,      &run->low,     &run->high, &run->soil,
                        &run->potential, &run->kinetic, &run->mass, &run->velocity};
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) memory_free(columns[i]);
}

static bool read_run(const char *form, double eps, int side, struct run *run) {
  char path[1024];
  struct h5_file *file = NULL;
  memset(run, 0, sizeof *run);
  snprintf(run->name, sizeof run->name, "%s-%.1f-%d", form, eps, side);
  snprintf(run->form, sizeof run->form, "%s", form);
  snprintf(path, sizeof path, "%s/%s.hdf", folder, run->name);
  run->eps = eps, run->spacing = SIDE / side;
  char *status = NULL;
  bool good = h5_open(path, &file) == STATUS_OK &&
              h5_read_attribute_text(file, "/run", "status", &status) == STATUS_OK;
  if (good && strcmp(status, "end_time") != 0) {
    (void)FAIL(STATUS_INPUT, "%s", status);
    good = false;
  }
  memory_free(&status);
  if (good) {
    run->time = column(file, "time", 1, &run->rows);
    run->low = column(file, "front_low", 3, &run->rows);
    run->high = column(file, "front_high", 3, &run->rows);
    run->soil = column(file, "volume_in_region_2_porous", 1, &run->rows);
    run->potential = column(file, "potential_energy", 1, &run->rows);
    run->kinetic = column(file, "kinetic_energy", 1, &run->rows);
    run->mass = column(file, "mass", 1, &run->rows);
    run->velocity = column(file, "velocity_rms", 1, &run->rows);
    good = run->time && run->low && run->high && run->soil && run->potential && run->kinetic &&
           run->mass && run->velocity && run->rows > 2 &&
           h5_read_attribute(file, "/run/timing", "wall_time", H5_F64, 1, &run->seconds) ==
               STATUS_OK &&
           h5_read_attribute(file, "/run", "particles_lost", H5_F64, 1, &run->lost) == STATUS_OK;
  }
  if (good)
    run->head = run->mass[0] / (1000 * SIDE * SIDE);
  else {
    json_array_append_new(results, json_pack("{s:s, s:s, s:n, s:s, s:n, s:n}", "case", run->name,
                                             "status", "skip", "reference", "measured",
                                             error_message(), "bound", "seconds"));
    error_clear();
    free_run(run);
  }
  h5_close(file);
  return good;
}

/* (H + C_r s) q' = G g (H + s) - eps s (a q + b q^2), s' = q/eps, H = H0 - eps s: place of the
 * front of water that falls through soil as a plug. M15's G is 1/eps where the water is in soil and
 * 1 above. Fills s[k] at times k dt, `n` of them at most; returns how many until the bottom. */
static size_t balance(const struct run *run, double dt, size_t n, double *place) {
  bool paper = !!strcmp(run->form, "akbari");
  double eps = run->eps, d = 0.01, nu = 1e-6, cr = 1 + 0.34 * (1 - eps) / eps;
  double a = 1000 * nu * pow(1 - eps, 2) / (pow(eps, 3) * d * d);
  double b = 1.1 * (1 - eps) / (pow(eps, 3) * d), q = 0, s = 1e-9;
  double scale = paper ? 1 : 1 / eps;
  for (size_t k = 0; k < n; k++) {
    place[k] = s;
    if (s >= SIDE) return k + 1;
    for (int part = 0; part < 100; part++) {
      double head = run->head - eps * s;
      double rate = GRAVITY * (head + s) - scale * eps * s * (a * q + b * q * q);
      q += dt / 100 * rate / (head + scale * cr * s);
      s += dt / 100 * q / eps;
    }
  }
  return n;
}

/* Time at which `depth`, a front falling from 0, passes `at`. */
static double passing(size_t n, const double *time, const double *depth, double at) {
  for (size_t k = 1; k < n; k++)
    if (depth[k] >= at)
      return time[k - 1] +
             (time[k] - time[k - 1]) * (at - depth[k - 1]) / (depth[k] - depth[k - 1]);
  return NAN;
}

/* Arrival, of runs and of the balance alike: the paper's moment at which the water reaches the
 * bottom of the soil (its section 5). The front is the lower face of the lowest particle; where the
 * last particle comes to a stop is the wall's affair, so the time to the bottom is that to half a
 * spacing above it and half of what the spacing before took. */
static double arrival(size_t n, const double *time, const double *depth, double spacing) {
  double near = passing(n, time, depth, SIDE - 0.5 * spacing);
  return near + 0.5 * (near - passing(n, time, depth, SIDE - 1.5 * spacing));
}

static double arrival_of_run(const struct run *run) {
  double *depth = malloc(run->rows * sizeof *depth), t;
  for (size_t k = 0; k < run->rows; k++) depth[k] = SIDE - run->low[3 * k + 2];
  t = arrival(run->rows, run->time, depth, run->spacing);
  free(depth);
  return t;
}

static double arrival_by_balance(const struct run *run) {
  enum { N = 2000 };
  static double place[N], time[N];
  for (size_t k = 0; k < N; k++) time[k] = 1e-3 * (double)k;
  return arrival(balance(run, 1e-3, N, place), time, place, run->spacing);
}

/* Points, pressure and density of the snapshot nearest to `time`. */
static size_t read_snapshot(const struct run *run, double time, double (**points)[3],
                            double **pressure, double **density) {
  char path[1100];
  struct h5_file *file = NULL;
  double *times = NULL;
  size_t n = 0, dims[2] = {0, 0}, best = 0;
  *points = NULL, *pressure = *density = NULL;
  snprintf(path, sizeof path, "%s/%s.hdf", folder, run->name);
  if (h5_open(path, &file) != STATUS_OK ||
      h5_read(file, "/run/snapshots/time", H5_F64, 1, &n, &times) != STATUS_OK)
    n = 0;
  for (size_t k = 0; k < n; k++)
    if (fabs(times[k] - time) < fabs(times[best] - time)) best = k;
  memory_free(&times);
  h5_close(file);
  if (n == 0) return error_clear(), 0;
  snprintf(path, sizeof path, "%s/%s-%04zu.hdf", folder, run->name, best);
  bool good = h5_open(path, &file) == STATUS_OK &&
              h5_read(file, "/VTKHDF/Points", H5_F64, 2, dims, points) == STATUS_OK &&
              h5_read(file, "/VTKHDF/PointData/pressure", H5_F64, 1, dims, pressure) == STATUS_OK &&
              h5_read(file, "/VTKHDF/PointData/density", H5_F64, 1, dims, density) == STATUS_OK;
  h5_close(file);
  if (!good) error_clear();
  return good ? dims[0] : 0;
}

/* At the end, a spacing and more below the surface: the rms distance of the pressure from rho g
 * (level - z), over rho g level, and the mean of 1 / kernel sum, the bulk volume over the exact
 * one.
 */
static double at_rest(const struct run *run, double level, double *bulk) {
  double(*points)[3], *pressure, *density, sum = 0, space = 0;
  size_t n = read_snapshot(run, 1e9, &points, &pressure, &density), counted = 0;
  for (size_t i = 0; i < n; i++) {
    double depth = level - points[i][2];
    if (depth < run->spacing) continue;
    sum += pow(pressure[i] - 1000 * GRAVITY * depth, 2), counted++;
    space += 1000 / density[i];
  }
  *bulk = space / (double)counted;
  memory_free(&points);
  memory_free(&pressure);
  memory_free(&density);
  return sqrt(sum / (double)counted) / (1000 * GRAVITY * level);
}

static void judge(const struct run *run) {
  double published = run->eps < 0.4 ? 0.42 : run->eps < 0.6 ? 0.34 : 0.26, rise = 0, risen = 0;
  double eps = run->eps, level = SIDE + run->head - eps * SIDE, above = level - SIDE;
  double rest = 1000 * GRAVITY * SIDE * SIDE * (eps * SIDE * SIDE / 2 + above * (SIDE + above / 2));
  double *potential = run->potential, *kinetic = run->kinetic, first = potential[0] + kinetic[0];
  size_t last = run->rows - 1;
  for (size_t i = 1; i <= last; i++) {
    double change = (potential[i] + kinetic[i] - potential[i - 1] - kinetic[i - 1]) / first;
    rise = fmax(rise, change), risen += fmax(0, change);
  }
  double share = run->soil[last] / (run->mass[last] / 1000), exact = eps * SIDE / run->head;
  double bulk, pressure = at_rest(run, level, &bulk);
  double arrived = arrival_of_run(run), expected = arrival_by_balance(run);
  if (!strcmp(run->form, "m15"))
    report(run, "front at the bottom, s (paper)", published, arrived, 0.05 * published);
  report(run, "front at the bottom, s (1-D balance)", expected, arrived, 0.05 * expected);
  report(run, "share of the water in the soil", exact, share, 0.02);
  report(run, "centre of gravity at rest over exact", 1, potential[last] / rest, 0.01);
  report(run, "pressure at rest, rms error over rho g H", 0, pressure, 0.02);
  report(run, "bulk volume at rest over exact", 1, bulk, 0.01);
  report(run, "velocity rms at the end, m/s", 0, run->velocity[last], 0.01);
  report(run, "particles lost", 0, run->lost, 0);
  report(run, "mass kept", 1, run->mass[last] / run->mass[0], 1e-12);
  report(run, "largest rise of energy in a step over the first", 0, rise, 1e-9);
  report(run, "sum of such rises", 0, risen, 1e-6);
  if (fabs(run->spacing - 0.01) < 1e-9) report(run, "wall time, s", 0, run->seconds, 180);
}

/* A slab one spacing thick through the middle of the tank, as the paper's figures show it. */
static void panel(FILE *plot, const struct run *run, double time, bool density) {
  double(*points)[3], *pressure, *density_of;
  size_t n = read_snapshot(run, time, &points, &pressure, &density_of);
  char title[96];
  fprintf(plot, "$points << EOD\n0 0 0\n");
  for (size_t i = 0; i < n; i++)
    if (fabs(points[i][1] - SIDE / 2) < 0.6 * run->spacing)
      fprintf(plot, "%.4f %.4f %.6g\n", points[i][0], points[i][2],
              density ? density_of[i] : pressure[i]);
  snprintf(title, sizeof title, "%s, %.2f s, %s", run->name, time, density ? "kg/m^3" : "Pa");
  fputs("EOD\nset title ", plot);
  plot_text(plot, title);
  fprintf(plot,
          " noenhanced\nset cbrange %s\nplot $points skip 1 using 1:2:3 with points pt 7 ps "
          "%g lc palette notitle, %g with lines lc rgb '#777777' dt 2 notitle\n",
          density ? "[800:1100]" : "[0:4000]", 60 * run->spacing, SIDE);
  memory_free(&points);
  memory_free(&pressure);
  memory_free(&density_of);
}

static void figure(const char *name, size_t rows, const struct run *const *runs,
                   const double times[][4], bool density) {
  char *body = NULL;
  size_t size;
  FILE *plot = open_memstream(&body, &size);
  fprintf(plot,
          "set multiplot layout %zu,4\nset xrange [0:%g]\nset yrange [0:.45]\nset size ratio "
          "-1\nset xtics .1\nset ytics .1\nset palette rgb 33,13,10\n",
          rows, SIDE);
  for (size_t r = 0; r < rows; r++)
    for (int k = 0; k < 4; k++) panel(plot, runs[r], times[r][k], density);
  fprintf(plot, "unset multiplot\n");
  fclose(plot);
  if (plot_save(folder, name, body, 1200, (int)(420 * rows)) != STATUS_OK) error_clear();
  free(body);
}

/* Front and share of the water in the soil against time, with the balance. */
static void histories(size_t count, const struct run *const *runs) {
  char *body = NULL;
  size_t size;
  FILE *plot = open_memstream(&body, &size);
  for (size_t r = 0; r < count; r++) {
    static double place[2000];
    const struct run *run = runs[r];
    size_t n = balance(run, 1e-3, 2000, place);
    fprintf(plot, "$run%zu << EOD\n", r);
    for (size_t k = 0; k < run->rows; k += 4)
      fprintf(plot, "%g %g %g\n", run->time[k], run->low[3 * k + 2],
              run->soil[k] / (run->mass[k] / 1000));
    fprintf(plot, "EOD\n$balance%zu << EOD\n", r);
    for (size_t k = 0; k < n; k += 5) fprintf(plot, "%g %g\n", 1e-3 * (double)k, SIDE - place[k]);
    fprintf(plot, "EOD\n");
  }
  fprintf(plot, "set multiplot layout 1,2\nset xrange [0:1.2]\nset xlabel 's'\n");
  for (int part = 0; part < 2; part++) {
    fprintf(plot, "set ylabel '%s'\n%s\nplot ",
            part ? "share of the water in the soil" : "front above the bottom, m",
            part ? "unset key" : "set key top right\nset yrange [0:*]");
    for (size_t r = 0; r < count; r++) {
      fprintf(plot, "%s$run%zu using 1:%d with lines ", r > 0 ? ", " : "", r, part + 2);
      plot_line_style(plot, r);
      fputs(" title ", plot);
      plot_text(plot, runs[r]->name);
      fprintf(plot, " noenhanced");
      if (part == 0)
        fprintf(plot, ", $balance%zu using 1:2 with lines dt 3 lc rgb '#777777' notitle", r);
    }
    fprintf(plot, "\n");
  }
  fprintf(plot, "unset multiplot\n");
  fclose(plot);
  if (plot_save(folder, "histories", body, 1200, 500) != STATUS_OK) error_clear();
  free(body);
}

/* The pictures: of the runs at the paper's 21 particles a side, or else at the most there are. */
static void draw(size_t count, const struct run *runs) {
  static const double times6[2][4] = {{.26, .42, .5, 2.5}, {.26, .42, .5, 2.5}};
  static const double times7[6][4] = {{.26, .34, .42, 2.5}, {.26, .34, .42, 2.5},
                                      {.2, .26, .34, 2.5},  {.26, .42, .84, 2.5},
                                      {.26, .34, .46, 2.5}, {.2, .28, .34, 2.5}};
  const struct run *drawn[16], *six[2] = {0}, *seven[6] = {0};
  size_t n = 0;
  double spacing = 1;
  for (size_t k = 0; k < count; k++)
    if (fabs(spacing - 0.01) > 1e-9 &&
        (runs[k].spacing < spacing || fabs(runs[k].spacing - 0.01) < 1e-9))
      spacing = runs[k].spacing;
  for (size_t k = 0; k < count; k++) {
    const struct run *run = &runs[k];
    if (fabs(run->spacing - spacing) > 1e-9) continue;
    drawn[n++] = run;
    int place = (run->eps > .4) + (run->eps > .6);
    if (!strcmp(run->form, "alpha0") || (!strcmp(run->form, "m15") && place == 0))
      six[*run->form == 'a'] = run;
    if (!strcmp(run->form, "m15")) seven[place] = run;
    if (!strcmp(run->form, "akbari")) seven[3 + place] = run;
  }
  if (six[0] != NULL && six[1] != NULL) figure("figure-6", 2, six, times6, true);
  size_t rows = seven[0] && seven[1] && seven[2] ? 3 : 0;
  if (rows == 3 && seven[3] && seven[4] && seven[5]) rows = 6;
  if (rows > 0) figure("figure-7", rows, seven, times7, false);
  if (n > 0) histories(n, drawn);
}

int main(int argc, char **argv) {
  static const struct {
    const char *form;
    double eps;
    int side;
  } cases[] = {{"m15", .3, 21},    {"m15", .5, 21},    {"m15", .8, 21},    {"akbari", .3, 21},
               {"akbari", .5, 21}, {"akbari", .8, 21}, {"alpha0", .3, 21}, {"m15", .3, 12},
               {"m15", .5, 12},    {"m15", .8, 12},    {"akbari", .3, 12}, {"akbari", .5, 12},
               {"akbari", .8, 12}, {"alpha0", .3, 12}, {"m15", .3, 32},    {"m15", .5, 32},
               {"m15", .8, 32}};
  enum { CASES = sizeof cases / sizeof *cases };
  static struct run runs[CASES];
  size_t count = 0;
  if (argc != 2) return fprintf(stderr, "usage: verify_m15 FOLDER\n"), 2;
  log_start("verify_m15", LOG_NORMAL);
  folder = argv[1];
  results = json_array();
  for (size_t k = 0; k < CASES; k++)
    if (read_run(cases[k].form, cases[k].eps, cases[k].side, &runs[count])) judge(&runs[count++]);
  draw(count, runs);
  for (size_t k = 0; k < count; k++) free_run(&runs[k]);
  char path[1024];
  snprintf(path, sizeof path, "%s/results.json", folder);
  int failed = json_dump_file(results, path, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
  json_decref(results);
  return failed ? 1 : 0;
}
