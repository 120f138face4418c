#include "ct2model/model/morphology.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "common/model_file.h"
#include "ct2model/model/connect.h"

/* The narrowest place on the widest path through the pores, which controls k. */

/* The critical diameter of Katz and Thompson (1986, Phys. Rev. B 34: 8179): the largest one at
 * which the pores at least as wide still percolate. The threshold of the distance to the walls is
 * found by bisection, in steps of an eighth of a voxel, up to 64 voxels. */
enum { STEPS = 8, WIDEST = 64 };

static enum status percolates_at(const struct voxel_model *model, size_t layers, float distance,
                                 uint8_t *wide, bool *through) {
  enum status status = STATUS_OK;
  const size_t size[3] = {model->size[0], model->size[1], layers};
  const bool whole = layers == model->size[2];
  const bool periodic[3] = {model->periodic[0], model->periodic[1], model->periodic[2] && whole};
  struct parts parts = {0};
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < size[0] * size[1] * layers; i++)
    wide[i] = model->solid[i] == 0 && model->wall_distance[i] >= distance;
  TRY(parts_find(wide, size, periodic, 1, &parts));
  *through = false;
  for (size_t i = 0; i < parts.count; i++) *through |= parts.parts[i].percolates[2];
cleanup:
  parts_end(&parts);
  return status;
}

/* Diameter of the largest ball that can pass along z through the first `layers` of the model, in
 * voxels (of spacing[0]); 0 if none can. */
static enum status critical_width_find(const struct voxel_model *model, size_t layers,
                                       double *width) {
  enum status status = STATUS_OK;
  uint8_t *wide = NULL;
  int low = 0, high = STEPS * WIDEST; /* `low` percolates, `high` does not */
  bool through = false;
  *width = 0.0;
  TRY(memory_allocate(&wide, model->size[0] * model->size[1] * layers, 1, "pores by their width"));
  TRY(percolates_at(model, layers, 0.0F, wide, &through));
  while (through && high - low > 1) {
    const int middle = (low + high) / 2;
    bool middle_through = false;
    TRY(percolates_at(model, layers, (float)(0.5 * middle / STEPS * model->spacing[0]), wide,
                      &middle_through));
    *(middle_through ? &low : &high) = middle;
  }
  *width = through ? fmax((double)low, 0.5) / STEPS : 0.0;
cleanup:
  memory_free(&wide);
  return status;
}

static double touching_share(const struct voxel_model *model, size_t layers) {
  const size_t nx = model->size[0], ny = model->size[1], nz = model->size[2];
  size_t pores = 0, touching = 0;
#pragma omp parallel for schedule(static) reduction(+ : pores, touching)
  for (size_t row = 0; row < ny * layers; row++) {
    size_t y = row % ny, z = row / ny;
    const uint8_t *s = model->solid, *at = s + row * nx;
    const uint8_t *sides[4] = {
        s + (z * ny + (y + 1) % ny) * nx, s + (z * ny + (y + ny - 1) % ny) * nx,
        s + ((z + 1) % nz * ny + y) * nx, s + ((z + nz - 1) % nz * ny + y) * nx};
    for (size_t x = 0; x < nx; x++) {
      if (at[x] != 0) continue;
      pores++;
      touching += (at[(x + 1) % nx] | at[(x + nx - 1) % nx] | sides[0][x] | sides[1][x] |
                   sides[2][x] | sides[3][x]) != 0;
    }
  }
  return pores > 0 ? (double)touching / (double)pores : 0.0;
}

/* The phases as bits, 1 in pores, in rows of whole words. */
enum { WORD = 64 };
struct pore_bits {
  size_t words;
  uint64_t *row;
};

static enum status pack_pores(const struct voxel_model *model, struct pore_bits *bits) {
  const size_t nx = model->size[0], rows = model->size[1] * model->size[2];
  bits->words = (nx + WORD - 1) / WORD;
  const enum status status =
      memory_allocate(&bits->row, rows * bits->words, sizeof *bits->row, "phases");
  if (status != STATUS_OK) return status;
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++)
    for (size_t x = 0; x < nx; x++)
      bits->row[row * bits->words + x / WORD] |= (uint64_t)(model->solid[row * nx + x] == 0)
                                                 << x % WORD;
  return STATUS_OK;
}

/* The word of a row of nx bits that begins at bit `from`; what lies beyond the row is 0. */
static uint64_t word_from(const uint64_t *row, size_t words, size_t from) {
  const size_t w = from / WORD, shift = from % WORD;
  if (w >= words) return 0;
  return shift == 0 ? row[w] : row[w] >> shift | (w + 1 < words ? row[w + 1] << (WORD - shift) : 0);
}

/* Pairs of bits `shift` apart that are both set, a row being periodic. */
TARGETS static size_t pairs_along(const uint64_t *row, size_t words, size_t nx, size_t shift) {
  size_t both = 0;
  for (size_t w = 0; w < words; w++)
    both += (size_t)__builtin_popcountll(row[w] & word_from(row, words, w * WORD + shift));
  for (size_t w = 0; w * WORD < shift; w++) { /* those beyond the end are at its beginning */
    const size_t left = shift - w * WORD;
    const uint64_t mask = left < WORD ? ((uint64_t)1 << left) - 1 : ~(uint64_t)0;
    both +=
        (size_t)__builtin_popcountll(row[w] & mask & word_from(row, words, nx - shift + w * WORD));
  }
  return both;
}

TARGETS static size_t pairs_across(const uint64_t *restrict a, const uint64_t *restrict b,
                                   size_t words) {
  size_t both = 0;
  for (size_t w = 0; w < words; w++) both += (size_t)__builtin_popcountll(a[w] & b[w]);
  return both;
}

/* Fraction of the pairs of voxels at `distance` along `axis` that are both pore. */
static double both_pore(const struct voxel_model *model, const struct pore_bits *bits, int axis,
                        size_t distance) {
  const size_t nx = model->size[0], ny = model->size[1], nz = model->size[2], words = bits->words;
  size_t both = 0;
#pragma omp parallel for schedule(static) reduction(+ : both)
  for (size_t row = 0; row < ny * nz; row++) {
    const uint64_t *at = bits->row + row * words;
    size_t y = row % ny, z = row / ny; // NOLINT: a model has rows
    if (axis == 1) y = (y + distance) % ny;
    if (axis == 2) z = (z + distance) % nz;
    both += axis == 0 ? pairs_along(at, words, nx, distance)
                      : pairs_across(at, bits->row + (z * ny + y) * words, words);
  }
  return (double)both / (double)model_site_count(model);
}

static enum status correlation_length(const struct voxel_model *model, double *mean) {
  struct pore_bits bits = {0};
  const enum status status = pack_pores(model, &bits);
  if (status != STATUS_OK) return status;
  double sum = 0.0, porosity = both_pore(model, &bits, 0, 0),
         variance = porosity * (1.0 - porosity);
  int axes = 0;
  for (int axis = 0; axis < 3; axis++) {
    if (model->size[axis] < 8) continue;
    double length = 0.5;
    for (size_t r = 1; r <= model->size[axis] / 2; r++) {
      double covariance = both_pore(model, &bits, axis, r) - porosity * porosity;
      if (covariance <= 0.0) break;
      length += covariance / variance;
    }
    sum += length * model->spacing[axis];
    axes++;
  }
  memory_free(&bits.row);
  *mean = axes > 0 ? sum / axes : NAN;
  return STATUS_OK;
}

/* ---- local thickness ---- */

/* Balls are centred on voxels. The largest ball of a pore has its centre between them and is
 * slightly wider; by this, in voxels. */
static const float OFF_CENTRE = 0.25f;

/* The index `step` further on a periodic axis, less than one period away. */
static size_t wrapped_index(size_t at, long step, size_t n) {
  const long to = (long)at + step;
  return (size_t)(to < 0 ? to + (long)n : to >= (long)n ? to - (long)n : to);
}

/* Raises the first `count` bytes of a row to at least `value`. The row has `left` bytes; what
 * follows may belong to another thread. */
enum { VECTOR_BYTES = 16 };
typedef uint8_t bytes __attribute__((vector_size(VECTOR_BYTES), aligned(1), may_alias));
static inline void raise_bytes(uint8_t *row, size_t count, size_t left, uint8_t value) {
  static const uint8_t FIRST[2 * VECTOR_BYTES] = {255, 255, 255, 255, 255, 255, 255, 255,
                                                  255, 255, 255, 255, 255, 255, 255, 255};
  size_t i = 0;
  for (; i < count && i + VECTOR_BYTES <= left; i += VECTOR_BYTES) {
    const size_t n = count - i < VECTOR_BYTES ? count - i : VECTOR_BYTES;
    const bytes raised = *(const bytes *)(FIRST + VECTOR_BYTES - n) & value,
                was = *(bytes *)(row + i);
    const bytes lower = (bytes)(was < raised);
    *(bytes *)(row + i) = (raised & lower) | (was & ~lower);
  }
  for (; i < count; i++) row[i] = row[i] < value ? value : row[i];
}

/* Raises width[], in quarters of a voxel, to `diameter` in the ball around one voxel, within the
 * layers from `low` to `high` - 1; periodic. */
static void paint_ball(const struct voxel_model *model, size_t site, float diameter, size_t low,
                       size_t high, uint8_t *width) {
  const uint8_t quarters = (uint8_t)fminf(4.0f * diameter, 4 * THICKNESS_BINS - 1);
  const size_t *n = model->size;
  const size_t at[3] = {site % n[0], site / n[0] % n[1], site / n[0] / n[1]};
  double radius = 0.5 * (double)diameter, unit = model->spacing[0];
  long reach[3];
  for (int d = 0; d < 3; d++) {
    reach[d] = (long)floor(radius * unit / model->spacing[d]);
    if (reach[d] > (long)n[d] / 2) reach[d] = (long)n[d] / 2;
  }
  for (long dz = -reach[2]; dz <= reach[2]; dz++) {
    const size_t layer = wrapped_index(at[2], dz, n[2]);
    if (layer < low || layer >= high) continue;
    for (long dy = -reach[1]; dy <= reach[1]; dy++) {
      double z = (double)dz * model->spacing[2] / unit, y = (double)dy * model->spacing[1] / unit;
      double left = radius * radius - z * z - y * y;
      if (left < 0.0) continue;
      long half = (long)sqrt(left);
      if (half > reach[0]) half = reach[0];
      uint8_t *row = width + (layer * n[1] + wrapped_index(at[1], dy, n[1])) * n[0];
      const size_t first = wrapped_index(at[0], -half, n[0]), count = 2 * (size_t)half + 1;
      const size_t whole = count < n[0] - first ? count : n[0] - first; /* up to the row's end */
      raise_bytes(row + first, whole, n[0] - first, quarters);
      raise_bytes(row, count - whole, n[0], quarters);
    }
  }
}

static float ball_diameter(const struct voxel_model *model, size_t site) {
  return 2.0f * model->wall_distance[site] / (float)model->spacing[0] + OFF_CENTRE;
}

/* Approximate number of voxels in all balls, and the diameter of the largest one. */
static uint64_t count_work(const struct voxel_model *model, float *widest) {
  const size_t plane = model->size[0] * model->size[1];
  uint64_t work = 0;
  float most = 0.0f;
#pragma omp parallel for schedule(static) reduction(+ : work) reduction(max : most)
  for (size_t z = 0; z < model->size[2]; z++) {
    for (size_t i = z * plane; i < (z + 1) * plane; i++) {
      if (model->solid[i] != 0) continue;
      const float ball = ball_diameter(model, i);
      const float radius = fmaxf(0.0f, fminf(0.5f * (ball - OFF_CENTRE), 1e4f));
      work += 1 + (uint64_t)(4.2f * radius * radius * radius);
      most = ball > most ? ball : most;
    }
  }
  *widest = most;
  return work;
}

/* Paints the parts of all balls that lie in a few layers: each thread writes to its own layers. */
static void paint_layers(const struct voxel_model *model, size_t low, size_t high, float widest,
                         uint8_t *width) {
  const size_t plane = model->size[0] * model->size[1], nz = model->size[2];
  const double far = 0.5 * (double)widest * model->spacing[0] / model->spacing[2] + 1.0;
  const size_t reach = far < (double)nz ? (size_t)far : nz;
  const size_t n = high - low + 2 * reach < nz ? high - low + 2 * reach : nz;
  for (size_t k = 0; k < n; k++) {
    const size_t z = (low + nz - reach + k) % nz; // NOLINT: a model has a layer
    for (size_t i = z * plane; i < (z + 1) * plane; i++)
      if (model->solid[i] == 0) paint_ball(model, i, ball_diameter(model, i), low, high, width);
  }
}

enum { SLAB = 16 };
enum status morphology_widths(const struct voxel_model *model, size_t layers, uint8_t **width) {
  float widest;
  *width = NULL;
  if (count_work(model, &widest) > 2000000000u) return STATUS_OK;
  const enum status status =
      memory_allocate(width, model->size[0] * model->size[1] * layers, 1, "pore widths");
  if (status != STATUS_OK) return status;
#pragma omp parallel for schedule(dynamic)
  for (size_t low = 0; low < layers; low += SLAB)
    paint_layers(model, low, low + SLAB < layers ? low + SLAB : layers, widest, *width);
  return STATUS_OK;
}

static enum status measure_thickness(const struct voxel_model *model, size_t layers,
                                     struct morphology *morphology) {
  enum status status = STATUS_OK;
  size_t pores = 0, used = model->size[0] * model->size[1] * layers;
  uint8_t *width = NULL;
  double counts[4 * THICKNESS_BINS] = {0};
  morphology->thickness_median = NAN;
  TRY(morphology_widths(model, layers, &width));
  if (width == NULL) return STATUS_OK;
  for (size_t i = 0; i < used; i++) {
    if (model->solid[i] != 0) continue;
    counts[width[i]] += 1.0;
    morphology->thickness_histogram[width[i] / 4] += 1.0;
    pores++;
  }
  double below = 0.0;
  for (int b = 0; b < 4 * THICKNESS_BINS && pores > 0; b++) {
    if (counts[b] > 0.0 && below + counts[b] >= 0.5 * (double)pores) {
      morphology->thickness_median = (b + (0.5 * (double)pores - below) / counts[b]) / 4.0;
      break;
    }
    below += counts[b];
  }
  for (int b = 0; b < THICKNESS_BINS && pores > 0; b++)
    morphology->thickness_histogram[b] /= (double)pores;
cleanup:
  memory_free(&width);
  return status;
}

/* ---- windows ---- */

/* Number of pore voxels in each box [0,x) x [0,y) x [0,z). */
static enum status summed_volume(const struct voxel_model *model, size_t layers, uint32_t **sums) {
  size_t nx = model->size[0] + 1, ny = model->size[1] + 1, nz = layers + 1;
  enum status status = memory_allocate(sums, nx * ny * nz, sizeof **sums, "window sums");
  if (status != STATUS_OK) return status;
  uint32_t *s = *sums;
  for (size_t z = 1; z < nz; z++) {
    for (size_t y = 1; y < ny; y++) {
      uint32_t row = 0;
      for (size_t x = 1; x < nx; x++) {
        row += model->solid[((z - 1) * (ny - 1) + y - 1) * (nx - 1) + x - 1] == 0;
        size_t i = (z * ny + y) * nx + x;
        s[i] = row + s[i - nx] + s[i - nx * ny] - s[i - nx - nx * ny];
      }
    }
  }
  return STATUS_OK;
}

static size_t window_statistics(const struct voxel_model *model, size_t layers, const uint32_t *s,
                                size_t window, double *mean, double *deviation) {
  size_t nx = model->size[0] + 1, ny = model->size[1] + 1;
  size_t half = window > 1 ? window / 2 : 1, count = 0;
  double sum = 0.0, squares = 0.0, volume = (double)window * (double)window * (double)window;
  for (size_t z = 0; z + window <= layers; z += half) {
    for (size_t y = 0; y + window <= model->size[1]; y += half) {
      for (size_t x = 0; x + window <= model->size[0]; x += half) {
        size_t a = (z * ny + y) * nx + x, dz = window * ny * nx, dy = window * nx, dx = window;
        double pores = (double)(s[a + dz + dy + dx] - s[a + dy + dx] - s[a + dz + dx] -
                                s[a + dz + dy] + s[a + dx] + s[a + dy] + s[a + dz] - s[a]);
        double porosity = pores / volume;
        sum += porosity;
        squares += porosity * porosity;
        count++;
      }
    }
  }
  double n = sum / (double)count, sd = sqrt(fmax(0.0, squares / (double)count - n * n));
  *mean = n / (1.0 - n);
  *deviation = sd / ((1.0 - n) * (1.0 - n)); /* de = dn / (1 - n)^2 */
  return count;
}

static enum status measure_windows(const struct voxel_model *model, size_t layers,
                                   struct morphology *morphology) {
  uint32_t *sums = NULL;
  size_t least = layers;
  for (int d = 0; d < 2; d++) least = model->size[d] < least ? model->size[d] : least;
  if (least < 8 || (double)model_site_count(model) > 4e9) return STATUS_OK;
  enum status status = summed_volume(model, layers, &sums);
  if (status != STATUS_OK) return status;
  for (size_t window = 4; window <= least && morphology->window_count < WINDOW_SIZES;) {
    size_t i = morphology->window_count++;
    morphology->window[i] = window;
    morphology->window_places[i] = window_statistics(
        model, layers, sums, window, &morphology->window_mean[i], &morphology->window_deviation[i]);
    size_t next = window * 2 <= least ? window * 2 : least;
    if (next == window) break;
    window = next;
  }
  memory_free(&sums);
  return STATUS_OK;
}

enum status morphology_measure(const struct voxel_model *model, size_t layers,
                               struct morphology *morphology) {
  enum status status = STATUS_OK;
  memset(morphology, 0, sizeof *morphology);
  morphology->touching = touching_share(model, layers);
  TRY(correlation_length(model, &morphology->correlation_length));
  TRY(measure_thickness(model, layers, morphology));
  TRY(critical_width_find(model, layers, &morphology->critical_width));
  morphology->expected_error = morphology->critical_width > 0.0
                                   ? fmin(0.5 / pow(morphology->critical_width, 2.0), 1.0)
                                   : NAN;
  TRY(measure_windows(model, layers, morphology));
cleanup:
  return status;
}
