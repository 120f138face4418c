/* The number of lattice points in a body at a random position has the body's area as its mean and a
 * variance of 0.0728 times its perimeter, in lattice spacings (Kendall 1948, Q. J. Math. 19: for
 * smooth ovals, averaged over all orientations). This holds for each slice of a body across an
 * axis. How many slices have the same error is estimated from the labels:
 *
 * - A wall along the axis is the same in all slices, one across it is different in each. With F
 * faces between labels along the axis, and G along the other two axes, errors agree over
 * G / (1.7 F) slices. For isotropic surfaces F / G is a half, and the variance of the volume is
 * then 0.067 times the surface, as for smooth bodies in three dimensions.
 * - Slices with equal numbers of voxels and of faces are repetitions, shifted or mirrored, with the
 * same error.
 * - Halves of a slice that are mirror images of each other have the same error.
 *
 * With many grains the errors average out; for a single pore across a small image they are some per
 * cent. Labels that change along one axis only are layers drawn on the faces of voxels, and have
 * exactly the width drawn. */
#include "ct2model/scan/label_volume.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

static const double VARIANCE_PER_PERIMETER = 0.0728;
/* Chosen such that 0.0728 (pi / 4) 2 / 1.7 = 0.067. */
static const double FACE_RATIO_FACTOR = 1.7;

/* A slice across an axis: its voxels of grain, and its faces between labels along the two other
 * axes. */
struct slice {
  uint64_t grain, face[3];
};

struct label_slices {
  const uint8_t *grain;
  const size_t *size;
  struct slice *slice[3];
};

static bool is_grain(const struct label_slices *seen, const size_t place[3]) {
  return seen->grain[(place[2] * seen->size[1] + place[1]) * seen->size[0] + place[0]] != 0;
}

static void count_faces(const struct label_slices *seen, const bool reflect[3]) {
  const size_t *n = seen->size;
  size_t place[3];
  for (place[2] = 0; place[2] < n[2]; place[2]++)
    for (place[1] = 0; place[1] < n[1]; place[1]++)
      for (place[0] = 0; place[0] < n[0]; place[0]++) {
        const bool grain = is_grain(seen, place);
        for (int a = 0; a < 3; a++) {
          seen->slice[a][place[a]].grain += grain;
          if (place[a] + 1 == n[a] && reflect[a]) continue;
          size_t next[3] = {place[0], place[1], place[2]};
          next[a] = place[a] + 1 < n[a] ? place[a] + 1 : 0;
          if (is_grain(seen, next) == grain) continue;
          for (int s = 0; s < 3; s++)
            if (s != a) seen->slice[s][place[s]].face[a]++;
        }
      }
}

/* Whether mirroring axis b or, if b != c, exchanging axes b and c, changes no voxel. */
static bool is_symmetric(const struct label_slices *seen, int b, int c) {
  const size_t *n = seen->size;
  size_t place[3];
  if (n[b] != n[c]) return false;
  for (place[2] = 0; place[2] < n[2]; place[2]++)
    for (place[1] = 0; place[1] < n[1]; place[1]++)
      for (place[0] = 0; place[0] < n[0]; place[0]++) {
        size_t image[3] = {place[0], place[1], place[2]};
        image[b] = b == c ? n[b] - 1 - place[b] : place[c];
        if (b != c) image[c] = place[b];
        if (is_grain(seen, image) != is_grain(seen, place)) return false;
      }
  return true;
}

/* Variance of the number of voxels by the slices across axis a. `faces`: number of faces between
 * labels along each axis. */
static double variance(const struct label_slices *seen, const double faces[3], int a) {
  const int b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;
  const double run = fmin((double)seen->size[a],
                          fmax(1.0, (faces[b] + faces[c]) / (FACE_RATIO_FACTOR * faces[a])));
  double sum = 0.0, images = 1.0;
  for (size_t i = 0; i < seen->size[a]; i++) {
    const struct slice *slice = &seen->slice[a][i];
    double same = 0.0;
    for (size_t j = 0; j < seen->size[a]; j++)
      same += memcmp(slice, &seen->slice[a][j], sizeof *slice) == 0;
    sum += (double)(slice->face[b] + slice->face[c]) * fmax(same, run);
  }
  if (faces[b] > 0.0 && is_symmetric(seen, b, b)) images *= 2.0;
  if (faces[c] > 0.0 && is_symmetric(seen, c, c)) images *= 2.0;
  if (faces[b] > 0.0 && faces[c] > 0.0 && is_symmetric(seen, b, c)) images *= sqrt(2.0);
  return VARIANCE_PER_PERIMETER * M_PI / 4.0 * sum * images; /* by Cauchy, a perimeter is pi / 4 of
                                                                the faces */
}

enum status label_volume_error(const uint8_t *grain, const size_t size[3], const bool reflect[3],
                               double *error) {
  enum status status = STATUS_OK;
  struct label_slices seen = {.grain = grain, .size = size};
  double faces[3] = {0}, most = 0.0;
  int axes = 0;
  *error = NAN;
  for (int a = 0; a < 3; a++)
    TRY(memory_allocate(&seen.slice[a], size[a], sizeof *seen.slice[a], "slices"));
  count_faces(&seen, reflect);
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
