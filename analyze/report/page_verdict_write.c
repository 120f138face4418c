/* The assessment as HTML. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/compatible_runs.h"
#include "analyze/product.h"
#include "analyze/report/page_html.h"
#include "analyze/report/page_verdict.h"
#include "analyze/seepage/seepage.h"
#include "analyze/tensor.h"
#include "common/units.h"

static void write_string(const json_t *object, const char *key, FILE *stream) {
  const char *text = json_string_value(json_object_get(object, key));
  if (text != NULL) html_text(stream, text);
}

/* Relative errors below this are not shown: those of prescribed rates, or rounding of averages. */
#define RELATIVE_ERROR_MIN 1e-6

/* "0.1540 &plusmn; 0.0021 cm/s (1.4 %)"; small and large numbers as (1.54 &plusmn; 0.02) 10^-3. */
static void quantity(FILE *out, double value, double relative, const char *unit) {
  char scaled[80];
  int power = value != 0.0 ? (int)floor(log10(fabs(value))) : 0;
  if (value == 0) relative = 0;
  fputs("<span class=\"quantity\">", out);
  if (value != 0 && !(relative >= RELATIVE_ERROR_MIN && isfinite(relative))) {
    const int digits = isfinite(relative) ? 5 : 4;
    if (power >= -2 && power < 5)
      fprintf(out, "%.*g %s", digits, value, unit);
    else
      fprintf(out, "%.*g &times; 10<sup>%s%d</sup> %s", digits, value / pow(10.0, power),
              power < 0 ? "&minus;" : "", abs(power), unit);
    if (!isfinite(relative)) fputs(" (error unknown)", out);
  } else if (power >= -2 && power < 5) {
    snprintf(scaled, sizeof scaled, " %s", unit);
    write_value_with_error(out, value, relative * value, "&plusmn;", scaled);
  } else {
    double unitless = value / pow(10.0, power);
    fputc('(', out);
    snprintf(scaled, sizeof scaled, ") &times; 10<sup>%s%d</sup> %s", power < 0 ? "&minus;" : "",
             abs(power), unit);
    write_value_with_error(out, unitless, relative * unitless, "&plusmn;", scaled);
  }
  fputs("</span>", out);
}

/* "0.030 cm/s, 0.026 to 0.034 (95 %)", or with a power of ten. */
static void interval(FILE *out, double value, double low, double high, const char *unit) {
  const double half = 0.5 * (high - low);
  if (value == 0 && !(half > 0)) {
    fprintf(out, "0 %s", unit);
    return;
  }
  int power = value > 0.0 ? (int)floor(log10(value)) : 0;
  if (power >= -3 && power < 5) power = 0;
  const double scale = pow(10.0, power);
  int digits = half > 0.0 ? 1 - (int)floor(log10(half / scale)) : 4;
  digits = digits < 0 ? 0 : digits > 8 ? 8 : digits;
  fprintf(out, "%.*f", digits, value / scale);
  if (power != 0)
    fprintf(out, " &times; 10<sup>%s%d</sup>", power < 0 ? "&minus;" : "", abs(power));
  fprintf(out, " %s", unit);
  if (!isfinite(half)) return;
  fprintf(out, ", <span class=\"interval\">%.*f to %.*f", digits, low / scale, digits,
          high / scale);
  if (power != 0)
    fprintf(out, " &times; 10<sup>%s%d</sup>", power < 0 ? "&minus;" : "", abs(power));
  fputs(" (95&nbsp;%)</span>", out);
}

/* The parts of the error as bars on a common scale. */
static void write_budget(const json_t *result, FILE *out) {
  const json_t *budget = json_object_get(result, "error_budget");
  static const struct {
    const char *key, *name;
  } parts[] = {{"resolution", "resolution"}, {"scan", "scan"},
               {"sides", "sides"},           {"void_ratio", "void ratio"},
               {"threshold", "threshold"},   {"micro", "soil below the voxel"},
               {"averaging", "averaging"},   {"steadiness", "steadiness"}};
  const double total = json_number_or_nan(budget, "total");
  if (!(total > 0.0)) return;
  fputs("<table class=\"budget\"><caption>What the error is made of</caption><tbody>\n", out);
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    const double part = json_number_or_nan(budget, parts[i].key);
    if (!isfinite(part) || part == 0) continue;
    const char *from = json_string_value(json_object_get(budget, "resolution_from"));
    fprintf(out, "<tr><th>%s%s</th><td class=\"number\">", parts[i].name,
            i == 0 && from != NULL && from[0] == 'e' ? " (expected)" : "");
    write_percent(out, part);
    fprintf(out, "</td><td class=\"share\"><i style=\"width:%.1f%%\"></i></td></tr>\n",
            100.0 * fmin(part / total, 1.0));
  }
  fputs("</tbody></table>\n", out);
  if (json_is_true(json_object_get(budget, "scan_unknown")))
    fputs(
        "<p class=\"note\">What the scan left in <var>k</var>, its blur, noise and labels, is not "
        "known and not counted.</p>\n",
        out);
  if (json_is_true(json_object_get(budget, "sides_unknown")))
    fputs("<p class=\"note\">What the sample&rsquo;s sides do to <var>k</var> is not known and not "
          "counted: no pore leads through the lattice on which it is looked for.</p>\n",
          out);
  const double assumed = json_number_or_nan(budget, "blur_assumed_m");
  if (isfinite(assumed))
    fprintf(
        out,
        "<p class=\"note\">The scanner&rsquo;s blur could not be measured: no surface stands "
        "alone in the scan. The share of the scan is that of a blur of %.3g&nbsp;&micro;m.</p>\n",
        1e6 * assumed);
  const double slope = fabs(json_number_or_nan(result, "dlnk_dvoid_ratio"));
  if (isfinite(json_number_or_nan(budget, "void_ratio")) && isfinite(slope) &&
      isnan(json_number_or_nan(budget, "threshold")))
    fprintf(out,
            "<p class=\"note\">The void ratio was given without its &plusmn;, which is not "
            "counted: each 0.01 of it is %.2g&nbsp;%% of <var>k</var>.</p>\n",
            slope);
  const double closed = json_number_or_nan(budget, "dlnk_sides_closed");
  char change[32] = "less than 0.01";
  if (fabs(closed) > 1e-4) snprintf(change, sizeof change, "%+.2g", 100.0 * expm1(closed));
  if (isfinite(closed))
    fprintf(
        out,
        "<p class=\"note\">Sides: the sample wraps round; mirrored at its sides, k changes by the "
        "share above. In a tube with the sample&rsquo;s sides, whose walls rub as no soil "
        "does, k would change by %s %%.</p>\n",
        change);
}

static void write_orientation(const json_t *result, FILE *out) {
  static const struct {
    const char *key, *name;
  } rows[] = {{"kozeny_carman", "Kozeny-Carman"}, {"hazen", "Hazen"}, {"terzaghi", "Terzaghi"}};
  const json_t *formulas = json_object_get(result, "formulas");
  const double k = json_number_or_nan(result, "k_m_per_s");
  char text[32], of_k[32];
  fputs("<table class=\"facts\"><caption>For orientation</caption><tbody>\n<tr><th>DIN 18130-1 "
        "(test: ISO 17892-11)</th><td>",
        out);
  write_string(result, "class_din", out);
  fputs("</td></tr>\n<tr><th>Casagrande</th><td>", out);
  write_string(result, "class_casagrande", out);
  fputs("</td></tr>\n", out);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    const double value = json_number_or_nan(formulas, rows[i].key);
    if (!isfinite(value)) continue;
    fprintf(out, "<tr><th>%s</th><td>%s cm/s", rows[i].name, short_number(100.0 * value, 2, text));
    if (k > 0.0) fprintf(out, " (%s times this k)", short_number(value / k, 2, of_k));
    fputs("</td></tr>\n", out);
  }
  fputs("</tbody></table>\n", out);
  if (formulas != NULL)
    fprintf(out,
            "<p class=\"note\">The formulas take the model&rsquo;s porosity and the surface of its "
            "grains; grain size %s &micro;m is that of spheres of the same surface, not a "
            "d<sub>10</sub>. Classes are those of water.</p>\n",
            short_number(1e6 * json_number_or_nan(formulas, "grain_size_m"), 3, text));
}

static void write_others(const json_t *results, const struct subject *subject, FILE *out) {
  const json_t *result;
  size_t i;
  if (json_array_size(results) < 2 && subject->permeable == subject->n) return;
  fputs("<div class=\"wide\"><table class=\"others\"><thead><tr><th>Further results</th><th><var>"
        "k</var></th></tr></thead><tbody>\n",
        out);
  json_array_foreach(results, i, result) {
    if (i == 0) continue;
    fputs("<tr><td>", out);
    write_string(result, "name", out);
    fputs("</td><td>", out);
    quantity(out, 100.0 * json_number_or_nan(result, "k_m_per_s"),
             json_number_or_nan(result, "k_relative_error"), "cm/s");
    fputs("</td></tr>\n", out);
  }
  for (i = subject->permeable; i < subject->n; i++) {
    fputs("<tr><td>", out);
    html_text(out, subject->runs[i].name);
    fprintf(out, " (%s)</td><td>none: %s</td></tr>\n", subject->runs[i].method,
            run_has_permeability(&subject->runs[i]) ? "not settled" : "see a page of its own");
  }
  fputs("</tbody></table></div>\n", out);
}

/* The flow of a seepage run, from the most accurate source: outflow by wells and drains, else the
 * flux of a plane, else the flow net. */
static void find_flow(const json_t *seepage, double *flow, double *error, const char **where,
                      const char **plane) {
  const json_t *through = json_object_get(seepage, "through"), *sink;
  json_t *taken = json_object_get(seepage, "taken_m2_per_s");
  const char *name;
  *flow = *error = 0;
  *plane = "";
  json_object_foreach(taken, name, sink) {
    *flow += json_number_or_nan(sink, "mean");
    *error += json_number_or_nan(sink, "error95");
  }
  *where = "taken out of the soil by wells and drains";
  if (json_object_size(taken) > 0 && *error == 0)
    *where = "taken out of the soil by wells and drains, as the scene gives it";
  if (json_object_size(taken) > 0) return;
  *where = "through the soil, by the flow net";
  *flow = json_number_or_nan(seepage, "flow_m2_per_s");
  *error = json_number_or_nan(seepage, "flow_error95_m2_per_s");
  if (through == NULL) return;
  *where = "through the soil, at the plane ";
  *plane = json_string_value(json_object_get(through, "plane")); /* present in every "through" */
  *flow = json_number_or_nan(through, "flux_m2_per_s");
  *error = json_number_or_nan(through, "error95");
}

/* Takes over the factor of safety of an exit gradient or a prism if it is the smallest so far. */
static void find_factor(const json_t *entry, double *factor, double *least, bool *resolved) {
  const double own = json_number_or_nan(entry, "factor_of_safety");
  if (!(own < *factor)) return;
  *factor = own;
  *least = json_number_or_nan(entry, "factor_of_safety_least");
  *resolved = json_is_true(json_object_get(entry, "resolved"));
}

/* Without a k: the flow through the soil, and the safety of its surface against uplift. */
static void write_seepage(const json_t *seepage, FILE *out) {
  const json_t *prism;
  const char *where, *plane;
  size_t i;
  double flow, error;
  double factor = INFINITY, least = NAN; /* the smallest, and its least value within the error */
  bool resolved = false;
  find_factor(json_object_get(seepage, "exit"), &factor, &least, &resolved);
  json_array_foreach(json_object_get(seepage, "heave"), i, prism) {
    find_factor(prism, &factor, &least, &resolved);
  }
  find_flow(seepage, &flow, &error, &where, &plane);
  const double uptake = json_number_or_nan(seepage, "soil_uptake_m2_per_s");
  const double drift = plane[0] == '\0' ? json_number_or_nan(seepage, "flow_drift_m2_per_s")
                                        : NAN; /* already included in the error */
  const bool none = fabs(uptake) > 0.5 * flow || drift > 0.5 * flow;
  fputs("<p class=\"k\">", out);
  if (none) {
    fputs("No steady flow <span class=\"interval\">through the soil", out);
  } else {
    quantity(out, flow, error / fabs(flow), "m&sup2;/s"); /* 0 for a prescribed rate */
    fprintf(out, " <span class=\"interval\">%s", where);
    html_text(out, plane);
  }
  fprintf(out, "</span></p>\n<p class=\"verdict\">%s head falls by %.3g&nbsp;m in it",
          none ? "The" : "For each metre along y; the", json_number_or_nan(seepage, "head_drop_m"));
  if (seepage_is_filling(flow, error, uptake))
    fprintf(out, ". The soil still %s %.3g&nbsp;m&sup2;/s: run longer",
            uptake > 0 ? "fills with" : "drains of", fabs(uptake));
  if (json_number_or_nan(seepage, "heads_drift_m") > 0)
    fputs(". Heads in it still go one way: run longer", out);
  if (drift > 0.1 * flow) fputs(". The velocities in it still go one way: run longer", out);
  const double resolves =
      json_number_or_nan(json_object_get(seepage, "exit"), "spacing_that_resolves_m");
  if (isfinite(factor)) {
    fprintf(out, ". Against its being lifted the soil has a factor of %.3g", factor);
    if (resolved && isfinite(least)) fprintf(out, ", %.3g at least", least);
    if (resolved)
      fprintf(out, ": %s", seepage_judge(isfinite(least) ? least : factor));
    else if (isnan(resolves))
      fputs(", which is not resolved: take a finer spacing", out);
  }
  if (isfinite(resolves))
    fprintf(out,
            "; but gradients beside a wall as shallow as here are not resolved: take a spacing of "
            "%.2g&nbsp;m",
            resolves);
  fputs(".</p>\n", out);
}

/* A flow in unsaturated soil: amount of water, and highest water table. */
static void write_moisture(const json_t *moisture, FILE *out) {
  const json_t *table = json_object_get(moisture, "water_table"), *level;
  const json_t *x = json_object_get(table, "x_m"), *levels = json_object_get(table, "level_m");
  double highest = NAN;
  size_t i, where = 0;
  json_array_foreach(levels, i, level) {
    if (!json_is_number(level) || json_number_value(level) <= highest) continue;
    highest = json_number_value(level);
    where = i;
  }
  fprintf(out,
          "<p class=\"k\">%.4g&nbsp;m&sup3; of water <span class=\"interval\">in the soil after ",
          json_number_or_nan(moisture, "water_m3"));
  char time[64];
  duration_format(json_number_or_nan(moisture, "time_s"), time, sizeof time);
  fprintf(out, "%s</span></p>\n<p class=\"verdict\">%.4g&nbsp;m&sup3; at the start", time,
          json_number_or_nan(moisture, "water_at_start_m3"));
  const double thickness = json_number_or_nan(moisture, "thickness_m");
  if (isfinite(thickness))
    fprintf(out, ", in a slice %.4g&nbsp;m thick along <var>y</var>", thickness);
  if (isfinite(highest))
    fprintf(out, "; the water table is highest at <var>x</var> = %.4g&nbsp;m: %.4g&nbsp;m",
            json_number_value(json_array_get(x, where)), highest);
  fputs(".</p>\n", out);
}

/* With several runs without a k only the first is shown: names it and the others. */
static void write_run_note(const struct subject *subject, FILE *out) {
  if (subject->n < 2) return;
  fputs("<p class=\"note\">Of ", out);
  html_text(out, subject->runs[0].name);
  fputs(" alone. Give", out);
  for (size_t i = 1; i < subject->n; i++) {
    fputs(i == 1 ? " " : i + 1 < subject->n ? ", " : " and ", out);
    html_text(out, subject->runs[i].name);
  }
  fputs(subject->n > 2 ? " pages of their own.</p>\n" : " a page of its own.</p>\n", out);
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

enum status verdict_write(const json_t *data, const struct subject *subject, FILE *out) {
  enum status status = STATUS_OK;
  struct tensor tensor;
  bool has_tensor;
  const json_t *results = json_object_get(data, "verdict"),
               *seepage = json_object_get(data, "seepage"),
               *moisture = json_object_get(data, "moisture");
  const json_t *result = json_array_get(results, 0);
  fputs("<section id=\"headline\"><article class=\"card\">\n", out);
  if (result == NULL) {
    if (seepage != NULL)
      write_seepage(seepage, out);
    else if (moisture != NULL)
      write_moisture(moisture, out);
    else
      fputs(
          run_has_permeability(&subject->runs[0])
              ? "<p>The flow has not settled, so there is no permeability to give: run it "
                "longer.</p>"
              : "<p>Nothing drives a flow through the whole body, or it has not settled, so there "
                "is no permeability to give.</p>",
          out);
    write_run_note(subject, out);
    fputs("</article></section>\n", out);
    return STATUS_OK;
  }
  const double k = json_number_or_nan(result, "k_m_per_s"),
               relative = json_number_or_nan(result, "k_relative_error");
  fputs("<p class=\"k\"><var>k</var> = ", out);
  interval(out, 100.0 * k, 100.0 * json_number_or_nan(result, "k_low_m_per_s"),
           100.0 * json_number_or_nan(result, "k_high_m_per_s"), "cm/s");
  if (json_is_true(json_object_get(json_object_get(result, "error_budget"), "sides_unknown")))
    fputs(" <span class=\"interval\">sides not counted</span>", out);
  fputs("</p>\n<p class=\"verdict\">", out);
  write_string(result, "good_for", out);
  fputs(". ", out);
  write_string(result, "advice", out);
  fputs("</p>\n<div class=\"columns\"><div><p>", out);
  write_string(result, "name", out);
  fputs("<br>= ", out);
  quantity(out, 100.0 * k, relative, "cm/s");
  fputs("<br>= ", out);
  quantity(out, k, relative, "m/s");
  fputs("<br>intrinsic permeability ", out);
  quantity(out, json_number_or_nan(result, "intrinsic_permeability_m2"), relative, "m&sup2;");
  fputs("<br>= ", out);
  quantity(out, json_number_or_nan(result, "intrinsic_permeability_m2") / DARCY, relative, "darcy");
  fputs("</p><p class=\"note\">", out);
  write_string(result, "note", out);
  fputs("</p>\n", out);
  if (k > 0.0) write_budget(result, out); /* without flow k has no error */
  fputs("</div><div>", out);
  if (k > 0.0) write_orientation(result, out); /* and the soil has no class */
  fputs("</div></div>\n", out);
  TRY(find_tensor(result, subject, &tensor, &has_tensor));
  if (has_tensor) tensor_html(&tensor, out);
  write_others(results, subject, out);
  fputs("</article></section>\n", out);
cleanup:
  return status;
}
