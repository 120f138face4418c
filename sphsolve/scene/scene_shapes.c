/* Regions other than boxes: prisms over a polygon, and cylinders (discs in 2-D). Each is cut into
 * boxes, i.e. rows of one spacing stacked along one axis, and each box is then an ordinary region,
 * so that methods need no special treatment of slopes. The axis is the one with the smaller steps:
 * rows across an edge from (0, 0) to (u, v), stacked along v, leave triangles with a total area of
 * spacing |u|/4 on each side.
 *
 * Soil keeps its area: in each row a box ends at the mean position of the edge over the row. Walls,
 * water and empty regions consist of the sites whose centres they cover, as boxes do. */
#include "sphsolve/scene/scene_shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/scene_parts.h"
#include "sphsolve/scene/lost_wall.h"
#include "sphsolve/scene/scene_stl.h"
#include "sphsolve/scene/stl.h"

/* Corners of the polygon that represents a circle of the same area. */
enum { CORNERS_OF_CIRCLE = 64 };
/* Scan lines per row, and the largest number of bisections of a row in which the
 * polygon branches. */
enum { SCAN_LINES = 8, BISECTIONS_MAX = 3 };

static double cross(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool edges_cross(const struct polygon *p, size_t i, size_t j) {
  const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
  const double *c = p->corner[j], *d = p->corner[(j + 1) % p->count];
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

static enum status check_polygon(struct config *config, config_node *node,
                                 const struct scene *scene, const struct polygon *p) {
  const double slack = 1e-6 * scene->spacing;
  double area = 0;
  for (int c = 0; c < 2; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < p->count; i++)
      low = fmin(low, p->corner[i][c]), high = fmax(high, p->corner[i][c]);
    if (!(low >= -slack && high <= scene->domain_size[p->plane[c]] + slack))
      return config_error(config, node, "%g to %g m in %s lies outside the domain (0 to %g m)", low,
                          high, scene_axis_names[p->plane[c]], scene->domain_size[p->plane[c]]);
  }
  for (size_t i = 0; i < p->count; i++) {
    const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    for (size_t j = i + 2; j < p->count; j++)
      if (!(i == 0 && j == p->count - 1) && edges_cross(p, i, j))
        return config_error(config, node,
                            "the edges from corners %zu and %zu cross; give the corners in their "
                            "order round the region",
                            i + 1, j + 1);
  }
  if (!(fabs(area) > slack * slack))
    return config_error(config, node, "these corners enclose no area");
  return STATUS_OK;
}

static enum status read_corners(struct config *config, config_node *group, struct polygon *p) {
  double values[2 * POLYGON_CORNERS_MAX] = {0};
  int count = 0;
  enum status status = config_quantities(config, group, "corners", DIM_LENGTH, 6,
                                         2 * POLYGON_CORNERS_MAX, values, &count, NULL);
  if (status != STATUS_OK) return status;
  if (count % 2 != 0)
    return config_error(config, config_child(group, "corners"),
                        "%d lengths are no pairs: %s and %s of each corner are wanted", count,
                        scene_axis_names[p->plane[0]], scene_axis_names[p->plane[1]]);
  p->count = (size_t)count / 2;
  status = memory_allocate(&p->corner, p->count, sizeof *p->corner, "corners");
  if (status == STATUS_OK) memcpy(p->corner, values, p->count * sizeof *p->corner);
  return status;
}

static enum status read_circle(struct config *config, config_node *group, struct polygon *p) {
  double centre[2] = {0}, radius = NAN;
  enum status status = STATUS_OK;
  TRY(config_quantities(config, group, "centre", DIM_LENGTH, 2, 2, centre, NULL, NULL));
  TRY(keys_read_number(config, group, "regions[]", "radius", &radius));
  if (!(radius > 0)) TRY(config_error(config, group, "a circle needs its radius"));
  p->count = CORNERS_OF_CIRCLE;
  TRY(memory_allocate(&p->corner, p->count, sizeof *p->corner, "corners"));
  const double turn = 2 * M_PI / CORNERS_OF_CIRCLE, reach = radius * sqrt(turn / sin(turn));
  for (size_t i = 0; i < p->count; i++) {
    const double angle = turn * ((double)i + 0.5);
    p->corner[i][0] = centre[0] + reach * cos(angle),
    p->corner[i][1] = centre[1] + reach * sin(angle);
    /* The corners lie slightly outside the circle, also where it touches a side. */
    for (int c = 0; c < 2; c++)
      p->corner[i][c] = fmin(centre[c] + radius, fmax(centre[c] - radius, p->corner[i][c]));
  }
cleanup:
  return status;
}

bool scene_has_shape(config_node *group) {
  return config_child(group, "corners") != NULL || config_child(group, "centre") != NULL;
}

enum status scene_read_shape(struct config *config, config_node *group, const struct scene *scene,
                             struct region *region) {
  enum status status = STATUS_OK;
  const bool circle = config_child(group, "corners") == NULL;
  config_node *node = config_child(group, circle ? "centre" : "corners");
  int axis = 1, count = 0;
  struct polygon *p;
  TRY(scene_parts_refuse_box_only(config, node, region));
  if (config_child(group, "box") != NULL || (!circle && config_child(group, "centre") != NULL))
    return config_error(config, group, "one of box, corners and centre is wanted");
  TRY(memory_allocate(&region->polygon, 1, sizeof *region->polygon, "corners"));
  p = region->polygon;
  region->box[1] = 0, region->box[4] = scene->domain_size[1];
  if (scene->dimensions == 2) {
    config_node *across = config_child(group, "axis");
    if (across == NULL) across = config_child(group, "along");
    if (across != NULL)
      TRY(config_error(config, across, "is of a scene in three dimensions; leave it out"));
  } else {
    double along[2];
    bool given = false;
    TRY(config_choice(config, group, "axis", scene_axis_names, &axis, NULL));
    region->box[axis] = 0, region->box[axis + 3] = scene->domain_size[axis];
    TRY(config_quantities(config, group, "along", DIM_LENGTH, 2, 2, along, &count, &given));
    if (given) region->box[axis] = along[0], region->box[axis + 3] = along[1];
    if (!(region->box[axis] >= 0 && region->box[axis] < region->box[axis + 3] &&
          region->box[axis + 3] <= scene->domain_size[axis] + 1e-6 * scene->spacing))
      TRY(config_error(config, config_child(group, "along"),
                       "from %g to %g m in %s is no length in the domain (0 to %g m)",
                       region->box[axis], region->box[axis + 3], scene_axis_names[axis],
                       scene->domain_size[axis]));
  }
  p->axis = axis;
  p->plane[0] = axis == 0 ? 1 : 0, p->plane[1] = axis == 2 ? 1 : 2;
  TRY(circle ? read_circle(config, group, p) : read_corners(config, group, p));
  TRY(check_polygon(config, node, scene, p));
  for (int c = 0; c < 2; c++) {
    double *low = &region->box[p->plane[c]], *high = low + 3;
    *low = INFINITY, *high = -INFINITY;
    for (size_t i = 0; i < p->count; i++)
      *low = fmin(*low, p->corner[i][c]), *high = fmax(*high, p->corner[i][c]);
  }
cleanup:
  return status;
}

size_t polygon_scan(const struct polygon *p, int w, double v, double at[POLYGON_CORNERS_MAX]) {
  size_t n = 0;
  for (size_t i = 0; i < p->count; i++) {
    const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
    if ((a[w] > v) == (b[w] > v)) continue;
    at[n++] = a[1 - w] + (b[1 - w] - a[1 - w]) * (v - a[w]) / (b[w] - a[w]);
  }
  qsort(at, n, sizeof *at, scene_parts_by_value);
  return n;
}

/* Neither beside the box along the axes, nor with all of its corners on one side of the edge. */
bool polygon_may_meet(const struct polygon *p, const double from[2], const double to[2]) {
  for (size_t i = 0; i < p->count; i++) {
    const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
    bool meets = true;
    for (int w = 0; w < 2; w++)
      meets = meets && fmin(a[w], b[w]) <= to[w] && fmax(a[w], b[w]) >= from[w];
    const double middle = (b[0] - a[0]) * (0.5 * (from[1] + to[1]) - a[1]) -
                          (b[1] - a[1]) * (0.5 * (from[0] + to[0]) - a[0]);
    const double reach =
        0.5 * (fabs(b[0] - a[0]) * (to[1] - from[1]) + fabs(b[1] - a[1]) * (to[0] - from[0]));
    if (meets && fabs(middle) <= reach) return true;
  }
  return false;
}

/* Adds the box from..to of the row low..high, or extends an equal box below it. */
static enum status add_part(const struct region *whole, int w, double low, double high, double from,
                            double to, double near, struct scene_parts *parts) {
  const int up = whole->polygon->plane[w], run = whole->polygon->plane[1 - w];
  for (size_t k = parts->count; k-- > 0;) {
    double *box = parts->region[k].box;
    if (fabs(box[up + 3] - low) < near && fabs(box[run] - from) < near &&
        fabs(box[run + 3] - to) < near) {
      box[up + 3] = high;
      return STATUS_OK;
    }
  }
  double box[6];
  memcpy(box, whole->box, sizeof box);
  box[up] = low, box[up + 3] = high, box[run] = from, box[run + 3] = to;
  return scene_parts_add(parts, whole, box);
}

/* Adds soil in the row low..high: boxes end at the mean over the row, which is bisected where the
 * polygon branches. */
static enum status cut_row(const struct region *whole, int w, double low, double high, double near,
                           int halvings, struct scene_parts *parts) {
  double ends[POLYGON_CORNERS_MAX] = {0}, at[POLYGON_CORNERS_MAX];
  size_t number = 0;
  for (int line = 0; line < SCAN_LINES; line++) {
    const double v = low + (high - low) * (line + 0.5) / SCAN_LINES;
    const size_t n = polygon_scan(whole->polygon, w, v, at);
    if (line > 0 && n != number && halvings > 0) {
      const double middle = 0.5 * (low + high);
      const enum status status = cut_row(whole, w, low, middle, near, halvings - 1, parts);
      return status == STATUS_OK ? cut_row(whole, w, middle, high, near, halvings - 1, parts)
                                 : status;
    }
    if (line > 0 && n != number) continue;
    number = n;
    for (size_t k = 0; k < n; k++) ends[k] += at[k] / SCAN_LINES;
  }
  for (size_t k = 0; k + 1 < number; k += 2)
    if (ends[k + 1] - ends[k] > near) {
      const enum status status = add_part(whole, w, low, high, ends[k], ends[k + 1], near, parts);
      if (status != STATUS_OK) return status;
    }
  return STATUS_OK;
}

/* Adds the sites with centres inside in the row at v. */
static enum status cut_sites(const struct scene *scene, const struct region *whole, int w, double v,
                             struct scene_parts *parts) {
  const double dx = scene->spacing, end = scene->domain_size[whole->polygon->plane[1 - w]];
  const double top = scene->domain_size[whole->polygon->plane[w]];
  double at[POLYGON_CORNERS_MAX];
  const size_t n = polygon_scan(whole->polygon, w, v, at);
  for (size_t k = 0; k + 1 < n; k += 2) {
    const double from = ceil(at[k] / dx - 0.5 - 1e-9), to = floor(at[k + 1] / dx - 0.5 + 1e-9) + 1;
    if (to <= from) continue;
    const enum status status = add_part(whole, w, v - 0.5 * dx, fmin(top, v + 0.5 * dx), from * dx,
                                        fmin(end, to * dx), 1e-6 * dx, parts);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

static enum status cut(const struct scene *scene, const struct region *whole,
                       struct scene_parts *parts) {
  const struct polygon *p = whole->polygon;
  const double dx = scene->spacing, near = 1e-6 * dx;
  double slope[2] = {0}; /* total lengths along each axis of the oblique edges */
  for (size_t i = 0; i < p->count; i++) {
    const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
    if (fabs(b[0] - a[0]) < near || fabs(b[1] - a[1]) < near) continue;
    for (int c = 0; c < 2; c++) slope[c] += fabs(b[c] - a[c]);
  }
  const int w = slope[1] < slope[0] ? 0 : 1; /* axis along which rows are stacked */
  const double low = whole->box[p->plane[w]], high = whole->box[p->plane[w] + 3];
  for (double row = floor(low / dx + 1e-6); row * dx < high - near; row++) {
    const enum status status =
        whole->type == REGION_POROUS || region_is_sink(whole)
            ? cut_row(whole, w, fmax(low, row * dx), fmin(high, (row + 1) * dx), near,
                      BISECTIONS_MAX, parts)
            : cut_sites(scene, whole, w, (row + 0.5) * dx, parts);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

/* Adds the points of a wall where it is thinner than the spacing and would let water through. */
static enum status fill_thin(const struct scene *scene, const struct region *whole,
                             struct scene_parts *parts) {
  enum status status = STATUS_OK;
  const struct polygon *p = whole->polygon;
  struct lost_wall wall;
  double at[POLYGON_CORNERS_MAX];
  TRY(lost_wall_begin(scene, whole->box, p ? p->axis : -1, &wall));
  if (p == NULL) TRY(scene_stl_lines(scene, whole, &wall));
  for (int w = 0; p != NULL && w < 2; w++)
    for (size_t i = 0; i < wall.size[p->plane[w]]; i++) {
      long line[3] = {0};
      line[p->plane[w]] = wall.first[p->plane[w]] + (long)i;
      const size_t n = polygon_scan(p, w, ((double)line[p->plane[w]] + 0.5) * scene->spacing, at);
      for (size_t k = 0; k + 1 < n; k += 2)
        lost_wall_add(&wall, p->plane[1 - w], line, at[k], at[k + 1]);
    }
  TRY(lost_wall_fill(&wall, whole, parts));
cleanup:
  memory_free(&wall.bits);
  return status;
}

enum status scene_cut_shapes(struct config *config, config_node *list, struct scene *scene,
                             size_t most) {
  enum status status = STATUS_OK;
  struct scene_parts parts = {0}, all = {0};
  bool any = false;
  for (size_t i = 0; i < scene->region_count; i++) {
    memcpy(scene->regions[i].extent, scene->regions[i].box, sizeof scene->regions[i].extent);
    any = any || scene->regions[i].polygon != NULL || scene->regions[i].stl != NULL;
  }
  for (size_t i = 0; i < scene->region_count && any; i++) {
    struct region *region = &scene->regions[i];
    const bool stl = region->stl != NULL;
    parts.count = 0;
    if (region->polygon != NULL || stl) {
      TRY(stl ? scene_cut_stl(scene, region, &parts) : cut(scene, region, &parts));
      if (region->type == REGION_WALL) TRY(fill_thin(scene, region, &parts));
      for (size_t k = 1; k < parts.count; k++) parts.region[k].stl = NULL;
      if (stl) TRY(stl_sort(region->stl, scene->spacing));
      if (parts.count == 0)
        TRY(config_error(config, config_item(list, i),
                         "is narrower than the spacing (%g m) and holds no site; use a smaller "
                         "domain.spacing",
                         scene->spacing));
    } else {
      TRY(memory_resize(&parts.region, parts.count = 1, sizeof *parts.region, "regions"));
      parts.region[0] = *region;
    }
    if (all.count + parts.count > most)
      TRY(config_error(config, list,
                       "polygons, circles and bodies make more than %zu boxes; use a wider "
                       "domain.spacing",
                       most));
    TRY(memory_resize(&all.region, all.count + parts.count, sizeof *all.region, "regions"));
    for (size_t k = 0; k < parts.count; k++) {
      all.region[all.count + k] = parts.region[k];
      all.region[all.count + k].first = all.count;
      all.region[all.count + k].end = all.count + parts.count;
    }
    all.count += parts.count;
  }
  if (any) {
    struct region *before = scene->regions;
    scene->regions = all.region, scene->region_count = all.count, all.region = before;
  }
cleanup:
  MEMORY_FREE(&parts.region, &all.region);
  return status;
}
