#include "common/cut_pores.h"

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
