#include "analyze/report/page_budget.h"

#include <math.h>
#include <string.h>

#include "analyze/report/page_html.h"
#include "common/hdf5_file.h"
#include "common/memory.h"

struct budget {
  size_t count;
  char **terms;
  double (*impulse)[3], *work;
  uint8_t *numerical;
};

static void budget_free(struct budget *budget) {
  h5_free_texts(budget->count, &budget->terms);
  memory_free(&budget->impulse);
  memory_free(&budget->work);
  memory_free(&budget->numerical);
}

static enum status budget_read_rows(struct h5_file *file, struct budget *budget) {
  enum status status = STATUS_OK;
  size_t works = 0, flags = 0, shape[2] = {0, 0};
  TRY(h5_read_texts(file, "/run/ledger/words", &budget->count, &budget->terms));
  TRY(h5_read(file, "/run/ledger/impulse", H5_F64, 2, shape, &budget->impulse));
  TRY(h5_read(file, "/run/ledger/work", H5_F64, 1, &works, &budget->work));
  TRY(h5_read(file, "/run/ledger/numerical", H5_U8, 1, &flags, &budget->numerical));
  if (works != budget->count || flags != works || shape[0] != works || shape[1] != 3)
    TRY_FAIL(STATUS_INPUT, "%s: /run/ledger has lists of different lengths: the file is damaged",
             h5_path(file));
cleanup:
  return status;
}

static double attribute(struct h5_file *file, const char *name) {
  return h5_attribute_or_nan(file, "/run/ledger", name);
}

static void row(FILE *stream, const char *style, const char *words, const double p[3],
                double energy) {
  fprintf(stream, "<tr class=\"%s\"><td>", style);
  html_text(stream, words);
  fputs("</td>", stream);
  for (int a = 0; a < 3; a++) fprintf(stream, "<td class=\"number\">%.4g</td>", p[a] + 0.0);
  fprintf(stream, "<td class=\"number\">%.4g</td></tr>\n", energy + 0.0);
}

#define LOSSES_SHOWN 10

/* Particles lost through walls: which, when and where. */
static enum status losses(struct h5_file *file, FILE *stream) {
  enum status status = STATUS_OK;
  double(*loss)[6] = NULL;
  size_t shape[2] = {0, 0};
  if (!h5_exists(file, "/run/ledger/losses")) return STATUS_OK;
  TRY(h5_read(file, "/run/ledger/losses", H5_F64, 2, shape, &loss));
  if (shape[1] != 6)
    TRY_FAIL(STATUS_INPUT, "%s: /run/ledger/losses has %zu columns, not 6: the file is damaged",
             h5_path(file), shape[1]);
  fprintf(stream, "<p>Lost through walls%s:", shape[0] > LOSSES_SHOWN ? ", the first" : "");
  for (size_t i = 0; i < shape[0] && i < LOSSES_SHOWN; i++)
    fprintf(stream, "%s particle %.0f at %.4g s, (%.4g, %.4g, %.4g) m, %.4g kg", i > 0 ? ";" : "",
            loss[i][0], loss[i][1], loss[i][2], loss[i][3], loss[i][4], loss[i][5]);
  fputs(".</p>\n", stream);
cleanup:
  memory_free(&loss);
  return status;
}

/* Balance of a flow that does not change in time. */
static void steady_run(const struct run *run, struct h5_file *file, FILE *stream) {
  fputs("<h3>", stream);
  html_text(stream, run->name);
  fprintf(stream,
          "</h3><p>Mass: the flux is the same through all planes across the flow to %.2g&nbsp;%% "
          "(rms). Momentum: walls and pressure balance what drives the flow to %.2g of it. Energy: "
          "friction takes what drives the flow gives, to %.2g of it.</p>\n",
          100 * attribute(file, "flux_open"), attribute(file, "force_open"),
          attribute(file, "power_open"));
}

static bool is_steady(struct h5_file *file) {
  return h5_exists(file, "/run/ledger") && isfinite(attribute(file, "flux_open"));
}

static enum status one_run(const struct run *run, struct h5_file *file, FILE *stream) {
  enum status status = STATUS_OK;
  struct budget budget = {0};
  double start[3], end[3], open[3];
  TRY(budget_read_rows(file, &budget));
  TRY(h5_read_attribute(file, "/run/ledger", "account_momentum_start", H5_F64, 3, start));
  TRY(h5_read_attribute(file, "/run/ledger", "account_momentum_end", H5_F64, 3, end));
  TRY(h5_read_attribute(file, "/run/ledger", "momentum_open", H5_F64, 3, open));
  fputs("<h3>", stream);
  html_text(stream, run->name);
  fprintf(stream,
          "</h3><p>Particles: %.0f at the start, %.0f came in, %.0f went out, %.0f lost, %.0f at "
          "the end, %.0f unaccounted for. Mass: %.6g kg at the end, open by %.2g kg.</p>\n",
          attribute(file, "particles_start"), attribute(file, "particles_entered"),
          attribute(file, "particles_left"), attribute(file, "particles_lost"),
          attribute(file, "particles_end"), attribute(file, "particles_open"),
          attribute(file, "mass_end"), attribute(file, "mass_open"));
  fputs("<div class=\"wide\"><table><thead><tr><th>Given to the water</th>"
        "<th class=\"number\">momentum x, kg&nbsp;m/s</th><th class=\"number\">y</th>"
        "<th class=\"number\">z</th><th class=\"number\">energy, J</th></tr></thead><tbody>\n",
        stream);
  row(stream, "on", "there at the start", start, attribute(file, "energy_start"));
  for (int numerical = 0; numerical < 2; numerical++)
    for (size_t t = 0; t < budget.count; t++) {
      char words[160];
      if (budget.numerical[t] != numerical) continue;
      snprintf(words, sizeof words, "%s%s", budget.terms[t], numerical ? " (numerical)" : "");
      row(stream, numerical ? "off" : "on", words, budget.impulse[t], budget.work[t]);
    }
  row(stream, "on", "not accounted for", open, attribute(file, "energy_open"));
  row(stream, "on", "there at the end", end, attribute(file, "energy_end"));
  fprintf(stream,
          "</tbody></table></div><p>Not accounted for: %.2g&nbsp;%% of the largest term of the "
          "momentum, %.2g&nbsp;%% of that of the energy",
          100 * attribute(file, "momentum_open_share"), 100 * attribute(file, "energy_open_share"));
  if (attribute(file, "energy_sampling_error") > 0)
    fprintf(stream, "; sums of samples may miss %.2g kg&nbsp;m/s and %.2g J",
            attribute(file, "momentum_sampling_error"), attribute(file, "energy_sampling_error"));
  fputs(".</p>\n", stream);
  TRY(losses(file, stream));
cleanup:
  budget_free(&budget);
  return status;
}

enum status page_has_budget(const struct run *runs, size_t n, bool *any) {
  enum status status = STATUS_OK;
  *any = false;
  for (size_t i = 0; i < n && !*any; i++) {
    struct h5_file *file = NULL;
    TRY(h5_open(runs[i].path, &file));
    *any = h5_exists(file, "/run/ledger/words") || is_steady(file);
    h5_close(file);
  }
cleanup:
  return status;
}

enum status page_budget(const struct run *runs, size_t n, FILE *stream) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  fputs("<p>What each effect gave the water over the run, summed from the forces it applied. The "
        "driving force's work is what the water lost of its potential energy. Terms marked "
        "numerical are the method's, not the equations'.</p>\n",
        stream);
  for (size_t i = 0; i < n; i++) {
    TRY(h5_open(runs[i].path, &file));
    if (h5_exists(file, "/run/ledger/words"))
      TRY(one_run(&runs[i], file, stream));
    else if (is_steady(file))
      steady_run(&runs[i], file, stream);
    h5_close(file);
    file = NULL;
  }
cleanup:
  h5_close(file);
  return status;
}
