#include "ct2model/model/export_profile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/memory.h"
#include "common/output_file.h"
#include "ct2model/model/morphology.h"

struct sums {
  double pores, voxels, width, wide; /* width: sum over `wide` pore voxels, in voxels */
};

static void write_layers(const struct voxel_model *model, int axis, const struct sums *layer,
                         FILE *stream) {
  for (size_t i = 0; i < model->size[axis]; i++) {
    fprintf(stream, "%c,%.9g,%.6g,", "xyz"[axis], ((double)i + 0.5) * model -> spacing[axis],
            layer[i].pores / layer[i].voxels);
    if (layer[i].wide > 0)
      fprintf(stream, "%.6g", layer[i].width / layer[i].wide * model->spacing[0]);
    fputc('\n', stream);
  }
}

enum status export_profile(const char *path, const struct voxel_model *model) {
  enum status status = STATUS_OK;
  struct sums *layer[3] = {NULL, NULL, NULL};
  double share[THICKNESS_BINS] = {0}, pores = 0;
  uint8_t *width = NULL;
  char *text = NULL;
  size_t size = 0;
  FILE *stream = open_memstream(&text, &size);
  if (stream == NULL) return FAIL(STATUS_RUN, "out of memory for the table");
  for (int a = 0; a < 3; a++)
    TRY(memory_allocate(&layer[a], model->size[a], sizeof *layer[a], "profiles"));
  if (model->wall_distance != NULL) TRY(morphology_widths(model, model->size[2], &width));
  for (size_t i = 0; i < model_site_count(model); i++) {
    const size_t at[3] = {i % model->size[0], i / model->size[0] % model->size[1],
                          i / model->size[0] / model->size[1]};
    const bool pore = model->solid[i] == 0;
    const double part = model->grain_fraction != NULL ? 1 - (double)model->grain_fraction[i]
                        : pore                        ? 1
                                                      : 0;
    for (int a = 0; a < 3; a++) {
      struct sums *s = &layer[a][at[a]];
      s->voxels++;
      s->pores += part;
      if (width == NULL || !pore) continue;
      s->wide++;
      s->width += width[i] / 4.0;
    }
    if (width == NULL || !pore) continue;
    share[width[i] / 4]++;
    pores++;
  }
  fprintf(stream, "axis,position_m,porosity,pore_width_m\n");
  for (int a = 0; a < 3; a++) write_layers(model, a, layer[a], stream);
  for (int b = 0; b < THICKNESS_BINS && pores > 0; b++)
    if (share[b] > 0)
      fprintf(stream, "width,%.9g,%.6g,\n", (b + 0.5) * model->spacing[0], share[b] / pores);
  const bool bad = fclose(stream) != 0;
  stream = NULL;
  if (bad) TRY_FAIL(STATUS_RUN, "out of memory for the table");
  TRY(output_write(path, text, size));
cleanup:
  if (stream != NULL) fclose(stream);
  for (int a = 0; a < 3; a++) memory_free(&layer[a]);
  memory_free(&width);
  free(text);
  return status;
}
