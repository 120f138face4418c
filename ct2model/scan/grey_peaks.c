#include "ct2model/scan/grey_peaks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"

/* Bins of a histogram, over 1.5 times the contrast. */
#define BINS 512
/* Largest difference between the halves of a flat cell, over the contrast. */
#define FLAT_DIFFERENCE 0.1
/* Standard deviation of the Gaussian that smooths a histogram, over the contrast; its range in
 * bins, three standard deviations. */
#define SMOOTHING 0.02
#define REACH 21
/* Smallest persistence of a peak, in square roots of counts, whose standard deviation is 1/2. */
#define PERSISTENCE_CLEAR 3.0
/* Largest ratio of a valley to its peak. */
#define VALLEY_MOST 0.8
/* Shift of a peak by edges, over the contrast. */
#define EDGE_ERROR 0.01
#define OCTANTS 8
/* Fewest cells in which a peak is sought. */
#define CELLS_MINIMUM 50
/* Cells to which a voxel belongs. */
#define CELLS_PER_VOXEL 8
/* Most peaks that are named in a message. */
#define PEAKS_TOLD 8

/* Means over 2x2x2 voxels, [z][y][x], and histograms of the flat cells of 2x2x2 such means. */
struct cells {
  size_t size[3];
  float *mean;
  double contrast;
  struct grey_histogram all, octant[OCTANTS];
};

/* Collects the different greys, up to LABELS; an image of labels has no more. */
#define LABELS 8
static void note_greys(size_t n, const float *values, float seen[LABELS], int *count) {
  for (size_t i = 0; i < n && *count <= LABELS; i++) {
    int at = 0;
    while (at < *count && at < LABELS && seen[at] != values[i]) at++;
    if (at == *count && at < LABELS) seen[at] = values[i];
    if (at == *count) *count += 1;
  }
}

static enum status average_voxels(const struct region *region, struct cells *c) {
  enum status status = STATUS_OK;
  const size_t nx = region->size[0], plane = nx * region->size[1];
  float *slices = NULL, seen[LABELS];
  int greys = 0;
  for (int d = 0; d < 3; d++) c->size[d] = region->size[d] / 2;
  if (c->size[0] < 4 || c->size[1] < 4 || c->size[2] < 4)
    TRY_FAIL(STATUS_INPUT,
             "%s: --micro auto: %zux%zux%zu voxels are too few for peaks of a histogram; name the "
             "greys, as 80..170",
             region->stack->files[0].path, region->size[0], region->size[1], region->size[2]);
  TRY(memory_allocate(&slices, 2 * plane, sizeof *slices, "two slices"));
  TRY(memory_allocate(&c->mean, c->size[0] * c->size[1] * c->size[2], sizeof *c->mean,
                      "means of greys"));
  for (size_t z = 0; z < c->size[2]; z++) {
    const size_t both[2] = {2 * z, 2 * z + 1};
    TRY(region_read(region, both, 2, slices));
    note_greys(2 * plane, slices, seen, &greys);
    for (size_t y = 0; y < c->size[1]; y++)
      for (size_t x = 0; x < c->size[0]; x++) {
        const float *a = slices + 2 * y * nx + 2 * x, *b = a + plane;
        c->mean[(z * c->size[1] + y) * c->size[0] + x] =
            0.125f * ((a[0] + a[1] + a[nx] + a[nx + 1]) + (b[0] + b[1] + b[nx] + b[nx + 1]));
      }
  }
  if (greys <= LABELS)
    TRY_FAIL(STATUS_INPUT,
             "%s: --micro auto: holds %d greys: an image of labels; say what each is, as "
             "--segmented \"0=pore,1=grain,2=soil(0.35, 2um)\"",
             region->stack->files[0].path, greys);
cleanup:
  memory_free(&slices);
  return status;
}

/* Starts histograms around the range that holds 96 % of the means. */
static enum status choose_bins(const struct region *region, struct cells *c) {
  enum status status = STATUS_OK;
  const size_t count = c->size[0] * c->size[1] * c->size[2];
  struct grey_histogram wide = {0};
  float low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < count; i++) low = fminf(low, c->mean[i]), high = fmaxf(high, c->mean[i]);
  if (!(high > low))
    TRY_FAIL(STATUS_INPUT, "%s: --micro auto: all voxels have the same grey",
             region->stack->files[0].path);
  TRY(grey_histogram_start((double)low, (double)(high - low) / 4096.0, 4096, &wide));
  grey_histogram_add(&wide, c->mean, count);
  const double first = grey_histogram_quantile(&wide, 0.02);
  c->contrast = grey_histogram_quantile(&wide, 0.98) - first;
  const double width = 1.5 * c->contrast / BINS, start = first - 0.25 * c->contrast;
  TRY(grey_histogram_start(start, width, BINS, &c->all));
  for (int o = 0; o < OCTANTS; o++) TRY(grey_histogram_start(start, width, BINS, &c->octant[o]));
cleanup:
  grey_histogram_end(&wide);
  return status;
}

/* Counts the flat cells. */
static void count_cells(struct cells *c) {
  const size_t step[3] = {1, c->size[0], c->size[0] * c->size[1]};
  const float limit = (float)(FLAT_DIFFERENCE * c->contrast);
  for (size_t z = 0; z + 1 < c->size[2]; z++)
    for (size_t y = 0; y + 1 < c->size[1]; y++)
      for (size_t x = 0; x + 1 < c->size[0]; x++) {
        const float *first = c->mean + z * step[2] + y * step[1] + x;
        float difference[3] = {0.0f}, sum = 0.0f;
        for (size_t corner = 0; corner < 8; corner++) {
          const float m =
              first[(corner & 1) * step[0] + (corner >> 1 & 1) * step[1] + (corner >> 2) * step[2]];
          sum += m;
          for (int d = 0; d < 3; d++) difference[d] += corner >> d & 1 ? m : -m;
        }
        bool flat = true;
        for (int d = 0; d < 3; d++) flat = flat && fabsf(0.25f * difference[d]) < limit;
        if (!flat) continue;
        const float mean = 0.125f * sum;
        const int octant =
            (2 * x >= c->size[0]) + 2 * (2 * y >= c->size[1]) + 4 * (2 * z >= c->size[2]);
        grey_histogram_add(&c->all, &mean, 1);
        grey_histogram_add(&c->octant[octant], &mean, 1);
      }
}

/* Square roots of the smoothed counts of a histogram, scaled to voxels that are counted once. */
static void smooth(const struct grey_histogram *h, double contrast, double root[BINS]) {
  const double deviation = SMOOTHING * contrast / h->width;
  for (int i = 0; i < BINS; i++) {
    double sum = 0.0;
    for (int j = i - REACH < 0 ? 0 : i - REACH; j <= i + REACH && j < BINS; j++)
      sum += (double)h->counts[j] * exp(-0.5 * pow((double)(i - j) / deviation, 2));
    /* Effective count: the sum times sum w / sum w^2 = sqrt(2), w the weights of the Gaussian. */
    root[i] = sqrt(M_SQRT2 * sum / CELLS_PER_VOXEL);
  }
}

/* A local maximum, its height above the valley between it and the nearest higher one (its
 * persistence), and that valley. */
struct summit {
  int bin;
  double persistence, valley;
};

/* Finds the local maxima of a curve, the most persistent first. */
static int find_summits(const double root[BINS], struct summit summits[BINS]) {
  int count = 0;
  for (int i = 1; i + 1 < BINS; i++) {
    if (!(root[i] > root[i - 1] && root[i] >= root[i + 1])) continue;
    double valley = 0.0;
    for (int way = -1; way <= 1; way += 2) {
      double least = root[i];
      int j = i + way;
      for (; j >= 0 && j < BINS && root[j] <= root[i]; j += way) least = fmin(least, root[j]);
      if (j >= 0 && j < BINS) valley = fmax(valley, least);
    }
    const struct summit found = {i, root[i] - valley, valley};
    int at = count++;
    for (; at > 0 && summits[at - 1].persistence < found.persistence; at--)
      summits[at] = summits[at - 1];
    summits[at] = found;
  }
  return count;
}

static double grey_of(const struct cells *c, double bin) {
  return c->all.low + c->all.width * (bin + 0.5);
}

/* Position of the maximum of the parabola through a bin and its neighbours. */
static double parabola_top(const double root[BINS], int i) {
  const double a = root[i - 1], b = root[i], d = root[i + 1];
  const double bend = a - 2.0 * b + d;
  return (double)i + (bend < 0.0 ? 0.5 * (a - d) / bend : 0.0);
}

/* Standard deviation of the position of a peak over the octants that show it between bins `first`
 * and `end`. */
static double octant_scatter(const struct cells *c, int first, int end) {
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (int o = 0; o < OCTANTS; o++) {
    double root[BINS];
    uint64_t cells = 0;
    int best = first;
    for (int i = first; i < end; i++) cells += c->octant[o].counts[i];
    if (cells < CELLS_MINIMUM) continue;
    smooth(&c->octant[o], c->contrast, root);
    for (int i = first; i < end; i++)
      if (root[i] > root[best]) best = i;
    if (best == first || best + 1 >= end) continue;
    const double grey = grey_of(c, parabola_top(root, best));
    n++, sum += grey, squares += grey * grey;
  }
  /* With too few octants the largest possible scatter. */
  if (n < 0.5 * OCTANTS) return 0.5 * FLAT_DIFFERENCE * c->contrast;
  return sqrt(fmax(0.0, squares - sum * sum / n) / (n - 1.0));
}

static enum status not_three(const struct region *region, const struct cells *c,
                             const struct summit *summits, int clear) {
  char list[PEAKS_TOLD * 16] = "";
  for (int i = 0; i < clear && i < PEAKS_TOLD; i++) {
    const size_t used = strlen(list);
    const double grey = grey_of(c, summits[i].bin) / (region->scale < 0.0 ? -1.0 : 1.0);
    snprintf(list + used, sizeof list - used, "%s%.4g", i > 0 ? ", " : "", grey);
  }
  return FAIL(
      STATUS_INPUT,
      "%s: --micro auto: the histogram shows %d clear peak%s%s%s%s, and pore, soil and grain "
      "are three; %s, or name the greys of soil, as 80..170",
      region->stack->files[0].path, clear, clear == 1 ? "" : "s", clear > 0 ? " (" : "", list,
      clear > 0 ? ")" : "",
      clear > PEAKS ? "crop away what is none of them"
                    : "leave --micro out, where there is no such soil");
}

enum status grey_peaks_find(const struct region *region, struct grey_peaks *peaks) {
  enum status status = STATUS_OK;
  struct cells c = {0};
  struct summit summits[BINS];
  double root[BINS];
  int bin[PEAKS], clear = 0;
  TRY(average_voxels(region, &c));
  TRY(choose_bins(region, &c));
  count_cells(&c);
  smooth(&c.all, c.contrast, root);
  const int count = find_summits(root, summits);
  for (int i = 0; i < count; i++) {
    const double share = summits[i].valley / (summits[i].persistence + summits[i].valley);
    if (summits[i].persistence < PERSISTENCE_CLEAR || share * share > VALLEY_MOST) continue;
    summits[clear++] = summits[i];
  }
  if (clear != PEAKS) TRY(not_three(region, &c, summits, clear));
  for (int i = 0; i < PEAKS; i++) {
    int rank = 0;
    for (int j = 0; j < PEAKS; j++) rank += summits[j].bin < summits[i].bin;
    bin[rank] = summits[i].bin;
  }
  for (int i = 0; i < PEAKS; i++) {
    const int first = i > 0 ? (bin[i - 1] + bin[i]) / 2 : 0;
    const int end = i + 1 < PEAKS ? (bin[i] + bin[i + 1]) / 2 : BINS;
    peaks->grey[i] = grey_of(&c, parabola_top(root, bin[i]));
    peaks->error[i] = hypot(2.0 * octant_scatter(&c, first, end), EDGE_ERROR * c.contrast);
  }
cleanup:
  memory_free(&c.mean);
  grey_histogram_end(&c.all);
  for (int o = 0; o < OCTANTS; o++) grey_histogram_end(&c.octant[o]);
  return status;
}
