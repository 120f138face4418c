/* The SPH operators of the steady Stokes system as one stencil: on a lattice the neighbours of
 * every site lie at the same offsets. Lengths are in units of the geometric mean spacing. */
#ifndef TOSUI_SPHSOLVE_STOKES_STENCIL_H
#define TOSUI_SPHSOLVE_STOKES_STENCIL_H

#include "common/error.h"
#include "common/kernel.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/stokes/solver/rows.h"

#define STOKES_OFFSET_MAX ((2 * STOKES_REACH + 1) * (2 * STOKES_REACH + 1) * (2 * STOKES_REACH + 1))

struct stokes_offset {
  int step[3];
  double r;           /* distance */
  double viscous;     /* c_ab: (A v)_a = sum_b c_ab (v_a - v_b) */
  double weight;      /* W */
  double gradient[3]; /* g_ab: (G p)_a = sum_b g_ab (p_b - p_a) */
};

struct stokes_stencil {
  int axis_count, axes[3]; /* 3: x, y, z; 2: x, z */
  double unit;             /* m, geometric mean spacing */
  double spacing[3];       /* in units */
  double smoothing_length; /* in units */
  int offset_count;
  struct stokes_offset *offsets;         /* [STOKES_OFFSET_MAX] */
  struct stokes_convolution laplace;     /* sum_b c_ab u_b */
  struct stokes_convolution gradient[3]; /* sum_b g_ab u_b, by axis */
};

/* Support of the kernel of method stokes, in spacings, for a scene with sites `spacing` (m)
 * apart. */
double stokes_support(const struct scene *scene, double spacing);

/* Mean over the axes of the sum of g_ab r_ab: 1 up to the discretisation error of the kernel's
 * sums. */
double stokes_stencil_moment(const struct stokes_stencil *stencil);

/* Builds the stencil of a kernel with that support (m) at sites `spacing` (m) apart. A support of
 * more than STOKES_REACH sites along an axis is an input error. Free with stokes_stencil_free. */
enum status stokes_stencil_build(int dimensions, const double spacing[3], enum kernel kernel,
                                 double support, struct stokes_stencil *stencil);
void stokes_stencil_free(struct stokes_stencil *stencil);

#endif
