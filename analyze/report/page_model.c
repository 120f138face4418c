#include "analyze/report/page_model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/json_number.h"
#include "common/memory.h"

/* Finds the value of a long option on a command line; false if the option is absent. As with
 * getopt_long names may be abbreviated, to at least `least` characters. */
static bool option_value(const char *line, const char *name, size_t least, char *value,
                         size_t size) {
  for (const char *word = line; word != NULL && *word != '\0';) {
    word += strspn(word, " ");
    size_t length = strcspn(word, " "), given = strcspn(word, " =");
    if (given >= least + 2 && given <= strlen(name) + 2 && strncmp(word, "--", 2) == 0 &&
        strncmp(word + 2, name, given - 2) == 0) {
      const char *from = word + given + 1;
      if (given == length) from = word + length + strspn(word + length, " ");
      snprintf(value, size, "%.*s", (int)strcspn(from, " "), from);
      return true;
    }
    word += length;
  }
  return false;
}

static enum threshold_rule rule_of(const struct page_model *model, const char *line) {
  char value[64];
  if (option_value(line, "threshold", 4, value, sizeof value) && strcmp(value, "auto") != 0)
    return strcmp(value, "otsu") == 0 ? RULE_OTSU : RULE_GIVEN;
  return isfinite(model->void_ratio_measured) ? RULE_MATCHED : RULE_NONE;
}

static void read_text(struct h5_file *file, const char *object, const char *name, char *text,
                      size_t size) {
  char *found = NULL;
  if (h5_exists(file, object) && h5_attribute_exists(file, object, name)) {
    if (h5_read_attribute_text(file, object, name, &found) == STATUS_OK)
      snprintf(text, size, "%s", found);
    else
      error_clear();
  }
  memory_free(&found);
}

void page_model_read(const struct run *run, struct page_model *model) {
  struct h5_file *file = NULL;
  char program[64] = "", line[8200] = "";
  *model = (struct page_model){.named = run->model_path[0] != '\0',
                               .threshold = NAN,
                               .void_ratio = NAN,
                               .void_ratio_measured = NAN,
                               .void_ratio_walls = NAN,
                               .voxel_scanned = NAN,
                               .porosity = NAN,
                               .specific_surface = NAN};
  model->other = run->model_other;
  snprintf(model->path, sizeof model->path, "%s", run->model_file);
  if (model->path[0] == '\0') return;
  if (h5_open(model->path, &file) != STATUS_OK) {
    error_clear();
    return;
  }
  model->found = true;
  model->threshold = h5_attribute_or_nan(file, "/model", "threshold");
  model->void_ratio = h5_attribute_or_nan(file, "/model", "void_ratio");
  model->void_ratio_measured = h5_attribute_or_nan(file, "/model", "void_ratio_measured");
  model->void_ratio_walls =
      model->void_ratio_measured + h5_attribute_or_nan(file, "/model", "void_ratio_error");
  model->voxel_scanned = h5_attribute_or_nan(file, "/model", "voxel_scanned");
  model->porosity = h5_attribute_or_nan(file, "/model", "porosity");
  if (isnan(model->porosity)) model->porosity = model->void_ratio / (1.0 + model->void_ratio);
  model->specific_surface = h5_attribute_or_nan(file, "/model", "specific_surface");
  model->smoothing = h5_attribute_or_nan(file, "/calibration", "smoothing");
  model->smoothing_even = h5_attribute_or_nan(file, "/calibration", "smoothing_even");
  model->blur = h5_attribute_or_nan(file, "/scanner", "blur");
  model->blur_removed = h5_attribute_or_nan(file, "/scanner", "removed") > 0.0;
  model->wall_distance = h5_exists(file, "/model/wall_distance");
  model->grain_fraction = h5_exists(file, "/model/grain_fraction");
  model->soil = h5_exists(file, "/model/micro_porosity");
  read_text(file, "/model", "mirror_axis", model->mirror_axis, sizeof model->mirror_axis);
  read_text(file, "/model", "sides", model->sides, sizeof model->sides);
  read_text(file, "/provenance", "program", program, sizeof program);
  read_text(file, "/provenance", "command_line", line, sizeof line);
  read_text(file, "/provenance", "origin", model->origin, sizeof model->origin);
  model->scanned = strcmp(program, "ct2model") == 0;
  if (model->scanned)
    model->rule = h5_attribute_or_nan(file, "/calibration", "segmented") > 0.0
                      ? RULE_LABELS
                      : rule_of(model, line);
  h5_close(file);
}

json_t *page_model_json(const struct page_model *model) {
  static const char *const RULES[] = {"", "matched", "otsu", "given", "labels"};
  const char *state = model->found   ? "found"
                      : model->other ? "changed"
                      : model->named ? "missing"
                                     : "none";
  return json_pack("{s:s,s:o,s:s,s:o,s:s}", "state", state, "path", json_text(model->path), "rule",
                   RULES[model->rule], "void_ratio_walls", json_number(model->void_ratio_walls),
                   "origin", model->origin);
}
