#include "sphsolve/darcy/saturated.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/edges.h"
#include "sphsolve/darcy/hole.h"

/* The quarters around an edge of the lattice along y: sites by 2 * (high z) + (high x), SITE_NONE
 * where there is none, and their permeabilities xx, zz, xz, m/s. */
#define QUARTERS 4
struct corner {
  uint32_t site[QUARTERS];
  double k[QUARTERS][3];
};
/* h on a face of a quarter, relative to p.(x - corner), is one of at most so many unknowns. */
#define UNKNOWNS 8
/* Columns: the unknowns, the sites' own h, and a constant. */
#define COLUMNS (UNKNOWNS + QUARTERS + 1)

/* Number of edges of the lattice along an axis, and the site before or behind one. */
static size_t corner_lines(const struct richards *s, int axis) {
  const size_t n = s->lattice->size[axis];
  return s->scene->periodic[axis] && n > 1 ? n : n + 1;
}
static bool beside_line(const struct richards *s, int axis, size_t line, int high, size_t *at) {
  const size_t n = s->lattice->size[axis];
  if (high ? line < n : line > 0) return *at = line - (size_t)!high, true;
  *at = n - 1;
  return !high && s->scene->periodic[axis] && n > 1;
}

static bool find_corner(const struct richards *s, size_t i, size_t j, size_t k,
                        struct corner *corner) {
  const size_t *size = s->lattice->size;
  bool any = false;
  for (int q = 0; q < QUARTERS; q++) {
    size_t x, z;
    corner->site[q] = SITE_NONE;
    if (beside_line(s, 0, i, q & 1, &x) && beside_line(s, 2, k, q >> 1, &z))
      corner->site[q] = s->number[(z * size[1] + j) * size[0] + x];
    any = any || corner->site[q] != SITE_NONE;
  }
  return any;
}

static uint32_t body_of(struct richards *s, uint32_t i) {
  while (s->body[i] != i) i = s->body[i] = s->body[s->body[i]];
  return i;
}

enum status richards_saturated_bodies(struct richards *s) {
  const enum status status =
      memory_allocate(&s->body, s->count, sizeof *s->body, "connected sites");
  if (status != STATUS_OK) return status;
  for (uint32_t i = 0; i < s->count; i++) s->body[i] = i;
  for (size_t f = 0; f < s->face_count; f++) {
    const uint32_t a = body_of(s, s->faces[f].i), b = body_of(s, s->faces[f].j);
    s->body[a > b ? a : b] = a > b ? b : a;
  }
  for (uint32_t i = 0; i < s->count; i++) s->body[i] = body_of(s, i);
  return STATUS_OK;
}

enum status richards_saturated_corners(struct richards *s) {
  enum status status = STATUS_OK;
  struct corner corner;
  for (int pass = 0; pass < 2; pass++) {
    s->corner_count = 0;
    for (size_t k = 0; k < corner_lines(s, 2); k++)
      for (size_t j = 0; j < s->lattice->size[1]; j++)
        for (size_t i = 0; i < corner_lines(s, 0); i++)
          for (int q = 0; q < 2 && find_corner(s, i, j, k, &corner); q++) {
            const uint32_t a = corner.site[q], b = corner.site[3 - q];
            if (a == SITE_NONE || b == SITE_NONE || a == b) continue;
            if (pass > 0) s->corners[s->corner_count][0] = a, s->corners[s->corner_count][1] = b;
            s->corner_count++;
          }
    if (pass == 0)
      TRY(memory_allocate(&s->corners, s->corner_count, sizeof *s->corners, "corners of sites"));
  }
cleanup:
  return status;
}

/* K / (1 + b |v| K) over K: what Forchheimer's term leaves of a permeability. */
static double part_left(const struct richards *s, size_t i) {
  const struct retention *soil = &s->soils[s->soil[i]];
  return 1 / (1 + soil->forchheimer * s->speed[i] * soil->conductivity[0]);
}

/* What walls leave open of the face of a site. */
static double face_share(const struct richards *s, size_t i, int axis, bool high) {
  return wall_cuts_face(&s->walls, s->site[i], axis, high);
}

/* Flux into a site through an edge by its law, where that is a resistance of half a spacing. */
static double flux_by_head(const struct richards *s, size_t e, double head, double *slope) {
  const struct richards_edge *edge = &s->edges[e];
  const size_t i = edge->site;
  const double pull = edge->low ? s->pull[edge->axis] : -s->pull[edge->axis];
  const double k = part_left(s, i) * s->soils[s->soil[i]].conductivity[edge->axis];
  *slope = 2 * edge->open * k / s->spacing;
  return *slope * (head - s->h[i]) + (richards_is_face(edge) ? edge->open * k * pull : 0);
}

/* The flux of an edge where its law is limited. */
static double flux_at_limit(const struct richards_law *law, uint8_t limited) {
  return limited == 1 ? law->least : law->most;
}

/* Solves the equations of a corner for its unknowns: Gauss's elimination with pivots. Column c of
 * the result is in at[][UNKNOWNS + c]. */
static void eliminate(int n, double at[UNKNOWNS][COLUMNS]) {
  for (int c = 0; c < n; c++) {
    int pivot = c;
    for (int r = c + 1; r < n; r++)
      if (fabs(at[r][c]) > fabs(at[pivot][c])) pivot = r;
    for (int m = 0; m < COLUMNS; m++) {
      const double swap = at[c][m];
      at[c][m] = at[pivot][m], at[pivot][m] = swap;
    }
    for (int r = 0; r < n; r++) {
      const double times = at[r][c] / at[c][c];
      for (int m = c; m < COLUMNS && r != c && times != 0; m++) at[r][m] -= times * at[c][m];
    }
  }
  for (int r = 0; r < n; r++)
    for (int m = UNKNOWNS; m < COLUMNS; m++) at[r][m] /= at[r][r];
}

/* One face of a quarter. */
struct quarter_face {
  uint32_t beside;
  int unknown;
  double open; /* share that no wall covers; 1 if no water passes */
  double z;    /* which part of p.x its middle has more than the corner, m */
};

/* Where soils meet at a corner and not in a layer, the four quarters act as one soil. With L = ln k
 * (of Darcy's law), X and Z the changes of L along x and z, and Q that across both, of a
 * chequerboard: if X^2 + Z^2 > Q^2, with p = (X^2 + Z^2)/(X^2 + Z^2 + Q^2), across the interface,
 * which has the normal (X, Z), and along it k = H^p M^(1 - p),   A^p M^(1 - p) with the arithmetic
 * mean A, the harmonic mean H and the geometric mean M of the four: exact for layers, and stairs
 * into which an oblique face of soil is cut conduct nearly as that face. Else, on the diagonals of
 * the soils K and J, k = 2 K sin(w) 2^(-2 w/pi),   2 J cos(w) 2^(2 w/pi - 1),   tan^2(w) = J/K
 * which is the flux of r^(4 w/pi), the h around such a corner that is singular there, through the
 * halves of the faces, over its fall between the sites. */
static void blend_corner(const struct richards *s, struct corner *corner) {
  double l[QUARTERS], sum = 0, inverse = 0, mean = 0, x = 0, z = 0, rest = 0;
  double pair[2] = {0, 0}, k[3];
  for (int q = 0; q < QUARTERS; q++) {
    const double *own = corner->k[q];
    const int even = (q & 1) == q >> 1;
    if (own[0] != own[1] || own[2] != 0) return;                /* beds */
    if (s->soil[corner->site[q]] + 1u == s->soil_count) return; /* free water */
    l[q] = log(s->soils[s->soil[corner->site[q]]].conductivity[0]);
    sum += 0.25 * own[0], inverse += 0.25 / own[0], mean += 0.25 * log(own[0]);
    pair[even] += 0.5 * log(own[0]);
    x += q & 1 ? l[q] : -l[q];
    z += q & 2 ? l[q] : -l[q];
    rest += even ? l[q] : -l[q];
  }
  if ((x == 0 || z == 0) && rest == 0) return;
  const double plane = x * x + z * z, p = plane / (plane + rest * rest);
  if (plane > rest * rest) {
    const double along = exp(p * log(sum) + (1 - p) * mean),
                 turn = (exp(-p * log(inverse) + (1 - p) * mean) - along) / plane;
    k[0] = along + turn * x * x, k[1] = along + turn * z * z, k[2] = turn * x * z;
  } else {
    const double w = atan(exp(0.5 * (pair[0] - pair[1]))), turn = 2 / M_PI * w;
    const double even = exp(pair[1]) * sin(w) * exp2(-turn),
                 odd = exp(pair[0]) * cos(w) * exp2(turn - 1);
    k[0] = k[1] = even + odd, k[2] = even - odd;
  }
  for (int q = 0; q < QUARTERS; q++) {
    corner->k[q][0] = k[0], corner->k[q][1] = k[1];
    corner->k[q][2] = (q & 1) == q >> 1 ? k[2] : -k[2];
  }
}

/* Adds the fluxes of the faces around a corner, and their slopes to the matrix. */
static void add_corner(struct richards *s, struct corner *corner, double time) {
  static const int axes[2] = {0, 2};
  const double d = s->spacing;
  struct quarter_face face[QUARTERS][2];
  double at[UNKNOWNS][COLUMNS] = {{0}}, shift[QUARTERS] = {0};
  int n = 0, open = 0; /* quarters of faces that lead to other sites */
  for (int q = 0; q < QUARTERS; q++) {
    const size_t i = corner->site[q];
    if (i == SITE_NONE) continue;
    const struct retention *soil = &s->soils[s->soil[i]];
    const double left = part_left(s, i), sign[2] = {q & 1 ? -1 : 1, q & 2 ? -1 : 1};
    corner->k[q][0] = left * soil->conductivity[0], corner->k[q][1] = left * soil->conductivity[2];
    corner->k[q][2] = sign[0] * sign[1] * left * soil->shear;
    for (int m = 0; m < 2; m++) {
      struct quarter_face *own = &face[q][m];
      shift[q] += 0.5 * d * sign[m] * s->pull[axes[m]];
      own->beside = s->beside[6 * i + 2 * (size_t)axes[m] + (sign[m] > 0)];
      own->z = 0.5 * d * sign[1 - m] * s->pull[axes[1 - m]];
      own->open = own->beside == SITE_NONE ? 1 : face_share(s, i, axes[m], sign[m] > 0);
      own->unknown = n;
      open += own->beside < BESIDE_EDGE;
      const int other = q ^ (1 << m);
      if (other < q && own->beside < BESIDE_EDGE && corner->site[other] != SITE_NONE &&
          face[other][m].beside == own->beside)
        own->unknown = face[other][m].unknown;
      n += own->unknown == n;
    }
  }
  if (open == 2 * QUARTERS) blend_corner(s, corner);
  for (int q = 0; q < QUARTERS; q++)
    for (int m = 0; m < 2 && corner->site[q] != SITE_NONE; m++)
      corner->k[q][m] *=
          face[q][m].open * richards_hole_factor(s, corner->site[q], axes[m], !(q >> m & 1));
  /* Out of a quarter, over the area of the whole face, flows
   *   -(k_mm (e_m - h) + k_xz (e_l - h))/d,   l the other axis,
   * times the open share of the face. */
  for (int q = 0; q < QUARTERS; q++)
    for (int m = 0; m < 2 && corner->site[q] != SITE_NONE; m++) {
      const struct quarter_face *own = &face[q][m];
      double *row = at[own->unknown];
      if (own->beside != SITE_NONE && own->beside >= BESIDE_EDGE) {
        const size_t e = own->beside - BESIDE_EDGE;
        const struct richards_law law = richards_law_at(s, &s->edges[e], time);
        if (s->limited[e] == 0) { /* e = head */
          row[own->unknown] = 1, row[COLUMNS - 1] = law.head + own->z;
          continue;
        }
        row[COLUMNS - 1] += 0.5 * d * flux_at_limit(&law, s->limited[e]);
      }
      const double shear = own->open * corner->k[q][2];
      row[own->unknown] += corner->k[q][m];
      row[face[q][1 - m].unknown] += shear;
      row[UNKNOWNS + q] += corner->k[q][m] + shear;
    }
  eliminate(n, at);
  for (int q = 0; q < QUARTERS; q++)
    for (int m = 0; m < 2 && corner->site[q] != SITE_NONE; m++) {
      const struct quarter_face *own = &face[q][m];
      const size_t i = corner->site[q];
      if (own->beside == SITE_NONE) continue;
      const double *e = at[own->unknown], *other = at[face[q][1 - m].unknown];
      const double shear = own->open * corner->k[q][2];
      double out = 0;
      for (int c = 0; c <= QUARTERS; c++) {
        if (c < QUARTERS && corner->site[c] == SITE_NONE) continue;
        double slope = -(corner->k[q][m] * e[UNKNOWNS + c] + shear * other[UNKNOWNS + c]);
        if (c == q) slope += corner->k[q][m] + shear;
        slope /= d;
        out += c < QUARTERS ? slope * (s->h[corner->site[c]] + shift[c]) : slope;
        if (c == QUARTERS) continue;
        /* Sites that no water leads to across the corner have no entry, and a slope of 0. */
        const size_t entry = rows_entry(&s->rows, i, corner->site[c]);
        if (entry < s->rows.start[i + 1]) s->rows.value[entry] += slope;
      }
      if (own->beside >= BESIDE_EDGE)
        s->edge_flux[own->beside - BESIDE_EDGE].q -= out;
      else if (!(q >> m & 1))
        s->face_flux[own->beside].q += out;
    }
}

/* Adds the fluxes along y, of one site to the next. */
static void add_along_y(struct richards *s) {
  for (size_t f = 0; f < s->face_count; f++) {
    const struct richards_face *face = &s->faces[f];
    const size_t i = face->i, j = face->j;
    if (face->axis != 1) continue;
    const double ki = part_left(s, i) * s->soils[s->soil[i]].conductivity[1] *
                      richards_hole_factor(s, i, 1, true) * face_share(s, i, 1, true),
                 kj = part_left(s, j) * s->soils[s->soil[j]].conductivity[1] *
                      richards_hole_factor(s, j, 1, false) * face_share(s, j, 1, false);
    const double slope = 2 * ki * kj / (ki + kj) / s->spacing;
    s->face_flux[f].q = slope * (s->h[i] - s->h[j] + s->pull[1] * s->spacing);
    s->rows.value[s->rows.diagonal[i]] += slope, s->rows.value[s->rows.diagonal[j]] += slope;
    s->rows.value[face->ij] -= slope, s->rows.value[face->ji] -= slope;
  }
}

/* Adds the fluxes of edges that no corner has: along y, and of wells and drains. */
static void add_edges(struct richards *s, double time) {
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    if (richards_is_face(edge) && edge->axis != 1) continue;
    const struct richards_law law = richards_law_at(s, edge, time);
    double slope = 0;
    s->edge_flux[e].q = s->limited[e] == 0 ? flux_by_head(s, e, law.head, &slope)
                                           : flux_at_limit(&law, s->limited[e]);
    s->rows.value[s->rows.diagonal[edge->site]] += slope;
  }
}

/* Finds all fluxes at the present heads, the matrix of their slopes and the residual. Returns
 * whether that is below its tolerance. `near`: the tolerance, m/s, and over the largest flux. */
static bool assemble(struct richards *s, double time, double near[2]) {
  struct corner corner;
  double most = 0, size = 0, worst = 0;
  memset(s->rows.value, 0, s->rows.start[s->count] * sizeof *s->rows.value);
  for (size_t f = 0; f < s->face_count; f++) s->face_flux[f] = (struct flux){0};
  for (size_t e = 0; e < s->edge_count; e++) s->edge_flux[e] = (struct flux){0};
  for (size_t k = 0; k < corner_lines(s, 2); k++)
    for (size_t j = 0; j < s->lattice->size[1]; j++)
      for (size_t i = 0; i < corner_lines(s, 0); i++)
        if (find_corner(s, i, j, k, &corner)) add_corner(s, &corner, time);
  add_along_y(s);
  add_edges(s, time);
  memset(s->residual, 0, s->count * sizeof *s->residual);
  for (size_t f = 0; f < s->face_count; f++) {
    const double q = s->face_flux[f].q;
    s->residual[s->faces[f].i] -= q, s->residual[s->faces[f].j] += q;
    most = fmax(most, fabs(q));
  }
  for (size_t e = 0; e < s->edge_count; e++) {
    s->residual[s->edges[e].site] += s->edge_flux[e].q;
    most = fmax(most, fabs(s->edge_flux[e].q));
  }
  for (size_t i = 0; i < s->count; i++) {
    double *diagonal = &s->rows.value[s->rows.diagonal[i]];
    size = fmax(size, *diagonal * (fabs(s->h[i]) + s->spacing));
    worst = isnan(s->residual[i]) ? NAN : fmax(worst, fabs(s->residual[i]));
  }
  near[0] = SATURATED_TOLERANCE * most + RESIDUAL_ROUNDING * size;
  near[1] = most > 0 ? near[0] / most : INFINITY;
  return worst <= near[0];
}

/* The flux into a site through an edge, by its law where that is limited now. */
static double unlimited_flux(const struct richards *s, size_t e, double time) {
  double slope;
  if (s->limited[e] == 0) return s->edge_flux[e].q;
  return flux_by_head(s, e, richards_law_at(s, &s->edges[e], time).head, &slope);
}

/* That of all sites of a drain, as water in it goes from one to another. */
static double drain_flux(const struct richards *s, const struct region *drain, double time) {
  double sum = 0;
  for (size_t e = 0; e < s->edge_count; e++)
    if (s->edges[e].region == drain) sum += unlimited_flux(s, e, time);
  return sum;
}

/* Where no law fixes the heads of sites that are connected, the matrix would be singular. */
static void fix_bodies(struct richards *s) {
  for (size_t i = 0; i < s->count; i++) s->target[i] = STORAGE_MIN;
  for (size_t e = 0; e < s->edge_count; e++)
    if (s->limited[e] == 0) s->target[s->body[s->edges[e].site]] = 0;
  for (size_t i = 0; i < s->count; i++) {
    double *diagonal = &s->rows.value[s->rows.diagonal[i]];
    *diagonal = *diagonal == 0 ? 1 : *diagonal * (1 + s->target[s->body[i]]); /* 0: enclosed */
  }
}

/* Which limits hold for the present fluxes, to `near` m/s; whether any has changed. */
static bool find_limits(struct richards *s, double time, double near) {
  bool changed = false;
  const struct region *drain = NULL; /* the last that was decided */
  uint8_t now = 0;
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    const struct richards_law law = richards_law_at(s, edge, time);
    if (!(law.least < law.most)) continue;
    if (edge->kind != EDGE_DRAIN || edge->region != drain) {
      const double q =
          edge->kind == EDGE_DRAIN ? drain_flux(s, edge->region, time) : unlimited_flux(s, e, time);
      const double room = s->limited[e] > 0 ? -near : near;
      now = q < law.least - room ? 1 : q > law.most + room ? 2 : 0;
      drain = edge->kind == EDGE_DRAIN ? edge->region : NULL;
    }
    changed = changed || now != s->limited[e];
    s->limited[e] = now;
  }
  return changed;
}

/* Speeds of Forchheimer's term from the present fluxes; the largest relative change of drag. */
static double find_speeds(struct richards *s) {
  double most = 0;
  for (size_t i = 0; i < s->count; i++) {
    const struct retention *soil = &s->soils[s->soil[i]];
    const double k = soil->conductivity[0], b = soil->forchheimer;
    double v[3];
    if (!(b > 0)) continue;
    richards_velocity(s, i, v);
    const double gradient =
        sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * (1 / k + b * s->speed[i]);
    const double speed = 2 * gradient / (1 / k + sqrt(1 / (k * k) + 4 * b * gradient));
    most = fmax(most, fabs(speed - s->speed[i]) * b * k / (1 + b * k * speed));
    s->speed[i] = speed;
  }
  return most;
}

enum status richards_saturated_solve(struct richards *s, double time) {
  for (size_t e = 0; e < s->edge_count && s->step == 0; e++) {
    const struct richards_law law = richards_law_at(s, &s->edges[e], time);
    s->limited[e] = isfinite(law.least);
  }
  bool solved = false;
  double near[2];
  s->iterations = 0;
  for (int round = 0; !solved && round < SATURATED_ROUNDS_MAX; round++) {
    assemble(s, time, near);
    fix_bodies(s);
    /* Coefficients of either sign may ask for the plain factorisation. */
    if (!rows_solve(&s->rows, FILL_IN_SHARE, s->residual, LINEAR_TOLERANCE_MIN, s->change,
                    &s->linear_total) &&
        !rows_solve(&s->rows, 0, s->residual, LINEAR_TOLERANCE_MIN, s->change, &s->linear_total))
      break;
    for (size_t i = 0; i < s->count; i++) s->h[i] += s->change[i];
    const bool balanced = assemble(s, time, near), limits = find_limits(s, time, near[0]);
    solved = find_speeds(s) <= near[1] && balanced && !limits;
    s->iterations++;
  }
  s->iterations_total += s->iterations;
  for (size_t i = 0; i < s->count; i++)
    s->now[i] = (struct retention_state){
        .h = s->h[i], .theta = s->soils[s->soil[i]].theta_s, .k = part_left(s, i)};
  if (solved) return STATUS_OK;
  return FAIL(STATUS_NUMERIC,
              "%s: no steady flow is found at t = %g s: what wells and fluxes bring has to leave "
              "again, so give one side a head, or another domain.spacing may help",
              s->scene->path, time);
}
