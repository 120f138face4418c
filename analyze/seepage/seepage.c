#include "analyze/seepage/seepage.h"

#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/run_places.h"
#include "analyze/seepage/plane_balance.h"
#include "common/json_number.h"
#include "common/statistics.h"

/* Drift of heads that is reported, as a share of the head difference in the soil. A smaller one is
 * only included in the error. */
#define HEAD_DRIFT_MIN 0.02

/* Uncertainty of a series that still changes in one direction: the means of its quarters all rise
 * or all fall, by more than the scatter. From the middle to the end of the series it changes by
 * half of the total change, and a further total change is assumed to be still to come. 0 without a
 * drift. With fewer than four values the difference of the first and last is used. */
static double drift_of(const double *values, size_t n, double error) {
  double quarter[4] = {0};
  const size_t each = n / 4;
  if (each == 0) return n > 1 ? 1.5 * fabs(values[n - 1] - values[0]) : 0;
  for (int q = 0; q < 4; q++) {
    for (size_t i = 0; i < each; i++) quarter[q] += values[(size_t)q * each + i];
    quarter[q] /= (double)each;
  }
  const double a = quarter[1] - quarter[0], b = quarter[2] - quarter[1],
               c = quarter[3] - quarter[2];
  if (!(a * b > 0 && b * c > 0)) return 0;
  const double way = fabs(a + b + c) * 4 / 3;
  return way > 2 * error ? 1.5 * way : 0;
}

/* Mean of a column over the second half of the time, its standard error and its drift. */
static void late_mean(const struct run *run, const struct history_column *column, double *mean,
                      double *error, double *drift) {
  const struct history_column *time = run_column(run, "time", 1);
  size_t first = 0;
  *mean = *error = *drift = NAN;
  if (time == NULL || column->rows == 0) return;
  while (first + 1 < column->rows && time->values[first] < 0.5 * time->values[time->rows - 1])
    first++;
  batch_means(column->values + first, column->rows - first, mean, error);
  /* Steady at each time; and if nothing is given in time, throughout. */
  if (strcmp(run->method, "darcy") == 0 && column->values[0] == *mean) *error = 0;
  *drift = drift_of(column->values + first, column->rows - first, *error);
}

/* Adds the uncertainty of the flow from a drift of the velocities in the soil, those of the
 * snapshots. */
static void add_drift(struct seepage *s) {
  const struct head_field *f = &s->field;
  double mean = 0;
  for (size_t i = 0; i < f->snapshots; i++) mean += f->speed[i] / (double)f->snapshots;
  const double drift = drift_of(f->speed, f->snapshots, 0);
  if (drift > 0 && fabs(mean) > 0 && !s->sinks) s->drift = fmin(drift / fabs(mean), 1) * s->flow;
  s->flow_error += s->drift;
}

/* Deviation of a value from Darcy's law on cells, plus the uncertainty of that; 0 if unknown. It
 * includes the error of the smeared edges of soil, which the scatter in time does not show. */
static double put_darcy(const struct darcy_value darcy, double mean, json_t *entry) {
  if (!isfinite(darcy.value)) return 0;
  json_put_number(entry, "darcy", darcy.value);
  return fabs(mean - darcy.value) + darcy.error;
}

/* Error of the flux through a plane, 95 %: its deviation from Darcy's law on cells, or from the
 * balance of mass if that is unknown, and its drift. A note if neither is known. */
static double flux_error(const struct seepage *s, const char *plane, double mean, double error,
                         double drift, json_t *entry, const char **note) {
  bool in_water;
  int axis = 0;
  double place = 0, off = 0;
  const double balance = plane_balance(s->run, &s->field, plane, mean, &in_water);
  if (!in_water && place_of_plane(s->run, plane, &axis, &place) && axis != 1)
    off = put_darcy(darcy_flow_through(&s->darcy, axis / 2, place), mean, entry);
  if (off == 0) off = balance;
  json_object_set_new(entry, "in_soil", json_boolean(!in_water));
  json_put_number(entry, "balance_error", balance);
  json_put_number(entry, "error95", isfinite(off) ? hypot(error, off) + drift : NAN);
  if (isfinite(off)) return hypot(error, off) + drift;
  *note = in_water ? ", of the mean over time alone: in free water it may be 20 % off"
                   : ", of the mean over time alone";
  return error + drift;
}

/* Chooses among the planes wholly in soil with a known error: the one with the smallest error of
 * those with the largest flux. */
static const char *find_through(const json_t *fluxes, double *flux, double *error) {
  const char *best = NULL, *name;
  const json_t *entry;
  double most = 0, least = 0;
  json_object_foreach((json_t *)fluxes, name, entry) {
    const double half = json_number_or_nan(entry, "error95");
    const double value = fabs(json_number_or_nan(entry, "mean"));
    if (!(half < value)) continue;
    if (best != NULL && !(value - half > most + least) &&
        !(value + half >= most - least && half < least))
      continue;
    best = name, most = value, least = half;
  }
  *flux = most, *error = least;
  return best;
}

static double largest_in_soil(const json_t *fluxes) {
  double most = 0;
  const char *name;
  const json_t *entry;
  json_object_foreach((json_t *)fluxes, name,
                      entry) if (json_is_true(json_object_get(entry, "in_soil"))) most =
      fmax(most, fabs(json_number_or_nan(entry, "mean")));
  return most;
}

/* Reports the flow through the soil: by a plane if possible, in which case the difference from it
 * is added to the error of the flow net; else by the flow net. */
static void show_flow(struct seepage *s, const json_t *fluxes, json_t *json, FILE *summary) {
  double flux, error;
  const char *plane = find_through(fluxes, &flux, &error);
  if (plane == NULL) {
    /* A plane in soil contradicts the flow net even if its own error is unknown. */
    flux = largest_in_soil(fluxes);
    if (flux > 0.5 * s->flow) s->flow_error = hypot(s->flow_error, s->flow - flux);
  } else {
    s->flow_error = hypot(s->flow_error, hypot(s->flow - flux, error));
    json_object_set_new(json, "through",
                        json_pack("{s:s,s:o,s:o}", "plane", plane, "flux_m2_per_s",
                                  json_number(flux), "error95", json_number(error)));
  }
  json_put_number(json, "flow_m2_per_s", s->flow);
  json_put_number(json, "flow_error95_m2_per_s", s->flow_error);
  json_put_number(json, "head_drop_m", s->drop);
  char text[80];
  if (s->sinks) {
    fprintf(summary, "flow net   none with wells or drains; head falls by %.4g m in soil\n",
            s->drop);
    return;
  }
  value_with_error(text, sizeof text, s->flow, s->flow_error, "+-");
  fprintf(summary, "flow net   %s m^2/s through soil, head falls by %.4g m in it%s\n", text,
          s->drop,
          isfinite(s->flow_error) ? "" : "; its +- is not known: every section has free water");
  json_put_number(json, "soil_uptake_m2_per_s", s->uptake);
  json_put_number(json, "flow_drift_m2_per_s", s->drift);
  if (s->drift > 0.1 * s->flow)
    fprintf(summary, "unsteady   the velocities in the soil still go one way: run longer\n");
  /* A smaller uptake is only included in the error. */
  if (fabs(s->uptake) > 0.1 * s->flow && fabs(s->uptake) > 0.5 * s->flow_error)
    fprintf(summary, "unsteady   the soil %s %.3g m^2/s: what flows in is not what flows out\n",
            s->uptake > 0 ? "fills with" : "drains of", fabs(s->uptake));
}

/* Deviation of the head of a gauge in soil from Darcy's law. */
static double gauge_deviation(const struct seepage *s, const char *name, double mean,
                              json_t *entry) {
  double at[3];
  if (!place_of_gauge(s->run, name, at)) return 0;
  return put_darcy(darcy_flow_head(&s->darcy, (double[]){at[0], at[2]}), mean, entry);
}

/* Deviation of the flow into a drain from Darcy's law, combined with the uncertainty of that. The
 * two solutions are independent but for the heads of the scene. */
static double drain_deviation(const struct seepage *s, const char *name, double mean,
                              json_t *entry) {
  const struct darcy_value law = darcy_flow_into_drain(&s->darcy, name);
  if (!isfinite(law.value)) return 0;
  json_put_number(entry, "darcy", law.value);
  return hypot(mean - law.value, law.error);
}

/* Free surface in soil at a gauge, m, where the pressure is that of the air; the level of the
 * outermost particles is known less well. NAN: the gauge's level is not in soil. */
static double surface_at(const struct seepage *s, const char *name, double level) {
  const struct head_field *f = &s->field;
  double at[3];
  if (!place_of_gauge(s->run, name, at)) return NAN;
  const double x = fmin(fmax(at[0] / f->dx - 0.5, 0), (double)f->nx - 1);
  const size_t i = (size_t)x, next = i + 1 < f->nx ? i + 1 : i;
  const double z = s->phreatic[i] + (x - (double)i) * (s->phreatic[next] - s->phreatic[i]);
  const size_t column = (size_t)fmin(fmax(at[0] / f->dx, 0), (double)f->nx - 1),
               row = (size_t)fmin(fmax(level / f->dz, 0), (double)f->nz - 1);
  return f->soil[row * f->nx + column] != REGION_NONE ? z : NAN;
}

/* Drift of the head of a gauge, m. It is steadier than that of its level, whose outermost particles
 * go in steps, but none where the gauge is above the water: there its head is its height. */
static double head_drift(const struct run *run, const char *gauge) {
  char name[80];
  double mean, error, drift = 0;
  snprintf(name, sizeof name, "head_%s", gauge);
  const struct history_column *column = run_column(run, name, 1);
  if (column != NULL) late_mean(run, column, &mean, &error, &drift);
  return isfinite(drift) ? drift : 0;
}

/* Largest drift of heads, m, in runs with wells and drains; 0 if it is negligible. */
static double heads_drift(const struct seepage *s, const json_t *heads) {
  double most = 0;
  const char *name;
  const json_t *entry;
  json_object_foreach((json_t *)heads, name, entry) most =
      fmax(most, json_number_or_nan(entry, "drift_error"));
  return s->sinks && most > HEAD_DRIFT_MIN * s->drop ? most : 0;
}

/* Reports the means of the columns whose names have a prefix: a line in the summary, an object in
 * the JSON. */
static void show_columns(const struct seepage *s, const char *prefix, const char *word,
                         double scale, const char *unit, json_t *json, FILE *summary) {
  const struct run *run = s->run;
  for (size_t c = 0; c < run->column_count; c++) {
    const struct history_column *column = &run->columns[c];
    double mean, error, drift;
    if (strncmp(column->name, prefix, strlen(prefix)) != 0 || column->components != 1) continue;
    late_mean(run, column, &mean, &error, &drift);
    if (isnan(mean)) continue; /* a gauge without a level */
    mean *= scale, error *= scale, drift *= scale;
    json_t *entry = json_object();
    json_put_number(entry, "mean", mean);
    json_put_number(entry, "standard_error", error);
    json_put_number(entry, "drift_error", drift);
    json_object_set_new(json, column->name + strlen(prefix), entry);
    double half = 2 * error + drift;
    const char *note = "";
    char law[80] = "";
    if (!strcmp(word, "flux"))
      half = flux_error(s, column->name + strlen(prefix), mean, 2 * error, drift, entry, &note);
    if (!strcmp(word, "taken"))
      half =
          hypot(2 * error, drain_deviation(s, column->name + strlen(prefix), mean, entry)) + drift;
    if (!strcmp(word, "level")) {
      const char *name = column->name + strlen(prefix);
      const double surface = surface_at(s, name, mean);
      half = 2 * error + drift;
      if (isfinite(surface)) {
        mean = surface, drift = fmax(drift, head_drift(run, name));
        json_put_number(entry, "mean", mean);
        json_put_number(entry, "drift_error", drift);
        half = s->surface_error + drift;
      }
      json_put_number(entry, "error95", half);
    }
    if (!strcmp(word, "head")) {
      half =
          hypot(2 * error, gauge_deviation(s, column->name + strlen(prefix), mean, entry)) + drift;
      json_put_number(entry, "error95", half);
    }
    char text[80];
    if (isnan(half)) note = ", too few values in time for a +-";
    if (half <= 1e-12 * fabs(mean)) half = 0; /* a prescribed rate */
    if (!strcmp(word, "taken")) json_put_number(entry, "error95", half);
    if (half == 0 || isnan(half))
      snprintf(text, sizeof text, "%.4g", mean);
    else
      value_with_error(text, sizeof text, mean, half, "+-");
    const double darcy = json_number_or_nan(entry, "darcy");
    if (isfinite(darcy)) snprintf(law, sizeof law, "; Darcy's law on cells: %.4g", darcy);
    fprintf(summary, "%-10s %s: %s %s%s%s\n", word, column->name + strlen(prefix), text, unit, law,
            note);
  }
}

/* Assessment of a factor of safety against uplift. */
static const char *judge(double factor) {
  return factor < 1 ? "the soil is lifted" : factor < 1.5 ? "little is in hand" : "it stays";
}

/* A gradient with its error, its critical value and the factor of safety: text of a line, and JSON.
 * The assessment is for the smallest factor within the error. */
static void show_gradient(double gradient, double error, double critical, bool resolved,
                          json_t *entry, char text[128], char factor[80]) {
  const double least = critical / (gradient + (isfinite(error) ? error : 0));
  json_put_number(entry, "gradient", gradient);
  json_put_number(entry, "critical", critical);
  json_put_number(entry, "factor_of_safety", critical / gradient);
  json_object_set_new(entry, "resolved", json_boolean(resolved));
  if (isfinite(error)) {
    json_put_number(entry, "error95", error);
    json_put_number(entry, "factor_of_safety_least", least);
    value_with_error(text, 128, gradient, error, "+-");
  } else {
    snprintf(text, 128, "%.3g", gradient);
  }
  if (!resolved)
    snprintf(factor, 80, "factor %.3g, not resolved: take a finer spacing", critical / gradient);
  else if (isfinite(error))
    snprintf(factor, 80, "factor %.3g, %.3g at least: %s", critical / gradient, least,
             judge(least));
  else
    snprintf(factor, 80, "factor %.3g, %s", critical / gradient, judge(least));
}

/* Reports water that is not at the head of its window. */
static void show_asked(const struct seepage *s, json_t *json, FILE *summary) {
  const struct asked_heads *a = &s->asked;
  if (a->reached) return;
  json_object_set_new(json, "window_off",
                      json_pack("{s:I,s:o,s:o}", "inflow", (json_int_t)a->window, "head_m",
                                json_number(a->found), "asked_m", json_number(a->prescribed)));
  fprintf(summary,
          "window     the water before regions[%zu] stands at %.4g m, not at its head of %.4g m, "
          "%s; a head a whole number of spacings high is met\n",
          a->window, a->found, a->prescribed,
          s->darcy.known ? "which the +- hold" : "which no +- here holds");
}

static void show_exit(const struct seepage *s, json_t *json, FILE *summary) {
  const struct lifting_exit *e = &s->lifting.exit;
  if (!e->found) return;
  json_t *entry = json_object();
  json_put_number(entry, "x_m", e->x);
  json_put_number(entry, "z_m", e->z);
  json_put_number(entry, "depth_m", e->depth);
  char text[128], factor[80];
  show_gradient(e->gradient, e->error, e->critical, e->resolved, entry, text, factor);
  const double resolves = lifting_resolving_spacing(&s->lifting);
  if (isfinite(resolves)) json_put_number(entry, "spacing_that_resolves_m", resolves);
  json_object_set_new(json, "exit", entry);
  fprintf(summary,
          "exit       gradient %s at x = %.4g m, z = %.4g m, mean of %.3g m of depth; critical "
          "%.3g: %s\n",
          text, e->x, e->z, e->depth, e->critical, factor);
  if (isfinite(resolves))
    fprintf(summary,
            "coarse     a wall goes into the soil by less than four of its particles: gradients "
            "beside its foot grow with finer spacing; domain.spacing = \"%.2g m\" resolves them\n",
            resolves);
}

/* Identifies a wall by its name, or by its number in the scene: in JSON and as text. */
static void put_wall(const struct seepage *s, size_t wall, json_t *entry, char text[64]) {
  const struct head_region *region = &s->field.regions[wall];
  json_object_set_new(entry, "wall", json_integer((json_int_t)region->number));
  if (region->name != NULL && *region->name) {
    json_object_set_new(entry, "name", json_text(region->name));
    snprintf(text, 64, "%s", region->name);
  } else {
    snprintf(text, 64, "regions[%zu]", region->number);
  }
}

static void show_prisms(const struct seepage *s, json_t *json, FILE *summary) {
  json_t *list = json_array();
  for (size_t n = 0; n < s->lifting.prism_count; n++) {
    const struct lifting_prism *p = &s->lifting.prisms[n];
    char text[128], factor[80], wall[64];
    json_t *entry = json_object();
    put_wall(s, p->wall, entry, wall);
    json_object_set_new(entry, "side", json_string(p->side < 0 ? "low x" : "high x"));
    json_put_number(entry, "depth_m", p->depth);
    json_put_number(entry, "width_m", p->width);
    show_gradient(p->gradient, p->error, p->critical, p->resolved, entry, text, factor);
    json_array_append_new(list, entry);
    fprintf(summary,
            "heave      beside the wall %s, %s x: mean gradient %s in a prism %.3g m deep, %.3g m "
            "wide; critical %.3g: %s\n",
            wall, p->side < 0 ? "lower" : "higher", text, p->depth, p->width, p->critical, factor);
  }
  json_object_set_new(json, "heave", list);
}

static void show_force(double force, double error, char text[128]) {
  if (error > 0)
    value_with_error(text, 128, force, error, "+-");
  else
    snprintf(text, 128, "%.4g", force);
}

static void show_loads(const struct seepage *s, json_t *json, FILE *summary) {
  json_t *list = json_array();
  for (size_t n = 0; n < s->lifting.load_count; n++) {
    const struct lifting_load *l = &s->lifting.loads[n];
    json_t *entry = json_object();
    char text[3][128], wall[64];
    put_wall(s, l->wall, entry, wall);
    json_put_number(entry, "force_x_N_per_m", l->force[0]);
    json_put_number(entry, "force_z_N_per_m", l->force[1]);
    json_put_number(entry, "uplift_N_per_m", l->uplift);
    json_put_number(entry, "uplift_pressure_Pa", l->pressure);
    json_array_append_new(list, entry);
    for (int c = 0; c < 2; c++) show_force(l->force[c], l->force_error[c], text[c]);
    show_force(l->uplift, l->uplift_error, text[2]);
    if (isfinite(l->uplift_error)) {
      json_put_number(entry, "force_x_error95", l->force_error[0]);
      json_put_number(entry, "force_z_error95", l->force_error[1]);
      json_put_number(entry, "uplift_error95", l->uplift_error);
    }
    fprintf(summary, "water      on the wall %s: %s N/m along x, %s N/m along z", wall, text[0],
            text[1]);
    if (l->length > 0) fprintf(summary, "; under it %.4g Pa, %s N/m upwards", l->pressure, text[2]);
    fputc('\n', summary);
  }
  json_object_set_new(json, "walls", list);
}

static void show_exits(const struct seepage *s, json_t *json, FILE *summary) {
  json_t *list = json_array();
  for (size_t n = 0; n < s->exit_count; n++) {
    const struct surface_exit *e = &s->exits[n];
    char text[80];
    value_with_error(text, sizeof text, e->z, e->error, "+-");
    fprintf(summary, "face       water comes out of soil up to %s m at x = %.4g m", text, e->x);
    if (isfinite(e->outside)) fprintf(summary, ", above water at %.4g m", e->outside);
    fputc('\n', summary);
    json_array_append_new(list, json_pack("{s:o,s:o,s:o,s:o}", "x_m", json_number(e->x), "z_m",
                                          json_number(e->z), "error95", json_number(e->error),
                                          "water_m", json_number(e->outside)));
  }
  json_object_set_new(json, "seepage_faces", list);
}

static void write_cells(const struct seepage *s, FILE *csv) {
  const struct head_field *f = &s->field;
  fputs("x,z,head,pressure,velocity_x,velocity_z,stream,soil\n", csv);
  for (size_t k = 0; k < f->nz; k++)
    for (size_t i = 0; i < f->nx; i++) {
      const size_t c = k * f->nx + i;
      double psi = 0;
      if (isnan(f->head[c])) continue;
      for (size_t n = 0; n < 4; n++) psi += 0.25 * s->psi[(k + n / 2) * (f->nx + 1) + i + n % 2];
      fprintf(csv, "%.6g,%.6g,%.7g,%.7g,%.6g,%.6g,", head_field_x(f, i), head_field_z(f, k),
              f->head[c], f->density * f->gravity * (f->head[c] - head_field_z(f, k)),
              f->velocity[0][c], f->velocity[1][c]);
      if (!s->sinks) fprintf(csv, "%.6g", psi);
      fputc(',', csv);
      if (f->soil[c] != REGION_NONE) fprintf(csv, "%zu", f->regions[f->soil[c]].number);
      fputc('\n', csv);
    }
}

static void put_phreatic(const struct seepage *s, json_t *json) {
  json_t *x = json_array(), *level = json_array();
  for (size_t i = 0; i < s->field.nx; i++) {
    if (isnan(s->phreatic[i])) continue;
    json_array_append_new(x, json_number(head_field_x(&s->field, i)));
    json_array_append_new(level, json_number(s->phreatic[i]));
  }
  json_object_set_new(json, "phreatic_line",
                      json_pack("{s:o,s:o,s:o}", "x_m", x, "level_m", level, "error95",
                                json_number(s->surface_error)));
}

/* Writes JSON, CSV of the cells, summary and the plot of the flow net. */
static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  const struct run *run = &subject->runs[0];
  double grain_density = NAN;
  struct seepage seepage, *s = &seepage;
  FILE *summary = product->summary.stream;
  json_t *json = product->json, *heads = json_object(), *levels = json_object(),
         *fluxes = json_object(), *taken = json_object();
  json_object_set_new(json, "fluxes_m2_per_s", fluxes);
  json_object_set_new(json, "heads_m", heads);
  json_object_set_new(json, "levels_m", levels);
  json_object_set_new(json, "taken_m2_per_s", taken);
  enum status status =
      options == NULL ? STATUS_OK
                      : options_quantity(options, "grain-density", DIM_DENSITY, &grain_density);
  if (status == STATUS_OK) status = seepage_find(run, grain_density, s);
  if (status != STATUS_OK) return status;
  add_drift(s);
  json_object_set_new(json, "path", json_text(run->path));
  json_object_set_new(json, "name", json_text(run->name));
  json_object_set_new(json, "snapshots", json_integer((json_int_t)s->field.snapshots));
  json_put_number(json, "from_s", s->field.from);
  json_put_number(json, "to_s", s->field.to);
  json_put_number(json, "grain_density_kg_per_m3", s->grain_density);
  fprintf(summary, "%s: means of %.4g to %.4g s, %zu snapshot%s\n", run->name, s->field.from,
          s->field.to, s->field.snapshots, s->field.snapshots == 1 ? "" : "s");
  show_columns(s, "flux_", "flux", 1 / s->field.thickness, "m^2/s (m^3/s for each m along y)",
               fluxes, summary);
  show_columns(s, "outflow_", "taken", 1 / s->field.thickness, "m^2/s", taken, summary);
  show_flow(s, fluxes, json, summary);
  show_columns(s, "head_", "head", 1, "m", heads, summary);
  show_columns(s, "level_", "level", 1, "m", levels, summary);
  const double drifting = heads_drift(s, heads);
  json_put_number(json, "heads_drift_m", drifting);
  if (drifting > 0) fputs("unsteady   heads still go one way: run longer\n", summary);
  show_exits(s, json, summary);
  show_asked(s, json, summary);
  show_exit(s, json, summary);
  show_prisms(s, json, summary);
  show_loads(s, json, summary);
  put_phreatic(s, json);
  write_cells(s, product->csv.stream);
  seepage_plot(s, product);
  seepage_free(s);
  return STATUS_OK;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = false;
  return subject->snapshots && subject->n == 1 ? seepage_applies(&subject->runs[0], applies)
                                               : STATUS_OK;
}

const struct analysis seepage_analysis = {
    .name = "seepage",
    .command =
        {"seepage", "RUN [--grain-density Q] [-o DIR]",
         "flow through soil: fluxes, heads, exit gradient and heave, forces on walls, flow net",
         "analyze seepage excavation.hdf -o results", 1, 1},
    .options = {{"grain-density", 0, "Q", 0,
                 "of the soil's grains, for the critical gradient (2650 kg/m^3)"}},
    .heading = "Seepage",
    .page_runs = OF_FIRST,
    .caption =
        "Flow net: equipotentials in the soil, streamlines where no well or drain takes from it, "
        "the water's surface, and what the water does to soil and walls.",
    .applies = applies,
    .analyze = analyze};
