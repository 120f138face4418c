#include "ct2model/scan/micro.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"

double soil_kozeny_carman(double porosity, double grain_size) {
  const double solid = 1.0 - porosity;
  return grain_size * grain_size * porosity * porosity * porosity / (180.0 * solid * solid);
}

enum status soil_parse_permeability(const char *option, const char *text, double *permeability,
                                    double *grain_size) {
  static const struct dimension AREA = {2, 0, 0};
  *permeability = *grain_size = 0.0;
  if (quantity_parse(text, AREA, permeability) != STATUS_OK) {
    error_clear();
    if (quantity_parse(text, DIM_LENGTH, grain_size) != STATUS_OK) {
      error_clear();
      return FAIL(STATUS_USAGE,
                  "--%s: '%s' is neither a permeability, as 1.8e-15 m^2, nor a grain size, as 2um",
                  option, text);
    }
  }
  if (*permeability > 0.0 || *grain_size > 0.0) return STATUS_OK;
  return FAIL(STATUS_USAGE, "--%s: '%s': soil that lets nothing through is grain; say so", option,
              text);
}

enum status soil_parse(const char *option, const char *text, struct soil *soil) {
  char *end;
  double size;
  soil->porosity = strtod(text, &end);
  if (end == text || *end != ',')
    return FAIL(STATUS_USAGE,
                "--%s: soil(%s): porosity and permeability are wanted, as soil(0.35, 1.8e-15 m^2), "
                "or porosity and grain size, as soil(0.35, 2um)",
                option, text);
  if (!(soil->porosity > 0.0 && soil->porosity < 1.0))
    return FAIL(STATUS_USAGE,
                "--%s: soil(%s): a porosity lies between 0 and 1; 0 is grain and 1 is pore, say so",
                option, text);
  const enum status status = soil_parse_permeability(option, end + 1, &soil->permeability, &size);
  if (status == STATUS_OK && size > 0.0)
    soil->permeability = soil_kozeny_carman(soil->porosity, size);
  return status;
}

void micro_end(struct micro *micro) {
  memory_free(&micro->kind);
}

enum status micro_check(const struct micro *micro, const double spacing[3]) {
  const double voxel = cbrt(spacing[0] * spacing[1] * spacing[2]);
  for (int kind = 1; kind < MICRO_GRAIN; kind++) {
    const double k = micro->soil[kind].permeability;
    if (k > voxel * voxel)
      return FAIL(STATUS_INPUT,
                  "soil of a permeability of %.3g m^2, more than the square of a voxel, %.3g m^2: "
                  "such pores are wider than voxels; take it as pore, or check the unit",
                  k, voxel * voxel);
  }
  return STATUS_OK;
}

/* Contents of a box of voxels: number of pore and of soil voxels, and sums over the latter. */
struct content {
  double pores, soils, porosity, log_permeability;
};

static void add_box(const struct micro *micro, const size_t first[3], const size_t end[3],
                    struct content *content) {
  for (size_t z = first[2]; z < end[2]; z++)
    for (size_t y = first[1]; y < end[1]; y++)
      for (size_t x = first[0]; x < end[0]; x++) {
        const uint8_t kind = micro->kind[(z * micro->size[1] + y) * micro->size[0] + x];
        if (kind == MICRO_GRAIN) continue;
        if (kind == MICRO_PORE) {
          content->pores += 1.0;
          continue;
        }
        content->soils += 1.0;
        content->porosity += micro->soil[kind].porosity;
        content->log_permeability += log(micro->soil[kind].permeability);
      }
}

void micro_resample(const struct micro *micro, int turn, const size_t n[3], const uint8_t *solid,
                    float *porosity, float *permeability) {
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < n[1] * n[2]; row++)
    for (size_t i = 0; i < n[0]; i++) {
      const size_t at[3] = {i, row % n[1], row / n[1]}, voxel = row * n[0] + i; // NOLINT: has rows
      struct content content = {0};
      porosity[voxel] = permeability[voxel] = 0.0f;
      if (solid[voxel]) continue;
      /* Walls are smoothed: a model voxel on the pore side may cover grain only, so that adjacent
       * voxels are used. */
      for (size_t wider = 0; wider < 3 && content.pores + content.soils == 0.0; wider++) {
        size_t first[3], end[3];
        for (int d = 0; d < 3; d++) {
          const int axis = (d + turn) % 3;
          const double step = (double)micro->size[axis] / (double)n[d];
          const size_t low = (size_t)(step * (double)at[d] + 0.5 * fmin(step, 1.0));
          const size_t high = (size_t)fmax(step * ((double)at[d] + 1.0) + 0.5, (double)low + 1.0);
          first[axis] = low > wider ? low - wider : 0;
          end[axis] = high + wider < micro->size[axis] ? high + wider : micro->size[axis];
        }
        add_box(micro, first, end, &content);
      }
      if (content.soils <= content.pores || content.soils == 0.0) continue;
      porosity[voxel] =
          (float)((content.porosity + content.pores) / (content.soils + content.pores));
      permeability[voxel] = (float)exp(content.log_permeability / content.soils);
    }
}

static enum status parse_table(const char *text, struct porosity_table *t) {
  const char *at = text;
  for (t->count = 0; t->count < POROSITIES_MOST; at++) {
    const int i = t->count++;
    char *end;
    t->grey[i] = strtod(at, &end);
    if (end == at || *end != ':' || !isfinite(t->grey[i])) break;
    t->porosity[i] = strtod(at = end + 1, &end);
    if (end == at || (*end != ',' && *end != '\0')) break;
    if (!(t->porosity[i] > 0.0 && t->porosity[i] < 1.0))
      return FAIL(STATUS_USAGE,
                  "--micro %s: grey %g: a porosity lies between 0 and 1; 0 is grain and 1 is pore, "
                  "and the first and the last grey say where these begin",
                  text, t->grey[i]);
    if (i > 0 && !(t->grey[i] > t->grey[i - 1]))
      return FAIL(STATUS_USAGE, "--micro %s: greys are wanted in rising order, and %g follows %g",
                  text, t->grey[i], t->grey[i - 1]);
    at = end;
    if (*end == ',') continue;
    if (t->count > 1) return STATUS_OK;
    break;
  }
  if (t->count == POROSITIES_MOST)
    return FAIL(STATUS_USAGE, "--micro %s: %d greys are possible", text, POROSITIES_MOST);
  return FAIL(STATUS_USAGE,
              "--micro %s: porosities of two greys or more are wanted, as 80:0.6,120:0.4,170:0.1",
              text);
}

enum status micro_rules_parse(const char *text, struct micro_rules *rules) {
  const char *dots = strstr(text, "..");
  char low[40], *end;
  rules->given = true;
  rules->automatic = strcmp(text, "auto") == 0;
  if (rules->automatic) return STATUS_OK;
  if (strchr(text, ':') != NULL) {
    const enum status status = parse_table(text, &rules->table);
    rules->low = rules->table.grey[0];
    rules->high = rules->table.grey[rules->table.count - 1];
    return status;
  }
  if (dots != NULL && (size_t)(dots - text) < sizeof low) {
    snprintf(low, sizeof low, "%.*s", (int)(dots - text), text);
    rules->low = strtod(low, &end);
    const bool first = end != low && *end == '\0' && isfinite(rules->low);
    rules->high = strtod(dots + 2, &end);
    if (first && end != dots + 2 && *end == '\0' && isfinite(rules->high) &&
        rules->low < rules->high)
      return STATUS_OK;
  }
  return FAIL(
      STATUS_USAGE,
      "--micro %s: auto is wanted, or the greys of soil, the lower first, as 80..170: below is "
      "pore, above is grain (turned round with --grain dark), or a table of their porosities, as "
      "80:0.6,170:0.1",
      text);
}
