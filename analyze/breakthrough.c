/* Breakthrough curves from the walks of a run: reading, fit and output. */
#include "analyze/breakthrough.h"

#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/chart.h"
#include "analyze/solute_flow.h"
#include "common/hdf5_file.h"
#include "common/memory.h"

#define CURVES_MAX 4 /* drawn at most */
/* Largest deviations with which the equation is considered to hold: of the share, absolute; of the
 * times of the first and last walkers, relative. */
#define MISFIT_MAX 0.02
#define TAIL_ERROR_MAX 0.1

/* One plane of one walk. Times in units of distance / U, D in units of distance times U. */
struct plane {
  double distance; /* m */
  double *time;    /* [quantiles], NAN: not reached by the end of the walk */
  bool fitted, reached;
  /* First and last: times of the first and last walkers over those of the fit. */
  double v, d, misfit, first, last;
};

struct curves {
  const char *path;
  size_t walk; /* index in the list of Peclet numbers */
  double peclet, speed, length, longitudinal;
  size_t planes, quantiles;
  double *share;
  struct plane *plane;
};

static bool has_walk(struct h5_file *file, size_t walk) {
  char path[64];
  snprintf(path, sizeof path, "/solute/walk/%zu/passage_time", walk);
  return h5_exists(file, path);
}

static void fit(const struct curves *c, struct plane *p) {
  const size_t n = c->quantiles;
  p->reached = isfinite(p->time[n - 1]);
  p->fitted = breakthrough_fit(p->time, c->share, n, &p->v, &p->d, &p->misfit);
  if (!p->fitted) return;
  p->first = p->time[0] / breakthrough_time(p->v, p->d, c->share[0]);
  p->last = p->time[n - 1] / breakthrough_time(p->v, p->d, c->share[n - 1]);
}

static enum status read_walk(struct h5_file *file, struct curves *c) {
  enum status status = STATUS_OK;
  double *distance = NULL, *time = NULL;
  char path[64];
  size_t planes, dims[2];
  snprintf(path, sizeof path, "/solute/walk/%zu/passage_distance", c->walk);
  TRY(h5_read(file, path, H5_F64, 1, &planes, &distance));
  snprintf(path, sizeof path, "/solute/walk/%zu/passage_time", c->walk);
  TRY(h5_read(file, path, H5_F64, 2, dims, &time));
  if (dims[0] != planes || dims[1] < 2)
    TRY_FAIL(STATUS_INPUT, "%s: %s does not belong to its distances", h5_path(file), path);
  c->planes = planes, c->quantiles = dims[1];
  TRY(memory_allocate(&c->share, c->quantiles, sizeof *c->share, "shares"));
  TRY(memory_allocate(&c->plane, planes, sizeof *c->plane, "planes"));
  for (size_t q = 0; q < c->quantiles; q++) c->share[q] = ((double)q + 0.5) / (double)c->quantiles;
  for (size_t p = 0; p < planes; p++) {
    struct plane *plane = &c->plane[p];
    plane->distance = distance[p];
    if (!(plane->distance > 0))
      TRY_FAIL(STATUS_INPUT, "%s: a plane lies where the walkers begin", h5_path(file));
    TRY(memory_allocate(&plane->time, c->quantiles, sizeof *plane->time, "times of passage"));
    for (size_t q = 0; q < c->quantiles; q++)
      plane->time[q] = time[p * c->quantiles + q] * c->speed / plane->distance;
    fit(c, plane);
  }
cleanup:
  memory_free(&distance);
  memory_free(&time);
  return status;
}

/* Appends all walks with a flow in one file to `list`. */
static enum status read_file(const char *path, struct curves **list, size_t *count) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  double *peclet = NULL, *longitudinal = NULL;
  size_t n, columns;
  TRY(h5_open(path, &file));
  TRY(h5_read(file, "/solute/peclet", H5_F64, 1, &n, &peclet));
  TRY(h5_read(file, "/solute/longitudinal", H5_F64, 1, &columns, &longitudinal));
  for (size_t i = 0; i < n && i < columns; i++) {
    if (!has_walk(file, i) || !(peclet[i] > 0)) continue;
    TRY(memory_resize(list, *count + 1, sizeof **list, "breakthrough curves"));
    struct curves *c = &(*list)[(*count)++];
    *c = (struct curves){.path = path,
                         .walk = i,
                         .peclet = peclet[i],
                         .speed = h5_attribute_or_nan(file, "/solute", "speed"),
                         .length = h5_attribute_or_nan(file, "/solute", "length"),
                         .longitudinal = longitudinal[i]};
    TRY(read_walk(file, c));
  }
cleanup:
  h5_close(file);
  memory_free(&peclet);
  memory_free(&longitudinal);
  return status;
}

static void free_curves(struct curves *c) {
  for (size_t p = 0; p < c->planes && c->plane != NULL; p++) memory_free(&c->plane[p].time);
  memory_free(&c->plane);
  memory_free(&c->share);
}

/* The fitted D over the molecular diffusion coefficient. */
static double relative_dispersion(const struct curves *c, const struct plane *p) {
  return p->d * p->distance * c->peclet / c->length;
}

static bool equation_holds(const struct plane *p) {
  return p->misfit <= MISFIT_MAX && fabs(p->first - 1) <= TAIL_ERROR_MAX &&
         fabs(p->last - 1) <= TAIL_ERROR_MAX;
}

static void write_json(const struct curves *list, size_t n, json_t *json) {
  json_t *all = json_array();
  for (size_t i = 0; i < n; i++) {
    const struct curves *c = &list[i];
    json_t *planes = json_array();
    for (size_t p = 0; p < c->planes; p++) {
      const struct plane *plane = &c->plane[p];
      json_t *object = json_object(), *time = json_array();
      for (size_t q = 0; q < c->quantiles; q++)
        json_array_append_new(time, json_number(plane->time[q] * plane->distance / c->speed));
      json_put_number(object, "distance_m", plane->distance);
      json_object_set_new(object, "time_s", time);
      if (plane->fitted) {
        json_put_number(object, "velocity_over_mean", plane->v);
        json_put_number(object, "longitudinal", relative_dispersion(c, plane));
        json_put_number(object, "misfit", plane->misfit);
        json_put_number(object, "first_over_fit", plane->first);
        json_put_number(object, "last_over_fit", plane->last);
        json_object_set_new(object, "holds", json_boolean(equation_holds(plane)));
      }
      json_array_append_new(planes, object);
    }
    json_array_append_new(all, json_pack("{s:o,s:o,s:o,s:o,s:o}", "path", json_text(c->path),
                                         "peclet", json_number(c->peclet), "longitudinal",
                                         json_number(c->longitudinal), "share",
                                         json_numbers(c->share, c->quantiles), "planes", planes));
  }
  json_object_set_new(json, "walks", all);
}

static void write_csv(const struct curves *list, size_t n, FILE *stream) {
  fputs("run,peclet,distance_m,share,time_s,time_s_of_the_fit\n", stream);
  for (size_t i = 0; i < n; i++)
    for (size_t p = 0; p < list[i].planes; p++) {
      const struct plane *plane = &list[i].plane[p];
      const double unit = plane->distance / list[i].speed;
      for (size_t q = 0; q < list[i].quantiles && plane->fitted; q++) {
        if (!isfinite(plane->time[q])) continue;
        csv_text(stream, list[i].path);
        fprintf(stream, ",%.10g,%.8g,%.5g,%.8g,%.8g\n", list[i].peclet, plane->distance,
                list[i].share[q], unit * plane->time[q],
                unit * breakthrough_time(plane->v, plane->d, list[i].share[q]));
      }
    }
}

static void write_summary(const struct curves *list, size_t n, FILE *stream) {
  fputs("breakthrough of planes, fitted by the advection-dispersion equation\n", stream);
  for (size_t i = 0; i < n; i++) {
    const struct curves *c = &list[i];
    fprintf(stream, "  Pe %.4g, D_L/D = %.4g\n  %10s  %8s  %10s  %7s  %9s  %9s\n", c->peclet,
            c->longitudinal, "plane (mm)", "v / U", "D_L/D", "misfit", "first", "last");
    for (size_t p = 0; p < c->planes; p++) {
      const struct plane *plane = &c->plane[p];
      if (!plane->fitted) continue;
      fprintf(stream, "  %10.4g  %8.4g  %10.4g  %5.1f %%  %9.3g", 1e3 * plane->distance, plane->v,
              relative_dispersion(c, plane), 100 * plane->misfit, plane->first);
      if (plane->reached)
        fprintf(stream, "  %9.3g  %s\n", plane->last, equation_holds(plane) ? "holds" : "fails");
      else
        fprintf(stream, "  %9s  not all have passed\n", "");
    }
  }
  fputs("  first, last: when a fraction of 0.0025 and of 0.9975 has passed, over the time of the "
        "fit\n\n",
        stream);
}

/* The plane that is drawn: the first one, where the equation is least accurate; NULL if none was
 * fitted. */
static const struct plane *plane_to_draw(const struct curves *c) {
  for (size_t p = 0; p < c->planes; p++)
    if (c->plane[p].fitted) return &c->plane[p];
  return NULL;
}

/* Fraction against time, and the density of travel times, each with the fit. */
static void draw(const struct curves *list, size_t n, json_t *charts) {
  enum { STEP = 5 }; /* quantiles between two densities */
  json_t *passed = chart_add(charts, "What has passed", "Time × U / distance (-)",
                             "Fraction that has passed (-)", CHART_LOG_X, CHART_OPEN);
  json_t *rates = chart_add(charts, "Travel times", "Time × U / distance (-)",
                            "Density of travel times (-)", CHART_LOG_XY, CHART_OPEN);
  for (size_t i = 0, drawn = 0; i < n && drawn < CURVES_MAX; i++) {
    const struct curves *c = &list[i];
    const struct plane *p = plane_to_draw(c);
    char name[120], line[140];
    if (p == NULL) continue;
    const int colour = (int)drawn++;
    snprintf(name, sizeof name, "Pe %.4g, %.3g mm", c->peclet, 1e3 * p->distance);
    snprintf(line, sizeof line, "%s, fit", name);
    json_t *walk = chart_series(passed, name, CHART_DOTS, colour, 0);
    json_t *fit = chart_series(passed, line, CHART_LINE, colour, 0);
    json_t *rate = chart_series(rates, name, CHART_DOTS, colour, 0);
    json_t *fit_rate = chart_series(rates, line, CHART_LINE, colour, 0);
    for (size_t q = 0; q < c->quantiles; q++) {
      if (q % (STEP - 1) == 0 && isfinite(p->time[q])) chart_point(walk, p->time[q], c->share[q]);
      chart_point(fit, breakthrough_time(p->v, p->d, c->share[q]), c->share[q]);
    }
    for (size_t q = 0; q + STEP < c->quantiles; q += STEP) {
      const double from = p->time[q], to = p->time[q + STEP], middle = sqrt(from * to);
      if (!isfinite(to) || !(to > from)) continue;
      chart_point(rate, middle, (c->share[q + STEP] - c->share[q]) / (to - from));
      chart_point(fit_rate, middle,
                  (breakthrough_share(p->v, p->d, to) - breakthrough_share(p->v, p->d, from)) /
                      (to - from));
    }
  }
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const char *const *paths = subject->solutes;
  const size_t n = subject->solute_count;
  (void)options;
  struct curves *list = NULL;
  size_t count = 0;
  for (size_t i = 0; i < n; i++)
    if (solute_has(paths[i], SOLUTE_WALK)) TRY(read_file(paths[i], &list, &count));
  write_json(list, count, product->json);
  write_csv(list, count, product->csv.stream);
  write_summary(list, count, product->summary.stream);
  draw(list, count, product->charts);
cleanup:
  for (size_t i = 0; i < count; i++) free_curves(&list[i]);
  memory_free(&list);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = solute_any_has(subject->solutes, subject->solute_count, SOLUTE_WALK);
  return STATUS_OK;
}

const struct analysis breakthrough_analysis = {
    .name = "breakthrough",
    .of_solutes = true,
    .delivered_with = "dispersion",
    .heading = "Breakthrough",
    .caption =
        "When a solute that began spread over the pores has passed the first plane across the "
        "flow, one box length on: share and density of travel times of the random walk "
        "(points), and the fit of the advection-dispersion equation (lines).",
    .applies = applies,
    .analyze = analyze};
