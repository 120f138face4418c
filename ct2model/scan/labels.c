#include "ct2model/scan/labels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/enclosed.h"
#include "ct2model/scan/label_volume.h"
#include "ct2model/scan/label_walls.h"

enum status labels_parse(const char *text, struct label_rules *rules) {
  *rules = (struct label_rules){.given = true};
  const char *at = text;
  while (at != NULL && *at != '\0') {
    char *end;
    if (rules->count == LABELS_MOST)
      return FAIL(STATUS_USAGE, "--segmented: more than %d labels", LABELS_MOST);
    const size_t i = rules->count++;
    rules->value[i] = (double)strtof(at, &end); /* single precision, as pixels are read */
    if (end == at) goto wrong;
    for (size_t other = 0; other < i; other++)
      if (rules->value[other] == rules->value[i])
        return FAIL(STATUS_USAGE, "--segmented %s: the label %.9g stands there twice", text,
                    rules->value[i]);
    if (*end == '\0' && i == 0) {
      rules->pore[0] = rules->rest_is_grain = true;
      return STATUS_OK;
    }
    if (strncmp(end, "=soil(", 6) == 0) {
      const size_t inside = strcspn(end + 6, ")");
      char soil[64];
      if (end[6 + inside] != ')' || inside >= sizeof soil) goto wrong;
      snprintf(soil, sizeof soil, "%.*s", (int)inside, end + 6);
      const enum status status = soil_parse("segmented", soil, &rules->soil[i]);
      if (status != STATUS_OK) return status;
      rules->is_soil[i] = true;
      at = end + 6 + inside + 1;
      if (*at != '\0' && *at != ',') goto wrong;
      at += *at == ',';
      continue;
    }
    const size_t length = strcspn(end, ",");
    if (length == 5 && strncmp(end, "=pore", 5) == 0)
      rules->pore[i] = true;
    else if (length != 6 || strncmp(end, "=grain", 6) != 0)
      goto wrong;
    at = end + length + (end[length] == ',');
  }
  return STATUS_OK;
wrong:
  return FAIL(STATUS_USAGE,
              "--segmented %s: the label that is pore is wanted, as 0, or what each is, as "
              "0=pore,1=grain,2=soil(0.35, 1.8e-15 m^2)",
              text);
}

void labels_end(struct labels *labels) {
  micro_end(&labels->micro);
  memory_free(&labels->smooth);
}

double labels_effect_on_k(const struct labels *labels) {
  const double n = labels->model_porosity, sharp = labels->sharp_porosity;
  return pow(n / sharp, 3) * pow((1.0 - sharp) / (1.0 - n), 2) - 1.0;
}

double labels_void_ratio_error(const struct labels *labels) {
  return 2.0 * labels->volume_error / pow(1.0 - labels->voids, 2.0);
}

static size_t find_label(const struct labels *labels, double value) {
  size_t i = 0;
  while (i < labels->count && labels->value[i] != value) i++;
  return i;
}

static void swap_labels(struct labels *labels, size_t i, size_t j) {
  const double value = labels->value[i];
  const bool pore = labels->pore[i], is_soil = labels->is_soil[i];
  const struct soil soil = labels->soil[i];
  labels->value[i] = labels->value[j], labels->value[j] = value;
  labels->pore[i] = labels->pore[j], labels->pore[j] = pore;
  labels->is_soil[i] = labels->is_soil[j], labels->is_soil[j] = is_soil;
  labels->soil[i] = labels->soil[j], labels->soil[j] = soil;
}

static void sort_labels(struct labels *labels) {
  for (size_t i = 1; i < labels->count; i++)
    for (size_t j = i; j > 0 && labels->value[j] < labels->value[j - 1]; j--)
      swap_labels(labels, j, j - 1);
}

/* Collects the values of three slices while they are few, and of further slices until there are
 * two. */
static enum status collect_values(const struct region *region, struct labels *labels, bool *few) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1], nz = region->size[2];
  float *slice = NULL;
  *few = true;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t s = 0; s < nz + 3 && *few && (s < 3 || labels->count < 2); s++) {
    const size_t z = s < 3 ? s * (nz - 1) / 2 : s - 3;
    TRY(region_read(region, &z, 1, slice));
    double last = NAN;
    for (size_t p = 0; p < plane && *few; p++) {
      const double value = (double)slice[p];
      if (value == last) continue;
      last = value;
      if (find_label(labels, value) < labels->count) continue;
      *few = labels->count < LABELS_MOST;
      if (*few) labels->value[labels->count++] = value;
    }
  }
cleanup:
  memory_free(&slice);
  return status;
}

static enum status name_greys(const struct region *region, const char *or_else) {
  return FAIL(STATUS_INPUT,
              "%s: --segmented, but it holds more than %d greys: leave --segmented out and give "
              "--void-ratio%s",
              region->stack->files[0].path, LABELS_MOST, or_else);
}

static enum status name_unknown(const struct region *region, size_t z, double value) {
  char name[160];
  stack_slice_name(region->stack, region->origin[2] + z, name, sizeof name);
  return FAIL(STATUS_INPUT,
              "%s: holds the label %.9g, of which --segmented says nothing; say %.9g=pore or "
              "%.9g=grain",
              name, value, value, value);
}

/* Sets grain[] to 1 in grain and 0 elsewhere. *fits becomes false if a voxel has neither of two
 * labels that were found automatically. */
static enum status classify(const struct region *region, const struct label_rules *rules,
                            struct labels *labels, uint8_t *grain, bool *fits) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1];
  size_t pores = 0, seen[LABELS_MOST] = {0};
  double voids = 0.0;
  float *slice = NULL;
  *fits = true;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t z = 0; z < region->size[2] && *fits; z++) {
    TRY(region_read(region, &z, 1, slice));
    size_t at = 0;
    for (size_t p = 0; p < plane; p++) {
      const double value = (double)slice[p];
      if (!(at < labels->count && labels->value[at] == value)) at = find_label(labels, value);
      if (at == labels->count) {
        if (rules->count == 0) {
          *fits = false;
          break;
        }
        if (!rules->rest_is_grain) TRY(name_unknown(region, z, value));
        if (at == LABELS_MOST) TRY(name_greys(region, ""));
        labels->value[labels->count++] = value;
      }
      const bool open = labels->pore[at] || labels->is_soil[at];
      seen[at]++;
      grain[z * plane + p] = !open;
      pores += open;
      if (labels->micro.kind != NULL)
        labels->micro.kind[z * plane + p] = labels->is_soil[at] ? (uint8_t)(at + 1)
                                            : labels->pore[at]  ? MICRO_PORE
                                                                : MICRO_GRAIN;
    }
  }
  const double count = (double)plane * (double)region->size[2];
  for (size_t i = 0; i < labels->count; i++) {
    voids += (double)seen[i] * (labels->pore[i]      ? 1.0
                                : labels->is_soil[i] ? labels->soil[i].porosity
                                                     : 0.0);
    if (*fits && labels->is_soil[i] && seen[i] == 0)
      TRY_FAIL(STATUS_INPUT, "%s: --segmented: no voxel has the label %g, which is said to be soil",
               region->stack->files[0].path, labels->value[i]);
    labels->micro.soil[i + 1] = labels->soil[i];
  }
  labels->voids = voids / count;
  labels->porosity = (double)pores / count;
cleanup:
  memory_free(&slice);
  return status;
}

/* Two values are labels; which one is pore follows a convention, and is reported. */
static enum status find_labels(const struct region *region, const struct label_rules *rules,
                               bool dark, struct labels *labels) {
  bool few;
  enum status status = collect_values(region, labels, &few);
  if (status != STATUS_OK) return status;
  sort_labels(labels);
  labels->on = few && labels->count == 2;
  if (labels->on) labels->pore[dark ? 1 : 0] = true;
  if (labels->on || !rules->given) return STATUS_OK;
  if (!few) return name_greys(region, ", or name the labels, as --segmented 0=pore,1=grain");
  char list[200] = "";
  for (size_t i = 0; i < labels->count; i++)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%g", i > 0 ? ", " : "",
             labels->value[i]);
  return FAIL(STATUS_INPUT,
              "%s: holds the label%s %s; say which is pore, as --segmented %g, or what each is, as "
              "--segmented %g=pore,...",
              region->stack->files[0].path, labels->count == 1 ? "" : "s", list, labels->value[0],
              labels->value[0]);
}

/* Fraction of zeros in the mirrored model, where the last layers occur once. */
static double share_of_model(const uint8_t *grain, const size_t size[3], const bool reflect[3]) {
  double weighed = 0.0, all = 0.0;
  for (size_t row = 0; row < size[1] * size[2]; row++)
    for (size_t x = 0; x < size[0]; x++) {
      const size_t place[3] = {x, row % size[1], row / size[1]}; // NOLINT: a region has rows
      double weight = 1.0;
      for (int a = 0; a < 3; a++)
        if (reflect[a] && place[a] + 1 == size[a]) weight *= 0.5;
      weighed += grain[row * size[0] + x] ? 0.0 : weight;
      all += weight;
    }
  return weighed / all;
}

enum status labels_smooth(struct region *region, const uint8_t *grain, const bool reflect[3],
                          struct labels *labels) {
  enum status status = STATUS_OK;
  const size_t count = region->size[0] * region->size[1] * region->size[2];
  struct grey_histogram volume = {0};
  labels->model_porosity = share_of_model(grain, region->size, reflect);
  if (labels->porosity <= 0.0 || labels->porosity >= 1.0)
    TRY_FAIL(STATUS_INPUT, "%s: by --%s all of the region is %s", region->stack->files[0].path,
             labels->count > 0 ? "segmented" : "micro",
             labels->porosity <= 0.0 ? "grain"
             : labels->micro.kind != NULL
                 ? "pore or soil: a model's surface is that between grain and "
                   "the rest, and there is none without grain; name a few voxels amid the "
                   "soil grain (2x2x2 are enough)"
                 : "pore");
  TRY(memory_allocate(&labels->smooth, count, 1, "the smoothed labels"));
  TRY(label_walls(grain, region->size, reflect, labels->smooth));
  struct region walls = *region;
  const struct enclosed_sides sides = {.reflect = {reflect[0], reflect[1], reflect[2]}};
  walls.held_type = PIXEL_U8;
  walls.scale = 1.0;
  walls.held = grain;
  TRY(enclosed_measure(&walls, &sides, 0.0, 1.0, &volume));
  labels->sharp_porosity = grey_histogram_porosity(&volume, 0.5);
  grey_histogram_end(&volume);
  walls.held = labels->smooth;
  TRY(enclosed_measure(&walls, &sides, 0.0, LABEL_GREY, &volume));
  labels->threshold = grey_histogram_quantile(&volume, labels->model_porosity);
  *region = walls;
cleanup:
  grey_histogram_end(&volume);
  return status;
}

enum status labels_take(struct region *region, const struct label_rules *rules, bool dark,
                        const bool reflect[3], struct labels *labels) {
  enum status status = STATUS_OK;
  const size_t count = region->size[0] * region->size[1] * region->size[2];
  uint8_t *grain = NULL;
  bool fits;
  region->scale = 1.0;
  *labels = (struct labels){.on = true, .count = rules->count};
  memcpy(labels->value, rules->value, sizeof labels->value);
  memcpy(labels->pore, rules->pore, sizeof labels->pore);
  memcpy(labels->is_soil, rules->is_soil, sizeof labels->is_soil);
  memcpy(labels->soil, rules->soil, sizeof labels->soil);
  memcpy(labels->micro.size, region->size, sizeof region->size);
  if (rules->count == 0) TRY(find_labels(region, rules, dark, labels));
  if (!labels->on) goto cleanup;
  TRY(memory_allocate(&grain, count, 1, "the labels"));
  for (size_t i = 0; i < rules->count; i++)
    if (rules->is_soil[i] && labels->micro.kind == NULL)
      TRY(memory_allocate(&labels->micro.kind, count, 1, "the labels"));
  TRY(classify(region, rules, labels, grain, &fits));
  labels->on = fits;
  if (!fits) goto cleanup;
  sort_labels(labels);
  TRY(labels_smooth(region, grain, reflect, labels));
  TRY(label_volume_error(grain, region->size, reflect, &labels->volume_error));
cleanup:
  if (!labels->on || status != STATUS_OK) region->scale = dark ? -1.0 : 1.0;
  memory_free(&grain);
  if (status != STATUS_OK) labels_end(labels);
  return status;
}
