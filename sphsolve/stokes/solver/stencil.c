#include "sphsolve/stokes/solver/stencil.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/stokes/effects/pressure.h"
#include "sphsolve/stokes/effects/viscosity.h"

/* Solves the n x n system m x = 1 (n <= 3) by Gauss elimination; the moments are positive. */
static void solve_ones(int n, double m[3][3], double x[3]) {
  for (int i = 0; i < n; i++) x[i] = 1.0;
  for (int i = 0; i < n; i++)
    for (int r = i + 1; r < n; r++) {
      const double f = m[r][i] / m[i][i];
      for (int c = i; c < n; c++) m[r][c] -= f * m[i][c];
      x[r] -= f * x[i];
    }
  for (int i = n - 1; i >= 0; i--) {
    for (int c = i + 1; c < n; c++) x[i] -= m[i][c] * x[c];
    x[i] /= m[i][i];
  }
}

/* Coefficients: c = -2 V (1/r) dW/dr, Morris, Fox, Zhu 1997 eq. 22; gradient V dW/dr e. The viscous
 * lattice sums are scaled axis by axis so that the operator is exact for a quadratic velocity on
 * this lattice, cubic or not; the gradient has its own correction. */
static void scale_moments(struct stokes_stencil *s) {
  double second[3][3] = {{0}}, scale[3];
  for (int o = 0; o < s->offset_count; o++) {
    const struct stokes_offset *offset = &s->offsets[o];
    for (int a = 0; a < s->axis_count; a++) {
      const double x = offset->step[s->axes[a]] * s->spacing[s->axes[a]];
      for (int b = 0; b < s->axis_count; b++) {
        const double y = offset->step[s->axes[b]] * s->spacing[s->axes[b]] / offset->r;
        second[a][b] += 0.5 * offset->viscous * x * x * y * y;
      }
    }
  }
  solve_ones(s->axis_count, second, scale);
  for (int o = 0; o < s->offset_count; o++) {
    struct stokes_offset *offset = &s->offsets[o];
    double factor = 0.0;
    for (int a = 0; a < s->axis_count; a++) {
      const double e = offset->step[s->axes[a]] * s->spacing[s->axes[a]] / offset->r;
      factor += scale[a] * e * e;
    }
    offset->viscous *= factor;
  }
}

/* `axis` < 0: the viscous coefficients, even in all directions; otherwise those of the gradient
 * along it. */
static void build_convolution(const struct stokes_stencil *s, int axis,
                              struct stokes_convolution *convolution) {
  memset(convolution, 0, sizeof *convolution);
  convolution->odd_x = axis == 0;
  int index[STOKES_REACH + 1][STOKES_REACH + 1];
  memset(index, -1, sizeof index);
  for (int o = 0; o < s->offset_count; o++) {
    const struct stokes_offset *offset = &s->offsets[o];
    const int i = offset->step[0], j = offset->step[1], k = offset->step[2];
    if (i < 0 || j < 0 || k < 0) continue;
    const double value = axis < 0 ? offset->viscous : offset->gradient[axis];
    if (value == 0.0) continue;
    if (index[j][k] < 0) {
      index[j][k] = convolution->class_count++;
      struct stokes_class *class = &convolution->classes[index[j][k]];
      for (int pass = 0; pass < 2; pass++) { /* added rows first, then subtracted ones */
        for (int sj = j ? 1 : 0; sj >= (j ? -1 : 0); sj -= 2)
          for (int sk = k ? 1 : 0; sk >= (k ? -1 : 0); sk -= 2) {
            const bool minus = (axis == 1 && sj < 0) || (axis == 2 && sk < 0);
            if (minus != (pass == 1)) continue;
            class->dj[class->row_count] = sj * j;
            class->dk[class->row_count++] = sk * k;
            class->plus_count += !minus;
          }
      }
    }
    struct stokes_class *class = &convolution->classes[index[j][k]];
    class->c_double[i] = value;
    class->c[i] = (float)value;
    if (i > convolution->reach) convolution->reach = i;
  }
}

enum status stokes_stencil_build(int dimensions, const double spacing[3], enum kernel kernel,
                                 double support, struct stokes_stencil *s) {
  enum status status = STATUS_OK;
  memset(s, 0, sizeof *s);
  s->axis_count = dimensions;
  s->axes[0] = 0, s->axes[1] = dimensions == 2 ? 2 : 1, s->axes[2] = 2;
  s->unit =
      dimensions == 2 ? sqrt(spacing[0] * spacing[2]) : cbrt(spacing[0] * spacing[1] * spacing[2]);
  int reach[3] = {0};
  for (int a = 0; a < dimensions; a++) {
    const int x = s->axes[a];
    s->spacing[x] = spacing[x] / s->unit;
    if (!(support >= 1.5 * spacing[x]) || !(support < (STOKES_REACH + 1) * spacing[x]))
      return FAIL(STATUS_INPUT,
                  "stokes.support: %g m is %.2f spacings along %c; choose one between 1.5 and %d "
                  "spacings in every direction",
                  support, support / spacing[x], "xyz"[x], STOKES_REACH);
    reach[x] = (int)(support / spacing[x]);
  }
  TRY(memory_allocate(&s->offsets, STOKES_OFFSET_MAX, sizeof *s->offsets, "a stencil"));
  const double radius = support / s->unit, h = radius / kernel_support_ratio(kernel);
  s->smoothing_length = h;
  for (int k = -reach[2]; k <= reach[2]; k++)
    for (int j = -reach[1]; j <= reach[1]; j++)
      for (int i = -reach[0]; i <= reach[0]; i++) {
        const double x[3] = {i * s->spacing[0], j * s->spacing[1], k * s->spacing[2]};
        const double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        if (r == 0.0 || r >= radius) continue;
        struct stokes_offset *offset = &s->offsets[s->offset_count++];
        const double dw = kernel_dw(kernel, dimensions, r, h);
        offset->step[0] = i, offset->step[1] = j, offset->step[2] = k;
        offset->r = r;
        offset->weight = kernel_w(kernel, dimensions, r, h);
        offset->viscous = stokes_viscosity_pair(r, dw);
        for (int a = 0; a < 3; a++) offset->gradient[a] = stokes_pressure_pair(r, dw) * x[a];
      }
  scale_moments(s);
  build_convolution(s, -1, &s->laplace);
  for (int a = 0; a < dimensions; a++) build_convolution(s, s->axes[a], &s->gradient[s->axes[a]]);
cleanup:
  return status;
}

void stokes_stencil_free(struct stokes_stencil *s) {
  memory_free(&s->offsets);
}

double stokes_stencil_moment(const struct stokes_stencil *s) {
  double sum = 0.0;
  for (int o = 0; o < s->offset_count; o++)
    for (int a = 0; a < s->axis_count; a++)
      sum += s->offsets[o].gradient[s->axes[a]] * s->offsets[o].step[s->axes[a]] *
             s->spacing[s->axes[a]];
  return sum / s->axis_count;
}

double stokes_support(const struct scene *scene, double spacing) {
  if (!isnan(scene->stokes.support)) return scene->stokes.support / spacing;
  return scene->stokes.kernel == KERNEL_QUINTIC ? SUPPORT_QUINTIC : SUPPORT_CUBIC;
}
