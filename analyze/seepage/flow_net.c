#include "analyze/seepage/flow_net.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* The velocities of a mean over particles are no perfect curl: psi is the one whose differences
 * between the corners of the cells are the fluxes through their faces as nearly as can be (least
 * squares), with none through walls and closed sides. Its normal equations are Laplace's on the
 * graph of the corners. Free water takes no part: it moves about by more than what seeps. */

/* A face between two corners: flux psi[to] - psi[from]; weight 0 where it is not known. */
struct face {
  double flux, weight;
};

struct net {
  const struct head_field *field;
  size_t nx, nz;       /* corners */
  struct face *upward; /* from corner (i, k) to (i, k+1): through it flows u dz */
  struct face *along;  /* from (i, k) to (i+1, k): -w dx */
};

static bool is_open(const struct head_field *f, double x, double z) {
  const double near = 1e-3 * fmin(f->dx, f->dz);
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *g = &f->regions[r];
    if (!strcmp(g->type, "inflow") && x >= g->low[0] - near && x <= g->high[0] + near &&
        z >= g->low[1] - near && z <= g->high[1] + near)
      return true;
  }
  return false;
}

/* Between cell a and cell b, SIZE_MAX beyond a side; `open`: that side is. */
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

static void find_faces(struct net *net) {
  const struct head_field *f = net->field;
  for (size_t k = 0; k < net->nz; k++)
    for (size_t i = 0; i < net->nx; i++) {
      const size_t c = k * net->nx + i;
      const double x = (double)i * f->dx, z = (double)k * f->dz;
      if (k < f->nz)
        net->upward[c] =
            face_of(f, i > 0 ? k * f->nx + i - 1 : SIZE_MAX, i < f->nx ? k * f->nx + i : SIZE_MAX,
                    0, is_open(f, x, z + 0.5 * f->dz), f->dz);
      if (i < f->nx)
        net->along[c] =
            face_of(f, k > 0 ? (k - 1) * f->nx + i : SIZE_MAX, k < f->nz ? k * f->nx + i : SIZE_MAX,
                    1, is_open(f, x + 0.5 * f->dx, z), -f->dx);
    }
}

/* y = A x, or with x NULL the right-hand side; the diagonal beside. */
static void apply(const struct net *net, const double *x, double *y, double *diagonal) {
  const size_t n = net->nx * net->nz;
  memset(y, 0, n * sizeof *y);
  if (diagonal != NULL) memset(diagonal, 0, n * sizeof *diagonal);
  for (size_t c = 0; c < n; c++)
    for (int s = 0; s < 2; s++) {
      const struct face *face = s == 0 ? &net->upward[c] : &net->along[c];
      const size_t to = c + (s == 0 ? net->nx : 1);
      if (!(face->weight > 0)) continue;
      const double d = x == NULL ? face->flux : x[to] - x[c];
      y[to] += d, y[c] -= d;
      if (diagonal != NULL) diagonal[to] += 1, diagonal[c] += 1;
    }
}

static double dot(const double *a, const double *b, size_t n) {
  double sum = 0;
  for (size_t c = 0; c < n; c++) sum += a[c] * b[c];
  return sum;
}

/* Conjugate gradients; constants lie in the null space and in no residual. */
static enum status solve(const struct net *net, double *psi) {
  enum status status = STATUS_OK;
  const size_t n = net->nx * net->nz;
  double *r = NULL, *p = NULL, *q = NULL, *diagonal = NULL;
  TRY(memory_allocate(&r, n, sizeof *r, "the stream function"));
  TRY(memory_allocate(&p, n, sizeof *p, "the stream function"));
  TRY(memory_allocate(&q, n, sizeof *q, "the stream function"));
  TRY(memory_allocate(&diagonal, n, sizeof *diagonal, "the stream function"));
  apply(net, NULL, r, diagonal);
  double first = 0, rz = 0;
  for (size_t c = 0; c < n; c++) p[c] = diagonal[c] > 0 ? r[c] / diagonal[c] : 0;
  rz = first = dot(r, p, n);
  for (size_t step = 0; rz > 1e-16 * first && step < 20 * (net->nx + net->nz); step++) {
    apply(net, p, q, NULL);
    const double alpha = rz / dot(p, q, n);
    double next = 0;
    for (size_t c = 0; c < n; c++) {
      psi[c] += alpha * p[c], r[c] -= alpha * q[c];
      if (diagonal[c] > 0) next += r[c] * r[c] / diagonal[c];
    }
    for (size_t c = 0; c < n; c++)
      p[c] = (diagonal[c] > 0 ? r[c] / diagonal[c] : 0) + next / rz * p[c];
    rz = next;
  }
cleanup:
  memory_free(&r);
  memory_free(&p);
  memory_free(&q);
  memory_free(&diagonal);
  return status;
}

/* Corners with wet soil beside them. */
static bool is_wet(const struct head_field *f, size_t i, size_t k) {
  for (size_t b = k > 0 ? k - 1 : 0; b <= k && b < f->nz; b++)
    for (size_t a = i > 0 ? i - 1 : 0; a <= i && a < f->nx; a++)
      if (f->soil[b * f->nx + a] != REGION_NONE && !isnan(f->head[b * f->nx + a])) return true;
  return false;
}

enum status flow_net_stream(const struct head_field *f, double **psi) {
  enum status status = STATUS_OK;
  struct net net = {.field = f, .nx = f->nx + 1, .nz = f->nz + 1};
  const size_t n = net.nx * net.nz;
  double least = INFINITY;
  TRY(memory_allocate(&net.upward, n, sizeof *net.upward, "the stream function"));
  TRY(memory_allocate(&net.along, n, sizeof *net.along, "the stream function"));
  TRY(memory_allocate(psi, n, sizeof **psi, "the stream function"));
  find_faces(&net);
  TRY(solve(&net, *psi));
  for (size_t c = 0; c < n; c++) {
    if (!is_wet(f, c % net.nx, c / net.nx)) (*psi)[c] = NAN;
    least = fmin(least, (*psi)[c]);
  }
  for (size_t c = 0; c < n; c++) (*psi)[c] -= least;
cleanup:
  memory_free(&net.upward);
  memory_free(&net.along);
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
      for (int c = 0; c + 1 < n; c += 2) /* a saddle has two pieces */
        fprintf(stream, "%.6g %.6g\n%.6g %.6g\n\n", at[c][0], at[c][1], at[c + 1][0], at[c + 1][1]);
    }
}
