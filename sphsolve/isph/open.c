#include "sphsolve/isph/open.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/particles.h"
#include "sphsolve/isph/radiation.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/sort.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/window.h"
#include "sphsolve/isph/constants.h"

/* Windows in the sides of the domain (open sides). Behind a window are columns of boundary
 * particles that move with the water (the buffer zones of Lastiwka, Basa, Quinlan 2009, one column
 * for each cell of the window). With a fixed head they carry the hydrostatic pressure of that head
 * and take their speed from the water before them; with a fixed flux they have its speed. The
 * foremost particle becomes water as it crosses the side; a particle that leaves becomes the
 * foremost. So the water always sees the same spacing on both sides, and a given flux is exact in
 * mass. */

/* Whether the head of a side changes in time. Its window is open up to the highest. */
static bool head_varies(const struct isph_open_side *side) {
  return side->kind == BOUNDARY_OPEN_HEAD &&
         (side->region->table.count > 0 || side->region->radiates);
}

/* Porosity of the soil at a place on a side, taking its edges as sharp; 1 in free water. */
static double porosity_at(const struct isph *s, const double x[3]) {
  double porosity = 1, near = 1e-6 * s->spacing;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    bool inside = region->type == REGION_POROUS;
    for (int a = 0; a < 3; a++)
      if (isph_uses_axis(s, a))
        inside = inside && x[a] >= region->box[a] - near && x[a] <= region->box[a + 3] + near;
    if (inside) porosity = region->porosity;
  }
  return porosity;
}

/* Adds a window of uniform porosity, whose columns are as far apart as the particles before it. */
static enum status add_side(struct isph *s, struct isph_open_side side) {
  double middle[3];
  size_t columns = 1;
  for (int a = 0; a < 3; a++) middle[a] = 0.5 * (side.low[a] + side.high[a]);
  middle[side.axis] = side.edge;
  side.porosity = porosity_at(s, middle);
  const double apart = s->spacing * pow(s->mass_ratio / side.porosity, 1.0 / s->dimensions);
  for (int a = 0; a < 3; a++) {
    double width = side.high[a] - side.low[a];
    side.cells[a] =
        a == side.axis || !isph_uses_axis(s, a) ? 1 : (int)fmax(1, round(width / apart));
    side.pitch[a] = a == side.axis ? s->spacing : width / side.cells[a];
    columns *= (size_t)side.cells[a];
  }
  side.first = s->column_count;
  s->column_count += columns;
  enum status status =
      memory_resize(&s->sides, s->side_count + 1, sizeof *s->sides, "inflow regions");
  if (status == STATUS_OK) s->sides[s->side_count++] = side;
  return status;
}

/* Whether the box of region k continues beyond its face e in another box of its polygon. */
static bool continues_beyond(const struct isph *s, size_t k, int e) {
  const struct region *region = &s->scene->regions[k];
  const double near = 1e-6 * s->spacing;
  for (size_t j = region->first; j < region->end; j++) {
    const double *own = region->box, *other = s->scene->regions[j].box;
    bool meets = fabs(own[e] - other[(e + 3) % 6]) < near;
    for (int a = 0; a < 3; a++)
      if (a != e % 3) meets = meets && own[a] < other[a + 3] + near && other[a] < own[a + 3] + near;
    if (meets) return true;
  }
  return false;
}

/* Divides a window where soil begins or ends along it, first along one axis, then the other. */
static enum status split_window(struct isph *s, const struct isph_open_side *side) {
  const double near = 1e-6 * s->spacing;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    if (region->type != REGION_POROUS) continue;
    bool touches = true;
    for (int a = 0; a < 3; a++)
      if (isph_uses_axis(s, a))
        touches = touches && (a == side->axis ? side->edge >= region->box[a] - near &&
                                                    side->edge <= region->box[a + 3] + near
                                              : side->low[a] < region->box[a + 3] - near &&
                                                    side->high[a] > region->box[a] + near);
    for (int e = 0; e < 6 && touches; e++) {
      const int a = e % 3;
      if (a == side->axis || !isph_uses_axis(s, a)) continue;
      if (!(region->box[e] > side->low[a] + near && region->box[e] < side->high[a] - near))
        continue;
      if (region->is_part && continues_beyond(s, k, e)) continue;
      struct isph_open_side below = *side, above = *side;
      below.high[a] = above.low[a] = region->box[e];
      enum status status = split_window(s, &below);
      return status == STATUS_OK ? split_window(s, &above) : status;
    }
  }
  return add_side(s, *side);
}

enum status isph_open_create(struct isph *s) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    if (region->type != REGION_INFLOW) continue;
    struct isph_open_side side = {.region = region};
    bool at_low = false;
    side.axis = scene_inflow_axis(scene, region, &at_low);
    side.inward = at_low ? 1 : -1;
    for (int a = 0; a < 3; a++) side.low[a] = region->box[a], side.high[a] = region->box[a + 3];
    side.edge = side.inward > 0 ? s->low[side.axis] : s->high[side.axis];
    side.head = region->boundary == BOUNDARY_HEAD ? isph_window_highest(region) : region->head;
    side.flux = region->flux;
    if (region->radiates) side.head = INFINITY; /* waves reach as high as the window */
    if (region->boundary == BOUNDARY_FLUX) side.velocity[side.axis] = side.flux * side.inward;
    side.kind = region->boundary == BOUNDARY_FLUX ? BOUNDARY_OPEN_FLUX : BOUNDARY_OPEN_HEAD;
    TRY(split_window(s, &side));
  }
  TRY(memory_allocate(&s->columns, s->column_count, sizeof *s->columns, "inflow regions"));
  TRY(memory_allocate(&s->column_front, s->column_count, sizeof *s->column_front,
                      "inflow regions"));
cleanup:
  return status;
}

/* Number of particles of a column: one more than a support needs, since the foremost moves away
 * from the side. */
static int column_layers(const struct isph *s, const struct isph_column *column) {
  return (int)ceil(s->support_max / column->pitch - 1e-9) + 1;
}

#define DRY_DISTANCE 100.0 /* in supports: distance at which a dry column is kept */

static void place_column(struct isph *s, size_t c) {
  const struct isph_column *column = &s->columns[c];
  const struct isph_open_side *side = &s->sides[column->side];
  /* A dry column of a head that varies in time is kept out of reach of the water. */
  const double front = column->dry ? DRY_DISTANCE * s->support_max : s->column_front[c];
  if (column->first == SIZE_MAX) return;
  for (int l = 0; l < column_layers(s, column); l++)
    s->boundary_position[column->first + (size_t)l][side->axis] =
        side->edge - side->inward * (front + l * column->pitch);
}

void isph_apply_tables(struct isph *s, double dt) {
  const double t = s->time + dt;
  bool heads = false;
  for (size_t b = 1; b < s->wall_box_count; b++) {
    struct isph_wall_box *box = &s->wall_boxes[b];
    const struct time_table *table = &box->region->table;
    for (int a = 0; a < 3 && table->count > 0; a++)
      box->velocity[a] = dt > 0 && !s->on_trial ? time_table_integral(table, s->time, t, a) / dt
                                                : time_table_at(table, t, a);
  }
  for (size_t k = 0; k < s->side_count; k++) {
    struct isph_open_side *side = &s->sides[k];
    const struct region *region = side->region;
    if (region->table.count == 0 && !region->radiates) continue;
    side->given = region->table.count > 0 ? time_table_at(&region->table, t, 0) : region->head;
    if (side->kind == BOUNDARY_OPEN_HEAD)
      side->head = isph_radiation_head(s, side), heads = true;
    else
      side->flux = side->given, side->velocity[side->axis] = side->flux * side->inward;
  }
  if (heads) isph_wall_move(s, 0);
}

void isph_open_update_dry(struct isph *s, bool place) {
  for (size_t c = 0; c < s->column_count; c++) {
    struct isph_column *column = &s->columns[c];
    const struct isph_open_side *side = &s->sides[column->side];
    if (!head_varies(side)) continue;
    if (column->first == SIZE_MAX) continue;
    const bool dry = !(isph_window_pressure(s, side, column->at[2]) > 0);
    if (dry == column->dry) continue;
    column->dry = dry;
    if (!place) continue;
    column->speed = 0;
    s->column_front[c] = 0.5 * column->pitch;
    place_column(s, c);
  }
}

enum status isph_open_fill(struct isph *s, size_t *capacity) {
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    for (int c = 0; c < side->cells[0] * side->cells[1] * side->cells[2]; c++) {
      struct isph_column *column = &s->columns[side->first + (size_t)c];
      int at[3] = {c % side->cells[0], c / side->cells[0] % side->cells[1],
                   c / side->cells[0] / side->cells[1]};
      double x[3];
      for (int a = 0; a < 3; a++) x[a] = side->low[a] + (at[a] + 0.5) * side->pitch[a];
      x[side->axis] = side->edge;
      memcpy(column->at, x, sizeof x);
      column->side = k;
      column->first = s->boundary_count;
      /* Each holds as much water as a particle of free water, with the smoothed porosity there. */
      double area = 1, porosity = 1;
      for (int a = 0; a < 3; a++)
        if (isph_uses_axis(s, a) && a != side->axis) area *= side->pitch[a];
      if (s->on.soil) {
        struct soil_point soil;
        isph_soil_at(s, x, 0, &soil);
        porosity = soil.porosity;
      }
      column->pitch = side->porosity < 1 || porosity < 1
                          ? s->wall_volume * s->mass_ratio / (porosity * area)
                          : s->spacing;
      column->volume = area * column->pitch;
      s->column_front[side->first + (size_t)c] = 0.5 * column->pitch;
      column->dry = side->kind == BOUNDARY_OPEN_HEAD && !(isph_window_pressure(s, side, x[2]) > 0);
      if (column->dry) {
        column->first = SIZE_MAX;
        continue;
      }
      for (int l = 0; l < column_layers(s, column); l++) {
        x[side->axis] = side->edge - side->inward * (l + 0.5) * column->pitch;
        enum status status = isph_boundary_add(s, capacity, x, side->kind, k, column->volume);
        if (status != STATUS_OK) return status;
      }
    }
  }
  return STATUS_OK;
}

/* The water beyond a side of given head is at rest, as in a reservoir. On its way in at the
 * velocity u it gains its kinetic energy from the pressure (Bernoulli), which on the side is P =
 * rho g (head - z) - rho u^2/2, and what flows out takes its own along (the condition of total
 * pressure; stability: Bruneau, Fabrie 1994, Int. J. Numer. Methods Fluids 19). With the whole head
 * the side would give rho u^3/2 for nothing, and shallow water beside it would go on sloshing.
 * Where the side lets waves out, the water beyond moves with them. */
static void take_velocity_head(struct isph *s, size_t k, double u) {
  const struct isph_open_side *side = &s->sides[k];
  if (!s->on.surface || side->region->radiates) return;
  const size_t end = side->first + (size_t)(side->cells[0] * side->cells[1] * side->cells[2]);
  for (size_t c = side->first; c < end; c++) {
    const struct isph_column *column = &s->columns[c];
    if (column->first == SIZE_MAX) continue;
    const double still = isph_window_pressure(s, side, column->at[2]);
    const double pressure = still - fmin(fmax(0, still), 0.5 * s->density * u * u);
    for (int l = 0; l < column_layers(s, column); l++)
      s->boundary_pressure[column->first + (size_t)l] = pressure;
  }
}

/* A given pressure does not determine the velocity along a window or its profile, and without
 * further conditions jets and eddies grow there. So within a spacing of a window free water moves
 * normal to it, and with a uniform velocity where it flows in; between one and two spacings this
 * fades out. In soil the drag has the same effect. */
void isph_open_straighten(struct isph *s) {
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    if (side->kind != BOUNDARY_OPEN_HEAD) continue;
    const int n = side->axis;
    const double reach = 2 * s->spacing;
    double total[2], mean = 0; /* volume, and volume times velocity */
    for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for schedule(static)
      for (size_t c = 0; c < s->chunk_count; c++) {
        double sum[2] = {0};
        for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
          double depth = isph_window_depth(s, side, s->position[i]);
          if (depth >= reach || (s->on.soil && s->soil_fraction[i] > 0)) continue;
          double *v = s->predicted[i], *given = s->applied[i].straightened;
          double keep = fmin(1, fmax(0, depth / s->spacing - 1));
          if (pass == 0) {
            sum[0] += s->volume[i], sum[1] += s->volume[i] * v[n];
            continue;
          }
          for (int a = 0; a < 3; a++) given[a] -= v[a];
          for (int a = 0; a < 3; a++)
            if (a != n) v[a] *= keep;
          if (mean * side->inward > 0) v[n] = keep * v[n] + (1 - keep) * mean;
          for (int a = 0; a < 3; a++) given[a] += v[a];
        }
        memcpy(s->sums[c], sum, sizeof sum);
      }
      if (pass > 0) break;
      isph_sum_chunks(s, 2, total);
      if (total[0] > 0) mean = total[1] / total[0];
    }
    take_velocity_head(s, k, fmax(0, mean * side->inward));
  }
}

enum status isph_open_measure(struct isph *s) {
  enum status status = STATUS_OK, worst = STATUS_OK;
  double(*measured)[2] = NULL; /* [columns]: kernel sum of water, and its velocity along the axis */
  TRY(memory_allocate(&measured, s->column_count, sizeof *measured, "inflow regions"));
  for (size_t c = 0; c < s->column_count; c++) {
    const struct isph_column *column = &s->columns[c];
    const struct isph_open_side *side = &s->sides[column->side];
    double velocity[3];
    if (column->dry || side->kind == BOUNDARY_OPEN_FLUX || !isph_answers_for(s, column->at))
      continue;
    const double size = isph_size_of(s, column->volume);
    const double support = fmin(s->support_max, s->scene->isph.support_ratio * size);
    status = isph_probe(s, column->at, support, &measured[c][0], velocity);
    if (status != STATUS_OK) worst = status;
    measured[c][1] = velocity[side->axis];
  }
  TRY(ranks_agree(worst));
  if (s->column_count > 0) ranks_sum_all(&measured[0][0], 2 * s->column_count);
  for (size_t c = 0; c < s->column_count; c++) {
    struct isph_column *column = &s->columns[c];
    const struct isph_open_side *side = &s->sides[column->side];
    double porosity = 1;
    struct soil_point soil;
    if (column->dry) continue;
    if (s->on.soil) {
      isph_soil_at(s, column->at, 0, &soil);
      porosity = soil.porosity;
    }
    if (side->kind == BOUNDARY_OPEN_FLUX) {
      column->speed = side->flux / porosity;
      continue;
    }
    if (measured[c][0] < INFLOW_KERNEL_SUM) s->column_front[c] = 0;
    column->speed = side->inward * measured[c][1] / porosity;
    column->water = measured[c][0];
  }
cleanup:
  memory_free(&measured);
  return status;
}

static enum status admit(struct isph *s, size_t c) {
  const struct isph_column *column = &s->columns[c];
  const struct isph_open_side *side = &s->sides[column->side];
  double x[3], velocity[3] = {0}, porosity = 1;
  memcpy(x, column->at, sizeof x);
  x[side->axis] -= side->inward * s->column_front[c];
  if (s->on.soil) {
    struct soil_point soil;
    isph_soil_at(s, x, 0, &soil);
    porosity = soil.porosity;
  }
  velocity[side->axis] = side->inward * column->speed * porosity;
  const double pressure =
      side->kind == BOUNDARY_OPEN_HEAD ? isph_window_pressure(s, side, x[2]) : 0;
  return isph_let_in(s, x, velocity, porosity * s->density * column->volume, pressure);
}

enum status isph_open_move(struct isph *s, double dt) {
  isph_open_update_dry(s, true);
  for (size_t c = 0; c < s->column_count; c++) {
    struct isph_column *column = &s->columns[c];
    if (column->dry) continue;
    /* at most one particle in a step */
    double path = fmin(column->speed * dt, COLUMN_STEP * column->pitch);
    double *front = &s->column_front[c];
    *front -= path;
    /* Nothing has left here. In soil the next particle that leaves, here or beside, takes this
     * place: as much goes out of the water as into the columns. A column that moved on regardless
     * would stand beside water that has not left, and hold it back: heads then fall up to 9 % late
     * through soil of porosity .3. */
    if (*front > COLUMN_GAP * column->pitch)
      *front =
          s->sides[column->side].porosity < 1 ? COLUMN_GAP * column->pitch : *front - column->pitch;
    if (*front <= 0) {
      enum status status = admit(s, c);
      if (status != STATUS_OK) return status;
      *front += column->pitch;
    }
    place_column(s, c);
  }
  return STATUS_OK;
}
