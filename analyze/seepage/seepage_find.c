#include <math.h>
#include <string.h>

#include "analyze/seepage/flow_net.h"
#include "analyze/seepage/plane_balance.h"
#include "analyze/seepage/seepage.h"
#include "common/memory.h"

static bool is_dry(const struct head_field *f, size_t i, size_t k) {
  return i < f->nx && k < f->nz && f->soil[k * f->nx + i] != REGION_NONE &&
         isnan(f->head[k * f->nx + i]);
}

static void find_phreatic(struct seepage *s) {
  const struct head_field *f = &s->field;
  for (size_t i = 0; i < f->nx; i++) {
    s->phreatic[i] = NAN;
    for (size_t k = f->nz; k-- > 0;) {
      const size_t c = k * f->nx + i;
      if (isnan(f->head[c])) continue;
      /* Water up to a wall above has no free surface. */
      if (k + 1 < f->nz && f->wall[c + f->nx] == REGION_NONE) s->phreatic[i] = f->head[c];
      break;
    }
  }
}

/* Top cell with water of a column, if it is of soil and below a free surface; else f->nz. */
static size_t surface_cell(const struct seepage *s, size_t i) {
  const struct head_field *f = &s->field;
  if (isnan(s->phreatic[i])) return f->nz;
  for (size_t k = f->nz; k-- > 0;)
    if (!isnan(f->head[k * f->nx + i])) return f->soil[k * f->nx + i] != REGION_NONE ? k : f->nz;
  return f->nz;
}

/* The free surface by Darcy's law is at the head of the top cells: a surface that is wrong by a
 * little hardly changes the heads below it. The error of the run's is twice the root mean square of
 * the differences, with the uncertainty of that head. */
static double surface_error(const struct seepage *s) {
  const struct head_field *f = &s->field;
  double squares = 0, count = 0;
  for (size_t i = 0; i < f->nx && s->darcy.known; i++) {
    const size_t k = surface_cell(s, i), c = k * f->nx + i;
    if (k == f->nz || isnan(s->darcy.level[0].head[c])) continue;
    const struct darcy_value law =
        darcy_value_of(s->darcy.level[0].head[c], s->darcy.level[1].head[c]);
    squares += pow(s->phreatic[i] - law.value, 2) + pow(law.error, 2), count++;
  }
  return count > 0 ? 2 * sqrt(squares / count) : 0.5 * f->dz;
}

/* Columns of which the free surface is read beside a face: not the nearest, in the smeared edge of
 * soil. */
#define EXIT_COLUMNS 3

/* Where the free surface meets the upright face on the given side of column i. At a distance d from
 * the face it is A d - d ln(d)/pi above that: with the surface at d = xi(s), s above its end, and P
 * = 0 on it and on the face, what flows out of the face is -xi' beside it, and on the face the
 * conjugate of (xi^2)'/2, so that xi = pi s/ln(1/s). Least squares for A and the end. Its error
 * is that of an intercept, and half of what the logarithm adds, since terms in ln ln d are left
 * out. The end is not below the water outside. */
static void find_exit(struct seepage *s, size_t i, int side) {
  const struct head_field *f = &s->field;
  const ptrdiff_t n = (ptrdiff_t)f->nx, at = (ptrdiff_t)i, out = at + 3 * side,
                  far = at - EXIT_COLUMNS * side;
  const size_t k = surface_cell(s, i);
  double mean[3] = {0}, square = 0, along[2] = {0}; /* of d, level, d ln d / pi */
  if (k == f->nz || out < 0 || out >= n || far < 0 || far >= n) return;
  for (size_t row = k; row + EXIT_COLUMNS >= k && row < f->nz; row--) { /* wraps around at 0 */
    const size_t next = row * f->nx + (size_t)(at + side);
    if (f->soil[next] != REGION_NONE || f->wall[next] != REGION_NONE) return;
  }
  for (int m = 1; m <= EXIT_COLUMNS; m++)
    if (surface_cell(s, (size_t)(at - m * side)) == f->nz) return;
  for (int m = 1; m <= EXIT_COLUMNS; m++) {
    const double d = m + 0.5, off = d - 0.5 * (EXIT_COLUMNS + 2),
                 value[3] = {d, s->phreatic[at - m * side], d * log(d) / M_PI};
    for (int v = 0; v < 3; v++) mean[v] += value[v] / EXIT_COLUMNS;
    square += off * off;
    for (int v = 0; v < 2; v++) along[v] += off * value[v + 1];
  }
  const double level = mean[1] - mean[0] * along[0] / square,
               more = f->dx * (mean[2] - mean[0] * along[1] / square), water = s->phreatic[out],
               least = isfinite(water) ? water : 0;
  const double noise = s->surface_error * sqrt(1.0 / EXIT_COLUMNS + mean[0] * mean[0] / square);
  const double error = hypot(0.5 * more, noise);
  if (!(along[0] > 0) || !(s->phreatic[at - side] > least + f->dz) ||
      !(level + more > least - error))
    return;
  s->exits[s->exit_count++] = (struct surface_exit){.x = head_field_x(f, i) + 0.5 * side * f->dx,
                                                    .z = fmax(level + more, least),
                                                    .error = error,
                                                    .outside = water};
}

static void find_head_range(struct seepage *s) {
  const struct head_field *f = &s->field;
  double high = -INFINITY;
  s->low = INFINITY;
  for (size_t c = 0; c < f->nx * f->nz; c++)
    if (head_field_is_soil(f, c % f->nx, c / f->nx))
      s->low = fmin(s->low, f->head[c]), high = fmax(high, f->head[c]);
  s->drop = fmax(0, high - s->low);
}

/* Difference of the extreme values of psi in the soil. */
static void find_flow(struct seepage *s) {
  const struct head_field *f = &s->field;
  double least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < f->nz; k++)
    for (size_t i = 0; i < f->nx; i++) {
      if (!head_field_is_soil(f, i, k)) continue;
      for (size_t c = 0; c < 4; c++) {
        const double psi = s->psi[(k + c / 2) * (f->nx + 1) + i + c % 2];
        least = fmin(least, psi), most = fmax(most, psi);
      }
    }
  s->flow = fmax(0, most - least);
}

/* Deviation of psi from the flow through sections of soil. */
struct deviation {
  double squares, count; /* squared flow not represented by psi; number of rows and columns */
  double most;           /* largest flow through a section by Darcy's law on cells */
  double darcy;          /* difference between psi and Darcy's law in that section */
  double surface;        /* largest flow through half a cell below a free surface in soil */
};

/* Adds the sections of row (axis 1) or column (axis 0) n of cells. A section extends from wall to
 * wall, because the flow down on one side of a wall and up on the other would cancel in the whole
 * row. Its deviation is the flow by the velocities of its cells minus the flow by psi at their
 * corners; sections with free water are skipped. Also the flux of half a cell below a free surface,
 * which is the uncertainty of its position. */
static void add_deviation(const struct seepage *s, int axis, size_t n,
                          struct deviation *deviation) {
  const struct head_field *f = &s->field;
  const size_t along = axis == 0 ? f->nz : f->nx, corners = f->nx + 1;
  const double length = axis == 0 ? f->dz : f->dx;
  double sum = 0, squares = 0, stretches = 0, by_psi = 0, by_darcy = 0;
  bool water = false;
  for (size_t m = 0; m <= along; m++) {
    const size_t i = axis == 0 ? n : m, k = axis == 0 ? m : n, c = k * f->nx + i;
    if (m == along || f->wall[c] != REGION_NONE) {
      if (!water && sum != 0) {
        squares += sum * sum, stretches++;
        if (fabs(by_darcy) > deviation->most) /* false if NAN, which is unknown */
          deviation->most = fabs(by_darcy), deviation->darcy = fabs(by_psi - by_darcy);
      }
      sum = by_psi = by_darcy = 0, water = false;
      continue;
    }
    if (isnan(f->head[c])) continue;
    water = water || f->soil[c] == REGION_NONE;
    const double *p = s->psi + k * corners + i;
    const double step = axis == 0 ? 0.5 * (p[corners] + p[corners + 1] - p[0] - p[1])
                                  : 0.5 * (p[0] + p[corners] - p[1] - p[corners + 1]);
    if (water || isnan(step)) continue;
    sum += length * f->velocity[axis][c] - step;
    by_psi += step, by_darcy += darcy_flow_cell(&s->darcy, axis, c).value;
    if (axis == 0 && k + 1 < f->nz && isnan(f->head[c + f->nx]) &&
        f->wall[c + f->nx] == REGION_NONE)
      deviation->surface = fmax(deviation->surface, 0.5 * fabs(length * f->velocity[axis][c]));
  }
  if (stretches > 0) deviation->squares += squares / stretches, deviation->count++;
}

static double net_error(const struct seepage *s) {
  const struct head_field *f = &s->field;
  struct deviation deviation = {0};
  for (int axis = 0; axis < 2; axis++)
    for (size_t n = 0; n < (axis == 0 ? f->nx : f->nz); n++) add_deviation(s, axis, n, &deviation);
  if (!(deviation.count > 0)) return NAN;
  const double alike = fmax(1, deviation.count / SECTIONS_CORRELATED);
  /* If all water goes through one section, the flow of the net is that of the section. */
  const double darcy = fmin(deviation.darcy, fabs(s->flow - deviation.most));
  return hypot(hypot(2 * sqrt(deviation.squares / deviation.count / alike), deviation.surface),
               darcy);
}

/* Rate at which the soil takes up water, as the flow by psi through faces between wet and dry soil.
 * While soil fills, streamlines end at the front; in steady flow the free surface is a streamline.
 * NAN with rain, which enters there in steady flow. */
static double find_uptake(const struct head_field *f, const double *psi) {
  const size_t corners = f->nx + 1;
  double sum = 0;
  for (size_t r = 0; r < f->region_count; r++)
    if (!strcmp(f->regions[r].type, "rain")) return NAN;
  for (size_t k = 0; k < f->nz; k++)
    for (size_t i = 0; i < f->nx; i++) {
      if (!head_field_is_soil(f, i, k)) continue;
      const double *p = psi + k * corners + i;
      if (is_dry(f, i + 1, k)) sum += p[corners + 1] - p[1];
      if (i > 0 && is_dry(f, i - 1, k)) sum -= p[corners] - p[0];
      if (is_dry(f, i, k + 1)) sum -= p[corners + 1] - p[corners];
      if (k > 0 && is_dry(f, i, k - 1)) sum += p[1] - p[0];
    }
  return sum;
}

enum status seepage_find(const struct run *run, double grain_density, struct seepage *s) {
  enum status status = STATUS_OK;
  struct head_field *f = &s->field;
  *s = (struct seepage){.run = run};
  s->grain_density = isnan(grain_density) ? 2650 : grain_density;
  if (!(s->grain_density > run->density))
    TRY_FAIL(STATUS_USAGE, "--grain-density %g kg/m^3: grains lighter than the water float",
             s->grain_density);
  TRY(head_field_read(run, f));
  bool soil = false;
  for (size_t c = 0; c < f->nx * f->nz; c++)
    soil = soil || head_field_is_soil(f, c % f->nx, c / f->nx);
  if (!soil)
    TRY_FAIL(STATUS_INPUT, "%s: no water in soil between %g and %g s, so nothing seeps", run->path,
             f->from, f->to);
  TRY(flow_net_stream(f, &s->psi));
  TRY(memory_allocate(&s->phreatic, f->nx, sizeof *s->phreatic, "the phreatic line"));
  find_head_range(s);
  find_flow(s);
  for (size_t r = 0; r < f->region_count; r++)
    s->sinks = s->sinks || head_region_is_sink(&f->regions[r]);
  for (size_t c = 0; s->sinks && c < (f->nx + 1) * (f->nz + 1); c++) s->psi[c] = NAN;
  if (s->sinks) s->flow = NAN;
  s->uptake = s->sinks ? NAN : find_uptake(f, s->psi);
  TRY(asked_heads_find(f, &s->asked));
  s->law = *f;
  s->law.head = s->asked.head;
  /* NAN with sinks. */
  if (!(fabs(s->uptake) > 0.1 * s->flow)) TRY(darcy_flow_find(&s->law, &s->darcy));
  s->flow_error = s->sinks ? NAN : net_error(s);
  if (isfinite(s->uptake)) s->flow_error = hypot(s->flow_error, s->uptake);
  find_phreatic(s);
  s->surface_error = surface_error(s);
  for (int side = -1; side <= 1; side += 2) {
    const size_t found = s->exit_count;
    for (size_t n = 0; n < f->nx && s->exit_count == found; n++)
      find_exit(s, side < 0 ? n : f->nx - 1 - n, side);
  }
  TRY(lifting_find(f, s->grain_density, &s->lifting));
  TRY(lifting_set_errors(&s->darcy, s->grain_density, &s->lifting));
cleanup:
  if (status != STATUS_OK) seepage_free(s);
  return status;
}

enum status seepage_applies(const struct run *run, bool *applies) {
  struct seepage seepage = {.run = run};
  *applies = false;
  if (!head_field_is_seepage(run) || run->dimensions != 2 || run->snapshot_count == 0)
    return STATUS_OK;
  enum status status = head_field_read(run, &seepage.field);
  if (status == STATUS_INPUT) { /* of an older version, or with gravity along x */
    error_clear();
    return STATUS_OK;
  }
  if (status != STATUS_OK) return status;
  find_head_range(&seepage);
  *applies = seepage.drop > seepage.field.dz;
  seepage_free(&seepage);
  return STATUS_OK;
}

void seepage_free(struct seepage *s) {
  darcy_flow_free(&s->darcy);
  asked_heads_free(&s->asked);
  head_field_free(&s->field);
  memory_free(&s->psi);
  lifting_free(&s->lifting);
  memory_free(&s->phreatic);
}
