/* Water content of unsaturated soil from the snapshots of a run of method richards: a map at the
 * end with the water table, profiles at all snapshots, and the balance. */
#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/plot.h"
#include "analyze/run_places.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/snapshot_file.h"

#define WIDTH 760         /* of the plot, pixels */
#define PROFILES_MAX 7    /* drawn, evenly distributed over the snapshots */
#define ROUNDING 1e-6     /* of times and places, relative */
#define MAP_COLUMNS_MIN 3 /* a narrower run is a column without a map */

/* Values at the sites of the middle plane along y, [nz][nx]; NAN outside of soil. */
struct moisture {
  const struct run *run;
  size_t nx, nz, row, shots;
  double *theta, *pressure; /* [snapshots][nz][nx]: water content (-) and pressure head (m) */
  double *level, *error;    /* [nx] m: of the water table at the end, and its error; NAN: none */
  size_t column;            /* of the profiles: the column with most water at the end */
};

static double x_of(const struct moisture *m, size_t i) {
  return m->run->origin[0] + (double)i * m->run->spacing[0];
}
static double z_of(const struct moisture *m, size_t k) {
  return m->run->origin[2] + (double)k * m->run->spacing[2];
}

static enum status read_shot(struct moisture *m, size_t shot) {
  enum status status = STATUS_OK;
  const struct run *run = m->run;
  struct snapshot snapshot = {0};
  double *theta = NULL, *head = NULL;
  char path[8192];
  if (snprintf(path, sizeof path, "%s%s", run->folder, run->snapshot_names[shot]) >=
      (int)sizeof path)
    TRY_FAIL(STATUS_INPUT, "%s: the name of a snapshot is too long", run->path);
  TRY(snapshot_open(path, &snapshot));
  TRY(snapshot_read(&snapshot, "water_content", 1, &theta));
  TRY(snapshot_read(&snapshot, "head", 1, &head));
  for (size_t p = 0; p < snapshot.count; p++) {
    const double *x = snapshot.points + 3 * p;
    double at[3];
    bool inside = true;
    for (int a = 0; a < 3; a++) {
      at[a] = round((x[a] - run->origin[a]) / run->spacing[a]);
      inside = inside && at[a] >= 0 && at[a] < (double)run->size[a];
    }
    if (!inside || !isfinite(theta[p]) || !isfinite(head[p]))
      TRY_FAIL(STATUS_INPUT, "%s: site %zu lies outside the run, or has no number", path, p);
    if ((size_t)at[1] != m->row) continue;
    const size_t cell = (shot * m->nz + (size_t)at[2]) * m->nx + (size_t)at[0];
    m->theta[cell] = theta[p];
    m->pressure[cell] = head[p] - x[2];
  }
cleanup:
  memory_free(&theta);
  memory_free(&head);
  snapshot_close(&snapshot);
  return status;
}

static enum status moisture_read(const struct run *run, struct moisture *m) {
  enum status status = STATUS_OK;
  double most = -1;
  *m = (struct moisture){.run = run,
                         .nx = run->size[0],
                         .nz = run->size[2],
                         .row = run->size[1] / 2,
                         .shots = run->snapshot_count};
  const size_t cells = m->nx * m->nz;
  TRY(memory_allocate(&m->theta, m->shots * cells, sizeof(double), "the water contents"));
  TRY(memory_allocate(&m->pressure, m->shots * cells, sizeof(double), "the pressure heads"));
  TRY(memory_allocate(&m->level, m->nx, sizeof(double), "the water table"));
  TRY(memory_allocate(&m->error, m->nx, sizeof(double), "the water table"));
  for (size_t c = 0; c < m->shots * cells; c++) m->theta[c] = m->pressure[c] = NAN;
  for (size_t s = 0; s < m->shots; s++) TRY(read_shot(m, s));
  for (size_t i = 0; i < m->nx; i++) {
    double sum = 0;
    for (size_t k = 0; k < m->nz; k++) {
      const double theta = m->theta[((m->shots - 1) * m->nz + k) * m->nx + i];
      if (!isnan(theta)) sum += theta;
    }
    if (sum > most * (1 + 1e-9)) most = sum, m->column = i;
  }
cleanup:
  return status;
}

static void moisture_free(struct moisture *m) {
  memory_free(&m->theta);
  memory_free(&m->pressure);
  memory_free(&m->level);
  memory_free(&m->error);
}

/* Water table of a column: the highest elevation up to which the pressure is positive from its foot
 * on; NAN if there is none. */
static double water_table(const struct moisture *m, size_t shot, size_t i) {
  double below = NAN;
  for (size_t k = 0; k < m->nz; k++) {
    const double h = m->pressure[(shot * m->nz + k) * m->nx + i];
    if (isnan(h) && isnan(below)) continue;
    if (isnan(h) || h < 0) {
      if (isnan(below)) return NAN;
      return isnan(h) ? z_of(m, k) - 0.5 * m->run->spacing[2]
                      : z_of(m, k) - m->run->spacing[2] * h / (h - below);
    }
    below = h;
  }
  return NAN;
}

/* Level at x between the columns of a run, or just beyond the last two; NAN: none. */
static double level_at(const struct moisture *m, const double *level, double x) {
  if (m->nx == 1) return level[0];
  const double at = (x - m->run->origin[0]) / m->run->spacing[0];
  const double low = fmin(fmax(floor(at), 0), (double)m->nx - 2);
  return level[(size_t)low] + (at - low) * (level[(size_t)low + 1] - level[(size_t)low]);
}

/* Levels at the end, and with a run on a coarser lattice their errors (95 %), m: the root mean
 * square of the differences to its levels within its spacing. For an error that falls as the square
 * of the spacing, and a lattice of twice the spacing, that is Roache's grid convergence index, with
 * the factor 3 of two lattices: 3/(2^2 - 1) = 1. */
static void find_levels(struct moisture *m, const struct moisture *coarse) {
  for (size_t i = 0; i < m->nx; i++)
    m->level[i] = water_table(m, m->shots - 1, i), m->error[i] = NAN;
  if (coarse == NULL) return;
  const double reach = coarse->run->spacing[0] * (1 + ROUNDING);
  for (size_t i = 0; i < m->nx; i++) {
    double squares = 0, count = 0;
    for (size_t j = 0; j < m->nx; j++) {
      const double off = m->level[j] - level_at(coarse, coarse->level, x_of(m, j));
      if (fabs(x_of(m, j) - x_of(m, i)) <= reach && !isnan(off)) squares += off * off, count++;
    }
    if (count > 0) m->error[i] = sqrt(squares / count);
  }
}

/* The last value of a column of the history; NAN if the column is missing. */
static double last_value(const struct run *run, const char *name) {
  const struct history_column *c = run_column(run, name, 1);
  return c != NULL && c->rows > 0 ? c->values[c->rows - 1] : NAN;
}

static void write_cells(const struct moisture *m, FILE *csv) {
  fputs("time,x,z,pressure_head,water_content\n", csv);
  for (size_t s = 0; s < m->shots; s++)
    for (size_t k = 0; k < m->nz; k++)
      for (size_t i = 0; i < m->nx; i++) {
        const size_t c = (s * m->nz + k) * m->nx + i;
        if (isnan(m->theta[c]) || (i != m->column && s + 1 < m->shots)) continue;
        fprintf(csv, "%.9g,%.6g,%.6g,%.8g,%.8g\n", m->run->snapshot_times[s], x_of(m, i),
                z_of(m, k), m->pressure[c], m->theta[c]);
      }
}

static void write_data(const struct moisture *m, FILE *stream) {
  const size_t last = m->shots - 1;
  fputs("$map << EOD\n", stream);
  for (size_t k = 0; k < m->nz; k++)
    for (size_t i = 0; i < m->nx; i++) {
      const double theta = m->theta[(last * m->nz + k) * m->nx + i];
      fprintf(stream, "%.6g %.6g ", x_of(m, i), z_of(m, k));
      fprintf(stream, isnan(theta) ? "NaN\n" : "%.6g\n", theta);
    }
  fputs("EOD\n$table << EOD\n", stream);
  for (size_t i = 0; i < m->nx; i++) {
    if (isnan(m->level[i]))
      fputc('\n', stream);
    else
      fprintf(stream, "%.6g %.6g\n", x_of(m, i), m->level[i]);
  }
  fputs("EOD\n", stream);
  for (size_t s = 0; s < m->shots; s++) {
    fprintf(stream, "$profile_%zu << EOD\n", s);
    for (size_t k = 0; k < m->nz; k++) {
      const double theta = m->theta[(s * m->nz + k) * m->nx + m->column];
      if (isnan(theta))
        fputc('\n', stream);
      else
        fprintf(stream, "%.6g %.6g\n", theta, z_of(m, k));
    }
    fputs("EOD\n", stream);
  }
}

/* Time of a snapshot, in hours or days for long runs. */
static void write_time(const struct moisture *m, size_t shot, char *text, size_t size) {
  const double time = m->run->snapshot_times[shot], all = m->run->snapshot_times[m->shots - 1];
  if (all >= 10 * 86400)
    snprintf(text, size, "%.4g d", time / 86400);
  else
    snprintf(text, size, all >= 7200 ? "%.4g h" : "%.4g s", all >= 7200 ? time / 3600 : time);
}

static void plot_profiles(const struct moisture *m, FILE *stream) {
  const size_t step = (m->shots + PROFILES_MAX - 1) / PROFILES_MAX;
  fprintf(stream,
          "set title 'profiles at x = %.4g m'\nset size noratio\nset autoscale x\nset xtics "
          "autofreq\nset ytics autofreq\nset "
          "xlabel 'water "
          "content'\nset key outside below horizontal samplen 2\nplot ",
          x_of(m, m->column));
  for (size_t n = 0, s = 0; s < m->shots; s += step, n++) {
    char time[40];
    write_time(m, s, time, sizeof time);
    fprintf(stream, "%s$profile_%zu with lines linewidth 1.6 ", n > 0 ? ", " : "", s);
    plot_line_style(stream, n);
    fprintf(stream, " title '%s'", time);
  }
  fputc('\n', stream);
}

#define PANEL_WIDTH 250 /* of the map, pixels: largest width and height */
#define TIC 40          /* width of a number below it, pixels */

/* Tic labels below a map of `width` x `height`: if there is little space, only at its ends or its
 * middle. */
static void plot_x_tics(const struct moisture *m, double width, double height, FILE *stream) {
  const double left = x_of(m, 0) - 0.5 * m->run->spacing[0];
  const double pixels = PANEL_WIDTH * fmin(width / height, 1);
  if (pixels >= 6 * TIC) return;
  fputs("set xtics (", stream);
  if (pixels < TIC)
    fprintf(stream, "'%.3g' %.6g)\n", left + 0.5 * width, left + 0.5 * width);
  else
    fprintf(stream, "'%.3g' %.6g, '%.3g' %.6g)\n", left, left, left + width, left + width);
}

/* Tic labels beside a map: only at its ends if it is low. */
static void plot_z_tics(const struct moisture *m, double width, double height, FILE *stream) {
  const double low = z_of(m, 0) - 0.5 * m->run->spacing[2];
  if (PANEL_WIDTH * fmin(height / width, 1) < 3 * TIC)
    fprintf(stream, "set ytics ('%.3g' %.6g, '%.3g' %.6g)\n", low, low, low + height, low + height);
}

static void plot(const struct moisture *m, struct product *product) {
  FILE *stream = product->plot.stream;
  const double *d = m->run->spacing, width = (double)m->nx * d[0], height = (double)m->nz * d[2];
  const bool map = m->nx >= MAP_COLUMNS_MIN;
  write_data(m, stream);
  fprintf(stream, "set yrange [%.6g:%.6g]\nset ylabel 'z (m)'\n", z_of(m, 0) - 0.5 * d[2],
          z_of(m, 0) - 0.5 * d[2] + height);
  if (map) {
    char time[40];
    write_time(m, m->shots - 1, time, sizeof time);
    plot_x_tics(m, width, height, stream);
    plot_z_tics(m, width, height, stream);
    fprintf(stream,
            "set multiplot layout 1,2 margins 0.1,0.97,0.3,0.9 spacing 0.17,0\n"
            "set title 'water content at %s'\nset size ratio -1\nset xrange [%.6g:%.6g]\nset "
            "xlabel 'x (m)'\n"
            "set palette defined (0 '#f4ead5', 0.5 '#7fb5d5', 1 '#0b3c6f')\n"
            "set colorbox user origin 0.1,0.1 size 0.35,0.04 horizontal\nset key off\n"
            "plot $map using 1:2:3 with image, $table with lines linewidth 2 linecolor rgb "
            "'%s'\n",
            time, x_of(m, 0) - 0.5 * d[0], x_of(m, 0) - 0.5 * d[0] + width, plot_colours[1]);
  }
  plot_profiles(m, stream);
  if (map) fputs("unset multiplot\n", stream);
  product->width = map ? WIDTH : 560;
  product->height = 420;
}

/* Levels at the gauges at the end, each with the error of the water table there. */
static void write_gauges(const struct moisture *m, FILE *summary, json_t *json) {
  static const char prefix[] = "level_";
  json_t *levels = json_object();
  for (size_t c = 0; c < m->run->column_count; c++) {
    const char *title = m->run->columns[c].name, *name = title + sizeof prefix - 1;
    double place[3];
    char text[80];
    if (strncmp(title, prefix, sizeof prefix - 1) != 0 || !place_of_gauge(m->run, name, place))
      continue;
    const double level = last_value(m->run, title), error = level_at(m, m->error, place[0]);
    if (isnan(level)) continue;
    value_with_error(text, sizeof text, level, error, "+-");
    fprintf(summary, "level      %s: %s m\n", name, text);
    json_object_set_new(
        levels, name,
        json_pack("{s:o,s:o}", "level_m", json_number(level), "error95", json_number(error)));
  }
  json_object_set_new(json, "levels_m", levels);
}

/* Where the water table ends at an upright face at x, beside columns `at`, `at` + `step` and so on.
 * At a distance d from the face it is A d - d ln(d)/pi above that (analyze/seepage/seepage_find.c);
 * least squares for A and the end. NAN if it does not rise from there. */
#define FACE_COLUMNS 3
static double face_end(const struct moisture *m, ptrdiff_t at, ptrdiff_t step) {
  double mean[2] = {0}, square = 0, along = 0;
  for (ptrdiff_t k = 0; k < FACE_COLUMNS; k++) {
    const ptrdiff_t i = at + k * step;
    if (i < 0 || i >= (ptrdiff_t)m->nx) return NAN;
    const double d = (double)k + 0.5, off = d - 0.5 * FACE_COLUMNS,
                 level = m->level[i] + m->run->spacing[0] * d * log(d) / M_PI;
    mean[0] += d / FACE_COLUMNS, mean[1] += level / FACE_COLUMNS;
    square += off * off, along += off * level;
  }
  return along > 0 ? mean[1] - mean[0] * along / square : NAN;
}

/* Where the highest water comes out of soil, and its error (95 %). On an upright face the water
 * table ends between that shape of it, which suction above it makes too low, and the highest face
 * of a site that lets water out, which is too high, as the water stands higher half a spacing
 * behind it. */
static void write_face(const struct moisture *m, FILE *summary, json_t *json) {
  const struct history_column *column = run_column(m->run, "seepage_top", 3);
  const double *top =
      column != NULL && column->rows > 0 ? column->values + 3 * (column->rows - 1) : NULL;
  char text[80];
  if (top == NULL || isnan(top[2])) return;
  const double column_at = (top[0] - m->run->origin[0]) / m->run->spacing[0];
  const ptrdiff_t low = (ptrdiff_t)floor(column_at),
                  row = (ptrdiff_t)round((top[2] - m->run->origin[2]) / m->run->spacing[2] - 0.5);
  double end = top[2], error = NAN;
  if (fabs(column_at - floor(column_at) - 0.5) < ROUNDING && row >= 0 && row < (ptrdiff_t)m->nz) {
    const bool soil_low =
        low >= 0 &&
        !isnan(m->pressure[((m->shots - 1) * m->nz + (size_t)row) * m->nx + (size_t)low]);
    const double least = soil_low ? face_end(m, low, -1) : face_end(m, low + 1, 1);
    if (least < top[2]) end = 0.5 * (least + top[2]), error = 0.5 * (top[2] - least);
  }
  value_with_error(text, sizeof text, end, error, "+-");
  fprintf(summary, "face       water comes out of soil up to %s m at x = %.4g m\n", text, top[0]);
  json_object_set_new(json, "seepage_face",
                      json_pack("{s:o,s:o,s:o}", "x_m", json_number(top[0]), "z_m",
                                json_number(end), "error95", json_number(error)));
}

static void write_summary(const struct moisture *m, struct product *product) {
  FILE *summary = product->summary.stream;
  const struct run *run = m->run;
  const double water = last_value(run, "water"), open = last_value(run, "water_open"),
               level = m->level[m->column];
  const struct history_column *column = run_column(run, "water", 1);
  const double first = column != NULL && column->rows > 0 ? column->values[0] : NAN;
  double dry = INFINITY, wet = -INFINITY;
  char time[40], text[80];
  for (size_t c = (m->shots - 1) * m->nz * m->nx; c < m->shots * m->nz * m->nx; c++)
    dry = fmin(dry, m->theta[c]), wet = fmax(wet, m->theta[c]); /* NAN is ignored by both */
  write_time(m, m->shots - 1, time, sizeof time);
  fprintf(summary, "%s: after %s\n", run->name, time);
  fprintf(summary, "water      %.6g m^3 at the start, %.6g m^3 at the end, open by %.2g of it",
          first, water, fabs(open) / fmax(water, 1e-300));
  if (run->size[1] == 1) fprintf(summary, "; of %.4g m along y", run->spacing[1]);
  fputc('\n', summary);
  fprintf(summary, "content    %.4g to %.4g at the end\n", dry, wet);
  if (isnan(m->error[m->column]))
    snprintf(text, sizeof text, "%.4g", level);
  else
    value_with_error(text, sizeof text, level, m->error[m->column], "+-");
  if (isfinite(level))
    fprintf(summary, "table      %s m at x = %.4g m, where most water is\n", text,
            x_of(m, m->column));
  json_t *json = product->json, *x = json_array(), *levels = json_array(), *errors = json_array();
  write_gauges(m, summary, json);
  write_face(m, summary, json);
  json_object_set_new(json, "path", json_text(run->path));
  json_object_set_new(json, "name", json_text(run->name));
  json_put_number(json, "time_s", run->snapshot_times[m->shots - 1]);
  json_put_number(json, "water_at_start_m3", first);
  json_put_number(json, "water_m3", water);
  if (run->size[1] == 1) json_put_number(json, "thickness_m", run->spacing[1]);
  json_put_number(json, "water_open_m3", open);
  json_put_number(json, "water_content_least", dry);
  json_put_number(json, "water_content_most", wet);
  for (size_t i = 0; i < m->nx; i++) {
    if (isnan(m->level[i])) continue;
    json_array_append_new(x, json_number(x_of(m, i)));
    json_array_append_new(levels, json_number(m->level[i]));
    json_array_append_new(errors, json_number(m->error[i]));
  }
  json_object_set_new(json, "water_table",
                      json_pack("{s:o,s:o,s:o}", "x_m", x, "level_m", levels, "error95", errors));
}

/* That a second run is the first one's on a coarser lattice, at the same time. */
static enum status check_coarse(const struct run *fine, const struct run *coarse) {
  const double at = fine->snapshot_times[fine->snapshot_count - 1],
               other = coarse->snapshot_count > 0
                           ? coarse->snapshot_times[coarse->snapshot_count - 1]
                           : NAN;
  if (strcmp(coarse->method, fine->method) != 0 || !(coarse->spacing[0] > fine->spacing[0]) ||
      (!(fabs(at - other) <= ROUNDING * at) &&
       (strcmp(fine->status, "steady") != 0 || strcmp(coarse->status, "steady") != 0)))
    return FAIL(STATUS_INPUT,
                "%s: for the error of levels this has to be the run of %s with twice its "
                "domain.spacing, to the same time",
                coarse->path, fine->path);
  return STATUS_OK;
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  struct moisture moisture = {0}, coarse = {0};
  const struct run *run = &subject->runs[0];
  (void)options;
  if (strcmp(run->method, "richards") != 0 || run->snapshot_count == 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: moisture is of runs of method richards with snapshots; this one is of %s",
             run->path, run->method);
  TRY(moisture_read(run, &moisture));
  if (subject->n > 1) {
    TRY(check_coarse(run, &subject->runs[1]));
    TRY(moisture_read(&subject->runs[1], &coarse));
    find_levels(&coarse, NULL);
  }
  find_levels(&moisture, subject->n > 1 ? &coarse : NULL);
  write_summary(&moisture, product);
  write_cells(&moisture, product->csv.stream);
  plot(&moisture, product);
cleanup:
  moisture_free(&moisture);
  moisture_free(&coarse);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies =
      subject->snapshots && subject->n == 1 && strcmp(subject->runs[0].method, "richards") == 0;
  return STATUS_OK;
}

const struct analysis moisture_analysis = {
    .name = "moisture",
    .command =
        {"moisture", "RUN [COARSER] [-o DIR]",
         "water in soil that is not full: map and profiles of the water content, water table",
         "analyze moisture recharge.hdf -o results", 1, 2},
    .several_models = true,
    .heading = "Water in the soil",
    .page_runs = OF_FIRST,
    .caption =
        "Water content: a map at the end with the water table, and profiles where most water "
        "is, at each snapshot.",
    .applies = applies,
    .analyze = analyze};
