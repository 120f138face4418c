#include "sphsolve/stokes/solver/soil.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/stokes/effects/soil_drag.h"
#include "sphsolve/stokes/effects/soil_viscosity.h"

/* Enclosed pores are treated as soil of porosity ENCLOSED_POROSITY and of ENCLOSED_FACTOR times the
 * largest permeability of soil. If the model has soil of more than ENCLOSED_PERMEABILITY_MAX
 * (spacing^2) they stay pores. */
#define ENCLOSED_PERMEABILITY_MAX 2e-3
/* Enclosed pores that touch other pores only over an edge or a corner have links to them that the
 * preconditioner, which couples over faces, does not contain. They get the largest permeability of
 * soil itself; with ENCLOSED_FACTOR times that value the solve would take four times the
 * iterations. */
enum { ENCLOSED_PORE = 1, ENCLOSED_TOUCHING };

bool stokes_soil_is(const struct stokes_soil *s, const struct lattice *l, size_t site) {
  return (s->enclosed && s->enclosed[site]) || lattice_is_soil(l, site);
}

/* Whether a pore touches others only over an edge or a corner: some pore among its 26 neighbours is
 * not connected to it over faces within these. */
static bool touches_over_edges_only(const struct lattice *l, const uint8_t *kind, size_t site) {
  const size_t *size = l->size;
  const size_t at[3] = {site % size[0], site / size[0] % size[1], site / size[0] / size[1]};
  static const int step[3] = {1, 3, 9};
  bool pore[27], joined[27] = {[13] = true};
  for (int n = 0; n < 27; n++) {
    const size_t off[3] = {(size_t)(n % 3), (size_t)(n / 3 % 3), (size_t)(n / 9)};
    size_t i[3];
    for (int a = 0; a < 3; a++) i[a] = (at[a] + off[a] + size[a] - 1) % size[a];
    pore[n] = kind[(i[2] * size[1] + i[1]) * size[0] + i[0]] == SITE_FLUID;
  }
  for (bool more = true; more;) {
    more = false;
    for (int n = 0; n < 27; n++)
      for (int a = 0; a < 3 && pore[n] && !joined[n]; a++) {
        const int along = n / step[a] % 3;
        joined[n] = (along > 0 && joined[n - step[a]]) || (along < 2 && joined[n + step[a]]);
        more = more || joined[n];
      }
  }
  for (int n = 0; n < 27; n++)
    if (pore[n] && !joined[n]) return true;
  return false;
}

static enum status find_enclosed(const struct lattice *l, const double driving[3],
                                 struct stokes_soil *s) {
  enum status status = STATUS_OK;
  struct lattice pores = *l;
  uint8_t *flowing = NULL;
  bool flows;
  const double most = lattice_soil_most(l), moved = l->micro_moved > 0.0 ? l->micro_moved : 1.0;
  s->enclosed_permeability = ENCLOSED_FACTOR * most / (s->unit * s->unit);
  if (s->enclosed_permeability / moved > ENCLOSED_FACTOR * ENCLOSED_PERMEABILITY_MAX)
    return STATUS_OK;
  pores.kind = NULL;
  TRY(memory_allocate(&pores.kind, l->count, 1, "the soil"));
  TRY(memory_allocate(&flowing, l->count, 1, "labels of the pores"));
  TRY(memory_allocate(&s->enclosed, l->count, 1, "the soil"));
  for (size_t i = 0; i < l->count; i++)
    pores.kind[i] = lattice_is_soil(l, i) ? SITE_WALL : l->kind[i];
  TRY(percolation_find(&pores, driving, false, flowing, &flows));
  for (size_t i = 0; i < l->count; i++)
    s->enclosed[i] = pores.kind[i] == SITE_FLUID && flowing[i] != PERCOLATION_FLOWS;
  for (bool more = true; more;) { /* a site that became soil may have connected others */
    more = false;
    for (size_t i = 0; i < l->count; i++) {
      if (s->enclosed[i] != ENCLOSED_PORE || !touches_over_edges_only(l, pores.kind, i)) continue;
      s->enclosed[i] = ENCLOSED_TOUCHING;
      more = true;
    }
    for (size_t i = 0; more && i < l->count; i++)
      if (s->enclosed[i] == ENCLOSED_TOUCHING) pores.kind[i] = SITE_WALL;
  }
cleanup:
  MEMORY_FREE(&pores.kind, &flowing);
  return status;
}

/* Permeability of soil or of an enclosed pore, spacing^2. */
static double permeability_at(const struct stokes_soil *s, const struct lattice *l, size_t site) {
  const int enclosed = s->enclosed ? s->enclosed[site] : 0;
  if (enclosed == ENCLOSED_PORE) return s->enclosed_permeability;
  if (enclosed == ENCLOSED_TOUCHING) return s->enclosed_permeability / ENCLOSED_FACTOR;
  return (double)l->micro_permeability[site] / (s->unit * s->unit);
}

/* Harmonic mean of two mobilities, over that of a pore, minus the first product V_0(a) V_0(b). */
static double mobility_remainder(double a, double b) {
  return 2.0 * a * b / (a + b) - stokes_soil_mobility_to_pore(a) * stokes_soil_mobility_to_pore(b);
}

struct stokes_soil_site stokes_soil_at(const struct stokes_soil *s, const struct lattice *l,
                                       size_t site) {
  const bool enclosed = s->enclosed && s->enclosed[site];
  if (!enclosed && !lattice_is_soil(l, site))
    return (struct stokes_soil_site){.permeability = INFINITY,
                                     .slip = INFINITY,
                                     .relative = 1.0,
                                     .viscosity = {1.0},
                                     .mobility = {1.0}};
  const double n = enclosed ? ENCLOSED_POROSITY : (double)l->micro_porosity[site];
  const double k = permeability_at(s, l, site);
  const double m = stokes_soil_mobility(k);
  const double viscosity = stokes_soil_viscosity_to_pore(n, k);
  const double second = s->pivot > 0.0 ? mobility_remainder(m, s->pivot) /
                                             sqrt(mobility_remainder(s->pivot, s->pivot))
                                       : 0.0;
  return (struct stokes_soil_site){
      .soil = true,
      .permeability = k,
      .slip = stokes_soil_slip(n, k),
      .relative = m,
      .viscosity = {viscosity, sqrt(fmax(1.0 / n - viscosity * viscosity, 0.0))},
      .mobility = {stokes_soil_mobility_to_pore(m),
                   sqrt(fmax(mobility_remainder(m, m) - second * second, 0.0)), second}};
}

/* The mobility of soil nearest to the geometric mean of the least and the largest; 0 if all are
 * alike. */
static double find_pivot(const struct stokes_soil *s, const struct lattice *l) {
  double least = INFINITY, most = 0.0, pivot = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < l->count; i++) {
      if (!stokes_soil_is(s, l, i)) continue;
      const double m = stokes_soil_mobility(permeability_at(s, l, i)), middle = sqrt(least * most);
      if (pass == 0)
        least = fmin(least, m), most = fmax(most, m);
      else if (pivot == 0.0 || fabs(log(m / middle)) < fabs(log(pivot / middle)))
        pivot = m;
    }
  return most > SOIL_MOBILITY_RATIO * least ? pivot : 0.0;
}

/* The largest thickness sqrt(k / n) of the boundary layer beneath a surface of soil, in
 * spacings. */
static double boundary_layer(const struct stokes_soil *s, const struct lattice *l) {
  double most = 0.0;
  for (size_t i = 0; i < l->count; i++)
    if (lattice_is_soil(l, i))
      most = fmax(most, (double)l->micro_permeability[i] / (double)l->micro_porosity[i]);
  return sqrt(most) / s->unit;
}

static enum status allocate(size_t n, int count, struct stokes_weights *weights) {
  enum status status = STATUS_OK;
  weights->count = count;
  for (int s = 0; s < count; s++)
    TRY(memory_allocate(&weights->value[s], n, sizeof *weights->value[s], "the soil"));
cleanup:
  return status;
}

enum status stokes_soil_build(const struct lattice *lattice, const struct stokes_grid *grid,
                              const double driving[3], double unit, struct stokes_soil **built) {
  enum status status = STATUS_OK;
  struct stokes_soil *s = NULL;
  if (lattice->micro_porosity == NULL) return STATUS_OK;
  TRY(memory_allocate(built, 1, sizeof **built, "the soil"));
  s = *built;
  s->unit = unit;
  TRY(memory_allocate(&s->force_defect, (size_t)lattice->dimensions * grid->active,
                      sizeof *s->force_defect, "the soil"));
  TRY(find_enclosed(lattice, driving, s));
  s->pivot = find_pivot(s, lattice);
  const double layer = boundary_layer(s, lattice);
  s->thick_layer = layer > THICK_LAYER;
  TRY(allocate(grid->active, layer > THIN_LAYER ? 2 : 1, &s->viscosity));
  TRY(allocate(grid->active, s->pivot > 0.0 ? 3 : 2, &s->mobility));
  TRY(memory_allocate(&s->relative, grid->active, sizeof *s->relative, "the soil"));
  TRY(memory_allocate(&s->row_scale, grid->active, sizeof *s->row_scale, "the soil"));
  TRY(memory_allocate(&s->rows, grid->rows, sizeof *s->rows, "the soil"));
#pragma omp parallel for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    size_t n = grid->row_start[row];
    for (size_t i = 0; i < grid->size[0]; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      const struct stokes_soil_site at = stokes_soil_at(s, lattice, row * grid->size[0] + i);
      for (int v = 0; v < s->viscosity.count; v++)
        s->viscosity.value[v][n] = (float)at.viscosity[v];
      for (int v = 0; v < s->mobility.count; v++) s->mobility.value[v][n] = (float)at.mobility[v];
      s->relative[n] = (float)at.relative;
      s->row_scale[n] = (float)sqrt(at.relative);
      s->rows[row] = s->rows[row] || at.soil;
      n++;
    }
  }
cleanup:
  return status;
}

void stokes_soil_free(struct stokes_soil **soil) {
  struct stokes_soil *s = *soil;
  if (s == NULL) return;
  for (int v = 0; v < STOKES_SOIL_SUMS; v++) {
    MEMORY_FREE(&s->viscosity.value[v], &s->mobility.value[v]);
  }
  MEMORY_FREE(&s->enclosed, &s->force_defect, &s->relative, &s->row_scale, &s->rows);
  memory_free(soil);
}
