/* Film strip of a plume: displacements of the walkers at times that double. */
#include <math.h>

#include "analyze/analysis.h"
#include "analyze/solute_flow.h"
#include "common/hdf5_file.h"
#include "common/memory.h"

#define FRAMES_MAX 6 /* the last ones, at most */

struct film {
  size_t frames, rows, columns; /* bins across and along the flow */
  double peclet;
  double *share;       /* [frames][rows][columns] */
  double *time;        /* [frames], s */
  double *low, *width; /* [frames][2], along and across, m */
};

static void name_of(char path[64], size_t walk, const char *what) {
  snprintf(path, 64, "/solute/walk/%zu/plume%s", walk, what);
}

static enum status read_film(const char *path, struct film *f) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  double *peclet = NULL;
  char name[64];
  size_t n, walk = 0, shape[3], times, low[2], width[2];
  TRY(h5_open(path, &file));
  TRY(h5_read(file, "/solute/peclet", H5_F64, 1, &n, &peclet));
  if (n == 0) TRY_FAIL(STATUS_INPUT, "%s: /solute/peclet is empty", path);
  for (size_t i = 0; i < n; i++) {
    name_of(name, i, "");
    if (h5_exists(file, name) && peclet[i] >= peclet[walk]) walk = i;
  }
  f->peclet = peclet[walk];
  name_of(name, walk, "");
  TRY(h5_read(file, name, H5_F64, 3, shape, &f->share));
  name_of(name, walk, "_time");
  TRY(h5_read(file, name, H5_F64, 1, &times, &f->time));
  name_of(name, walk, "_low");
  TRY(h5_read(file, name, H5_F64, 2, low, &f->low));
  name_of(name, walk, "_width");
  TRY(h5_read(file, name, H5_F64, 2, width, &f->width));
  f->frames = shape[0], f->rows = shape[1], f->columns = shape[2];
  if (times != f->frames || low[0] != f->frames || width[0] != f->frames || low[1] != 2 ||
      width[1] != 2)
    TRY_FAIL(STATUS_INPUT, "%s: the pictures of the plume do not belong to their times", path);
cleanup:
  h5_close(file);
  memory_free(&peclet);
  return status;
}

/* Shares by bin, with the bin's centre in mm; an empty line between rows. */
static void write_frame(const struct film *f, size_t frame, FILE *stream) {
  const double *low = f->low + 2 * frame, *width = f->width + 2 * frame;
  const double *share = f->share + frame * f->rows * f->columns;
  double most = 0;
  for (size_t i = 0; i < f->rows * f->columns; i++) most = fmax(most, share[i]);
  fprintf(stream, "$frame%zu << EOD\n", frame);
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++)
      fprintf(stream, "%.5g %.5g %.3g\n%s", 1e3 * (low[0] + ((double)i + 0.5) * width[0]),
              1e3 * (low[1] + ((double)j + 0.5) * width[1]),
              most > 0 ? share[j * f->columns + i] / most : 0, i + 1 == f->columns ? "\n" : "");
  fputs("EOD\n", stream);
}

/* Distance of tics, 1, 2 or 5 times a power of ten, for two to four of them, as panels are
 * small. */
static double tic_distance(double range) {
  const double least = range / 4.5, power = pow(10, floor(log10(least)));
  return power * (least <= 2 * power ? 2 : least <= 5 * power ? 5 : 10);
}

static void write_plot(const struct film *f, FILE *stream) {
  const size_t first = f->frames > FRAMES_MAX ? f->frames - FRAMES_MAX : 0;
  for (size_t k = first; k < f->frames; k++) write_frame(f, k, stream);
  fputs("set multiplot layout 3,2 margins 0.17,0.97,0.135,0.95 spacing 0.14,0.14\n"
        "set palette defined (0 '#ffffff', 0.05 '#dceaf5', 0.4 '#56B4E9', 1 '#003a5d')\n"
        "unset colorbox\nunset key\nset cbrange [0:1]\nset tics out\nunset grid\n",
        stream);
  for (size_t k = first; k < f->frames; k++) {
    const double *low = f->low + 2 * k, *width = f->width + 2 * k;
    fprintf(stream,
            "set title 'after %.3g s' offset 0,-0.6\nset xrange [%.5g:%.5g]\nset yrange "
            "[%.5g:%.5g]\nset xtics %g\nset ytics %g\n%s%splot $frame%zu using 1:2:3 with image\n",
            f->time[k], 1e3 * low[0], 1e3 * (low[0] + (double)f->columns * width[0]), 1e3 * low[1],
            1e3 * (low[1] + (double)f->rows * width[1]),
            tic_distance(1e3 * (double)f->columns * width[0]),
            tic_distance(1e3 * (double)f->rows * width[1]),
            k - first >= FRAMES_MAX - 2 ? "set xlabel 'along the flow (mm)'\n" : "unset xlabel\n",
            (k - first) % 2 == 0 ? "set ylabel 'across (mm)'\n" : "unset ylabel\n", k);
  }
  fputs("unset multiplot\n", stream);
}

static void free_film(struct film *f) {
  memory_free(&f->share);
  memory_free(&f->time);
  memory_free(&f->low);
  memory_free(&f->width);
}

/* Mean displacement along the flow and standard deviations along and across it, m. */
static void measure(const struct film *f, size_t frame, double *mean, double deviation[2]) {
  const double *low = f->low + 2 * frame, *width = f->width + 2 * frame;
  double sum[2] = {0}, square[2] = {0}, all = 0;
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      const double share = f->share[(frame * f->rows + j) * f->columns + i];
      const double x[2] = {low[0] + ((double)i + 0.5) * width[0],
                           low[1] + ((double)j + 0.5) * width[1]};
      all += share;
      for (int d = 0; d < 2; d++) sum[d] += share * x[d], square[d] += share * x[d] * x[d];
    }
  *mean = sum[0] / all;
  for (int d = 0; d < 2; d++) deviation[d] = sqrt(fmax(square[d] / all - pow(sum[d] / all, 2), 0));
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const char *const *paths = subject->solutes;
  const size_t n = subject->solute_count;
  (void)options;
  struct film film = {0};
  size_t i = 0;
  while (i + 1 < n && !solute_has(paths[i], SOLUTE_PLUME)) i++;
  TRY(read_film(paths[i], &film));
  json_t *list = json_array();
  fputs("time_s,mean_m,deviation_along_m,deviation_across_m\n", product->csv.stream);
  fprintf(product->summary.stream, "plume at Pe %.4g\n  %10s  %10s  %16s  %16s\n", film.peclet,
          "time (s)", "mean (mm)", "spread along (mm)", "across (mm)");
  for (size_t k = 0; k < film.frames; k++) {
    double mean, deviation[2];
    measure(&film, k, &mean, deviation);
    json_array_append_new(list, json_pack("{s:o,s:o,s:o,s:o}", "time_s", json_number(film.time[k]),
                                          "mean_m", json_number(mean), "deviation_along_m",
                                          json_number(deviation[0]), "deviation_across_m",
                                          json_number(deviation[1])));
    fprintf(product->csv.stream, "%.8g,%.8g,%.8g,%.8g\n", film.time[k], mean, deviation[0],
            deviation[1]);
    fprintf(product->summary.stream, "  %10.4g  %10.4g  %16.4g  %16.4g\n", film.time[k], 1e3 * mean,
            1e3 * deviation[0], 1e3 * deviation[1]);
  }
  fputc('\n', product->summary.stream);
  json_put_number(product->json, "peclet", film.peclet);
  json_object_set_new(product->json, "frames", list);
  if (film.frames > 0) {
    write_plot(&film, product->plot.stream);
    /* Sized so that the text is readable on a telephone. */
    product->width = 560, product->height = 660;
  }
cleanup:
  free_film(&film);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = solute_any_has(subject->solutes, subject->solute_count, SOLUTE_PLUME);
  return STATUS_OK;
}

const struct analysis film_analysis = {
    .name = "film",
    .of_solutes = true,
    .delivered_with = "dispersion",
    .heading = "Plume",
    .caption =
        "Where a solute is that began at one point, on the mean over all points of the pores: "
        "concentration over its maximum, at times that double; along the flow and across it.",
    .applies = applies,
    .analyze = analyze};
