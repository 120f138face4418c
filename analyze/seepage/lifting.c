#include "analyze/seepage/lifting.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

double lifting_critical(double grain_density, double density, double porosity) {
  return (grain_density / density - 1) * (1 - porosity); /* 1 / (1 + e) = 1 - porosity */
}

/* Head in the soil of a column at an elevation, by linear interpolation; NAN outside of soil. */
static double head_at(const struct head_field *f, size_t i, double z) {
  const double row = z / f->dz - 0.5;
  if (!(row >= 0)) return head_field_is_soil(f, i, 0) ? f->head[i] : NAN;
  const size_t k = (size_t)row, above = head_field_is_soil(f, i, k + 1) ? k + 1 : k;
  const double t = row - (double)k;
  if (!head_field_is_soil(f, i, k)) return NAN;
  return (1 - t) * f->head[k * f->nx + i] + t * f->head[above * f->nx + i];
}

/* Head at the upper face of soil whose topmost cell is k: of the water above, read outside of the
 * smeared edge, or the elevation if there is none. */
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

/* Whether cell k is the topmost cell of soil below water or air. */
static bool is_top(const struct head_field *f, size_t i, size_t k) {
  const size_t above = (k + 1) * f->nx + i;
  return head_field_is_soil(f, i, k) && k + 1 < f->nz && f->soil[above] == REGION_NONE &&
         f->wall[above] == REGION_NONE;
}

/* Depth over which the exit gradient is averaged, in particle sizes of the soil: a layer of this
 * thickness is lifted if its mean gradient is critical (Terzaghi 1922). A gradient at a single
 * depth would miss a wall's foot just above or below it. */
#define EXIT_DEPTH_PARTICLES 2.0

/* Depth of a prism that the particles resolve, in particle sizes of the soil. */
#define PRISM_PARTICLES_MIN 4.0

struct exit_gradient {
  double mean; /* over the layer; NAN if the soil is not deep enough */
  /* At its lower end, over one particle size: away from the face, which the kernel smears. */
  double deep;
  double cells; /* uncertainty of `mean` due to cell averages and linear interpolation */
};

/* Uncertainty in m of an interpolated head: linear interpolation between two rows has an error of
 * at most h'' dz^2 / 8, and cell averages a third of that, together a sixth of the second
 * difference. */
static double interpolation_error(const struct head_field *f, size_t i, double z) {
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
  const double depth = EXIT_DEPTH_PARTICLES * size, z = (double)(k + 1) * f->dz - depth;
  const double lower = head_at(f, i, z - 0.5 * size), upper = head_at(f, i, z + 0.5 * size);
  return (struct exit_gradient){(head_at(f, i, z) - head_over(f, i, k)) / depth,
                                (lower - upper) / size, interpolation_error(f, i, z) / depth};
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
                                 .depth = EXIT_DEPTH_PARTICLES * f->dz / sqrt(porosity),
                                 .gradient = fmax(own.mean, own.deep),
                                 .deep = own.deep,
                                 .critical = critical,
                                 .error = NAN};
    }
}

/* If the foot of a wall is within the layer, the soil above the foot is lifted first, by a gradient
 * above the layer's mean: the exit is then not resolved. */
static void check_exit_resolution(const struct head_field *f, struct lifting *l) {
  struct lifting_exit *e = &l->exit;
  for (size_t n = 0; e->found && n < l->prism_count; n++) {
    const struct lifting_prism *p = &l->prisms[n];
    const struct head_region *w = &f->regions[p->wall];
    const double away = p->side < 0 ? w->low[0] - e->x : e->x - w->high[0];
    if (away > -f->dx && away < e->depth && p->depth < e->depth) e->resolved = false;
  }
}

/* Whether a box of a wall stands on another wall at its face on that side, so that the wall does
 * not end there. */
static bool continues_below(const struct head_field *f, const struct head_region *w, int side) {
  const double x = side < 0 ? w->low[0] + 0.5 * f->dx : w->high[0] - 0.5 * f->dx;
  const double z = w->low[1] - 0.5 * f->dz;
  if (!(x > 0 && z > 0)) return false;
  const size_t i = (size_t)(x / f->dx), k = (size_t)(z / f->dz);
  return i < f->nx && k < f->nz && f->wall[k * f->nx + i] != REGION_NONE;
}

/* The prism beside a wall that ends in soil; false if there is none or the water flows
 * downwards. */
static bool find_prism(const struct head_field *f, double grain_density, size_t wall, int side,
                       struct lifting_prism *prism) {
  const struct head_region *w = &f->regions[wall];
  const double face = side < 0 ? w->low[0] - 0.5 * f->dx : w->high[0] + 0.5 * f->dx;
  if (!(face > 0) || !(w->low[1] > 0) || continues_below(f, w, side)) return false;
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
      .resolved = depth >= PRISM_PARTICLES_MIN * size,
      .depth = depth,
      .width = (double)columns * f->dx,
      .gradient = (below - above) / (double)columns / depth,
      .porosity = f->regions[soil].porosity,
      .critical = lifting_critical(grain_density, f->density, f->regions[soil].porosity),
      .error = NAN};
  return true;
}

/* Adds the pressure on each face of a wall's cell that borders wet soil or water: at the face, by
 * the head of the adjacent cell. The boxes of one wall of the scene are summed. */
static void load_wall(const struct head_field *f, size_t i, size_t k, struct lifting *lifting) {
  static const int step[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  struct lifting_load *load = NULL;
  const size_t wall = f->wall[k * f->nx + i];
  for (size_t n = 0; n < lifting->load_count; n++)
    if (f->regions[lifting->loads[n].wall].number == f->regions[wall].number)
      load = &lifting->loads[n];
  for (int n = 0; n < 4; n++) {
    const size_t a = i + (size_t)step[n][0], b = k + (size_t)step[n][1]; /* wraps around below 0 */
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
  check_exit_resolution(f, l);
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

/* Uncertainty of a value: its deviation from Darcy's law on two grids, plus the uncertainty of
 * that. */
static double deviation_from_law(double value, double coarse, double fine) {
  const struct darcy_value law = darcy_value_of(coarse, fine);
  return fabs(value - law.value) + law.error;
}

/* The exit gradient is the gradient of the run below the layer, scaled to the whole layer by the
 * ratio of the two in Darcy's law. With an error of half of the value or more it is not
 * resolved. */
static void set_exit_error(const struct exit_gradient by_law[2], struct lifting_exit *e) {
  const double mean = darcy_value_of(by_law[0].mean, by_law[1].mean).value;
  const double deep = darcy_value_of(by_law[0].deep, by_law[1].deep).value;
  if (mean > 0 && deep > 0 && e->deep > 0) e->gradient = e->deep * mean / deep;
  e->error = deviation_from_law(e->gradient, by_law[0].mean, by_law[1].mean) + by_law[1].cells;
  if (!(e->error < 0.5 * e->gradient)) e->resolved = false;
}

enum status lifting_set_errors(const struct darcy_flow *darcy, double grain_density,
                               struct lifting *l) {
  enum status status = STATUS_OK;
  struct head_field law[2];
  struct lifting by_law[2] = {0};
  struct exit_gradient gradient[2];
  double *head[2] = {NULL, NULL};
  if (!darcy->known) return STATUS_OK;
  const struct head_field *f = darcy->field;
  for (int g = 0; g < 2; g++) { /* both grids */
    law[g] = *f;
    TRY(memory_allocate(&head[g], f->nx * f->nz, sizeof **head, "heads of soil"));
    for (size_t c = 0; c < f->nx * f->nz; c++)
      head[g][c] = isnan(darcy->level[g].head[c]) ? f->head[c] : darcy->level[g].head[c];
    law[g].head = head[g];
    TRY(lifting_find(&law[g], grain_density, &by_law[g]));
    if (l->exit.found) gradient[g] = exit_gradient(&law[g], l->exit.i, l->exit.k);
  }
  if (l->exit.found) set_exit_error(gradient, &l->exit);
  for (size_t n = 0; n < l->prism_count; n++) {
    struct lifting_prism *p = &l->prisms[n];
    if (p->resolved)
      p->error =
          deviation_from_law(p->gradient, gradient_of(&by_law[0], p), gradient_of(&by_law[1], p));
  }
  for (size_t n = 0; n < l->load_count;
       n++) { /* the same walls in the same order, because the same cells are wet */
    struct lifting_load *own = &l->loads[n];
    const struct lifting_load *a = &by_law[0].loads[n], *b = &by_law[1].loads[n];
    for (int c = 0; c < 2; c++)
      own->force_error[c] = deviation_from_law(own->force[c], a->force[c], b->force[c]);
    own->uplift_error = deviation_from_law(own->uplift, a->uplift, b->uplift);
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
    if (!p->resolved) spacing = fmin(spacing, p->depth / PRISM_PARTICLES_MIN * sqrt(p->porosity));
  }
  return isfinite(spacing) ? spacing : NAN;
}
