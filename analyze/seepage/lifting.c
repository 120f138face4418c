#include "analyze/seepage/lifting.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

double lifting_critical(double grain_density, double density, double porosity) {
  return (grain_density / density - 1) * (1 - porosity); /* 1 / (1 + e) = 1 - porosity */
}

/* Head in soil at an elevation between two cells of a column, NAN elsewhere. */
static double head_at(const struct head_field *f, size_t i, double z) {
  const double row = z / f->dz - 0.5;
  if (!(row >= 0)) return head_field_is_soil(f, i, 0) ? f->head[i] : NAN;
  const size_t k = (size_t)row, above = head_field_is_soil(f, i, k + 1) ? k + 1 : k;
  const double t = row - (double)k;
  if (!head_field_is_soil(f, i, k)) return NAN;
  return (1 - t) * f->head[k * f->nx + i] + t * f->head[above * f->nx + i];
}

/* Head over the upper face of soil whose topmost cell is k: of the water there, clear of the
 * smeared edge, else its elevation. */
static double head_over(const struct head_field *f, size_t i, size_t k) {
  for (size_t up = 3; up >= 1; up--) {
    const size_t c = (k + up) * f->nx + i;
    bool free = true;
    for (size_t b = k + 1; b <= k + up; b++)
      free = free && b < f->nz && f->wall[b * f->nx + i] == REGION_NONE &&
             f->soil[b * f->nx + i] == REGION_NONE;
    if (free && !isnan(f->head[c])) return f->head[c];
  }
  return (double)(k + 1) * f->dz;
}

/* Whether cell k is the topmost of soil under water or air. */
static bool is_top(const struct head_field *f, size_t i, size_t k) {
  const size_t above = (k + 1) * f->nx + i;
  return head_field_is_soil(f, i, k) && k + 1 < f->nz && f->soil[above] == REGION_NONE &&
         f->wall[above] == REGION_NONE;
}

/* The exit gradient is the mean over so many sizes of the soil's particles below its upper face: a
 * layer so deep is lifted where that is critical (Terzaghi 1922), and a gradient at one depth would
 * leave out a foot just above or below it. */
#define EXIT_SIZES 2.0

/* Of a wall in soil that the particles resolve. */
#define SIZES_DEEP 4.0

struct exit_gradient {
  double mean;  /* of the layer; NAN: there is no soil so deep */
  double deep;  /* at its lower end, over one size: clear of the face, which the kernel smears */
  double cells; /* what means of cells, and straight lines between them, leave open of `mean` */
};

/* Straight lines between two rows are off by h'' dz^2 / 8 at most and means of cells by a third of
 * that: of the second difference a sixth, m. */
static double left_by_cells(const struct head_field *f, size_t i, double z) {
  double most = 0;
  const size_t first = (size_t)fmax(1, floor(z / f->dz - 0.5));
  for (size_t k = first; k <= first + 1; k++) {
    if (!head_field_is_soil(f, i, k - 1) || !head_field_is_soil(f, i, k) ||
        !head_field_is_soil(f, i, k + 1))
      continue;
    const double *h = f->head + k * f->nx + i;
    most = fmax(most, fabs(*(h - f->nx) - 2 * *h + h[f->nx]));
  }
  return most / 6;
}

static struct exit_gradient exit_gradient(const struct head_field *f, size_t i, size_t k) {
  const double size = f->dz / sqrt(f->regions[f->soil[k * f->nx + i]].porosity);
  const double depth = EXIT_SIZES * size, z = (double)(k + 1) * f->dz - depth;
  const double lower = head_at(f, i, z - 0.5 * size), upper = head_at(f, i, z + 0.5 * size);
  return (struct exit_gradient){(head_at(f, i, z) - head_over(f, i, k)) / depth,
                                (lower - upper) / size, left_by_cells(f, i, z) / depth};
}

static void find_exit(const struct head_field *f, double grain_density, struct lifting_exit *e) {
  double most = 0;
  for (size_t i = 0; i < f->nx; i++)
    for (size_t k = 0; k < f->nz; k++) {
      if (!is_top(f, i, k)) continue;
      const size_t soil = f->soil[k * f->nx + i];
      const double porosity = f->regions[soil].porosity;
      const double critical = lifting_critical(grain_density, f->density, porosity);
      const struct exit_gradient own = exit_gradient(f, i, k);
      if (!(own.mean / critical > most)) continue;
      most = own.mean / critical;
      *e = (struct lifting_exit){.found = true,
                                 .resolved = true,
                                 .soil = soil,
                                 .i = i,
                                 .k = k,
                                 .x = head_field_x(f, i),
                                 .z = (double)(k + 1) * f->dz,
                                 .depth = EXIT_SIZES * f->dz / sqrt(porosity),
                                 .gradient = fmax(own.mean, own.deep),
                                 .deep = own.deep,
                                 .critical = critical,
                                 .error = NAN};
    }
}

/* A layer with a wall's foot in it is lifted above the foot first, by more than its mean. */
static void judge_exit(const struct head_field *f, struct lifting *l) {
  struct lifting_exit *e = &l->exit;
  for (size_t n = 0; e->found && n < l->prism_count; n++) {
    const struct lifting_prism *p = &l->prisms[n];
    const struct head_region *w = &f->regions[p->wall];
    const double away = p->side < 0 ? w->low[0] - e->x : e->x - w->high[0];
    if (away > -f->dx && away < e->depth && p->depth < e->depth) e->resolved = false;
  }
}

/* Whether a box of a wall stands on another one at its face to that side: its foot is no end. */
static bool goes_on(const struct head_field *f, const struct head_region *w, int side) {
  const double x = side < 0 ? w->low[0] + 0.5 * f->dx : w->high[0] - 0.5 * f->dx;
  const double z = w->low[1] - 0.5 * f->dz;
  if (!(x > 0 && z > 0)) return false;
  const size_t i = (size_t)(x / f->dx), k = (size_t)(z / f->dz);
  return i < f->nx && k < f->nz && f->wall[k * f->nx + i] != REGION_NONE;
}

/* The prism beside a wall that ends in soil; false where there is none, or the water goes down. */
static bool find_prism(const struct head_field *f, double grain_density, size_t wall, int side,
                       struct lifting_prism *prism) {
  const struct head_region *w = &f->regions[wall];
  const double face = side < 0 ? w->low[0] - 0.5 * f->dx : w->high[0] + 0.5 * f->dx;
  if (!(face > 0) || !(w->low[1] > 0) || goes_on(f, w, side)) return false;
  const size_t first = (size_t)(face / f->dx), base = (size_t)(w->low[1] / f->dz);
  size_t top = base, columns = 0;
  if (!head_field_is_soil(f, first, base)) return false;
  while (head_field_is_soil(f, first, top) && !is_top(f, first, top)) top++;
  if (!is_top(f, first, top)) return false;
  const double depth = (double)(top + 1) * f->dz - w->low[1];
  const size_t wanted = (size_t)fmax(1, round(0.5 * depth / f->dx));
  double below = 0, above = 0;
  for (size_t n = 0; n < wanted; n++) {
    const size_t i = side < 0 ? first - n : first + n;
    if ((side < 0 && n > first) || !is_top(f, i, top)) break;
    const double head = head_at(f, i, w->low[1]);
    if (isnan(head)) break;
    below += head, above += head_over(f, i, top), columns++;
  }
  if (columns == 0 || !(below > above)) return false;
  const size_t soil = f->soil[top * f->nx + first];
  const double size = f->dz / sqrt(f->regions[soil].porosity);
  *prism = (struct lifting_prism){
      .wall = wall,
      .side = side,
      .resolved = depth >= SIZES_DEEP * size,
      .depth = depth,
      .width = (double)columns * f->dx,
      .gradient = (below - above) / (double)columns / depth,
      .porosity = f->regions[soil].porosity,
      .critical = lifting_critical(grain_density, f->density, f->regions[soil].porosity),
      .error = NAN};
  return true;
}

/* Pressure on each wet face between a wall's cell and one of water or soil; at the face, by the
 * head of the cell before it. The boxes of one wall of the scene are one. */
static void load_wall(const struct head_field *f, size_t i, size_t k, struct lifting *lifting) {
  static const int step[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  struct lifting_load *load = NULL;
  const size_t wall = f->wall[k * f->nx + i];
  for (size_t n = 0; n < lifting->load_count; n++)
    if (f->regions[lifting->loads[n].wall].number == f->regions[wall].number)
      load = &lifting->loads[n];
  for (int n = 0; n < 4; n++) {
    const size_t a = i + (size_t)step[n][0], b = k + (size_t)step[n][1]; /* wraps below 0 */
    if (a >= f->nx || b >= f->nz || isnan(f->head[b * f->nx + a])) continue;
    const double z = head_field_z(f, k) + 0.5 * step[n][1] * f->dz;
    const double pressure = fmax(0, f->density * f->gravity * (f->head[b * f->nx + a] - z));
    const double length = step[n][0] != 0 ? f->dz : f->dx;
    if (load == NULL) {
      load = &lifting->loads[lifting->load_count++];
      *load = (struct lifting_load){.wall = wall, .force_error = {NAN, NAN}, .uplift_error = NAN};
    }
    for (int c = 0; c < 2; c++) load->force[c] -= step[n][c] * pressure * length;
    if (step[n][1] < 0) load->uplift += pressure * length, load->length += length;
  }
}

enum status lifting_find(const struct head_field *f, double grain_density, struct lifting *l) {
  enum status status = STATUS_OK;
  *l = (struct lifting){0};
  TRY(memory_allocate(&l->prisms, 2 * f->region_count, sizeof *l->prisms, "walls"));
  TRY(memory_allocate(&l->loads, f->region_count, sizeof *l->loads, "walls"));
  find_exit(f, grain_density, &l->exit);
  for (size_t r = 0; r < f->region_count; r++)
    for (int side = -1; side <= 1; side += 2)
      if (!strcmp(f->regions[r].type, "wall") &&
          find_prism(f, grain_density, r, side, &l->prisms[l->prism_count]))
        l->prism_count++;
  judge_exit(f, l);
  for (size_t k = 0; k < f->nz; k++)
    for (size_t i = 0; i < f->nx; i++)
      if (f->wall[k * f->nx + i] != REGION_NONE) load_wall(f, i, k, l);
  for (size_t n = 0; n < l->load_count; n++)
    if (l->loads[n].length > 0) l->loads[n].pressure = l->loads[n].uplift / l->loads[n].length;
cleanup:
  if (status != STATUS_OK) lifting_free(l);
  return status;
}

void lifting_free(struct lifting *l) {
  memory_free(&l->prisms);
  memory_free(&l->loads);
}

static double gradient_of(const struct lifting *l, const struct lifting_prism *like) {
  for (size_t n = 0; n < l->prism_count; n++)
    if (l->prisms[n].wall == like->wall && l->prisms[n].side == like->side)
      return l->prisms[n].gradient;
  return NAN;
}

/* What a value is off one that is known on two grids. */
static double off(double value, double coarse, double fine) {
  const struct darcy_value law = darcy_value_of(coarse, fine);
  return fabs(value - law.value) + law.error;
}

/* The run's gradient below the layer, and from there up to the face as the law has it. A bar of
 * half of the value or more says nothing. */
static void hold_exit(const struct exit_gradient by_law[2], struct lifting_exit *e) {
  const double mean = darcy_value_of(by_law[0].mean, by_law[1].mean).value;
  const double deep = darcy_value_of(by_law[0].deep, by_law[1].deep).value;
  if (mean > 0 && deep > 0 && e->deep > 0) e->gradient = e->deep * mean / deep;
  e->error = off(e->gradient, by_law[0].mean, by_law[1].mean) + by_law[1].cells;
  if (!(e->error < 0.5 * e->gradient)) e->resolved = false;
}

enum status lifting_hold_against(const struct darcy_flow *darcy, double grain_density,
                                 struct lifting *l) {
  enum status status = STATUS_OK;
  struct head_field law[2];
  struct lifting by_law[2] = {0};
  struct exit_gradient gradient[2];
  double *head[2] = {NULL, NULL};
  if (!darcy->known) return STATUS_OK;
  const struct head_field *f = darcy->field;
  for (int g = 0; g < 2; g++) { /* grids */
    law[g] = *f;
    TRY(memory_allocate(&head[g], f->nx * f->nz, sizeof **head, "heads of soil"));
    for (size_t c = 0; c < f->nx * f->nz; c++)
      head[g][c] = isnan(darcy->level[g].head[c]) ? f->head[c] : darcy->level[g].head[c];
    law[g].head = head[g];
    TRY(lifting_find(&law[g], grain_density, &by_law[g]));
    if (l->exit.found) gradient[g] = exit_gradient(&law[g], l->exit.i, l->exit.k);
  }
  if (l->exit.found) hold_exit(gradient, &l->exit);
  for (size_t n = 0; n < l->prism_count; n++) {
    struct lifting_prism *p = &l->prisms[n];
    if (p->resolved) p->error = off(p->gradient, gradient_of(&by_law[0], p), gradient_of(&by_law[1], p));
  }
  for (size_t n = 0; n < l->load_count;
       n++) { /* the same walls in the same order: the same cells are wet */
    struct lifting_load *own = &l->loads[n];
    const struct lifting_load *a = &by_law[0].loads[n], *b = &by_law[1].loads[n];
    for (int c = 0; c < 2; c++) own->force_error[c] = off(own->force[c], a->force[c], b->force[c]);
    own->uplift_error = off(own->uplift, a->uplift, b->uplift);
  }
cleanup:
  for (int g = 0; g < 2; g++) {
    lifting_free(&by_law[g]);
    memory_free(&head[g]);
  }
  return status;
}

double lifting_resolving_spacing(const struct lifting *l) {
  double spacing = INFINITY;
  for (size_t n = 0; n < l->prism_count; n++) {
    const struct lifting_prism *p = &l->prisms[n];
    if (!p->resolved) spacing = fmin(spacing, p->depth / SIZES_DEEP * sqrt(p->porosity));
  }
  return isfinite(spacing) ? spacing : NAN;
}
