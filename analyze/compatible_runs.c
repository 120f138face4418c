#include "analyze/compatible_runs.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

bool compatible_runs_same_body(const struct run *a, const struct run *b, int *axis) {
  for (int d = 0; d < 3; d++) {
    if (d == 1 && a->dimensions == 2) continue;
    double la = (double)a->size[d] * a->spacing[d], lb = (double)b->size[d] * b->spacing[d];
    *axis = d;
    if (fabs(la - lb) > 0.05 * la + 1.01 * (a->spacing[d] + b->spacing[d])) return false;
  }
  return true;
}

bool compatible_runs_same_model(const struct run *a, const struct run *b, bool levels) {
  int axis;
  if (a->identity == b->identity) return true;
  return levels && fabs(a->spacing[0] / b->spacing[0] - 1) > 1e-4 &&
         compatible_runs_same_body(a, b, &axis);
}

/* Numbers the models: runs have the same number if each fits all others of it. Returns the number
 * of models. */
static size_t number_models(const struct run *runs, size_t n, bool levels, size_t *model) {
  size_t models = 0;
  for (size_t i = 0; i < n; i++) {
    for (model[i] = 0; model[i] < models; model[i]++) {
      bool fits = true;
      for (size_t j = 0; j < i; j++)
        fits = fits &&
               (model[j] != model[i] || compatible_runs_same_model(&runs[j], &runs[i], levels));
      if (fits) break;
    }
    if (model[i] == models) models++;
  }
  return models;
}

enum status compatible_runs_check(const struct run *runs, size_t n, bool levels, bool allowed) {
  enum status status = STATUS_OK;
  size_t *model = NULL;
  char list[800] = "";
  TRY(memory_allocate(&model, n, sizeof *model, "runs"));
  size_t models = number_models(runs, n, levels, model), used = 0;
  if (models < 2) goto cleanup;
  for (size_t m = 0; m < models; m++) {
    size_t first = n, more = 0;
    for (size_t i = 0; i < n; i++)
      if (model[i] == m && first == n)
        first = i;
      else
        more += model[i] == m;
    const char *path = runs[first].model_path, *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    char others[40] = "";
    if (more > 0) snprintf(others, sizeof others, " and %zu more", more);
    int wrote = snprintf(list + used, sizeof list - used, "%s%s (%s%s)", m > 0 ? ", " : "",
                         *name ? name : "a domain", runs[first].path, others);
    if (used + (size_t)wrote >= sizeof list) break;
    used += (size_t)wrote;
  }
  if (allowed)
    log_info("runs of %zu models together: %s", models, list);
  else
    status = FAIL(STATUS_INPUT,
                  "the runs are of %zu different models: %s; give runs of one model, or --mix to "
                  "show them together",
                  models, list);
cleanup:
  memory_free(&model);
  return status;
}

static bool differs(const struct run *run) {
  return run->levels.count > 1 && run->k_finest > 0.0 && run->k > 0.0 &&
         fabs(run->k_finest / run->k - 1.0) > 1e-3;
}

double lattice_note_k(const struct run *run) {
  return run->k_finest > 0.0 ? run->k_finest : run->k;
}

double lattice_note_scale(const struct run *run) {
  return differs(run) ? run->k / run->k_finest : 1.0;
}

void lattice_note_write(const struct run *run, const char *before, const char *after,
                        FILE *stream) {
  if (!differs(run)) return;
  fprintf(stream,
          "%sVelocities are of the finest lattice (%.3g um), k = %.4g cm/s; k from all lattices is "
          "%.4g cm/s%s",
          before, 1e6 * run->levels.spacing[run->levels.count - 1], 100.0 * run->k_finest,
          100.0 * run->k, after);
}
