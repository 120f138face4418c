/* What the page begins with where it is no permeability. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/compatible_runs.h"
#include "analyze/product.h"
#include "analyze/report/page_verdict.h"
#include "analyze/seepage/seepage.h"
#include "analyze/tensor.h"
#include "common/units.h"

/* {"value", "error" (95 %), "unit", "text": what the value is of, "sentence"} */
static json_t *headline(double value, double error, const char *unit, const char *text,
                        const char *sentence) {
  return json_pack("{s:o,s:o,s:s,s:o,s:o}", "value", json_number(value), "error",
                   json_number(error), "unit", unit, "text", json_text(text), "sentence",
                   json_text(sentence));
}

/* The flow of a seepage run, from the most accurate source: outflow by wells and drains, else the
 * flux of a plane, else the flow net. Returns whether it is that of a plane. */
static bool find_flow(const json_t *seepage, double *flow, double *error, char where[300]) {
  const json_t *through = json_object_get(seepage, "through"), *sink;
  json_t *taken = json_object_get(seepage, "taken_m2_per_s");
  const char *name;
  *flow = *error = 0;
  json_object_foreach(taken, name, sink) {
    *flow += json_number_or_nan(sink, "mean");
    *error += json_number_or_nan(sink, "error95");
  }
  if (json_object_size(taken) > 0) {
    snprintf(where, 300, "taken out of the soil by wells and drains%s",
             *error == 0 ? ", as the scene gives it" : "");
    return false;
  }
  if (through == NULL) {
    snprintf(where, 300, "through the soil, by the flow net");
    *flow = json_number_or_nan(seepage, "flow_m2_per_s");
    *error = json_number_or_nan(seepage, "flow_error95_m2_per_s");
    return false;
  }
  snprintf(where, 300, "through the soil, at the plane %.200s",
           json_string_value(json_object_get(through, "plane")));
  *flow = json_number_or_nan(through, "flux_m2_per_s");
  *error = json_number_or_nan(through, "error95");
  return true;
}

/* Takes over the factor of safety of an exit gradient or a prism if it is the smallest so far. */
static void find_factor(const json_t *entry, double *factor, double *least, bool *resolved) {
  const double own = json_number_or_nan(entry, "factor_of_safety");
  if (!(own < *factor)) return;
  *factor = own;
  *least = json_number_or_nan(entry, "factor_of_safety_least");
  *resolved = json_is_true(json_object_get(entry, "resolved"));
}

/* The safety of the soil's surface against uplift. */
static void write_uplift(const json_t *seepage, FILE *out) {
  const json_t *prism, *exit = json_object_get(seepage, "exit");
  double factor = INFINITY, least = NAN; /* the smallest, and its least value within the error */
  bool resolved = false;
  size_t i;
  find_factor(exit, &factor, &least, &resolved);
  json_array_foreach(json_object_get(seepage, "heave"), i, prism) {
    find_factor(prism, &factor, &least, &resolved);
  }
  const double resolves = json_number_or_nan(exit, "spacing_that_resolves_m");
  if (isfinite(factor)) {
    fprintf(out, ". Factor of safety against uplift %.3g", factor);
    if (resolved && isfinite(least)) fprintf(out, ", %.3g at least", least);
    if (resolved)
      fprintf(out, ": %s", seepage_judge(isfinite(least) ? least : factor));
    else if (isnan(resolves))
      fputs(", which is not resolved: take a finer spacing", out);
  }
  if (isfinite(resolves))
    fprintf(out,
            "; but gradients beside a wall as shallow as here are not resolved: take a spacing of "
            "%.2g m",
            resolves);
}

/* The flow through the soil for each metre along y, and what it does. */
static json_t *of_seepage(const json_t *seepage, FILE *out, const struct text *text) {
  double flow, error;
  char where[300];
  const bool plane = find_flow(seepage, &flow, &error, where);
  const double uptake = json_number_or_nan(seepage, "soil_uptake_m2_per_s");
  const double drift = plane ? NAN /* already included in the error */
                             : json_number_or_nan(seepage, "flow_drift_m2_per_s");
  const bool none = fabs(uptake) > 0.5 * flow || drift > 0.5 * flow;
  fprintf(out, "%s head falls by %.3g m in it", none ? "The" : "For each metre along y; the",
          json_number_or_nan(seepage, "head_drop_m"));
  if (seepage_is_filling(flow, error, uptake))
    fprintf(out, ". The soil still %s %.3g m\xc2\xb2/s: run longer",
            uptake > 0 ? "fills with" : "drains of", fabs(uptake));
  if (json_number_or_nan(seepage, "heads_drift_m") > 0)
    fputs(". Heads in it still go one way: run longer", out);
  if (drift > 0.1 * flow) fputs(". The velocities in it still go one way: run longer", out);
  write_uplift(seepage, out);
  fputc('.', out);
  fflush(out);
  return none ? headline(NAN, NAN, "", "No steady flow through the soil", text->data)
              : headline(flow, error, "m\xc2\xb2/s", where, text->data);
}

/* A flow in unsaturated soil: amount of water, and highest water table. */
static json_t *of_moisture(const json_t *moisture, FILE *out, const struct text *text) {
  const json_t *table = json_object_get(moisture, "water_table"), *level;
  const json_t *x = json_object_get(table, "x_m"), *levels = json_object_get(table, "level_m");
  const double thickness = json_number_or_nan(moisture, "thickness_m");
  double highest = NAN;
  char time[64], where[128];
  size_t i, at = 0;
  json_array_foreach(levels, i, level) {
    if (!json_is_number(level) || json_number_value(level) <= highest) continue;
    highest = json_number_value(level);
    at = i;
  }
  duration_format(json_number_or_nan(moisture, "time_s"), time, sizeof time);
  snprintf(where, sizeof where, "of water in the soil after %s", time);
  fprintf(out, "%.3g m\xc2\xb3 at the start", json_number_or_nan(moisture, "water_at_start_m3"));
  if (isfinite(thickness)) fprintf(out, ", in a slice %.3g m thick along y", thickness);
  if (isfinite(highest))
    fprintf(out, "; the water table is highest at x = %.3g m: %.3g m",
            json_number_value(json_array_get(x, at)), highest);
  fputc('.', out);
  fflush(out);
  return headline(json_number_or_nan(moisture, "water_m3"), 0.0, "m\xc2\xb3", where, text->data);
}

/* Last value of a column, component c; NAN without such a column. */
static double last_of(const struct run *run, const char *name, int components, int c) {
  const struct history_column *column = run_column(run, name, components);
  if (column == NULL || column->rows == 0) return NAN;
  return column->values[(column->rows - 1) * (size_t)components + (size_t)c];
}

/* Free water: where it is at the end, and how fast. NULL if the run does not record it. */
static json_t *of_free_water(const struct run *run, FILE *out, const struct text *text) {
  const double low = last_of(run, "front_low", 3, 0), high = last_of(run, "front_high", 3, 0);
  const double top = last_of(run, "front_high", 3, 2), speed = last_of(run, "velocity_rms", 1, 0);
  const double end = last_of(run, "time", 1, 0);
  char time[64], when[96];
  if (!isfinite(low) || !isfinite(high) || !isfinite(top)) return NULL;
  if (end < 60.0)
    snprintf(time, sizeof time, "%.3g s", end);
  else
    duration_format(end, time, sizeof time);
  snprintf(when, sizeof when, "Water after %s", time);
  fprintf(out, "It lies between x = %.3g m and %.3g m, and up to z = %.3g m", low, high, top);
  if (isfinite(speed)) fprintf(out, "; its speed is %.3g m/s (root of the mean square)", speed);
  fputc('.', out);
  fflush(out);
  return headline(NAN, NAN, "", when, text->data);
}

/* Finds the tensor of the run of a result, or of another run with the same body. */
static enum status find_tensor(const json_t *result, const struct subject *subject,
                               struct tensor *tensor, bool *found) {
  enum status status = STATUS_OK;
  const char *path = json_string_value(json_object_get(result, "path"));
  const struct run *own = NULL;
  *found = false;
  for (size_t i = 0; i < subject->n && own == NULL; i++)
    if (path != NULL && strcmp(subject->runs[i].path, path) == 0) own = &subject->runs[i];
  if (own == NULL) return STATUS_OK;
  TRY(tensor_read(own, tensor, found));
  for (size_t i = 0; i < subject->n && !*found; i++)
    if (compatible_runs_same_model(own, &subject->runs[i], true))
      TRY(tensor_read(&subject->runs[i], tensor, found));
cleanup:
  return status;
}

static enum status add_tensor(json_t *data, const struct subject *subject) {
  enum status status = STATUS_OK;
  struct text text = {0};
  struct tensor tensor;
  bool found;
  TRY(find_tensor(json_array_get(json_object_get(data, "verdict"), 0), subject, &tensor, &found));
  if (!found) goto cleanup;
  TRY(text_start(&text));
  tensor_symmetry(&tensor, text.stream);
  TRY(text_finish(&text));
  json_t *object = tensor_json(&tensor);
  json_object_set_new(object, "note", json_text(text.data));
  json_object_set_new(data, "tensor", object);
cleanup:
  text_free(&text);
  return status;
}

enum status verdict_headline(json_t *data, const struct subject *subject) {
  enum status status = STATUS_OK;
  const json_t *seepage = json_object_get(data, "seepage");
  const json_t *moisture = json_object_get(data, "moisture");
  struct text text = {0};
  json_t *head;
  if (json_array_size(json_object_get(data, "verdict")) > 0) return add_tensor(data, subject);
  TRY(text_start(&text));
  if (seepage != NULL)
    head = of_seepage(seepage, text.stream, &text);
  else if (moisture != NULL)
    head = of_moisture(moisture, text.stream, &text);
  else
    head = of_free_water(&subject->runs[0], text.stream, &text);
  if (head == NULL)
    head = headline(NAN, NAN, "", "",
                    run_has_permeability(&subject->runs[0])
                        ? "The flow has not settled, so there is no permeability to give: run it "
                          "longer."
                        : "Nothing drives a flow through the whole body, so there is no "
                          "permeability to give.");
  json_object_set_new(data, "headline", head);
cleanup:
  text_free(&text);
  return status;
}
