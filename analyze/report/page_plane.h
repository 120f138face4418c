/* A plane through the middle of a body: velocity, pressure and distance to the grains at the
 * lattice points in it, and interpolated between them. Lengths in spacings: point (i, j) is at (i,
 * j). */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_PLANE_H
#define TOSUI_ANALYZE_REPORT_PAGE_PLANE_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"
#include "common/model_file.h"

struct plane {
  int axis, across, up; /* normal; horizontal; vertical, along the force */
  size_t size[2];
  double spacing[2], at; /* m; position of the plane along its normal */
  float *distance;       /* [size] in spacings, positive in pores */
  float *velocity;       /* [size][2] m/s in the plane */
  float *speed;          /* [size] m/s */
  /* [size] Pa relative to its mean, extrapolated into the grains; NULL: not stored. */
  float *pressure;
  /* [size] 1 in soil with pores below the site size, else 0; NULL without such soil. */
  float *soil;
  double speed_high, pressure_high; /* 98th percentiles in the pores, where the colour scales end */
};

/* Reads the plane of a three-dimensional run; `model` has no arrays if its file could not be read.
 * Free with plane_free. */
enum status plane_read(const struct run *run, const struct particles *particles,
                       const struct voxel_model *model, struct plane *plane);
void plane_free(struct plane *plane);

/* Interpolation at a position: cubic (Catmull, Rom 1974) for the distance, so that outlines are
 * smooth; linear for the others, with `components` values per point, of which the c-th is used. */
double plane_cubic(const struct plane *plane, const float *field, double x, double y);
double plane_linear(const struct plane *plane, const float *field, int components, int c, double x,
                    double y);

#endif
