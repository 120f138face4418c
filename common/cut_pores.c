#include "common/cut_pores.h"

/* Voxels in which layers i and j along an axis differ; `pores`: those of both. */
static size_t unlike_voxels(const struct voxel_model *model, int axis, size_t i, size_t j,
                            size_t *pores) {
  const size_t *n = model->size, step[3] = {1, n[0], n[0] * n[1]};
  const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
  size_t unlike = 0;
  *pores = 0;
  for (size_t v = 0; v < n[b]; v++)
    for (size_t u = 0; u < n[a]; u++) {
      const uint8_t *at = model->solid + u * step[a] + v * step[b];
      const bool one = at[i * step[axis]] != 0, other = at[j * step[axis]] != 0;
      unlike += one != other;
      *pores += (size_t)!one + (size_t)!other;
    }
  return unlike;
}

/* Layers of one body change by as much from one to the next; half as much again is for chance. */
#define CHANGE_SPARE 1.5

double model_cut_pores(const struct voxel_model *model, int axis) {
  const size_t n = model->size[axis];
  size_t pores, most = 0;
  for (size_t i = 0; i + 1 < n; i++) {
    const size_t unlike = unlike_voxels(model, axis, i, i + 1, &pores);
    if (unlike > most) most = unlike;
  }
  const size_t round = n > 1 ? unlike_voxels(model, axis, n - 1, 0, &pores) : 0;
  return (double)round > CHANGE_SPARE * (double)most ? (double)round / (double)pores : 0.0;
}

bool model_repeats(const struct voxel_model *model, int axis, size_t layers) {
  size_t pores, most = 0, change = 0, image = 0;
  for (size_t i = 0; i + 1 < layers; i++) {
    const size_t unlike = unlike_voxels(model, axis, i, i + 1, &pores);
    if (unlike > most) most = unlike;
    change += unlike;
    image += unlike_voxels(model, axis, i, layers - 1 - i, &pores);
  }
  if (image <= change) return false;
  const size_t round = unlike_voxels(model, axis, layers - 1, 0, &pores);
  /* Layers that know nothing of each other differ in 2 phi (1 - phi) of their voxels. */
  const double area = (double)model_site_count(model) / (double)model->size[axis];
  const double phi = 0.5 * (double)pores / area;
  return (double)round <= CHANGE_SPARE * (double)most && (double)round < phi * (1.0 - phi) * area;
}
