/* Reads the runs of scripts/m15 and holds them against the paper, the 1-D balance and the exact
 * state at rest. Usage: verify_m15 FOLDER; writes FOLDER/results.json. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"

#define SIDE 0.21 /* of the tank, and height of the soil, m */
#define HEAD 0.20 /* height of the water at the start, m */
#define GRAVITY 9.8
#define TOUCH 0.002 /* m */

static json_t *results;
static double seconds; /* of the run being judged */

static void report(const char *run, const char *what, double reference, double measured,
                   double bound) {
  char name[128];
  bool pass = fabs(measured - reference) <= bound;
  snprintf(name, sizeof name, "%s: %s", run, what);
  printf("%-4s %-48s reference %-10.4g measured %-10.4g bound %.3g\n", pass ? "pass" : "FAIL", name,
         reference, measured, bound);
  json_array_append_new(results,
                        json_pack("{s:s, s:s, s:f, s:f, s:f, s:f}", "case", name, "status",
                                  pass ? "pass" : "fail", "reference", reference, "measured",
                                  measured, "bound", bound, "seconds", seconds));
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

/* (H + C_r s) q' = G g (H + s) - eps s (a q + b q^2), s' = q/eps, H = H0 - eps s: time for the
 * front to pass the soil. M15's G is 1/eps where the water is in soil and 1 above. */
static double balance(double eps, bool paper) {
  double d = 0.01, nu = 1e-6, cr = 1 + 0.34 * (1 - eps) / eps;
  double a = 1000 * nu * pow(1 - eps, 2) / (pow(eps, 3) * d * d);
  double b = 1.1 * (1 - eps) / (pow(eps, 3) * d), q = 0, s = 1e-9, t = 0, dt = 1e-5;
  double scale = paper ? 1 : 1 / eps;
  for (; s < SIDE && t < 5; t += dt) {
    double head = HEAD - eps * s;
    double rate = GRAVITY * (head + s) - scale * eps * s * (a * q + b * q * q);
    q += dt * rate / (head + scale * cr * s);
    s += dt * q / eps;
  }
  return t;
}

static void judge(const char *folder, const char *name, double eps, bool paper, bool relaxed) {
  char path[1024];
  struct h5_file *file = NULL;
  size_t n = 0, m;
  snprintf(path, sizeof path, "%s/%s.hdf", folder, name);
  if (h5_open(path, &file) != STATUS_OK) {
    printf("skip %s: %s\n", name, error_message());
    error_clear();
    return;
  }
  seconds = 0;
  if (h5_attribute_exists(file, "/run", "wall_time") &&
      h5_read_attribute(file, "/run", "wall_time", H5_F64, 1, &seconds) != STATUS_OK)
    error_clear();
  double *time = column(file, "time", 1, &n), *low = column(file, "front_low", 3, &m);
  double *soil = column(file, "volume_in_region_2_porous", 1, &m);
  double *potential = column(file, "potential_energy", 1, &m);
  double *kinetic = column(file, "kinetic_energy", 1, &m), *mass = column(file, "mass", 1, &m);
  if (time && low && soil && potential && kinetic && mass && n > 1) {
    double arrival = NAN, rise = 0;
    for (size_t i = 1; i < n; i++) {
      /* The lowest particle touches the floor, to within the .2 spacings that walls guard. */
      if (isnan(arrival) && low[3 * i + 2] <= TOUCH) {
        double before = low[3 * i - 1], after = low[3 * i + 2];
        arrival = time[i - 1] + (time[i] - time[i - 1]) * (before - TOUCH) / (before - after);
      }
      rise = fmax(rise, potential[i] + kinetic[i] - potential[i - 1] - kinetic[i - 1]);
    }
    double published = eps < 0.4 ? 0.42 : eps < 0.6 ? 0.34 : 0.26;
    double level = SIDE + HEAD - eps * SIDE, area = SIDE * SIDE, above = level - SIDE;
    double weight = 1000 * GRAVITY * area;
    double rest = weight * (eps * SIDE * SIDE / 2 + above * (SIDE + above / 2));
    if (paper && relaxed)
      report(name, "front at the bottom, s (paper)", published, arrival, 0.05 * published);
    if (relaxed) {
      if (!paper)
        report(name, "front at the bottom, s (1-D balance)", balance(eps, false), arrival,
               0.05 * balance(eps, false));
      report(name, "share of the water in the soil", eps * SIDE / HEAD, soil[n - 1] / (area * HEAD),
             0.02);
      report(name, "centre of gravity at rest over exact", 1, potential[n - 1] / rest, 0.01);
      report(name, "mass kept", 1, mass[n - 1] / mass[0], 1e-12);
      report(name, "largest rise of energy in 5 ms over the first", 0, rise / potential[0], 1e-3);
    } else {
      /* What goes wrong without the relaxation is shown, not judged. */
      printf("     %s: share of the water in the soil %.3f, exact %.3f; centre of gravity %.4f\n",
             name, soil[n - 1] / (area * HEAD), eps * SIDE / HEAD, potential[n - 1] / rest);
    }
  }
  memory_free(&time);
  memory_free(&low);
  memory_free(&soil);
  memory_free(&potential);
  memory_free(&kinetic);
  memory_free(&mass);
  h5_close(file);
}

int main(int argc, char **argv) {
  static const double eps[] = {0.3, 0.5, 0.8};
  if (argc != 2) return fprintf(stderr, "usage: verify_m15 FOLDER\n"), 2;
  results = json_array();
  for (int paper = 1; paper >= 0; paper--)
    for (int k = 0; k < 3; k++) {
      char name[32];
      snprintf(name, sizeof name, "%s-%.1f", paper ? "m15" : "akbari", eps[k]);
      judge(argv[1], name, eps[k], paper, true);
    }
  judge(argv[1], "alpha0-0.3", 0.3, true, false);
  char path[1024];
  snprintf(path, sizeof path, "%s/results.json", argv[1]);
  int failed = json_dump_file(results, path, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
  json_decref(results);
  return failed ? 1 : 0;
}
