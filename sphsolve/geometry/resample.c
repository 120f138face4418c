#include "sphsolve/geometry/resample.h"

#include <math.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/geometry/throats.h"

/* If no whole number of sites comes within this relative error of the requested spacing, several
 * periods of the body are used instead of one, at most COPIES_MAX. */
#define SPACING_ERROR_MAX 0.05
#define COPIES_MAX 8

struct target {
  size_t size[3], copies[3], count;
  double spacing[3];
};

bool lattice_is_mirrored(const struct lattice *l) {
  const size_t plane = l->size[0] * l->size[1], nz = l->size[2];
  if (nz < 4) return false;
  for (size_t k = 0; k < nz / 2; k++) {
    const size_t low = k * plane, high = (nz - 1 - k) * plane;
    if (memcmp(l->kind + low, l->kind + high, plane) != 0) return false;
    if (l->wall_distance != NULL && memcmp(l->wall_distance + low, l->wall_distance + high,
                                           plane * sizeof *l->wall_distance) != 0)
      return false;
    if (!lattice_soil_same(l, low, high, plane)) return false;
  }
  return true;
}

#define SITES_MAX 1099511627776.0 /* 2^40 */

static enum status find_target(const struct lattice *fine, double spacing, bool mirrored,
                               struct target *t) {
  t->count = 1;
  for (int a = 0; a < 3; a++) {
    const double length = (double)fine->size[a] * fine->spacing[a];
    const size_t unit = a == 2 && mirrored ? 2 : 1;
    double least = INFINITY;
    t->size[a] = t->copies[a] = 1;
    t->spacing[a] = fine->dimensions == 2 && a == 1 ? fine->spacing[a] : spacing;
    for (size_t m = 1; fine->size[a] > 1 && m <= COPIES_MAX && least > SPACING_ERROR_MAX; m++) {
      const double wanted = (double)m * length / spacing;
      if (!(wanted < 1e9)) return FAIL(STATUS_INPUT, "lattice.spacing: %g m is too fine", spacing);
      const double whole = fmax(1.0, round(wanted / (double)unit)) * (double)unit;
      if (fabs(wanted / whole - 1.0) >= least) continue;
      least = fabs(wanted / whole - 1.0);
      t->size[a] = (size_t)whole;
      t->copies[a] = m;
      t->spacing[a] = (double)m * length / whole;
    }
    if (!size_multiply(t->count, t->size[a], &t->count) || (double)t->count > SITES_MAX)
      return FAIL(STATUS_INPUT,
                  "lattice.spacing: %g m makes too many points; that of the model's voxels, %g m, "
                  "fits",
                  spacing, fine->spacing[a]);
  }
  return STATUS_OK;
}

enum status lattice_resampled_size(const struct lattice *fine, double spacing, size_t size[3],
                                   size_t *count) {
  struct target t;
  const enum status status = find_target(fine, spacing, lattice_is_mirrored(fine), &t);
  memcpy(size, t.size, sizeof t.size);
  *count = t.count;
  return status;
}

/* Four sites around each new one and their weights: cubic Lagrange interpolation, periodic. Linear
 * interpolation would flatten curved walls and reduce the order of convergence to the first. */
struct tap {
  size_t index[4];
  float weight[4];
};

static void find_taps(size_t from, double from_spacing, size_t to, double to_spacing,
                      struct tap *taps) {
  for (size_t i = 0; i < to; i++) {
    const double at = ((double)i + 0.5) * to_spacing / from_spacing - 0.5, n = (double)from;
    const double x = at - floor(at / n) * n, whole = floor(x), t = x - whole;
    const double w[4] = {-t * (t - 1.0) * (t - 2.0) / 6.0, (t * t - 1.0) * (t - 2.0) / 2.0,
                         -t * (t + 1.0) * (t - 2.0) / 2.0, t * (t * t - 1.0) / 6.0};
    for (size_t k = 0; k < 4; k++) {
      taps[i].index[k] = ((size_t)whole + k + from - 1) % from;
      taps[i].weight[k] = (float)w[k];
    }
  }
}

/* Interpolates along the axis of `stride` values: out [outer][to][stride] from in
 * [outer][from][stride]. */
static void resample_axis(const float *in, size_t from, size_t stride, const struct tap *taps,
                          size_t to, size_t outer, float *out) {
#pragma omp parallel for schedule(static) collapse(2)
  for (size_t o = 0; o < outer; o++)
    for (size_t i = 0; i < to; i++) {
      const float *base = in + o * from * stride, *w = taps[i].weight;
      const size_t *n = taps[i].index;
      float *to_row = out + (o * to + i) * stride;
      for (size_t s = 0; s < stride; s++)
        to_row[s] = w[0] * base[n[0] * stride + s] + w[1] * base[n[1] * stride + s] +
                    w[2] * base[n[2] * stride + s] + w[3] * base[n[3] * stride + s];
    }
}

/* Whether both lattices have the same sites; interpolation would then change only rounding
 * errors. */
static bool are_same_sites(const struct lattice *fine, const struct lattice *out) {
  for (int a = 0; a < 3; a++)
    if (fine->size[a] != out->size[a] ||
        fabs(fine->spacing[a] - out->spacing[a]) > 1e-12 * fine->spacing[a])
      return false;
  return true;
}

/* Of a mirrored lattice only the first half of the layers is interpolated; the rest is its mirror
 * image. */
static enum status resample_distances(const struct lattice *fine, bool mirrored,
                                      struct lattice *out) {
  enum status status = STATUS_OK;
  struct tap *taps = NULL;
  float *planes = NULL, *rows = NULL;
  const size_t *n = fine->size, *m = out->size;
  const size_t most = m[0] > m[1] ? (m[0] > m[2] ? m[0] : m[2]) : (m[1] > m[2] ? m[1] : m[2]);
  const size_t layers = mirrored ? (m[2] + 1) / 2 : m[2];
  if (are_same_sites(fine, out)) {
    memcpy(out->wall_distance, fine->wall_distance, out->count * sizeof *out->wall_distance);
    return STATUS_OK;
  }
  TRY(memory_allocate(&taps, most, sizeof *taps, "a lattice"));
  TRY(memory_allocate(&planes, n[0] * n[1] * layers, sizeof *planes, "a lattice"));
  find_taps(n[2], fine->spacing[2], m[2], out->spacing[2], taps);
  resample_axis(fine->wall_distance, n[2], n[0] * n[1], taps, layers, 1, planes);
  TRY(interrupt_look());
  TRY(memory_allocate(&rows, n[0] * m[1] * layers, sizeof *rows, "a lattice"));
  find_taps(n[1], fine->spacing[1], m[1], out->spacing[1], taps);
  resample_axis(planes, n[1], n[0], taps, m[1], layers, rows);
  TRY(interrupt_look());
  memory_free(&planes);
  find_taps(n[0], fine->spacing[0], m[0], out->spacing[0], taps);
  resample_axis(rows, n[0], 1, taps, m[0], m[1] * layers, out->wall_distance);
  if (mirrored) lattice_mirror_distances(out);
cleanup:
  MEMORY_FREE(&taps, &planes, &rows);
  return status;
}

void lattice_mirror_distances(struct lattice *l) {
  const size_t plane = l->size[0] * l->size[1], nz = l->size[2];
  for (size_t k = 0; k < nz / 2; k++)
    memcpy(l->wall_distance + (nz - 1 - k) * plane, l->wall_distance + k * plane,
           plane * sizeof *l->wall_distance);
}

void lattice_set_kinds(struct lattice *l, float offset, float least) {
  size_t pores = 0;
#pragma omp parallel for schedule(static) reduction(+ : pores)
  for (size_t s = 0; s < l->count; s++) {
    const float d = l->wall_distance[s] + offset;
    const bool fluid = d > 0.0f;
    l->kind[s] = fluid ? SITE_FLUID : SITE_WALL;
    l->wall_distance[s] = fluid ? fmaxf(d, least) : fminf(d, -least);
    pores += fluid;
  }
  l->fluid_count = pores;
  l->wall_count = l->count - pores;
}

static void copy_regions(const struct lattice *fine, struct lattice *out) {
  for (size_t s = 0; s < out->count; s++) {
    const size_t index[3] = {s % out->size[0], s / out->size[0] % out->size[1],
                             s / out->size[0] / out->size[1]};
    size_t near = 0;
    for (int a = 2; a >= 0; a--) {
      const double at = ((double)index[a] + 0.5) * out->spacing[a] / fine->spacing[a];
      near = near * fine->size[a] + (size_t)at % fine->size[a];
    }
    out->region[s] = fine->region[near];
  }
}

enum status lattice_sample(const struct lattice *fine, double spacing, double offset,
                           struct lattice *out) {
  enum status status = STATUS_OK;
  struct target t;
  const bool mirrored = lattice_is_mirrored(fine);
  *out = (struct lattice){.dimensions = fine->dimensions,
                          .model = fine->model,
                          .shapes = fine->shapes,
                          .surface = fine->surface ? fine->surface : fine,
                          .surface_moved = fine->surface_moved + offset};
  memcpy(out->folded, fine->folded, sizeof out->folded);
  TRY(find_target(fine, spacing, mirrored, &t));
  out->count = t.count;
  out->bulk_count = fine->bulk_count;
  for (int a = 0; a < 3; a++) {
    out->size[a] = t.size[a];
    out->spacing[a] = t.spacing[a];
    out->origin[a] = fine->origin[a] + 0.5 * (t.spacing[a] - fine->spacing[a]);
    out->bulk_count *= (double)(t.copies[a] * fine->size[a]) == 1.0
                           ? 1.0
                           : (double)t.copies[a] * fine->spacing[a] / t.spacing[a];
  }
  TRY(memory_allocate(&out->kind, out->count, 1, "a lattice"));
  TRY(memory_allocate(&out->wall_distance, out->count, sizeof *out->wall_distance, "a lattice"));
  if (fine->region)
    TRY(memory_allocate(&out->region, out->count, sizeof *out->region, "a lattice"));
  TRY(resample_distances(fine, mirrored, out));
  TRY(interrupt_look());
  lattice_set_kinds(out, (float)offset, (float)(1e-3 * spacing));
  if (fine->region) copy_regions(fine, out);
  TRY(lattice_soil_resample(fine, out));
  if (mirrored) lattice_soil_mirror(out);
cleanup:
  if (status != STATUS_OK) lattice_free(out);
  return status;
}

enum status lattice_resample(const struct lattice *fine, double spacing, double offset,
                             struct lattice *out) {
  enum status status = lattice_sample(fine, spacing, offset, out);
  if (status != STATUS_OK) return status;
  status = thin_wall_find_faces(out);
  if (status != STATUS_OK) lattice_free(out);
  return status;
}

/* Pore fraction of a site whose wall is `away` spacings away. */
static inline double pore_fraction(double away) {
  const double share = 0.5 + away, least = share > 0.0 ? share : 0.0;
  return least < 1.0 ? least : 1.0;
}

enum { SUMS = 8 };
double lattice_void_ratio(const struct lattice *l, double moved) {
  double pores = 0.0;
  const double per_h = 1.0 / cbrt(l->spacing[0] * l->spacing[1] * l->spacing[2]);
  /* Planes are summed in a fixed order, whatever the number of threads. */
#pragma omp parallel for ordered schedule(static, 1)
  for (size_t k = 0; k < l->size[2]; k++) {
    const size_t plane = l->size[0] * l->size[1];
    const float *distance = l->wall_distance + k * plane;
    /* Several partial sums, so that additions do not wait for each other. */
    double sums[SUMS] = {0.0}, sum = 0.0;
    const size_t whole = plane - plane % SUMS;
    for (size_t s = 0; s < whole; s += SUMS)
      for (size_t i = 0; i < SUMS; i++)
        sums[i] += pore_fraction(((double)distance[s + i] + moved) * per_h);
    for (size_t s = whole; s < plane; s++)
      sum += pore_fraction(((double)distance[s] + moved) * per_h);
    for (size_t i = 0; i < SUMS; i++) sum += sums[i];
#pragma omp ordered
    pores += sum;
  }
  return pores / (l->bulk_count - pores);
}

enum status lattice_apply_spacing(const struct scene *scene, struct lattice *lattice) {
  struct lattice wanted = {0};
  double sites = 1;
  if (!isfinite(scene->lattice_spacing)) return STATUS_OK;
  for (int a = 0; a < 3; a++) {
    const double length = (double)lattice->size[a] * lattice->spacing[a];
    if (lattice->size[a] > 1 && scene->lattice_spacing > 0.5 * length)
      return scene_error(scene, AT_LATTICE,
                         "%g m is no lattice for a model that is %g m long in %c; voxels of it are "
                         "%g m",
                         scene->lattice_spacing, length, 'x' + a, lattice->spacing[a]);
    sites *= fmax(1, length / scene->lattice_spacing);
  }
  if (sites > SITES_MAX)
    return scene_error(scene, AT_LATTICE,
                       "%g m makes too many points (%.1g); lattice.spacing = \"%.4g um\", that of "
                       "the model's voxels, fits, and finer points tell nothing new",
                       scene->lattice_spacing, sites, 1e6 * lattice->spacing[0]);
  enum status status = lattice_resample(lattice, scene->lattice_spacing, 0.0, &wanted);
  if (status != STATUS_OK) return error_context(status, "%s", scene->path);
  bool leads = true, still = true;
  const double *force = scene->driving;
  if (force[0] != 0.0 || force[1] != 0.0 || force[2] != 0.0) {
    status = percolation_find(lattice, force, false, NULL, &leads);
    if (status == STATUS_OK && leads) status = percolation_find(&wanted, force, true, NULL, &still);
    if (status == STATUS_OK && leads && !still)
      status =
          scene_error(scene, AT_LATTICE,
                      "points %.4g um apart close every way through the model, which its voxels "
                      "of %.4g um leave open: k would be 0; finer points are needed",
                      1e6 * scene->lattice_spacing, 1e6 * lattice->spacing[0]);
    if (status != STATUS_OK) {
      lattice_free(&wanted);
      return status;
    }
  }
  struct throats throats;
  const enum status compared = throats_compare(lattice, &wanted, &throats);
  struct lattice *surface = NULL;
  const enum status kept = memory_allocate(&surface, 1, sizeof *surface, "a lattice");
  if (kept != STATUS_OK) {
    lattice_free(&wanted);
    return kept;
  }
  *surface = *lattice;
  *lattice = wanted;
  lattice->surface = lattice->own_surface = surface;
  memory_free(&surface->kind); /* only its distances are read */
  MEMORY_FREE(&surface->region, &surface->micro_porosity, &surface->micro_permeability);
  if (compared == STATUS_OK && throats.closed + throats.opened > 0)
    log_warning("%s: points %.4g um apart close %zu throats of the model's and open %zu",
                scene->path, 1e6 * scene->lattice_spacing, throats.closed, throats.opened);
  return compared;
}
