#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/snapshot_file.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/flow_cells.h"
#include "sphsolve/solute/constants.h"

/* Volume fluxes through faces from the velocities of sites. Between two sites in the fluid the
 * velocity of a face is their mean. Near the wall the velocity decreases to 0 with the wall
 * distance d: there u / d varies slowly, and the flux is u / d times the integral of the distance
 * over the open part of the face. */

/* Mean of u / d, 1/s, over the two sites at the face; if both are too near the wall, over those
 * around. */
static double slope(const struct solute_flow *f, const float *sites, const int x[3], int axis) {
  const double near = FACE_DISTANCE_MIN * f->spacing[axis];
  for (int ring = 0; ring < 2; ring++) {
    double sum = 0, weights = 0;
    for (int s = 0; s < (ring ? 18 : 2); s++) {
      int at[3] = {x[0], x[1], x[2]};
      at[axis] -= s % 2;
      at[(axis + 1) % 3] += ring ? s / 2 % 3 - 1 : 0;
      at[(axis + 2) % 3] += ring ? s / 6 - 1 : 0;
      const size_t site = solute_flow_at(f, at[0], at[1], at[2]);
      const double d = (double)f->distance[site];
      if (!(d > near)) continue;
      sum += (double)sites[3 * site + (size_t)axis];
      weights += d;
    }
    if (weights > 0) return sum / weights;
  }
  return 0;
}

/* Velocity of a site along the axis, averaged over the cross-section of its cell: the site value
 * plus h^2/24 times the second derivatives across the axis (without this term the mean of a
 * parabola over N sites has an error of 1/(2 N^2)). If a site beside it is in grain, the parabola
 * is 0 at the wall between the two. */
static double site_mean(const struct solute_flow *f, const float *sites, const int x[3], int axis) {
  const size_t a = (size_t)axis, at = solute_flow_at(f, x[0], x[1], x[2]);
  const double u = (double)sites[3 * at + a], d = (double)f->distance[at];
  double mean = u;
  for (int t = 1; t < 3; t++) {
    double change[2], apart[2]; /* of velocity, and distance in spacings, to the sites beside it */
    for (int side = 0; side < 2; side++) {
      int y[3] = {x[0], x[1], x[2]};
      y[(axis + t) % 3] += side ? 1 : -1;
      const size_t there = solute_flow_at(f, y[0], y[1], y[2]);
      const double other = (double)f->distance[there];
      apart[side] = other > 0 ? 1 : fmax(d / (d - other), FACE_DISTANCE_MIN);
      change[side] = (other > 0 ? (double)sites[3 * there + a] : 0) - u;
    }
    mean += 2 * (change[0] / apart[0] + change[1] / apart[1]) / (apart[0] + apart[1]) / 24;
  }
  return mean;
}

static double face_flux(const struct solute_flow *f, const float *sites, const int x[3], int axis) {
  int low[3] = {x[0], x[1], x[2]};
  low[axis]--;
  const size_t here = solute_flow_at(f, x[0], x[1], x[2]),
               there = solute_flow_at(f, low[0], low[1], low[2]);
  const double open = (double)f->aperture[axis][here];
  const double d = 0.5 * ((double)f->distance[here] + (double)f->distance[there]);
  if (!(open > 0)) return 0;
  if (open >= 1 && f->distance[here] > 0 && f->distance[there] > 0)
    return 0.5 * (site_mean(f, sites, x, axis) + site_mean(f, sites, low, axis));
  double m[2], area, moment;
  for (int t = 0; t < 2; t++) {
    const int across = (axis + 1 + t) % 3;
    double sum = 0;
    for (int side = 0; side < 2; side++) {
      int up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
      up[axis] -= side, down[axis] -= side;
      up[across]++, down[across]--;
      sum += (double)f->distance[solute_flow_at(f, up[0], up[1], up[2])] -
             (double)f->distance[solute_flow_at(f, down[0], down[1], down[2])];
    }
    m[t] = 0.25 * sum;
  }
  solute_face_open(d, m[0], m[1], &area, &moment);
  return slope(f, sites, x, axis) * moment;
}

/* Sets the face fluxes from site velocities, [nz][ny][nx][3], m/s, 0 in walls. */
static void solute_flow_fluxes(struct solute_flow *f, const float *sites) {
#pragma omp parallel for schedule(static)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const int x[3] = {i, j, k};
        for (int a = 0; a < 3; a++)
          f->velocity[a][solute_flow_at(f, i, j, k)] = (float)face_flux(f, sites, x, a);
      }
}

#define IMAGE "/VTKHDF/PointData/"

/* Reads the record of the run, and checks that its flow can carry a solute. */
static enum status read_record(const char *path, struct solute_flow *f, uint64_t *flow) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  char *method = NULL;
  TRY(h5_open(path, &file));
  if (!h5_exists(file, "/run") || !h5_attribute_exists(file, "/run", "method"))
    TRY_FAIL(STATUS_INPUT, "%s: no record of a run; give the OUT.hdf that sphsolve run leaves",
             path);
  TRY(h5_read_attribute_text(file, "/run", "method", &method));
  if (strcmp(method, "stokes") != 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: a run of method %s; a solute is carried by the flow of method stokes, on its "
             "lattice: run the flow again with --set 'scene.method=\"stokes\"'",
             path, method);
  /* In such soil a solute has a different porosity and diffusion coefficient than in open pores. */
  if (h5_exists(file, "/run/micro"))
    TRY_FAIL(STATUS_INPUT,
             "%s: the flow goes through soil with pores below the voxel, in which method solute "
             "cannot follow a solute; build the model with that soil as grain or as pore",
             path);
  f->viscosity = h5_attribute_or_nan(file, "/run", "viscosity");
  f->density = h5_attribute_or_nan(file, "/run", "density");
  *flow = flow_hash_read(file, "/run");
cleanup:
  memory_free(&method);
  h5_close(file);
  return status;
}

/* Closes the faces that thin walls close. */
static enum status close_thin_walls(struct h5_file *file, struct solute_flow *f) {
  enum status status = STATUS_OK;
  uint8_t *cut = NULL;
  size_t size[3], at = 0;
  if (!h5_exists(file, IMAGE "thin_walls")) return STATUS_OK;
  TRY(h5_read(file, IMAGE "thin_walls", H5_U8, 3, size, &cut));
  for (int a = 0; a < 3; a++)
    if (size[a] != (size_t)f->n[2 - a])
      TRY_FAIL(STATUS_INPUT, "%s: thin_walls and wall_distance are not of one lattice",
               h5_path(file));
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++, at++)
        for (int a = 0; a < 3; a++) {
          if (!(cut[at] >> a & 1)) continue;
          const size_t next = solute_flow_at(f, i + (a == 0), j + (a == 1), k + (a == 2));
          f->aperture[a][next] = 0;
          f->thin_walls |= f->distance[at] > 0 && f->distance[next] > 0;
        }
cleanup:
  memory_free(&cut);
  return status;
}

static enum status read_flow(const char *run_file, bool whole, struct solute_flow *f) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  float *distance = NULL, *velocity = NULL;
  char path[4200];
  const size_t length = strlen(run_file);
  const bool ending = length > 4 && !strcmp(run_file + length - 4, ".hdf");
  struct solute_flow record = {0};
  uint64_t flow = 0;
  *f = (struct solute_flow){0};
  TRY(read_record(run_file, &record, &flow));
  if ((size_t)snprintf(path, sizeof path, "%.*s-image.hdf", (int)(ending ? length - 4 : length),
                       run_file) >= sizeof path)
    TRY_FAIL(STATUS_INPUT, "%s: the path is too long", run_file);
  status = h5_open(path, &file);
  if (status != STATUS_OK)
    TRY(error_context(status, "the flow on its lattice, which a run of method stokes leaves beside "
                              "its record unless output.image = false"));
  TRY(flow_hash_check(run_file, flow, path, file));
  size_t size[3], shape[4];
  double spacing[3], origin[3];
  int n[3];
  if (!h5_exists(file, IMAGE "wall_distance") || !h5_exists(file, IMAGE "velocity"))
    TRY_FAIL(STATUS_INPUT, "%s: no wall_distance or no velocity; run the flow again", path);
  TRY(h5_read(file, IMAGE "wall_distance", H5_F32, 3, size, &distance));
  TRY(h5_read(file, IMAGE "velocity", H5_F32, 4, shape, &velocity));
  TRY(h5_read_attribute(file, "/VTKHDF", "Spacing", H5_F64, 3, spacing));
  TRY(h5_read_attribute(file, "/VTKHDF", "Origin", H5_F64, 3, origin));
  for (int a = 0; a < 3; a++) {
    if (shape[a] != size[a] || shape[3] != 3 || size[a] < 1 || size[a] > INT_MAX / 4)
      TRY_FAIL(STATUS_INPUT, "%s: velocity and wall_distance are not of one lattice", path);
    if (!(spacing[a] > 0 && spacing[a] < 1e6))
      TRY_FAIL(STATUS_INPUT, "%s: the spacing is %g m along %c", path, spacing[a], "xyz"[a]);
    n[a] = (int)size[2 - a];
  }
  TRY(solute_flow_allocate(n, spacing, f));
  f->viscosity = record.viscosity, f->density = record.density;
  for (int a = 0; a < 3; a++) f->origin[a] = origin[a];
  for (size_t at = 0; at < f->count; at++) {
    bool finite = distance[at] > -1e30f && distance[at] < 1e30f;
    for (size_t a = 0; a < 3; a++)
      finite = finite && velocity[3 * at + a] > -1e30f && velocity[3 * at + a] < 1e30f;
    if (!finite)
      TRY_FAIL(STATUS_INPUT, "%s: site %zu has a velocity or distance that is no number", path, at);
  }
  memcpy(f->distance, distance, f->count * sizeof *distance);
  memory_free(&distance);
  solute_flow_cut(f);
  TRY(close_thin_walls(file, f));
  solute_flow_fluxes(f, velocity);
  memory_free(&velocity);
  solute_flow_measure(f);
  if (whole) status = solute_flow_finish(f);
  if (status == STATUS_INPUT) status = error_context(status, "%s", path);
  if (status == STATUS_OK && !(f->speed > 0))
    status = FAIL(STATUS_INPUT, "%s: the water rests; nothing carries a solute", path);
cleanup:
  h5_close(file);
  MEMORY_FREE(&distance, &velocity);
  if (status != STATUS_OK) solute_flow_free(f);
  return status;
}

enum status solute_flow_read(const char *run_file, struct solute_flow *flow) {
  return read_flow(run_file, true, flow);
}

enum status solute_flow_preview(const char *run_file, struct solute_flow *flow) {
  return read_flow(run_file, false, flow);
}
