#include "ct2model/scanner/porod.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/surface/specks.h"

/* The probability that of two points a distance r apart, in any direction, one lies in the pore and
 * one in the grain tends to S r / 2 as r goes to 0, where S is the surface per volume (Debye,
 * Anderson, Brumberger 1957, J. Appl. Phys. 28: 679; for the spectrum of scattering Porod 1951). So
 * 2 / r times that probability, extrapolated to r = 0, is S. It falls with r, at first linearly,
 * because of surfaces near each other at edges and contacts (Ciccariello, Goodisman, Brumberger
 * 1988, J. Appl. Cryst. 21: 117):
 *
 *   S (1 - B x + BEND x^3),   x = r / a,   a = 4 n (1 - n) / S,
 *
 * where a is the distance at which the extrapolated probability reaches that of independent points
 * at porosity n. The B of true grains of sands is 0.21 to 0.37.
 * Restored grains show the correct probability beyond about two blurs: S and B are fitted from that
 * distance to twice that. B tells edges and contacts from walls that are smooth all over, where
 * noise and relief cannot be told apart: there the restored surface is kept. Where S is far above
 * the surface of the walls, as between plane walls a few voxels apart, or directions differ, as for
 * a slit, the law does not apply. */
enum { CHUNK = 64 };

/* The vector between the two points of a pair, in voxels, the number of such pairs and of those
 * whose phases differ. */
struct pairs {
  long x, y, z;
  double distance; /* m */
  uint64_t count, differ;
};

/* Chooses vectors with directions spread over a hemisphere by the golden angle, and lengths spread
 * over the range by another low-discrepancy sequence. False if the scan is shorter than twice a
 * vector along some axis. */
static bool choose_vectors(const size_t size[3], const double voxel[3], double from, double to,
                           struct pairs vectors[VECTORS]) {
  for (int i = 0; i < VECTORS; i++) {
    const double up = (i + 0.5) / VECTORS, across = sqrt(1.0 - up * up);
    const double angle = i * M_PI * (3.0 - sqrt(5.0));
    const double length = from + (to - from) * fmod(i * sqrt(2.0), 1.0);
    const double way[3] = {across * cos(angle), across * sin(angle), up};
    long step[3];
    double square = 0.0;
    for (int d = 0; d < 3; d++) {
      step[d] = lrint(length * way[d] / voxel[d]);
      square += pow((double)step[d] * voxel[d], 2.0);
      if (2 * (size_t)labs(step[d]) > size[d]) return false;
    }
    vectors[i] = (struct pairs){step[0], step[1], step[2], sqrt(square), 0, 0};
  }
  return true;
}

/* Number of bits x of `here` that differ from bits x + shift of `there`, over n - shift bits. */
TARGETS static uint64_t differing(const uint64_t *here, const uint64_t *there, size_t n,
                                  size_t shift) {
  const size_t remaining = n - shift, skipped = shift / PHASE_WORD, bit = shift % PHASE_WORD;
  const size_t words = phase_words(n);
  uint64_t sum = 0;
  for (size_t w = 0; w * PHASE_WORD < remaining; w++) {
    uint64_t moved = there[w + skipped] >> bit;
    if (bit > 0 && w + skipped + 1 < words) moved |= there[w + skipped + 1] << (PHASE_WORD - bit);
    uint64_t other = moved ^ here[w];
    if ((w + 1) * PHASE_WORD > remaining) other &= ((uint64_t)1 << remaining % PHASE_WORD) - 1;
    sum += (uint64_t)__builtin_popcountll(other);
  }
  return sum;
}

/* Adds the pairs whose first voxel lies in one of the first `count` slices; `bits` holds these and
 * the following slices, `held` in all. */
static void count_pairs(const uint64_t *bits, const size_t size[3], size_t count, size_t held,
                        struct pairs *pairs) {
  const size_t words = phase_words(size[0]), shift = (size_t)labs(pairs->x);
  for (size_t z = 0; z < count && z + (size_t)pairs->z < held; z++)
    for (size_t y = pairs->y < 0 ? (size_t)-pairs->y : 0; y < size[1]; y++) {
      const size_t other_y = (size_t)((long)y + pairs->y);
      if (other_y >= size[1]) break;
      const uint64_t *a = bits + (z * size[1] + y) * words;
      const uint64_t *b = bits + ((z + (size_t)pairs->z) * size[1] + other_y) * words;
      pairs->differ +=
          pairs->x < 0 ? differing(b, a, size[0], shift) : differing(a, b, size[0], shift);
      pairs->count += size[0] - shift;
    }
}

static void pack_row(const uint8_t *levels, double threshold, size_t n, uint64_t *bits) {
  memset(bits, 0, phase_words(n) * sizeof *bits);
  for (size_t x = 0; x < n; x++)
    bits[x / PHASE_WORD] |= (uint64_t)((double)levels[x] > threshold) << x % PHASE_WORD;
}

static enum status count_all(const struct restored *restored, struct pairs vectors[VECTORS]) {
  enum status status = STATUS_OK;
  const size_t *size = restored->scan.size, nx = size[0], ny = size[1], nz = size[2];
  const size_t words = phase_words(nx);
  size_t reach = 0;
  uint64_t *bits = NULL;
  for (int i = 0; i < VECTORS; i++)
    if ((size_t)vectors[i].z > reach) reach = (size_t)vectors[i].z;
  TRY(memory_allocate(&bits, (CHUNK + reach) * ny * words, sizeof *bits, "pairs of voxels"));
  for (size_t z = 0; z < nz; z += CHUNK) {
    const size_t held = nz - z < CHUNK + reach ? nz - z : CHUNK + reach;
#pragma omp parallel for schedule(static)
    for (size_t row = 0; row < held * ny; row++)
      pack_row(restored->scan.levels + (z * ny + row) * nx, restored->threshold, nx,
               bits + row * words);
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < VECTORS; i++)
      count_pairs(bits, size, held < CHUNK ? held : CHUNK, held, &vectors[i]);
  }
cleanup:
  memory_free(&bits);
  return status;
}

/* Fits S (returned) and B (`slope`) by least squares, iterating since a depends on S. `error`:
 * standard error of S by the scatter between directions. */
static double extrapolate(const struct pairs vectors[VECTORS], double n, double surface,
                          double *slope, double *error) {
  for (int round = 0; round < 8; round++) {
    const double a = 4.0 * n * (1.0 - n) / surface;
    double uu = 0.0, ur = 0.0, rr = 0.0, uy = 0.0, ry = 0.0, yy = 0.0;
    for (int i = 0; i < VECTORS; i++) {
      const double r = vectors[i].distance, u = 1.0 + BEND * pow(r / a, 3.0);
      const double y = 2.0 / r * (double)vectors[i].differ / (double)vectors[i].count;
      uu += u * u, ur += u * r, rr += r * r, uy += u * y, ry += r * y, yy += y * y;
    }
    const double both = uu * rr - ur * ur, falls = (uu * ry - ur * uy) / both;
    surface = (rr * uy - ur * ry) / both;
    *slope = -falls * a / surface;
    *error = sqrt(fmax(yy - surface * uy - falls * ry, 0.0) / (VECTORS - 2) * rr / both);
  }
  return surface;
}

/* Measures the law: S (`found`; NAN if a side of the scan is too short), B (`slope`) and the
 * standard error of S (`scatter`). `surface`: that of the walls, 1/m. */
static enum status measure_law(const struct restored *restored, double blur, const double voxel[3],
                               double surface, double *found, double *slope, double *scatter) {
  enum status status = STATUS_OK;
  struct pairs vectors[VECTORS];
  const double n = restored->void_ratio / (1.0 + restored->void_ratio);
  const double a = 4.0 * n * (1.0 - n) / surface;
  const double widest = fmax(voxel[0], fmax(voxel[1], voxel[2]));
  const double from = fmax(RANGE_VOXELS * widest, fmin(RANGE_BLURS * blur, RANGE_MOST * a));
  *found = *slope = *scatter = NAN;
  if (!choose_vectors(restored->scan.size, voxel, from, RANGE_FACTOR * from, vectors))
    return STATUS_OK;
  TRY(count_all(restored, vectors));
  *found = extrapolate(vectors, n, surface, slope, scatter);
cleanup:
  return status;
}

/* Whether the law applies to these walls. */
static bool law_applies(double found, double scatter, double surface) {
  return found < RATIO_MOST * surface && 2.0 * scatter <= ERROR_LAW * found;
}

enum status porod_grains(const struct restored *restored, double blur, const double voxel[3],
                         double surface, double *grains) {
  enum status status = STATUS_OK;
  double found, slope, scatter;
  TRY(measure_law(restored, blur, voxel, surface, &found, &slope, &scatter));
  *grains = law_applies(found, scatter, surface) ? ramp(slope, B_TOUCHING, B_GRAINS) : 0.0;
cleanup:
  return status;
}

enum status porod_surface(const struct restored *restored, const struct scanner *scanner,
                          const double voxel[3], double *surface, double *error) {
  enum status status = STATUS_OK;
  double found, slope, scatter;
  const double n = restored->void_ratio / (1.0 + restored->void_ratio);
  const double a = 4.0 * n * (1.0 - n) / *surface;
  const bool usable = scanner->known && !scanner->narrow;
  *error = (usable && scanner->smooth_walls == 1.0 ? ERROR_SMOOTH : ERROR_NO_LAW) * *surface;
  if (!usable) return STATUS_OK;
  TRY(measure_law(restored, scanner->blur, voxel, *surface, &found, &slope, &scatter));
  if (!law_applies(found, scatter, *surface)) return STATUS_OK;
  const double edges = ramp(slope, B_APART, B_TOUCHING);
  const double smooth = scanner->smooth_walls, smooth_weight = smooth * (1.0 - edges);
  const double disagreement = smooth * edges * fabs(found / *surface - 1.0);
  *surface += (1.0 - smooth_weight) * (found - *surface);
  const double hidden = ERROR_PER_BLUR * scanner->blur / a;
  const double law = hypot(hypot(ERROR_LAW, 2.0 * scatter / found), hypot(hidden, disagreement));
  *error = (law + smooth_weight * (ERROR_SMOOTH - law)) * *surface;
cleanup:
  return status;
}
