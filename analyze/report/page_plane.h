/* A plane through the middle of a body: velocity, pressure and distance to the grains at the
 * lattice points in it, and between them. Lengths in spacings: point (i, j) lies at (i, j). */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_PLANE_H
#define TOSUI_ANALYZE_REPORT_PAGE_PLANE_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"
#include "common/model_file.h"

struct plane {
  int axis, across, up; /* normal; horizontal; vertical, along the force */
  size_t size[2];
  double spacing[2], at; /* m; place of the plane along its normal */
  float *distance;       /* [size] in spacings, positive in pores */
  float *velocity;       /* [size][2] m/s in the plane */
  float *speed;          /* [size] m/s */
  float *pressure; /* [size] Pa about its mean, carried on into the grains; NULL: not stored */
  float *soil;     /* [size] 1 in soil with pores below the sites, else 0; NULL: there is none */
  double speed_high, pressure_high; /* 98th percentiles of the pores; colours end there */
};

/* Of a run in three dimensions; `model` as its file has it, without arrays where that could not be
 * read. Free with plane_free. */
enum status plane_read(const struct run *run, const struct particles *particles,
                       const struct voxel_model *model, struct plane *plane);
void plane_free(struct plane *plane);

/* Cubic (Catmull, Rom 1974) for the distance, so that outlines are smooth; linear for the others.
 * `components` values a point, the c-th. */
double plane_cubic(const struct plane *plane, const float *field, double x, double y);
double plane_linear(const struct plane *plane, const float *field, int components, int c, double x,
                    double y);

#endif
