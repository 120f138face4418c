#include "data-samples/grain_field.h"

#include <math.h>
#include <stdlib.h>

#include "common/log.h"
#include "common/memory.h"

#define PI 3.14159265358979323846
#define FAR_AWAY 1e3F /* voxels */

/* Offsets up to this are accepted and resolved to 1/HISTOGRAM_FINE of a voxel. */
enum { OFFSET_MAX = 2, HISTOGRAM_FINE = 1 << 18 };

/* Wavy faces and rough edges: lattice spacing and standard deviation, m. */
static const double WAVE_LENGTH = 42e-6, WAVE_HEIGHT = 1.7e-6;
static const double ROUGH_LENGTH = 13e-6, ROUGH_HEIGHT = 0.7e-6;
static const double ROUGH_BAND = 8e-6; /* from the smooth surface, where roughness is drawn */

void grain_field_box(const long size[3], double voxel, double largest, double box[3]) {
  for (int i = 0; i < 3; i++) {
    box[i] = voxel * (double)(size[i] + 2 * FIELD_HALO) + 0.5 * largest;
    /* Periodic neighbours must be unique: twice the reach of a pair of grains. */
    if (box[i] < 4.5 * largest) box[i] = 4.5 * largest;
  }
}

struct drawing {
  struct grain_field *field;
  const struct noise_lattice *noise;
  uint64_t key;
  double first;  /* voxels: where in the packing the extent begins */
  long *claimed; /* by layer: voxels inside grains, those inside two counted twice */
};

static float surface_relief(const struct drawing *drawing, const float *origin, const float *x) {
  const double scale = drawing->field->voxel;
  float value = 0;
  for (int octave = 0; octave < 2; octave++) {
    const float per_cell = (float)(scale / (octave ? ROUGH_LENGTH : WAVE_LENGTH));
    const float height = (float)((octave ? ROUGH_HEIGHT : WAVE_HEIGHT) / scale);
    value += height * noise_lattice_value(drawing->noise, origin[0] + x[0] * per_cell,
                                          origin[1] + x[1] * per_cell, origin[2] + x[2] * per_cell);
  }
  return value;
}

/* One image of one grain on layer z (of the extent); `centre` in voxels of the extent. */
static void draw_layer(const struct drawing *drawing, const struct grain *grain, uint32_t label,
                       const double centre[3], long z, float *row) {
  struct grain_field *field = drawing->field;
  const float voxel = (float)field->voxel, width = (float)(grain->edge_radius / field->voxel);
  const float margin = OFFSET_MAX + 2;
  const float reach = (float)(grain->radius / field->voxel) + margin;
  const float band = (float)(ROUGH_BAND / field->voxel);
  float x[3], origin[3];
  for (int i = 0; i < 3; i++)
    origin[i] = (float)(random_bits(drawing->key, 3 * (uint64_t)label + (uint64_t)i) >> 52) / 16;
  x[2] = (float)((double)z - centre[2]);
  const float disc = reach * reach - x[2] * x[2];
  if (disc <= 0) return;
  const long y0 = (long)fmax(0, ceil(centre[1] - reach));
  const long y1 = (long)fmin((double)field->extent[1] - 1, floor(centre[1] + reach));
  for (long y = y0; y <= y1; y++) {
    x[1] = (float)((double)y - centre[1]);
    const float chord = disc - x[1] * x[1];
    if (chord <= 0) continue;
    const double half = sqrtf(chord);
    const long x0 = (long)fmax(0, ceil(centre[0] - half));
    const long x1 = (long)fmin((double)field->extent[0] - 1, floor(centre[0] + half));
    const long n = x1 - x0 + 1;
    if (n <= 0) continue;
    for (int f = 0; f < grain->faces; f++) {
      const float *normal = grain->normal[f];
      const float start = normal[1] * x[1] + normal[2] * x[2] - grain->distance[f] / voxel +
                          normal[0] * (float)((double)x0 - centre[0]);
      if (f == 0)
        for (long i = 0; i < n; i++) row[i] = start + normal[0] * (float)i;
      else
        for (long i = 0; i < n; i++)
          row[i] = grain_round(row[i], start + normal[0] * (float)i, width);
    }
    const size_t base =
        ((size_t)z * (size_t)field->extent[1] + (size_t)y) * (size_t)field->extent[0] + (size_t)x0;
    for (long i = 0; i < n; i++) {
      float distance = row[i];
      if (distance > margin) continue;
      if (fabsf(distance) < band) {
        x[0] = (float)((double)(x0 + i) - centre[0]);
        distance += surface_relief(drawing, origin, x);
      }
      drawing->claimed[z] += distance < 0;
      if (distance < field->distance[base + (size_t)i]) {
        field->distance[base + (size_t)i] = distance;
        field->label[base + (size_t)i] = label;
      }
    }
  }
}

/* All images of the grain that may reach layer z. */
static void draw_grain(const struct drawing *drawing, const struct grain_packing *packing, long g,
                       long z, float *row) {
  const struct grain *grain = &packing->grain[g];
  const struct grain_field *field = drawing->field;
  double centre[3];
  for (int image = 0; image < 27; image++) {
    const int shift[3] = {image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
    const double reach = grain->radius / field->voxel + OFFSET_MAX + 2;
    int outside = 0;
    for (int i = 0; i < 3; i++) {
      centre[i] = (grain->centre[i] + shift[i] * packing->box[i]) / field->voxel - drawing->first;
      outside |= centre[i] < -reach || centre[i] > (double)field->extent[i] + reach;
    }
    if (outside || fabs((double)z - centre[2]) > reach) continue;
    draw_layer(drawing, grain, (uint32_t)g + 1, centre, z, row);
  }
}

/* The offset below which as near `wanted` voxels of the scan lie as the histogram's bins allow;
 * sets `solid` to what it reaches. */
static enum status choose_offset(struct grain_field *field, long wanted) {
  enum status status = STATUS_OK;
  const long bins = 2L * OFFSET_MAX * HISTOGRAM_FINE;
  long *histogram = NULL, below = 0, bin = 0;
  TRY(memory_allocate(&histogram, (size_t)bins + 1, sizeof *histogram, "distance histogram"));
  for (long z = 0; z < field->size[2]; z++)
    for (long y = 0; y < field->size[1]; y++)
      for (long x = 0; x < field->size[0]; x++) {
        const float distance = field->distance[grain_field_index(field, x, y, z)];
        if (distance < -OFFSET_MAX)
          below++;
        else if (distance < OFFSET_MAX)
          histogram[(long)((distance + OFFSET_MAX) * HISTOGRAM_FINE)]++;
      }
  field->solid = below;
  while (bin < bins && labs(field->solid + histogram[bin] - wanted) <= labs(field->solid - wanted))
    field->solid += histogram[bin++];
  field->offset = (double)bin / HISTOGRAM_FINE - OFFSET_MAX;
  if (below > wanted || bin == bins)
    TRY_FAIL(STATUS_NUMERIC,
             "void ratio: this seed's packing cannot be brought to it by moving surfaces less than "
             "%d voxels; try another --seed or a larger --size",
             OFFSET_MAX);
cleanup:
  memory_free(&histogram);
  return status;
}

enum status grain_field_create(struct grain_field *field, const struct grain_packing *packing,
                               const struct field_request *request) {
  enum status status = STATUS_OK;
  struct noise_lattice noise = {0};
  float *rows = NULL;
  long *claimed = NULL, inside = 0;
  size_t total = 1;
  struct progress progress;
  long done = 0;
  const long *size = request->size;
  *field = (struct grain_field){.voxel = request->voxel, .halo = request->halo};
  for (int i = 0; i < 3; i++) {
    field->size[i] = size[i];
    field->extent[i] = size[i] + 2 * field->halo;
    if (!size_multiply(total, (size_t)field->extent[i], &total))
      TRY_FAIL(STATUS_USAGE, "--size: too large");
  }
  TRY(noise_lattice_create(&noise, request->seed, RANDOM_ROUGHNESS));
  TRY(memory_allocate(&field->distance, total, sizeof *field->distance, "distance field"));
  TRY(memory_allocate(&field->label, total, sizeof *field->label, "grain labels"));
  TRY(memory_allocate(&rows, (size_t)field->extent[2] * (size_t)field->extent[0], sizeof *rows,
                      "row buffers"));
  TRY(memory_allocate(&claimed, (size_t)field->extent[2], sizeof *claimed, "layer counts"));
  /* The scan begins FIELD_HALO of its voxels into the packing; its first voxel's centre is that of
   * `refine` finer ones. */
  const int refine = request->refine;
  const double first =
      (double)(FIELD_HALO * refine) - 0.5 * (double)(refine - 1) - (double)request->halo;
  const struct drawing drawing = {field, &noise, random_key(request->seed, RANDOM_ROUGHNESS), first,
                                  claimed};
  const size_t layer = (size_t)field->extent[0] * (size_t)field->extent[1];
  progress_start(&progress, "drawing", "layers", (double)field->extent[2]);
  /* Each layer is one thread's alone and sees the grains in their order. */
#pragma omp parallel for schedule(dynamic, 1)
  for (long z = 0; z < field->extent[2]; z++) {
    for (size_t i = 0; i < layer; i++) field->distance[(size_t)z * layer + i] = FAR_AWAY;
    for (long g = 0; g < packing->count; g++)
      draw_grain(&drawing, packing, g, z, rows + z * field->extent[0]);
#pragma omp critical
    progress_update(&progress, (double)++done, NULL);
  }
  progress_end(&progress);
  for (size_t i = 0; i < total; i++) inside += field->distance[i] < 0;
  for (long z = 0; z < field->extent[2]; z++) field->shared += (double)claimed[z];
  if (inside) field->shared = (field->shared - (double)inside) / (double)inside;
  const double voxels = (double)size[0] * (double)size[1] * (double)size[2];
  TRY(choose_offset(field, lround(voxels / (1 + request->void_ratio))));
cleanup:
  noise_lattice_destroy(&noise);
  memory_free(&rows);
  memory_free(&claimed);
  if (status != STATUS_OK) grain_field_destroy(field);
  return status;
}

void grain_field_destroy(struct grain_field *field) {
  memory_free(&field->distance);
  memory_free(&field->label);
}

struct contact {
  uint32_t low, high;
};

static int contact_compare(const void *a, const void *b) {
  const struct contact *p = a, *q = b;
  if (p->low != q->low) return p->low < q->low ? -1 : 1;
  return (p->high > q->high) - (p->high < q->high);
}

static uint32_t cluster_root(uint32_t *parent, uint32_t grain) {
  while (parent[grain] != grain) grain = parent[grain] = parent[parent[grain]];
  return grain;
}

/* Every face that two grains share, once for each voxel face. */
static enum status find_contacts(const struct grain_field *field, struct contact **contact,
                                 size_t *count) {
  size_t capacity = 0;
  *count = 0;
  for (long z = 0; z < field->size[2]; z++)
    for (long y = 0; y < field->size[1]; y++)
      for (long x = 0; x < field->size[0]; x++) {
        const size_t here = grain_field_index(field, x, y, z);
        if (!(field->distance[here] < field->offset)) continue;
        const long at[3] = {x, y, z};
        for (int i = 0; i < 3; i++) {
          if (at[i] + 1 == field->size[i]) continue;
          const size_t there = grain_field_index(field, x + (i == 0), y + (i == 1), z + (i == 2));
          const uint32_t a = field->label[here], b = field->label[there];
          if (a == b || !(field->distance[there] < field->offset)) continue;
          if (*count == capacity) {
            capacity = capacity ? 2 * capacity : 65536;
            const enum status status =
                memory_resize(contact, capacity, sizeof **contact, "grain contacts");
            if (status != STATUS_OK) return status;
          }
          (*contact)[(*count)++] = (struct contact){a < b ? a : b, a < b ? b : a};
        }
      }
  return STATUS_OK;
}

enum status grain_field_measure(const struct grain_field *field, long grains,
                                struct grain_statistics *statistics) {
  enum status status = STATUS_OK;
  struct contact *contact = NULL;
  uint32_t *parent = NULL, *touched = NULL;
  long *volume = NULL, *cluster = NULL, largest = 0;
  unsigned char *cut = NULL;
  size_t count = 0;
  const size_t labels = (size_t)grains + 1;
  *statistics = (struct grain_statistics){.diameter_min = 1};
  TRY(memory_allocate(&parent, labels, sizeof *parent, "grain clusters"));
  TRY(memory_allocate(&cluster, labels, sizeof *cluster, "grain clusters"));
  TRY(memory_allocate(&touched, labels, sizeof *touched, "grain contacts"));
  TRY(memory_allocate(&volume, labels, sizeof *volume, "grain volumes"));
  TRY(memory_allocate(&cut, labels, sizeof *cut, "grains at the edge"));
  for (long z = 0; z < field->size[2]; z++)
    for (long y = 0; y < field->size[1]; y++)
      for (long x = 0; x < field->size[0]; x++) {
        const size_t here = grain_field_index(field, x, y, z);
        if (!(field->distance[here] < field->offset)) continue;
        volume[field->label[here]]++;
        if (x == 0 || y == 0 || z == 0 || x + 1 == field->size[0] || y + 1 == field->size[1] ||
            z + 1 == field->size[2])
          cut[field->label[here]] = 1;
      }
  TRY(find_contacts(field, &contact, &count));
  if (count) qsort(contact, count, sizeof *contact, contact_compare);
  for (uint32_t g = 0; g < labels; g++) parent[g] = g;
  for (size_t c = 0; c < count; c++) {
    if (c && contact_compare(&contact[c], &contact[c - 1]) == 0) continue;
    touched[contact[c].low]++;
    touched[contact[c].high]++;
    const uint32_t a = cluster_root(parent, contact[c].low);
    const uint32_t b = cluster_root(parent, contact[c].high);
    parent[a > b ? a : b] = a > b ? b : a;
  }
  for (uint32_t g = 1; g < labels; g++) {
    if (!volume[g]) continue;
    const uint32_t root = cluster_root(parent, g);
    statistics->grains++;
    cluster[root] += volume[g];
    if (cluster[root] > largest) largest = cluster[root];
    if (cut[g]) continue;
    const double diameter = field->voxel * cbrt(6 / PI * (double)volume[g]);
    statistics->whole_grains++;
    statistics->coordination += touched[g];
    statistics->diameter_mean += diameter;
    statistics->diameter_min = fmin(statistics->diameter_min, diameter);
    statistics->diameter_max = fmax(statistics->diameter_max, diameter);
  }
  if (statistics->whole_grains) {
    statistics->coordination /= (double)statistics->whole_grains;
    statistics->diameter_mean /= (double)statistics->whole_grains;
  }
  if (field->solid) statistics->largest_cluster = (double)largest / (double)field->solid;
cleanup:
  memory_free(&contact);
  memory_free(&parent);
  memory_free(&cluster);
  memory_free(&touched);
  memory_free(&volume);
  memory_free(&cut);
  return status;
}
