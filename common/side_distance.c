#include "common/side_distance.h"

#include <math.h>

#include "common/constants.h"

/* Distance from a voxel centre to the nearer of the two outermost layers of centres; for a voxel in
 * one of them, to the other one. */
static double distance_to_side(size_t i, size_t n, double spacing) {
  if (i == 0 || i + 1 == n) return spacing * (double)(n - 1);
  return spacing * (double)(i < n - 1 - i ? i : n - 1 - i);
}

/* For a voxel in an outermost layer: the distance within the layer to where its surface, taken as a
 * plane, meets the layer. The direction cosines of the surface normal along the outward axes follow
 * from the difference to the distance of the next voxel inside; they are negative if the surface
 * lies inside. INFINITY if it does not meet the layer nearby. */
static float distance_within_layer(const size_t n[3], const double spacing[3],
                                   const float *distance, const size_t at[3], const bool axes[3]) {
  const size_t step[3] = {1, n[0], n[0] * n[1]}, i = at[0] + n[0] * (at[1] + at[2] * n[1]);
  const double own = fabs((double)distance[i]);
  double outward = 0.0;
  for (int a = 0; a < 3; a++) {
    if (!axes[a] || n[a] < 3 || (at[a] > 0 && at[a] + 1 < n[a])) continue;
    const float next = distance[at[a] == 0 ? i + step[a] : i - step[a]];
    if ((next < 0.0f) != (distance[i] < 0.0f)) continue;
    const double cosine = fmin((fabs((double)next) - own) / spacing[a], 1.0);
    if (cosine > 0.0) outward += cosine * cosine;
  }
  const bool meets = outward < OUTWARD_COSINE_MAX * OUTWARD_COSINE_MAX;
  return copysignf(meets ? (float)(own / sqrt(1.0 - outward)) : INFINITY, distance[i]);
}

/* Distance of a voxel by its neighbours of the other phase, from the nearest: the surface lies
 * between the two centres. INFINITY if there is no such neighbour with a known distance. */
static float distance_from_neighbours(const size_t n[3], const double spacing[3],
                                      const float *distance, const size_t at[3]) {
  const size_t step[3] = {1, n[0], n[0] * n[1]};
  const size_t i = at[0] + at[1] * step[1] + at[2] * step[2];
  const float own = distance[i];
  float least = INFINITY;
  for (int a = 0; a < 3; a++)
    for (int side = -1; side <= 1; side += 2) {
      if (side < 0 ? at[a] == 0 : at[a] + 1 == n[a]) continue;
      const float other = distance[side < 0 ? i - step[a] : i + step[a]];
      if ((other < 0.0f) == (own < 0.0f) || !isfinite(other)) continue;
      const double left = spacing[a] - fabs((double)other);
      least = fminf(least, (float)fmax(left, SIDE_DISTANCE_MIN * spacing[a]));
    }
  return copysignf(least, own);
}

void side_distance_unwrap(const size_t n[3], const double spacing[3], const bool axes[3],
                          float *distance) {
  const size_t plane = n[0] * n[1];
  /* Pass 0 corrects the outermost layers and pass 1 the voxels next to the other phase, both while
   * neighbouring distances are still present; pass 2 marks the rest as unknown. Unknown values keep
   * the sign of their phase until the end. */
  for (int pass = 0; pass < 3; pass++)
    for (size_t i = 0; i < plane * n[2]; i++) {
      const size_t at[3] = {i % n[0], i / n[0] % n[1], i / plane};
      double reach = INFINITY;
      bool outermost = false;
      for (int a = 0; a < 3; a++) {
        if (!axes[a]) continue;
        outermost = outermost || at[a] == 0 || at[a] + 1 == n[a];
        reach = fmin(reach, distance_to_side(at[a], n[a], spacing[a]));
      }
      const bool beyond = fabs((double)distance[i]) > reach;
      if (!isfinite(distance[i]) || !(outermost || beyond)) continue;
      const float near = distance_from_neighbours(n, spacing, distance, at);
      if (pass == 0 && outermost && !beyond) {
        distance[i] = distance_within_layer(n, spacing, distance, at, axes);
        if (!isfinite(distance[i])) distance[i] = near;
      } else if (beyond && pass == (isfinite(near) ? 1 : 2) && fabsf(near) > fabsf(distance[i])) {
        distance[i] = near;
      }
    }
  for (size_t i = 0; i < plane * n[2]; i++)
    if (!isfinite(distance[i])) distance[i] = INFINITY;
}

/* Number of voxels in which layers i and j along an axis differ; *pores: number of pore voxels in
 * both together. */
static size_t differing_voxels(const struct voxel_model *model, int axis, size_t i, size_t j,
                               size_t *pores) {
  const size_t *n = model->size, step[3] = {1, n[0], n[0] * n[1]};
  const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
  size_t differing = 0;
  *pores = 0;
  for (size_t v = 0; v < n[b]; v++)
    for (size_t u = 0; u < n[a]; u++) {
      const uint8_t *at = model->solid + u * step[a] + v * step[b];
      const bool one = at[i * step[axis]] != 0, other = at[j * step[axis]] != 0;
      differing += one != other;
      *pores += (size_t)!one + (size_t)!other;
    }
  return differing;
}

/* Largest difference across the seam, over the largest between adjacent layers of the same body;
 * the excess over 1 allows for chance. */
#define SEAM_RATIO_MAX 1.5

double model_cut_pores(const struct voxel_model *model, int axis) {
  const size_t n = model->size[axis];
  size_t pores, most = 0;
  for (size_t i = 0; i + 1 < n; i++) {
    const size_t differing = differing_voxels(model, axis, i, i + 1, &pores);
    if (differing > most) most = differing;
  }
  const size_t seam = n > 1 ? differing_voxels(model, axis, n - 1, 0, &pores) : 0;
  return (double)seam > SEAM_RATIO_MAX * (double)most ? (double)seam / (double)pores : 0.0;
}

bool model_repeats(const struct voxel_model *model, int axis, size_t layers) {
  size_t pores, most = 0, change = 0, mirrored = 0;
  for (size_t i = 0; i + 1 < layers; i++) {
    const size_t differing = differing_voxels(model, axis, i, i + 1, &pores);
    if (differing > most) most = differing;
    change += differing;
    mirrored += differing_voxels(model, axis, i, layers - 1 - i, &pores);
  }
  if (mirrored <= change) return false;
  const size_t seam = differing_voxels(model, axis, layers - 1, 0, &pores);
  /* Independent layers of porosity phi differ in a share 2 phi (1 - phi) of their voxels. */
  const double area = (double)model_site_count(model) / (double)model->size[axis];
  const double phi = 0.5 * (double)pores / area;
  return (double)seam <= SEAM_RATIO_MAX * (double)most && (double)seam < phi * (1.0 - phi) * area;
}
