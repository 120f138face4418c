/* The number of a lattice's points in a body whose place on it is by chance has the mean of the
 * body's area and the variance .0728 times its perimeter, in spacings (Kendall 1948, Q. J. Math.
 * 19: of smooth ovals, over all their turns). Slices of a body across an axis each have that; how
 * many are off by the same is read from the labels:
 *
 * - A wall along the axis is the same in all slices, one across it is met anew in each. With F
 *   faces between labels along the axis, and G along the other two, it is G / (1.7 F) slices: of
 *   surfaces that face all ways F / G is a half, and the variance of the volume then is .067 times
 *   the surface, as it is of smooth bodies in three dimensions.
 * - Slices of as many voxels with as many faces are the same once more, moved or mirrored.
 * - Halves of a slice that are each other's image are off by the same.
 *
 * Of many grains all that is lost in the sum; of one pore across a small image it is per cents.
 * Labels that change along one axis alone are layers, drawn on the faces of voxels: as wide as
 * drawn. */
#include "ct2model/scan/label_volume.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

static const double OVAL = 0.0728;
static const double ANEW = 1.7; /* of which .0728 (pi / 4) 2 / 1.7 = .067 */

/* A slice across an axis: its grain, and its faces along each axis but that. */
struct slice {
  uint64_t grain, face[3];
};

struct labels_seen {
  const uint8_t *grain;
  const size_t *size;
  struct slice *slice[3];
};

static bool at(const struct labels_seen *seen, const size_t place[3]) {
  return seen->grain[(place[2] * seen->size[1] + place[1]) * seen->size[0] + place[0]] != 0;
}

static void count(const struct labels_seen *seen, const bool reflect[3]) {
  const size_t *n = seen->size;
  size_t place[3];
  for (place[2] = 0; place[2] < n[2]; place[2]++)
    for (place[1] = 0; place[1] < n[1]; place[1]++)
      for (place[0] = 0; place[0] < n[0]; place[0]++) {
        const bool grain = at(seen, place);
        for (int a = 0; a < 3; a++) {
          seen->slice[a][place[a]].grain += grain;
          if (place[a] + 1 == n[a] && reflect[a]) continue;
          size_t next[3] = {place[0], place[1], place[2]};
          next[a] = place[a] + 1 < n[a] ? place[a] + 1 : 0;
          if (at(seen, next) == grain) continue;
          for (int s = 0; s < 3; s++)
            if (s != a) seen->slice[s][place[s]].face[a]++;
        }
      }
}

/* Whether turning axis b round, or with b != c exchanging b and c, changes no voxel. */
static bool is_own_image(const struct labels_seen *seen, int b, int c) {
  const size_t *n = seen->size;
  size_t place[3];
  if (n[b] != n[c]) return false;
  for (place[2] = 0; place[2] < n[2]; place[2]++)
    for (place[1] = 0; place[1] < n[1]; place[1]++)
      for (place[0] = 0; place[0] < n[0]; place[0]++) {
        size_t image[3] = {place[0], place[1], place[2]};
        image[b] = b == c ? n[b] - 1 - place[b] : place[c];
        if (b != c) image[c] = place[b];
        if (at(seen, image) != at(seen, place)) return false;
      }
  return true;
}

/* Variance of the number of voxels by the slices across axis a; faces: along each axis. */
static double variance(const struct labels_seen *seen, const double faces[3], int a) {
  const int b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;
  const double run =
      fmin((double)seen->size[a], fmax(1.0, (faces[b] + faces[c]) / (ANEW * faces[a])));
  double sum = 0.0, images = 1.0;
  for (size_t i = 0; i < seen->size[a]; i++) {
    const struct slice *slice = &seen->slice[a][i];
    double same = 0.0;
    for (size_t j = 0; j < seen->size[a]; j++)
      same += memcmp(slice, &seen->slice[a][j], sizeof *slice) == 0;
    sum += (double)(slice->face[b] + slice->face[c]) * fmax(same, run);
  }
  if (faces[b] > 0.0 && is_own_image(seen, b, b)) images *= 2.0;
  if (faces[c] > 0.0 && is_own_image(seen, c, c)) images *= 2.0;
  if (faces[b] > 0.0 && faces[c] > 0.0 && is_own_image(seen, b, c)) images *= sqrt(2.0);
  return OVAL * M_PI / 4.0 * sum * images; /* a perimeter is pi / 4 of the faces (Cauchy) */
}

enum status label_volume_error(const uint8_t *grain, const size_t size[3], const bool reflect[3],
                               double *error) {
  enum status status = STATUS_OK;
  struct labels_seen seen = {.grain = grain, .size = size};
  double faces[3] = {0}, most = 0.0;
  int axes = 0;
  *error = NAN;
  for (int a = 0; a < 3; a++)
    TRY(memory_allocate(&seen.slice[a], size[a], sizeof *seen.slice[a], "slices"));
  count(&seen, reflect);
  for (int a = 0; a < 3; a++) {
    const int across = a == 0 ? 1 : 0;
    for (size_t i = 0; i < size[across]; i++) faces[a] += (double)seen.slice[across][i].face[a];
    axes += faces[a] > 0.0;
  }
  for (int a = 0; a < 3 && axes > 1; a++) most = fmax(most, variance(&seen, faces, a));
  *error = sqrt(most) / ((double)size[0] * (double)size[1] * (double)size[2]);
cleanup:
  for (int a = 0; a < 3; a++) memory_free(&seen.slice[a]);
  return status;
}
