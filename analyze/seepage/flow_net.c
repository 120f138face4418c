#include "analyze/seepage/flow_net.h"

#include <math.h>

#include "analyze/seepage/grid_laplace.h"
#include "common/memory.h"

/* Velocities averaged over particles are not exactly divergence-free. psi is the least squares
 * solution whose differences between the corners of the cells approximate the fluxes through their
 * faces, with no flux through walls and closed sides. Its normal equations are Laplace's equation
 * on the graph of the corners. Free water is excluded: its motion is larger than the seepage. */

/* A face between two corners: flux psi[to] - psi[from]; weight 0 if it is unknown. */
struct face {
  double flux, weight;
};

/* The face between cells a and b; SIZE_MAX is beyond the side of the domain, which may be
 * `open`. */
static struct face face_of(const struct head_field *f, size_t a, size_t b, int axis, bool open,
                           double scale) {
  double sum = 0;
  int n = 0;
  for (int s = 0; s < 2; s++) {
    const size_t c = s == 0 ? a : b;
    if (c == SIZE_MAX) {
      if (!open) return (struct face){0, 1};
      continue;
    }
    if (f->wall[c] != REGION_NONE) return (struct face){0, 1};
    if (f->soil[c] == REGION_NONE || isnan(f->velocity[axis][c])) continue;
    sum += f->velocity[axis][c], n++;
  }
  return (struct face){n > 0 ? scale * sum / n : 0, n > 0};
}

/* Enters the fluxes through the faces as sources of the grid of corners. The edge upwards from
 * corner (i, k) has the flux u dz, that along the row -w dx. */
static void find_faces(const struct head_field *f, struct grid_laplace *net) {
  for (size_t k = 0; k < net->nz; k++)
    for (size_t i = 0; i < net->nx; i++) {
      const size_t c = k * net->nx + i;
      const double x = (double)i * f->dx, z = (double)k * f->dz;
      if (k < f->nz) {
        const struct face face =
            face_of(f, i > 0 ? k * f->nx + i - 1 : SIZE_MAX, i < f->nx ? k * f->nx + i : SIZE_MAX,
                    0, head_field_is_open(f, x, z + 0.5 * f->dz), f->dz);
        net->upward[c] = face.weight;
        net->source[c + net->nx] += face.flux, net->source[c] -= face.flux;
      }
      if (i < f->nx) {
        const struct face face =
            face_of(f, k > 0 ? (k - 1) * f->nx + i : SIZE_MAX, k < f->nz ? k * f->nx + i : SIZE_MAX,
                    1, head_field_is_open(f, x + 0.5 * f->dx, z), -f->dx);
        net->along[c] = face.weight;
        net->source[c + 1] += face.flux, net->source[c] -= face.flux;
      }
    }
}

/* Whether a corner has wet soil beside it. */
static bool is_wet(const struct head_field *f, size_t i, size_t k) {
  for (size_t b = k > 0 ? k - 1 : 0; b <= k && b < f->nz; b++)
    for (size_t a = i > 0 ? i - 1 : 0; a <= i && a < f->nx; a++)
      if (f->soil[b * f->nx + a] != REGION_NONE && !isnan(f->head[b * f->nx + a])) return true;
  return false;
}

enum status flow_net_stream(const struct head_field *f, double **psi) {
  enum status status = STATUS_OK;
  struct grid_laplace net = {0};
  const size_t n = (f->nx + 1) * (f->nz + 1);
  double least = INFINITY;
  TRY(memory_allocate(psi, n, sizeof **psi, "the stream function"));
  TRY(grid_laplace_create(f->nx + 1, f->nz + 1, &net));
  find_faces(f, &net);
  TRY(grid_laplace_solve(&net, 1e-8, *psi));
  for (size_t c = 0; c < n; c++) {
    if (!is_wet(f, c % net.nx, c / net.nx)) (*psi)[c] = NAN;
    least = fmin(least, (*psi)[c]);
  }
  for (size_t c = 0; c < n; c++) (*psi)[c] -= least;
cleanup:
  grid_laplace_free(&net);
  if (status != STATUS_OK) memory_free(psi);
  return status;
}

void flow_net_contour(const double *values, size_t nx, size_t nz, double dx, double dz,
                      double offset, double level, FILE *stream) {
  static const int corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  for (size_t k = 0; k + 1 < nz; k++)
    for (size_t i = 0; i + 1 < nx; i++) {
      double v[5], at[4][2];
      int n = 0;
      for (int c = 0; c < 5; c++)
        v[c] = values[(k + (size_t)corner[c][1]) * nx + i + (size_t)corner[c][0]];
      if (isnan(v[0] + v[1] + v[2] + v[3])) continue;
      for (int c = 0; c < 4; c++) {
        if ((v[c] < level) == (v[c + 1] < level)) continue;
        const double t = (level - v[c]) / (v[c + 1] - v[c]);
        at[n][0] = ((double)i + offset + corner[c][0] + t * (corner[c + 1][0] - corner[c][0])) * dx;
        at[n][1] = ((double)k + offset + corner[c][1] + t * (corner[c + 1][1] - corner[c][1])) * dz;
        n++;
      }
      for (int c = 0; c + 1 < n; c += 2) /* a saddle has two segments */
        fprintf(stream, "%.6g %.6g\n%.6g %.6g\n\n", at[c][0], at[c][1], at[c + 1][0], at[c + 1][1]);
    }
}
