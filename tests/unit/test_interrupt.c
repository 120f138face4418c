/* Ctrl-C in every stage of a run: sphsolve is told to stop at its n-th look for a signal, for n all
 * through the run, and what --resume makes of what was left is, bit for bit, the run that was never
 * stopped. No clock decides here. */
#include "faults.h"
#include "long_tests.h"

#include <math.h>

#include "common/interrupt.h"
#include "common/model_file.h"

int sphsolve_main(int argc, char **argv);
#define main sphsolve_main
#include "sphsolve/sphsolve.c"
#undef main

enum { MOST = 44, STOPS = 12 };
#define EDGE 1.4e-4
#define MANY 100000000L

static double periodic(double x) {
  return x - round(x);
}

/* Two spheres in a periodic box of n voxels a side; with all parts of the error, as of a scan with
 * a blur whose sides were wrapped. */
static void write_spheres(size_t n, bool parts) {
  static float distance[MOST * MOST * MOST];
  static uint8_t solid[MOST * MOST * MOST];
  const double centre[2][3] = {{0.264, 0.307, 0.25}, {0.771, 0.707, 0.729}};
  const double radius[2] = {0.314, 0.257}, spacing = EDGE / (double)n;
  for (size_t i = 0; i < n * n * n; i++) {
    const size_t at[3] = {i % n, i / n % n, i / n / n};
    double least = INFINITY;
    for (int s = 0; s < 2; s++) {
      double square = 0.0;
      for (int a = 0; a < 3; a++)
        square += pow(periodic((double)at[a] / (double)n - centre[s][a]), 2.0);
      least = fmin(least, sqrt(square) - radius[s]);
    }
    distance[i] = (float)(EDGE * least);
    solid[i] = least <= 0.0;
  }
  const struct voxel_model model = {.size = {n, n, n},
                                    .spacing = {spacing, spacing, spacing},
                                    .periodic = {true, true, true},
                                    .solid = solid,
                                    .wall_distance = distance};
  static const char *const names[] = {"contrast_to_noise", "noise_correlation", "blur",
                                      "blur_uncertainty",  "resolution",        "removed"};
  const double values[] = {5.0, 0.5 * spacing, spacing, 0.1 * spacing, spacing, 1.0};
  struct h5_file *file;
  unlink("model.hdf");
  assert_int_equal(h5_create("model.hdf", &file), STATUS_OK);
  assert_int_equal(model_write(file, &model), STATUS_OK);
  if (parts) {
    assert_int_equal(h5_write_attribute_text(file, "/model", "sides", "periodic"), STATUS_OK);
    assert_int_equal(h5_make_group(file, "/scanner"), STATUS_OK);
  }
  for (size_t i = 0; parts && i < sizeof values / sizeof *values; i++)
    assert_int_equal(h5_write_attribute(file, "/scanner", names[i], H5_F64, 1, &values[i]),
                     STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  FILE *scene = fopen("scene.cfg", "w");
  fputs("scene = { method = \"stokes\"; };\nmodel = { file = \"model.hdf\"; };\n"
        "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n"
        "force = { body_acceleration = [\"0\", \"0\", \"-9.8 m/s^2\"]; };\n",
        scene);
  fclose(scene);
}

/* What a run found: numbers of its record, and a sum of all velocities with weights. */
enum { NUMBERS = 10 };
struct found {
  double of[NUMBERS], balance[2], flow;
};

static struct found read_found(void) {
  static const char *const names[NUMBERS] = {
      "k",        "k_low",    "k_high",     "k_finest",   "k_solver_error",
      "reynolds", "residual", "divergence", "iterations", "sites_solved"};
  struct found found = {.flow = 0.0};
  struct h5_file *file;
  float *velocity = NULL;
  size_t dims[4];
  assert_int_equal(h5_open("out.hdf", &file), STATUS_OK);
  for (int i = 0; i < NUMBERS; i++) found.of[i] = h5_attribute_or_nan(file, "/run", names[i]);
  found.balance[0] = h5_attribute_or_nan(file, "/run/ledger", "flux_open");
  found.balance[1] = h5_attribute_or_nan(file, "/run/ledger", "force_open");
  h5_close(file);
  assert_int_equal(h5_open("out-image.hdf", &file), STATUS_OK);
  assert_int_equal(h5_read(file, "/VTKHDF/PointData/velocity", H5_F32, 4, dims, &velocity),
                   STATUS_OK);
  h5_close(file);
  for (size_t i = 0; i < dims[0] * dims[1] * dims[2] * dims[3]; i++)
    found.flow += (double)velocity[i] * (double)(1 + i % 7);
  memory_free(&velocity);
  return found;
}

static double number_of(const char *path, const char *group, const char *name) {
  struct h5_file *file;
  assert_int_equal(h5_open_output(path, &file), STATUS_OK);
  const double number = h5_attribute_or_nan(file, group, name);
  h5_close(file);
  return number;
}

/* How far a run is that was stopped at the n-th look: twice the lattices before the one whose
 * solution it keeps, and 1 where that is at its end; -1: it keeps none. */
static int progress_at(const char *start, long n, double *iterations) {
  struct h5_file *file;
  double *cascade = NULL;
  size_t count;
  kept_each(kept_drop);
  interrupt_after(n);
  assert_int_equal(faults_run(sphsolve_main, start), 130);
  interrupt_after(0);
  if (access("out.ckpt.hdf", F_OK) != 0) return -1;
  assert_int_equal(h5_open("out.ckpt.hdf", &file), STATUS_OK);
  assert_int_equal(h5_read_attribute(file, "/state", "iterations", H5_F64, 1, iterations),
                   STATUS_OK);
  assert_int_equal(h5_read(file, "/state/cascade", H5_F64, 1, &count, &cascade), STATUS_OK);
  const int progress = 2 * (int)cascade[0] + !h5_exists(file, "/state/residual0");
  h5_close(file);
  memory_free(&cascade);
  return progress;
}

/* The run's looks for a signal. */
static long run_whole(const char *command, int code) {
  interrupt_after(MANY);
  const int found = faults_run(sphsolve_main, command);
  if (found != code) faults_show();
  assert_int_equal(found, code);
  return MANY - interrupt_after(0);
}

/* Looks while image and snapshot are written: one a dataset. */
enum { WRITING = 9 };

/* Of looks 1 to `most` the first at which a run that is stopped keeps at least `progress`. */
static long first_that_keeps(const char *start, int progress, long most, double *iterations) {
  long before = 0, found = most;
  while (found - before > 1) {
    const long middle = before + (found - before) / 2;
    if (progress_at(start, middle, iterations) >= progress)
      found = middle;
    else
      before = middle;
  }
  return found;
}

/* `last`: of the looks from the first lattice on, the part that a run does again which was stopped
 * in its last lattice. What comes before, reading the model and planning, each start does. */
static void stop_everywhere(const char *options, double last) {
  char start[200], resume[220];
  double iterations;
  snprintf(start, sizeof start, "sphsolve run scene.cfg -o out --threads 1 --quiet %s", options);
  snprintf(resume, sizeof resume, "%s --resume", start);
  kept_each(kept_drop);
  const long looks = run_whole(start, 0);
  const struct found whole = read_found();
  for (int i = 0; i < NUMBERS; i++) assert_true(isfinite(whole.of[i]));
  assert_true(isfinite(whole.balance[0]) && isfinite(whole.balance[1]));
  const long begun = first_that_keeps(start, 0, looks, &iterations);
  for (int i = 0; i < STOPS + WRITING; i++) {
    const long n = i < STOPS ? 1 + (looks - 1) * i / (STOPS - 1) : looks + STOPS - 1 - i;
    kept_each(kept_drop);
    const size_t held = memory_in_use();
    interrupt_after(n);
    assert_int_equal(faults_run(sphsolve_main, start), 130);
    interrupt_after(0);
    assert_int_equal(memory_in_use(), held);
    kept_each(faults_check_file);
    if (faults.file[0] != '\0') fail_msg("look %ld: %s", n, faults.file);
    /* Of what was being written nothing stays but whole files, and k in the record. */
    if (n > looks - WRITING) assert_true(isfinite(number_of("out.hdf", "/run", "k")));
    const long left = run_whole(resume, 0);
    assert_int_equal(access("out-0001.hdf", F_OK), -1);
    /* Coarser lattices are not solved again. */
    if (n > looks * 9 / 10 && (double)(left - begun) > last * (double)(looks - begun))
      fail_msg("look %ld of %ld: %ld after it, %ld of them to begin", n, looks, left, begun);
    const struct found again = read_found();
    if (memcmp(&whole, &again, sizeof whole) != 0)
      fail_msg("look %ld of %ld: k is %.17g, not %.17g", n, looks, again.of[0], whole.of[0]);
  }
  print_message("# %s: %ld looks, %ld to begin\n", start, looks, begun);
}

static void test_cascade(void **state) {
  (void)state;
  write_spheres(14, true);
  stop_everywhere("--error 1%", 0.5);
}
/* The last lattice is one that was chosen, with which the error was expected to be reached. Until
 * its first round is over the one before it is what is kept, and both are set up anew: that takes
 * their part of the points of all lattices at most. */
static void long_test_chosen_lattice(void **state) {
  (void)state;
  static const char options[] = "--error 1.25%", run[] = "sphsolve run scene.cfg -o out --quiet ";
  char start[100];
  struct h5_file *file;
  double *spacing = NULL, *points = NULL, all = 0.0;
  size_t count;
  write_spheres(MOST, false);
  snprintf(start, sizeof start, "%s%s", run, options);
  kept_each(kept_drop);
  run_whole(start, 0);
  assert_int_equal(h5_open("out.hdf", &file), STATUS_OK);
  assert_int_equal(h5_read(file, "/run/levels/spacing", H5_F64, 1, &count, &spacing), STATUS_OK);
  assert_int_equal(h5_read(file, "/run/levels/sites", H5_F64, 1, &count, &points), STATUS_OK);
  h5_close(file);
  assert_true(count > 4);
  assert_true(fabs(spacing[count - 2] / spacing[count - 1] - sqrt(2.0)) > 0.1);
  for (size_t i = 0; i < count; i++) all += points[i];
  stop_everywhere(options, (points[count - 2] + points[count - 1]) / all);
  memory_free(&spacing);
  memory_free(&points);
}
/* Up to its first round a lattice has nothing worth keeping beside what it began from. */
static void test_before_the_first_round(void **state) {
  (void)state;
  static const char start[] = "sphsolve run scene.cfg -o out --threads 1 --quiet --error 1%";
  write_spheres(14, true);
  kept_each(kept_drop);
  double iterations = 0.0;
  /* the first look that keeps the second lattice */
  const long begun = first_that_keeps(start, 2, run_whole(start, 0), &iterations);
  assert_int_equal(progress_at(start, begun, &iterations), 2);
  assert_true(iterations > 0.0);
}
static void long_test_fixed_lattices(void **state) {
  (void)state;
  write_spheres(14, true);
  stop_everywhere("", 0.5);
}

/* A large file that may be left is left between two batches of chunks, and nothing of it stays; a
 * checkpoint, which is written after a signal, is written to its end. */
static void test_left_on_signal(void **state) {
  (void)state;
  const size_t dims[3] = {40, 250, 1000}, count = dims[0] * dims[1] * dims[2];
  float *values = calloc(count, sizeof *values);
  static const char path[] = "large.hdf", part[] = "large.hdf.part";
  struct h5_file *file = NULL;
  for (int leave = 0; leave < 2; leave++) {
    unlink(path);
    assert_int_equal(h5_create(path, &file), STATUS_OK);
    h5_leave_on_signal(leave == 1);
    interrupt_after(3); /* not at the beginning of the dataset */
    assert_int_equal(h5_write(file, "/values", H5_F32, 3, dims, values, true),
                     leave ? STATUS_INTERRUPTED : STATUS_OK);
    assert_int_equal(interrupt_after(0), leave ? 0 : 3);
    h5_leave_on_signal(false);
    if (leave)
      h5_close(file);
    else
      assert_int_equal(h5_commit(file), STATUS_OK);
    assert_int_equal(access(path, F_OK), leave ? -1 : 0);
    assert_int_equal(access(part, F_OK), -1);
  }
  error_clear();
  free(values);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_left_on_signal), cmocka_unit_test(test_cascade),
      cmocka_unit_test(test_before_the_first_round), cmocka_unit_test(long_test_chosen_lattice),
      cmocka_unit_test(long_test_fixed_lattices)};
  long_tests_choose();
  return cmocka_run_group_tests(tests, faults_start, faults_end);
}
