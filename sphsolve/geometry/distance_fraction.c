/* Wall distances from the grain volume fraction of voxels. In a cut voxel the surface is the plane
 * normal to the gradient of the fraction (Parker, Youngs 1992) that gives the voxel its grain
 * fraction (Scardovelli, Zaleski 2000). Where neighbouring voxels do not agree with such a plane,
 * as in a field that is blurred over several voxels, the surface lies where the fraction crosses
 * 1/2 between two centres. */
#include <math.h>
#include <stdint.h>

#include "common/memory.h"
#include "sphsolve/geometry/distance_internal.h"
#include "sphsolve/geometry/plane_cut.h"

/* A piece of surface: a disc about `foot` (m, from the voxel's centre) normal to `normal`. */
struct piece {
  float foot[3], normal[3];
};

/* Whether the voxel contains both grain and pore. */
static bool is_cut(float f) {
  return f > 1e-4f && f < 1 - 1e-4f;
}

/* Unit normal n along the gradient of the fraction, from the 26 neighbours; returns the length of
 * the gradient. */
static double normal_of(const struct grid *grid, const float *f, const long x[3], double n[3]) {
  double gradient[3] = {0}, length = 0;
  for (int k = -1; k <= 1; k++)
    for (int j = -1; j <= 1; j++)
      for (int i = -1; i <= 1; i++) {
        int by[3] = {i, j, k};
        long at = distance_neighbour(grid, x, by);
        for (int a = 0; at < 0 && a < 3; a++) { /* outside: the nearest voxel inside */
          int inside[3] = {i, j, k};
          inside[a] = 0;
          at = distance_neighbour(grid, x, inside);
        }
        if (at < 0) continue;
        for (int a = 0; a < 3; a++)
          gradient[a] +=
              by[a] * (double)f[at] * (by[(a + 1) % 3] ? 1 : 2) * (by[(a + 2) % 3] ? 1 : 2);
      }
  for (int a = 0; a < 3; a++) {
    const bool side = !grid->periodic[a] && (x[a] == 0 || x[a] + 1 == (long)grid->size[a]);
    n[a] = (side ? 2 : 1) * gradient[a] / grid->spacing[a]; /* one-sided difference at a side */
    length += n[a] * n[a];
  }
  length = sqrt(length);
  for (int a = 0; a < 3 && length > 0; a++) n[a] /= length;
  return length;
}

/* Largest difference between the fraction of the neighbouring voxel and the one that the plane
 * gives it; not 0, as walls are curved. */
#define FRACTION_DIFFERENCE_MAX 0.2

/* The plane in a cut voxel as a piece of surface; false if the neighbouring voxel disagrees. */
static bool plane_of(const struct grid *grid, const float *f, const long x[3],
                     struct piece *piece) {
  const int none[3] = {0, 0, 0};
  const double share = (double)f[distance_neighbour(grid, x, none)];
  double n[3], m[3], sum = 0;
  int steepest = 0;
  if (!(normal_of(grid, f, x, n) > 0)) return false;
  for (int a = 0; a < 3; a++) {
    m[a] = fmax(fabs(n[a]) * grid->spacing[a], 1e-4 * grid->spacing[a]);
    sum += m[a];
    if (m[a] > m[steepest]) steepest = a;
  }
  for (int a = 0; a < 3; a++) m[a] /= sum;
  double low = 0, high = 1;
  for (int step = 0; step < 40; step++) {
    const double middle = 0.5 * (low + high);
    if (plane_box_below(m, middle) < share)
      low = middle;
    else
      high = middle;
  }
  /* The neighbouring voxel on the side of the centre where the surface lies. */
  const double level = 0.5 * (low + high);
  const int towards = (share < 0.5 ? 1 : -1) * (n[steepest] > 0 ? 1 : -1);
  int by[3] = {0, 0, 0};
  by[steepest] = towards;
  const long next = distance_neighbour(grid, x, by);
  if (next < 0) return false;
  const double expected = plane_box_below(m, level + (share < 0.5 ? m[steepest] : -m[steepest]));
  if (fabs(expected - (double)f[next]) > FRACTION_DIFFERENCE_MAX) return false;
  const double away = (0.5 - level) * sum; /* distance from the centre along the normal */
  for (int a = 0; a < 3; a++) {
    piece->normal[a] = (float)n[a];
    piece->foot[a] = (float)(away * n[a]);
  }
  return true;
}

struct surface {
  struct grid grid;
  const float *fraction;
  uint32_t *piece_of; /* [sites]: 1 + the number of its piece, 0 for none */
  struct piece *pieces;
  size_t count, room;
  uint32_t planes; /* number of pieces that are planes of cut voxels; they come first */
};

static enum status add_piece(struct surface *s, size_t site, const struct piece *piece) {
  enum status status = STATUS_OK;
  if (s->count == UINT32_MAX)
    TRY_FAIL(STATUS_INPUT, "the surface of the grains cuts more than 2^32 voxels");
  if (s->count == s->room) {
    s->room = s->room == 0 ? 1024 : 2 * s->room;
    TRY(memory_resize(&s->pieces, s->room, sizeof *s->pieces, "the surface of the grains"));
  }
  s->pieces[s->count++] = *piece;
  s->piece_of[site] = (uint32_t)s->count;
cleanup:
  return status;
}

/* Whether the fraction crosses 1/2 between the voxel at x and one of its six face neighbours.
 * Unless `planes` is NULL: *piece lies at the mean of the crossings, interpolated linearly between
 * centres, over those neighbours that have no plane; *planes: all of them have one. */
static bool crosses(const struct surface *s, const long x[3], bool *planes, struct piece *piece) {
  const int none[3] = {0, 0, 0};
  const long here = distance_neighbour(&s->grid, x, none);
  const double value = (double)s->fraction[here];
  double n[3], along = 0;
  int edges = 0;
  bool any = false;
  for (int e = 0; e < 6; e++) {
    int by[3] = {0, 0, 0};
    const int axis = e / 2;
    by[axis] = e % 2 ? 1 : -1;
    const long next = distance_neighbour(&s->grid, x, by);
    if (next < 0 || (value < 0.5) == (s->fraction[next] < 0.5f)) continue;
    any = true;
    if (planes == NULL || (s->piece_of[next] != 0 && s->piece_of[next] <= s->planes)) continue;
    if (edges == 0 && !(normal_of(&s->grid, s->fraction, x, n) > 0)) continue;
    const double part = (0.5 - value) / ((double)s->fraction[next] - value);
    along += part * by[axis] * s->grid.spacing[axis] * n[axis];
    edges++;
  }
  if (planes == NULL) return any;
  *planes = edges == 0;
  for (int a = 0; a < 3 && edges > 0; a++) {
    piece->normal[a] = (float)n[a];
    piece->foot[a] = (float)(along / edges * n[a]);
  }
  return any;
}

/* The planes of cut voxels first, then the crossings of 1/2 where there is no plane. */
static enum status find_pieces(struct surface *s) {
  enum status status = STATUS_OK;
  const size_t *size = s->grid.size;
  for (int pass = 0; pass < 2; pass++) {
    s->planes = (uint32_t)s->count;
    for (size_t site = 0; site < size[0] * size[1] * size[2]; site++) {
      const long x[3] = {(long)(site % size[0]), (long)(site / size[0] % size[1]),
                         (long)(site / size[0] / size[1])};
      struct piece piece;
      bool planes;
      if (pass == 0) {
        if (is_cut(s->fraction[site]) && crosses(s, x, NULL, NULL) &&
            plane_of(&s->grid, s->fraction, x, &piece))
          TRY(add_piece(s, site, &piece));
      } else if (s->piece_of[site] == 0 && crosses(s, x, &planes, &piece) && !planes) {
        TRY(add_piece(s, site, &piece));
      }
    }
  }
cleanup:
  return status;
}

/* Distance from a site to the plane of a piece, and along that plane to its foot. */
static void to_piece(const struct surface *s, const struct piece *piece, const int by[3],
                     double *plane, double *across) {
  double along = 0, square = 0;
  for (int a = 0; a < 3; a++) {
    const double r = by[a] * s->grid.spacing[a] + (double)piece->foot[a];
    along += r * (double)piece->normal[a];
    square += r * r;
  }
  *plane = fabs(along);
  *across = sqrt(fmax(square - along * along, 0));
}

/* In radii of a disc: pieces whose distances differ by less belong to one surface, as the planes of
 * a curved surface differ by about this much. */
#define SAME_SURFACE 0.15

/* Unsigned distance from the site x to the surface: the nearest disc tells which surface is
 * nearest; the piece of that surface whose foot is closest to the normal through x gives the
 * distance. */
static double to_surface(const struct surface *s, const long x[3], const struct offset *offsets,
                         int n, double limit) {
  const double *spacing = s->grid.spacing;
  const double disc = fmax(fmax(spacing[0], spacing[1]), spacing[2]);
  double best = limit, result = limit, least = INFINITY;
  for (int pass = 0; pass < 2; pass++)
    for (int o = 0; o < n && offsets[o].face < best + 2 * disc; o++) {
      const long at = distance_neighbour(&s->grid, x, offsets[o].by);
      if (at < 0 || s->piece_of[at] == 0) continue;
      double plane, across;
      to_piece(s, &s->pieces[s->piece_of[at] - 1], offsets[o].by, &plane, &across);
      const double beyond = fmax(across - disc, 0);
      const double distance = sqrt(plane * plane + beyond * beyond);
      if (pass == 0) {
        best = fmin(best, distance);
      } else if (distance <= best + SAME_SURFACE * disc && across < least) {
        least = across;
        result = distance;
      }
    }
  return fmin(result, limit);
}

enum status distance_from_fraction(const size_t size[3], const double spacing[3],
                                   const bool periodic[3], size_t first, size_t end,
                                   const float *grain_fraction, float *distance) {
  enum status status = STATUS_OK;
  struct surface s = {.grid = {size, spacing, periodic}, .fraction = grain_fraction};
  struct offset offsets[OFFSETS];
  const int n = distance_offsets(spacing, offsets);
  const double limit = distance_reach(spacing);
  const size_t plane = size[0] * size[1];
  TRY(memory_allocate(&s.piece_of, plane * size[2], sizeof *s.piece_of,
                      "the surface of the grains"));
  TRY(find_pieces(&s));
#pragma omp parallel for schedule(static)
  for (size_t at = first * plane; at < end * plane; at++) {
    const long x[3] = {(long)(at % size[0]), (long)(at / size[0] % size[1]),
                       (long)(at / size[0] / size[1])};
    const double d = to_surface(&s, x, offsets, n, limit);
    distance[at] = (float)(grain_fraction[at] < 0.5f ? d : -d);
  }
cleanup:
  MEMORY_FREE(&s.piece_of, &s.pieces);
  return status;
}
