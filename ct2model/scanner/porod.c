#include "ct2model/scanner/porod.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/ramp.h"
#include "ct2model/surface/phase_bits.h"

/* Of two points a distance r apart, in any direction, one is in the pore and one in the grain with
 * a probability of S r / 2 as r goes to 0, S the surface of a unit of volume (Debye, Anderson,
 * Brumberger 1957, J. Appl. Phys. 28: 679; of the spectrum of scattering Porod 1951). So 2 / r
 * times that probability is S where it is followed back to r = 0. Surfaces that are near each
 * other, at edges and contacts, let it fall at once, along a straight line (Ciccariello, Goodisman,
 * Brumberger 1988, J. Appl. Cryst. 21: 117):
 *
 *   S (1 - B x + BEND x^3),   x = r / a,   a = 4 n (1 - n) / S,
 *
 * a the length over which a porosity n has turned into chance. BEND is that of the true grains of
 * sixty generated sands, angular, round, long and with fines, whose B is .21 to .37
 * (docs/notes/2026-11-26-specific-surface.md). Restored grains show the probability right from some
 * two blurs on: S and B are fitted from there to twice that. */
static const double BEND = 1.0 / 64.0;
static const double FROM_BLURS = 2.0, FROM_VOXELS = 2.0, FROM_MOST = 0.7, TO = 2.0;
/* Where noise and relief cannot be told apart, B tells edges and contacts from walls that are
 * smooth all over: it is .21 and more of true sands, .23 to .3 of touching balls, .25 and less of
 * balls that stand apart, and tubes, fibres and slits show the law in no direction alike
 * (docs/notes/2026-11-26-smooth-sands.md). There S is the law's, and its half width holds the
 * restored surface, too. */
static const double APART = 0.15, TOUCHING = 0.21;
/* Of 102 sands B is .254 and more, and hides no smooth walls
 * (docs/notes/2026-11-28-surface-cost.md). */
static const double GRAINS = 0.25;
/* S over that of the restored surface: of sands it is 1.17 at most. Where the law asks for more, as
 * between plane walls a few voxels apart, it is not theirs: 2 / r times the probability stays level
 * up to that distance, and falls steeply from there. */
static const double MOST = 1.19;
/* 95 % half widths, of S: that of the law, beside so much blur / a, as the finest grains are lost
 * whole under a blur, and no scan tells whether there were any; of smooth walls' own surface; and
 * of what the law does not see. Where directions differ so much that their number leaves more than
 * LAW, as a slit's do, it is not asked: of sands they leave 2 % at most, of a felt 7. */
static const double LAW = 0.045, LOST = 0.25, SMOOTH = 0.09, UNSEEN = 0.2;

enum { VECTORS = 256, CHUNK = 64 };

/* Voxels from one point to the other, and how many such pairs there are, and differ. */
struct pairs {
  long x, y, z;
  double distance; /* m */
  uint64_t count, differ;
};

/* Directions spread over half a sphere by the golden angle, distances over the range by a sequence
 * of their own. False where a side of the scan hardly holds them. */
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

/* Where bits x of `here` and x + shift of `there` differ, of n - shift. */
TARGETS static uint64_t differing(const uint64_t *here, const uint64_t *there, size_t n,
                                  size_t shift) {
  const size_t left = n - shift, skipped = shift / PHASE_WORD, bit = shift % PHASE_WORD;
  const size_t words = phase_words(n);
  uint64_t sum = 0;
  for (size_t w = 0; w * PHASE_WORD < left; w++) {
    uint64_t moved = there[w + skipped] >> bit;
    if (bit > 0 && w + skipped + 1 < words) moved |= there[w + skipped + 1] << (PHASE_WORD - bit);
    uint64_t other = moved ^ here[w];
    if ((w + 1) * PHASE_WORD > left) other &= ((uint64_t)1 << left % PHASE_WORD) - 1;
    sum += (uint64_t)__builtin_popcountll(other);
  }
  return sum;
}

/* Adds the pairs whose first voxel is in one of `count` slices; `bits` has `held` of them and of
 * those behind. */
static void count_pairs(const uint64_t *bits, const size_t size[3], size_t count, size_t held,
                        struct pairs *pairs) {
  const size_t words = phase_words(size[0]), shift = (size_t)labs(pairs->x);
  for (size_t z = 0; z < count && z + (size_t)pairs->z < held; z++)
    for (size_t y = pairs->y < 0 ? (size_t)-pairs->y : 0; y < size[1]; y++) {
      const size_t its = (size_t)((long)y + pairs->y);
      if (its >= size[1]) break;
      const uint64_t *a = bits + (z * size[1] + y) * words;
      const uint64_t *b = bits + ((z + (size_t)pairs->z) * size[1] + its) * words;
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

/* S and B, `slope`, by least squares; a, which is by S, in turn. `error`: the standard error by the
 * scatter between directions. */
static double follow_back(const struct pairs vectors[VECTORS], double n, double surface,
                          double *slope, double *error) {
  for (int again = 0; again < 8; again++) {
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

/* S, `found` (NAN where a side is too short), its `slope`, B, and `scatter`, its standard error;
 * `surface` as the walls have it. */
static enum status find_law(const struct restored *restored, double blur, const double voxel[3],
                            double surface, double *found, double *slope, double *scatter) {
  enum status status = STATUS_OK;
  struct pairs vectors[VECTORS];
  const double n = restored->void_ratio / (1.0 + restored->void_ratio);
  const double a = 4.0 * n * (1.0 - n) / surface;
  const double widest = fmax(voxel[0], fmax(voxel[1], voxel[2]));
  const double from = fmax(FROM_VOXELS * widest, fmin(FROM_BLURS * blur, FROM_MOST * a));
  *found = *slope = *scatter = NAN;
  if (!choose_vectors(restored->scan.size, voxel, from, TO * from, vectors)) return STATUS_OK;
  TRY(count_all(restored, vectors));
  *found = follow_back(vectors, n, surface, slope, scatter);
cleanup:
  return status;
}

/* Whether the law is that of the walls. */
static bool holds(double found, double scatter, double surface) {
  return found < MOST * surface && 2.0 * scatter <= LAW * found;
}

enum status porod_grains(const struct restored *restored, double blur, const double voxel[3],
                         double surface, double *grains) {
  enum status status = STATUS_OK;
  double found, slope, scatter;
  TRY(find_law(restored, blur, voxel, surface, &found, &slope, &scatter));
  *grains = holds(found, scatter, surface) ? ramp(slope, TOUCHING, GRAINS) : 0.0;
cleanup:
  return status;
}

enum status porod_surface(const struct restored *restored, const struct scanner *scanner,
                          const double voxel[3], double *surface, double *error) {
  enum status status = STATUS_OK;
  double found, slope, scatter;
  const double n = restored->void_ratio / (1.0 + restored->void_ratio);
  const double a = 4.0 * n * (1.0 - n) / *surface;
  const bool alone = scanner->known && !scanner->narrow;
  *error = (alone && scanner->smooth_walls == 1.0 ? SMOOTH : UNSEEN) * *surface;
  if (!alone) return STATUS_OK;
  TRY(find_law(restored, scanner->blur, voxel, *surface, &found, &slope, &scatter));
  if (!holds(found, scatter, *surface)) return STATUS_OK;
  const double edges = ramp(slope, APART, TOUCHING);
  const double smooth = scanner->smooth_walls, own = smooth * (1.0 - edges);
  const double both = smooth * edges * fabs(found / *surface - 1.0);
  *surface += (1.0 - own) * (found - *surface);
  const double blurred = LOST * scanner->blur / a;
  const double law = hypot(hypot(LAW, 2.0 * scatter / found), hypot(blurred, both));
  *error = (law + own * (SMOOTH - law)) * *surface;
cleanup:
  return status;
}
