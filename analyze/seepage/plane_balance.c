#include "analyze/seepage/plane_balance.h"

#include <math.h>
#include <string.h>

#include "analyze/run_places.h"

/* Whether water may enter or leave between two positions on an axis (0 x, 1 z). */
static bool is_open_between(const struct head_field *f, int axis, double a, double b) {
  for (size_t r = 0; r < f->region_count; r++)
    if ((!strcmp(f->regions[r].type, "inflow") || head_region_is_source(&f->regions[r])) &&
        f->regions[r].low[axis] < fmax(a, b) && f->regions[r].high[axis] > fmin(a, b))
      return true;
  return false;
}

/* Flux through row or column n of cells, and its wet lengths in soil and in free water. */
static double section(const struct head_field *f, int axis, size_t n, double *soil, double *water) {
  const size_t along = axis == 0 ? f->nz : f->nx;
  const double length = axis == 0 ? f->dz : f->dx;
  double flux = 0;
  *soil = *water = 0;
  for (size_t m = 0; m < along; m++) {
    const size_t c = axis == 0 ? m * f->nx + n : n * f->nx + m;
    if (f->wall[c] != REGION_NONE || isnan(f->head[c])) continue;
    *(f->soil[c] != REGION_NONE ? soil : water) += length;
    flux += length * f->velocity[axis][c];
  }
  return flux;
}

double plane_balance(const struct run *run, const struct head_field *f, const char *name,
                     double mean, bool *in_water) {
  int axis = 0;
  double place = 0, soil, water, sum = 0, squares = 0, count = 0;
  if (in_water != NULL) *in_water = false;
  if (!place_of_plane(run, name, &axis, &place) || (axis != 0 && axis != 2)) return NAN;
  if (axis == 2) axis = 1; /* index in head_field: x, z */
  const size_t sections = axis == 0 ? f->nx : f->nz;
  const double step = axis == 0 ? f->dx : f->dz;
  for (size_t n = 0; n < sections; n++) {
    const double at = ((double)n + 0.5) * step;
    const double flux = section(f, axis, n, &soil, &water);
    if (fabs(at - place) <= 0.51 * step && water > 0 && in_water != NULL) *in_water = true;
    if (water > 0 || !(soil > 0) || is_open_between(f, axis, at, place)) continue;
    sum += flux, squares += flux * flux, count++;
  }
  if (count < 3) return NAN;
  const double reference = sum / count;
  const double scatter = 2 * sqrt(fmax(0, squares / count - reference * reference) /
                                  fmax(1, count / SECTIONS_CORRELATED));
  return hypot(mean - reference, scatter);
}
