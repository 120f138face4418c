/* Regions enclosed by a surface of triangles (stl.h), cut into boxes like polygons: rows of one
 * spacing along the axis that most of the surface faces, since the ends of rows follow the surface
 * best.
 */
#include "sphsolve/scene/scene_stl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/scene_names.h"
#include "sphsolve/scene/stl.h"

/* Scan lines per row of soil, in each of the two directions. */
enum { LINES = 4 };

bool scene_has_stl(config_node *group) {
  return config_child(group, "stl") != NULL;
}

enum status scene_read_stl(struct config *config, config_node *group, const struct scene *scene,
                           struct region *region) {
  enum status status = STATUS_OK;
  config_node *node = config_child(group, "stl");
  char path[4096];
  double unit = NAN;
  if (scene->dimensions != 3)
    return config_error(config, node, "a 2-D scene has no bodies; give the corners of a polygon");
  TRY(scene_parts_refuse_box_only(config, node, region));
  if (config_child(group, "box") != NULL)
    return config_error(config, group, "one of box and stl is wanted");
  TRY(keys_read_number(config, group, "regions[]", "stl_unit", &unit));
  if (!(unit > 0))
    TRY(config_error(config, group,
                     "stl_unit is missing: STL files do not tell their unit of length; write "
                     "stl_unit = \"1 mm\" or the like"));
  TRY(scene_file_find(config, group, "stl", "\"body.stl\"", "", path));
  TRY(memory_allocate(&region->stl, 1, sizeof *region->stl, "an STL file"));
  status = stl_read(path, unit, region->stl);
  if (status == STATUS_INPUT) { /* report the line of the scene */
    char why[1024];
    snprintf(why, sizeof why, "%s", error_message());
    error_clear();
    status = config_error(config, node, "%s", why);
  }
  if (status != STATUS_OK) goto cleanup;
  memcpy(region->box, region->stl->extent, sizeof region->box);
  const double slack = 1e-6 * scene->spacing;
  for (int a = 0; a < 3; a++)
    if (!(region->box[a] >= -slack && region->box[a + 3] <= scene->domain_size[a] + slack))
      TRY(config_error(config, node,
                       "%g to %g m in %c lies outside the domain (0 to %g m); look at stl_unit, "
                       "and at the file's origin",
                       region->box[a], region->box[a + 3], 'x' + a, scene->domain_size[a]));
cleanup:
  return status;
}

/* Segments of a section, in the coordinates along a row and across rows. */
struct section {
  size_t count, room;
  double (*end)[2][2];
};

struct cut {
  const struct scene *scene;
  const struct region *whole;
  int run, across, up; /* axes: along a row, across rows, and across layers */
  struct section sections[LINES];
  size_t count, room; /* intervals between crossings */
  double (*interval)[2];
  struct scene_parts *parts;
  size_t row; /* first part of the layer */
};

static enum status find_section(const struct cut *cut, double v, struct section *section) {
  const struct stl *stl = cut->whole->stl;
  section->count = 0;
  for (size_t t = 0; t < stl->count; t++) {
    double ends[2][2];
    if (!stl_section(stl->corner[t], cut->run, cut->across, cut->up, v, ends)) continue;
    if (section->count == section->room) {
      section->room = section->room > 0 ? 2 * section->room : 64;
      const enum status status =
          memory_resize(&section->end, section->room, sizeof *section->end, "a body's section");
      if (status != STATUS_OK) return status;
    }
    memcpy(section->end[section->count++], ends, sizeof *section->end);
  }
  return STATUS_OK;
}

/* Adds the inside intervals of the line at w. */
static enum status add_line(struct cut *cut, const struct section *section, double w) {
  const size_t before = 2 * cut->count;
  size_t n = before;
  for (size_t k = 0; k < section->count; k++) {
    const double *a = section->end[k][0], *b = section->end[k][1];
    if ((a[1] > w) == (b[1] > w)) continue;
    if (n / 2 + 1 >= cut->room) {
      cut->room = cut->room > 0 ? 2 * cut->room : 64;
      const enum status status =
          memory_resize(&cut->interval, cut->room, sizeof *cut->interval, "a body's section");
      if (status != STATUS_OK) return status;
    }
    (&cut->interval[0][0])[n++] = a[0] + (b[0] - a[0]) * (w - a[1]) / (b[1] - a[1]);
  }
  if (n > before)
    qsort(&cut->interval[0][0] + before, n - before, sizeof(double), scene_parts_by_value);
  cut->count = n / 2;
  return STATUS_OK;
}

static bool same_extent(const double a[6], const double b[6], int axis, double near) {
  return fabs(a[axis] - b[axis]) < near && fabs(a[axis + 3] - b[axis + 3]) < near;
}

/* Adds a box, or extends that of the previous row. */
static enum status add_box(struct cut *cut, const double box[6]) {
  const double near = 1e-6 * cut->scene->spacing;
  for (size_t k = cut->row; k < cut->parts->count; k++) {
    double *old = cut->parts->region[k].box;
    if (same_extent(old, box, cut->run, near) && same_extent(old, box, cut->up, near) &&
        fabs(old[cut->across + 3] - box[cut->across]) < near) {
      old[cut->across + 3] = box[cut->across + 3];
      return STATUS_OK;
    }
  }
  return scene_parts_add(cut->parts, cut->whole, box);
}

/* Extends boxes that end where this layer begins; the first part of the layer is `from`. */
static void join_layers(struct cut *cut, size_t from) {
  const double near = 1e-6 * cut->scene->spacing;
  struct region *region = cut->parts->region;
  size_t kept = from;
  for (size_t k = from; k < cut->parts->count; k++) {
    bool joined = false;
    for (size_t j = 0; j < from && !joined; j++) {
      joined = same_extent(region[j].box, region[k].box, cut->run, near) &&
               same_extent(region[j].box, region[k].box, cut->across, near) &&
               fabs(region[j].box[cut->up + 3] - region[k].box[cut->up]) < near;
      if (joined) region[j].box[cut->up + 3] = region[k].box[cut->up + 3];
    }
    if (!joined) region[kept++] = region[k];
  }
  cut->parts->count = kept;
}

/* Soil: overlapping intervals of all lines of a row form one box with the same volume. */
static enum status cut_soil(struct cut *cut, double box[6]) {
  const int lines = LINES * LINES;
  qsort(cut->interval, cut->count, sizeof *cut->interval, scene_parts_by_value);
  for (size_t k = 0, end; k < cut->count; k = end) {
    double reach = cut->interval[k][1], length = 0, moment = 0, low = 0, high = 0;
    for (end = k; end < cut->count && (end == k || cut->interval[end][0] <= reach); end++) {
      const double a = cut->interval[end][0], b = cut->interval[end][1];
      reach = fmax(reach, b);
      length += (b - a) / lines, moment += 0.5 * (b * b - a * a) / lines;
      low += a / lines, high += b / lines;
    }
    if (!(length > 1e-6 * cut->scene->spacing)) continue;
    if (end - k != (size_t)lines)
      low = moment / length - 0.5 * length, high = moment / length + 0.5 * length;
    box[cut->run] = low, box[cut->run + 3] = high;
    const enum status status = add_box(cut, box);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

/* Walls, water and empty space: the sites whose centres are inside. */
static enum status cut_sites(struct cut *cut, double box[6]) {
  const double dx = cut->scene->spacing, end = cut->scene->domain_size[cut->run];
  for (size_t k = 0; k < cut->count; k++) {
    const double from = ceil(cut->interval[k][0] / dx - 0.5 - 1e-9);
    const double to = floor(cut->interval[k][1] / dx - 0.5 + 1e-9) + 1;
    if (to <= from) continue;
    box[cut->run] = from * dx, box[cut->run + 3] = fmin(end, to * dx);
    const enum status status = add_box(cut, box);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

/* Cuts the rows of the layer whose extent along `up` is set in `box`. */
static enum status cut_layer(struct cut *cut, double box[6]) {
  enum status status = STATUS_OK;
  const bool soil = cut->whole->type == REGION_POROUS;
  const int lines = soil ? LINES : 1, w = cut->across;
  const double dx = cut->scene->spacing, near = 1e-6 * dx;
  const double low = cut->whole->box[w], high = cut->whole->box[w + 3];
  const size_t from = cut->parts->count;
  for (int l = 0; l < lines; l++)
    TRY(find_section(cut, box[cut->up] + (box[cut->up + 3] - box[cut->up]) * (l + 0.5) / lines,
                     &cut->sections[l]));
  cut->row = from;
  for (double row = floor(low / dx + 1e-6); row * dx < high - near; row++) {
    box[w] = row * dx, box[w + 3] = fmin((row + 1) * dx, cut->scene->domain_size[w]);
    if (soil) box[w] = fmax(low, box[w]), box[w + 3] = fmin(high, box[w + 3]);
    cut->count = 0;
    for (int l = 0; l < lines; l++)
      for (int m = 0; m < lines; m++) {
        const double at =
            soil ? box[w] + (box[w + 3] - box[w]) * (m + 0.5) / lines : (row + 0.5) * dx;
        TRY(add_line(cut, &cut->sections[l], at));
      }
    TRY(soil ? cut_soil(cut, box) : cut_sites(cut, box));
  }
  join_layers(cut, from);
cleanup:
  return status;
}

/* Twice the area of the surface projected along an axis. */
static double projected_area(const struct stl *stl, int axis) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  double sum = 0;
  for (size_t t = 0; t < stl->count; t++) {
    double(*x)[3] = stl->corner[t];
    sum +=
        fabs((x[1][a] - x[0][a]) * (x[2][b] - x[0][b]) - (x[1][b] - x[0][b]) * (x[2][a] - x[0][a]));
  }
  return sum;
}

enum status scene_cut_stl(const struct scene *scene, const struct region *whole,
                          struct scene_parts *parts) {
  enum status status = STATUS_OK;
  struct cut cut = {.scene = scene, .whole = whole, .parts = parts};
  const double *extent = whole->box, dx = scene->spacing, near = 1e-6 * dx;
  const bool soil = whole->type == REGION_POROUS;
  double area[3];
  for (int a = 0; a < 3; a++) {
    area[a] = projected_area(whole->stl, a);
    if (area[a] > area[cut.run] * (1 + 1e-6)) cut.run = a;
  }
  cut.across = cut.run == 0 ? 1 : 0, cut.up = cut.run == 2 ? 1 : 2;
  const double low = extent[cut.up], high = extent[cut.up + 3];
  for (double layer = floor(low / dx + 1e-6); layer * dx < high - near; layer++) {
    double box[6];
    memcpy(box, extent, sizeof box);
    box[cut.up] = layer * dx, box[cut.up + 3] = (layer + 1) * dx;
    if (soil) box[cut.up] = fmax(low, box[cut.up]), box[cut.up + 3] = fmin(high, box[cut.up + 3]);
    TRY(cut_layer(&cut, box));
  }
cleanup:
  for (int l = 0; l < LINES; l++) memory_free(&cut.sections[l].end);
  memory_free(&cut.interval);
  return status;
}

enum status scene_stl_lines(const struct scene *scene, const struct region *whole,
                            struct lost_wall *wall) {
  enum status status = STATUS_OK;
  struct cut cut = {.scene = scene, .whole = whole};
  for (cut.run = 0; cut.run < 3; cut.run++) {
    cut.across = (cut.run + 1) % 3, cut.up = (cut.run + 2) % 3;
    for (size_t k = 0; k < wall->size[cut.up]; k++) {
      long at[3] = {0};
      at[cut.up] = wall->first[cut.up] + (long)k;
      TRY(find_section(&cut, ((double)at[cut.up] + 0.5) * scene->spacing, &cut.sections[0]));
      for (size_t j = 0; j < wall->size[cut.across] && cut.sections[0].count > 0; j++) {
        at[cut.across] = wall->first[cut.across] + (long)j;
        cut.count = 0;
        TRY(add_line(&cut, &cut.sections[0], ((double)at[cut.across] + 0.5) * scene->spacing));
        for (size_t i = 0; i < cut.count; i++)
          lost_wall_add(wall, cut.run, at, cut.interval[i][0], cut.interval[i][1]);
      }
    }
  }
cleanup:
  memory_free(&cut.sections[0].end);
  memory_free(&cut.interval);
  return status;
}
