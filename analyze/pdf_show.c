/* Output of velocity densities as text, JSON and charts; the estimates are in pdf.c. */
#include "analyze/pdf.h"

#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/chart.h"
#include "analyze/compatible_runs.h"
#include "common/memory.h"

/* Statistics of a run's last snapshot. */
struct velocity_statistics {
  const struct run *run;
  size_t particles;
  double time;
  double mean; /* mean pore velocity along the force, m/s */
  struct pdf raw, normalised;
  double low, high;            /* of v / mean */
  double backward;             /* share of particles moving against the force */
  double transverse;           /* |mean transverse velocity| / mean */
  double transverse_deviation; /* rms transverse velocity / mean */
  double tortuosity;           /* mean speed / mean along the force */
  struct moments moments;      /* of v / mean */
  double sigma, gamma;         /* power-exponential */
};

static enum status measure(const struct run *run, struct velocity_statistics *out) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  double *along = NULL;
  const double *f = run->direction;
  out->run = run;
  if (f[0] == 0.0 && f[1] == 0.0 && f[2] == 0.0)
    TRY_FAIL(STATUS_INPUT,
             "%s: nothing drives the flow of this run, so there is no direction to take the "
             "velocity along",
             run->path);
  TRY(run_last_snapshot(run, &particles));
  size_t n = particles.count;
  TRY(memory_allocate(&along, n, sizeof *along, "velocities"));
  double mean[3] = {0}, speed = 0.0, sideways = 0.0, total = 0.0;
  for (size_t i = 0; i < n; i++) {
    const double *v = particles.velocity + 3 * i;
    double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    along[i] = v[0] * f[0] + v[1] * f[1] + v[2] * f[2];
    total += along[i];
    for (int d = 0; d < 3; d++) mean[d] += (v[d] - along[i] * f[d]) / (double)n;
    speed += sqrt(square);
    sideways += fmax(square - along[i] * along[i], 0.0);
    out->backward += along[i] < 0.0 ? 1.0 : 0.0;
  }
  out->particles = n;
  out->time = particles.time;
  out->mean = total / (double)n;
  out->backward /= (double)n;
  /* If the water is at rest or is not driven along a closed path, the mean is rounding only. */
  if (!(fabs(out->mean) > 1e-6 * speed / (double)n))
    TRY_FAIL(
        STATUS_INPUT,
        "%s: the last snapshot's mean velocity along the force is rounding alone: the fluid is "
        "at rest, or moves round no closed way; no velocity to normalise",
        run->path);
  out->transverse =
      sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]) / fabs(out->mean);
  out->transverse_deviation = sqrt(sideways / (double)n) / fabs(out->mean);
  out->tortuosity = speed / (double)n / fabs(out->mean);
  TRY(pdf_estimate(along, n, &out->raw));
  for (size_t i = 0; i < n; i++) along[i] /= out->mean;
  TRY(pdf_estimate(along, n, &out->normalised));
  out->low = INFINITY;
  out->high = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    out->low = fmin(out->low, along[i]);
    out->high = fmax(out->high, along[i]);
  }
  moments_of(along, n, &out->moments);
  pdf_fit_power_exponential(along, n, &out->sigma, &out->gamma);
cleanup:
  memory_free(&along);
  particles_free(&particles);
  return status;
}

static json_t *pdf_json(const struct pdf *pdf) {
  return json_pack("{s:o,s:o}", "bin_edges", json_numbers(pdf->edges, pdf->bins + 1), "density",
                   json_numbers(pdf->density, pdf->bins));
}

static void fill_json(const struct velocity_statistics *s, json_t *object) {
  json_object_set_new(object, "path", json_text(s->run->path));
  json_object_set_new(object, "name", json_text(s->run->name));
  json_put_number(object, "time_s", s->time);
  json_object_set_new(object, "particles", json_integer((json_int_t)s->particles));
  json_put_number(object, "hydraulic_gradient", s->run->hydraulic_gradient);
  json_put_number(object, "pore_mean_m_per_s", s->mean);
  json_put_number(object, "k_of_velocities_m_per_s", lattice_note_k(s->run));
  json_put_number(object, "normalised_velocity_min", s->low);
  json_put_number(object, "normalised_velocity_max", s->high);
  json_object_set_new(object, "pdf", pdf_json(&s->normalised));
  json_object_set_new(object, "pdf_m_per_s", pdf_json(&s->raw));
  json_put_number(object, "standard_deviation", s->moments.standard_deviation);
  json_put_number(object, "skewness", s->moments.skewness);
  json_put_number(object, "excess_kurtosis", s->moments.excess_kurtosis);
  json_put_number(object, "backward_fraction", s->backward);
  json_put_number(object, "transverse_ratio", s->transverse);
  json_put_number(object, "transverse_rms_ratio", s->transverse_deviation);
  json_put_number(object, "tortuosity", s->tortuosity);
  json_object_set_new(
      object, "power_exponential",
      json_pack("{s:o,s:o}", "sigma", json_number(s->sigma), "gamma", json_number(s->gamma)));
}

static void write_csv(const struct velocity_statistics *table, size_t n, FILE *stream) {
  fputs("run,normalised_velocity,density,velocity_m_per_s,density_s_per_m,"
        "k_of_velocities_m_per_s\n",
        stream);
  for (size_t i = 0; i < n; i++) {
    const struct pdf *a = &table[i].normalised, *b = &table[i].raw;
    for (size_t j = 0; j < a->bins || j < b->bins; j++) {
      csv_text(stream, table[i].run->name);
      if (j < a->bins)
        fprintf(stream, ",%.8g,%.8g", 0.5 * (a->edges[j] + a->edges[j + 1]), a->density[j]);
      else
        fputs(",,", stream);
      if (j < b->bins)
        fprintf(stream, ",%.8g,%.8g", 0.5 * (b->edges[j] + b->edges[j + 1]), b->density[j]);
      else
        fputs(",,", stream);
      fprintf(stream, ",%.8g\n", lattice_note_k(table[i].run));
    }
  }
}

static void write_summary(const struct velocity_statistics *table, size_t n, FILE *stream) {
  fputs("Velocity along the driving force, last snapshot, over the pore mean\n", stream);
  fprintf(stream, "  %-26s %12s %8s %8s %8s %8s %9s %10s %7s\n", "run", "mean (m/s)", "min", "max",
          "st.dev.", "skew", "backward", "transverse", "gamma");
  for (size_t i = 0; i < n; i++) {
    const struct velocity_statistics *s = &table[i];
    fprintf(stream, "  %-26.60s %12.5g %8.3f %8.3f %8.3f %8.3f %7.2f %% %8.2f %% %7.2f\n",
            s->run->name, s->mean, s->low, s->high, s->moments.standard_deviation,
            s->moments.skewness, 100.0 * s->backward, 100.0 * s->transverse, s->gamma);
  }
  fputs("transverse: mean velocity across the force over that along it; gamma: exponent of "
        "exp(-(s/sigma)^gamma)\n",
        stream);
  for (size_t i = 0; i < n; i++) {
    char before[80] = "";
    if (n > 1) snprintf(before, sizeof before, "%.60s: ", table[i].run->name);
    lattice_note_write(table[i].run, before, "\n", stream);
  }
}

/* ---- reference curves: computed once, for charts and JSON ---- */

#define REFERENCE_POINTS 300

/* A curve over [0, end]: `density` of the normalised velocity, or the fitted power-exponential. */
struct reference {
  const char *name;
  double (*density)(double);
  double end;
};
static const struct reference references[] = {{"slit", pdf_slit, 1.4999},
                                              {"tube", pdf_tube, 2.0},
                                              {"exponential", pdf_exponential, INFINITY},
                                              {"power-exponential", NULL, INFINITY}};
enum { REFERENCES = sizeof references / sizeof *references };

static double reference_at(const struct reference *reference,
                           const struct velocity_statistics *first, double s) {
  if (reference->density != NULL) return reference->density(s);
  const double area = first->sigma * exp(lgamma(1.0 / first->gamma)) / first->gamma;
  return exp(-pow(s / first->sigma, first->gamma)) / area;
}

static void reference_json(const struct velocity_statistics *table, size_t n, json_t *json) {
  json_t *list = json_array();
  double most = 2.5;
  for (size_t i = 0; i < n; i++) most = fmax(most, table[i].high);
  for (size_t r = 0; r < REFERENCES; r++) {
    json_t *x = json_array(), *y = json_array();
    const double end = fmin(references[r].end, most);
    for (size_t i = 0; i <= REFERENCE_POINTS; i++) {
      const double s = end * (double)i / REFERENCE_POINTS;
      json_array_append_new(x, json_number(s));
      json_array_append_new(y, json_number(reference_at(&references[r], &table[0], s)));
    }
    json_array_append_new(list, json_pack("{s:s,s:o,s:o}", "name", references[r].name,
                                          "normalised_velocity", x, "density", y));
  }
  json_object_set_new(json, "references", list);
}

/* Velocity, and velocity over the mean with the reference curves; densities on logarithmic axes.
 * On the page (`scaled`) the velocities of a run carry the flow of its k. */
static void draw(const struct velocity_statistics *table, size_t n, bool scaled,
                 const struct product *product) {
  static const struct {
    double factor;
    const char *name;
  } units[] = {{1.0, "m/s"}, {1e3, "mm/s"}, {1e6, "µm/s"}, {1e9, "nm/s"}};
  double fastest = 0.0;
  size_t unit = 0;
  char velocity[64], density_label[64];
  for (size_t i = 0; i < n; i++) fastest = fmax(fastest, table[i].mean * table[i].high);
  while (unit < 3 && units[unit].factor * fastest < 0.1) unit++;
  snprintf(velocity, sizeof velocity, "Velocity along the force (%s)", units[unit].name);
  snprintf(density_label, sizeof density_label, "Probability density (1/(%s))", units[unit].name);
  json_t *raw = chart_add(product->charts, "Velocity along the force", velocity, density_label,
                          CHART_LOG_Y, CHART_OPEN);
  json_t *normalised = chart_add(product->charts, "Velocity over the mean in the pores",
                                 "Velocity / mean in the pores (-)", "Probability density (-)",
                                 CHART_LOG_Y, CHART_OPEN);
  const json_t *reference, *x;
  double least = 1.0;
  size_t r, j;
  for (size_t i = 0; i < n; i++) {
    const struct pdf *a = &table[i].raw, *b = &table[i].normalised;
    const double scale = scaled && n == 1 ? lattice_note_scale(table[i].run) : 1.0;
    const char *name = table[i].run->name;
    chart_steps(chart_series(raw, name, CHART_LINE, (int)i, 0), a->bins, a->edges, a->density,
                units[unit].factor * scale, 0.0);
    chart_steps(chart_series(normalised, name, CHART_LINE, (int)i, 0), b->bins, b->edges,
                b->density, 1.0, 0.0);
    for (j = 0; j < b->bins; j++)
      if (b->density[j] > 0) least = fmin(least, b->density[j]);
  }
  json_array_foreach(json_object_get(product->json, "references"), r, reference) {
    const json_t *density = json_object_get(reference, "density");
    char name[64];
    if (scaled && strstr(references[r].name, "exponential") == NULL) continue;
    snprintf(name, sizeof name, references[r].density == NULL ? "%s, γ = %.2f" : "%s",
             references[r].name, table[0].gamma);
    json_t *curve = chart_series(normalised, name, CHART_LINE, CHART_GREY, (int)r + 1);
    json_array_foreach(json_object_get(reference, "normalised_velocity"), j, x) {
      const double y = json_number_value(json_array_get(density, j));
      if (y > 0.5 * least && y < 10.0) chart_point(curve, json_number_value(x), y);
    }
  }
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const struct run *runs = subject->runs;
  const size_t n = subject->n;
  struct velocity_statistics *table = NULL;
  TRY(memory_allocate(&table, n, sizeof *table, "runs"));
  for (size_t i = 0; i < n; i++) {
    TRY(measure(&runs[i], &table[i]));
    json_t *object = json_object();
    fill_json(&table[i], object);
    product_add_run(product, object, n);
  }
  write_csv(table, n, product->csv.stream);
  write_summary(table, n, product->summary.stream);
  reference_json(table, n, product->json);
  draw(table, n, options == NULL, product);
cleanup:
  for (size_t i = 0; table != NULL && i < n; i++) {
    pdf_free(&table[i].raw);
    pdf_free(&table[i].normalised);
  }
  memory_free(&table);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = subject->flowing > 0 && subject->snapshots;
  return STATUS_OK;
}

/* A uniform velocity, as in a soil without pores of its own, has no distribution. */
static bool shown(const struct subject *subject, const json_t *json) {
  const json_t *run;
  size_t i;
  (void)subject;
  json_array_foreach(json_object_get(json, "runs"), i, run) {
    if (json_number_or_nan(run, "standard_deviation") > 1e-6) return true;
  }
  return false;
}

const struct analysis pdf_analysis = {
    .name = "pdf",
    .command = {"pdf", "RUN... [-o DIR]",
                "probability density of the pore velocity, raw and normalised",
                "analyze pdf dense-1G.hdf dense-10G.hdf -o results", 1, -1},
    .heading = "Pore velocity",
    .page_runs = OF_FLOWING,
    .caption = "Probability density of the velocity along the driving force, and of this over the "
               "mean in the pores with an exponential and a fitted power-exponential.",
    .applies = applies,
    .analyze = analyze,
    .shown = shown};
