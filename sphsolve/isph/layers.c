#include "sphsolve/isph/layers.h"

#include <math.h>
#include <string.h>

#include "sphsolve/isph/symmetric.h"

static const double unit[6] = {1, 0, 0, 1, 0, 1};

static const double *tensor_of(const struct region *soil) {
  return soil->anisotropic ? soil->anisotropy : unit;
}

void isph_layers_add(struct isph_layers *layers, double w, double a, const struct region *soil) {
  if (!(a > 0) || layers->count == ISPH_LAYERS) return;
  layers->at[layers->count].w = w;
  layers->at[layers->count].a = a;
  layers->at[layers->count++].soil = soil;
}

/* Effective drag tensor of layered soils. Soils that meet at a plane of normal n have the gradient
 * along it and the flux across it in common. With <> the mean weighted by the fractions,
 *   K = <K> - <K n n.K / n.K.n> + <K n / n.K.n> <n.K / n.K.n> / <1 / n.K.n>
 * (Backus 1962 in general form; for scalars these are Wiener's two means). Towards corners it goes
 * over to the geometric mean of the scalar mobilities times the mean of the relative tensors. */
void isph_layers_close(const struct isph_layers *layers, struct soil_point *soil) {
  const double *n = soil->normal;
  const bool meets = n[0] != 0 || n[1] != 0 || n[2] != 0;
  double whole = 0, level = 0, mean[6] = {0}, shape[6] = {0}, across = 0, ratio[3] = {0};
  memset(soil->tensor, 0, sizeof soil->tensor);
  for (size_t k = 0; k < layers->count; k++) whole += layers->at[k].w;
  if (!(whole > 0)) return;
  for (size_t k = 0; k < layers->count; k++) {
    const double *t = tensor_of(layers->at[k].soil);
    const double w = layers->at[k].w / whole, a = layers->at[k].a;
    double to[3];
    symmetric_times(t, n, to);
    const double normal = symmetric_along(t, n);
    level -= w * log(a);
    for (int b = 0, m = 0; b < 3; b++) {
      if (meets) ratio[b] += w * to[b] / normal;
      for (int c = b; c < 3; c++, m++) {
        shape[m] += w * t[m];
        mean[m] += w / a * (t[m] - (meets ? to[b] * to[c] / normal : 0));
      }
    }
    if (meets) across += w * a / normal;
  }
  for (int b = 0, m = 0; b < 3 && meets; b++)
    for (int c = b; c < 3; c++, m++) {
      mean[m] += ratio[b] * ratio[c] / across;
      mean[m] = soil->plane * mean[m] + (1 - soil->plane) * exp(level) * shape[m];
    }
  symmetric_inverse(mean, soil->tensor);
  for (int m = 0; m < 6; m++) soil->tensor[m] *= whole;
}
