#include "sphsolve/scene/scene_geometry.h"

#include <math.h>

static bool axis_is_used(const struct scene *scene, int axis) {
  return scene->dimensions == 3 || axis != 1;
}

double scene_region_thickness(const struct scene *scene, const struct region *region) {
  double least = INFINITY;
  for (int a = 0; a < 3; a++)
    if (axis_is_used(scene, a)) least = fmin(least, region->box[a + 3] - region->box[a]);
  return least;
}

/* Whether a site of the lattice lies between two positions along an axis. */
static bool holds_site(double low, double high, double spacing) {
  return floor(high / spacing - 0.5 - 1e-9) >= ceil(low / spacing - 0.5 + 1e-9);
}

/* A polygon or body that is not cut yet; its box is only its extent. */
static bool is_polygon(const struct region *region) {
  return (region->polygon != NULL || region->stl != NULL) && !region->is_part;
}

static enum status check_extent(struct config *config, config_node *group,
                                const struct scene *scene, const struct region *region) {
  config_node *box = config_child(group, "box");
  bool at_low;
  for (int a = 0; a < 3; a++)
    if ((region->type == REGION_WATER || region->type == REGION_POROUS) && axis_is_used(scene, a) &&
        !holds_site(region->box[a], region->box[a + 3], scene->spacing))
      return config_error(config, box,
                          "%g to %g m in %c is narrower than the spacing (%g m) and holds no "
                          "particle; use a smaller domain.spacing or a wider box",
                          region->box[a], region->box[a + 3], 'x' + a, scene->spacing);
  const double thick = scene_region_thickness(scene, region);
  if (region->type == REGION_WALL && !is_polygon(region) && !region->is_part &&
      thick < SCENE_WALL_THICKNESS_MIN * scene->spacing)
    return config_error(config, box,
                        "a wall %g m thick is thinner than a thousandth of the spacing (%g m) and "
                        "could be missed; %g m is enough to be found",
                        thick, scene->spacing, SCENE_WALL_THICKNESS_MIN * scene->spacing);
  if (region->type != REGION_INFLOW) return STATUS_OK;
  const int side = scene_inflow_axis(scene, region, &at_low);
  if (side < 0)
    return config_error(config, box,
                        "an inflow region is a thin box on one side of the domain that is not "
                        "periodic; this box touches none, or two opposite ones");
  const double depth = region->box[side + 3] - region->box[side];
  if (depth > 2 * scene->spacing && depth > thick)
    return config_error(config, box,
                        "an inflow region is a thin box on a side; this one reaches %g m into "
                        "the domain from its side in %c, farther than it is wide; make it thinner",
                        depth, 'x' + side);
  return STATUS_OK;
}

/* A later region that covers an earlier one completely is treated as a mistake, except that water
 * and soil may share a place, and that rain and absorbing regions act on what is there. */
static enum status check_pair(struct config *config, config_node *list, const struct scene *scene,
                              size_t i, size_t j) {
  const struct region *early = &scene->regions[i], *late = &scene->regions[j];
  bool inside = true, overlap = true, low[2] = {false, false};
  for (int a = 0; a < 3; a++) {
    inside = inside && early->box[a] >= late->box[a] && early->box[a + 3] <= late->box[a + 3];
    overlap = overlap && early->box[a] < late->box[a + 3] && late->box[a] < early->box[a + 3];
  }
  if (late->type == REGION_INFLOW) {
    if (early->type != late->type || !overlap ||
        scene_inflow_axis(scene, early, &low[0]) != scene_inflow_axis(scene, late, &low[1]) ||
        low[0] != low[1])
      return STATUS_OK;
    return config_error(config, config_item(list, j),
                        "overlaps the inflow region on line %d on the same side; leave one out, or "
                        "let them meet at an edge",
                        early->line);
  }
  const bool shared =
      early->type == REGION_RAIN || late->type == REGION_RAIN ||
      (early->type == REGION_ABSORBING) != (late->type == REGION_ABSORBING) ||
      (early->type == REGION_WATER && late->type == REGION_POROUS) ||
      (early->type == REGION_POROUS && late->type == REGION_WATER) ||
      (early->type == REGION_INFLOW && late->type != REGION_WALL && late->type != REGION_EMPTY);
  if (!inside || shared || is_polygon(late)) return STATUS_OK;
  return config_error(config, config_item(list, i),
                      "the later region on line %d covers all of it; put that one first, or leave "
                      "one out",
                      late->line);
}

/* A wall at rest. */
static bool is_resting_wall(const struct region *region) {
  const double *v = region->velocity;
  return region->type == REGION_WALL && v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* Index of the last region that contains a point; -1 if none. */
static int region_at(const struct scene *scene, const double point[3]) {
  for (size_t r = scene->region_count; r-- > 0;) {
    bool in = !is_polygon(&scene->regions[r]);
    for (int a = 0; a < 3; a++)
      in = in && (!axis_is_used(scene, a) ||
                  (point[a] > scene->regions[r].box[a] && point[a] < scene->regions[r].box[a + 3]));
    if (in) return (int)r;
  }
  return -1;
}

/* Checks the gap from low to high along an axis between wall i and a side, or the wall `other`
 * unless NULL. */
static enum status check_gap(struct config *config, config_node *list, const struct scene *scene,
                             size_t i, const struct region *other, int axis, double low,
                             double high) {
  const struct region *wall = &scene->regions[i];
  const double slack = 1e-6 * scene->spacing;
  double middle[3];
  if (high - low <= slack || high - low >= scene->spacing - slack) return STATUS_OK;
  for (int a = 0; a < 3; a++) {
    const double from = other != NULL ? fmax(wall->box[a], other->box[a]) : wall->box[a];
    const double to = other != NULL ? fmin(wall->box[a + 3], other->box[a + 3]) : wall->box[a + 3];
    if (a != axis && to <= from + slack) return STATUS_OK; /* they do not face each other */
    middle[a] = a == axis ? 0.5 * (low + high) : 0.5 * (from + to);
  }
  const int between = region_at(scene, middle);
  if (between >= 0 && scene->regions[between].type == REGION_WALL) return STATUS_OK;
  return config_error(config, config_item(list, i),
                      "leaves a throat of %g m in %c between itself and %s, narrower than the "
                      "spacing (%g m); use a smaller domain.spacing, or close it",
                      high - low, 'x' + axis, other != NULL ? "another wall" : "a side",
                      scene->spacing);
}

/* Checks the throats between a wall and closed sides, and walls behind it. */
static enum status check_throats(struct config *config, config_node *list,
                                 const struct scene *scene, size_t i) {
  enum status status = STATUS_OK;
  const struct region *wall = &scene->regions[i];
  for (int a = 0; a < 3; a++) {
    if (!axis_is_used(scene, a) || is_polygon(wall)) continue;
    if (!scene->periodic[a]) {
      TRY(check_gap(config, list, scene, i, NULL, a, 0, wall->box[a]));
      TRY(check_gap(config, list, scene, i, NULL, a, wall->box[a + 3], scene->domain_size[a]));
    }
    for (size_t j = 0; j < scene->region_count; j++)
      if (j != i && is_resting_wall(&scene->regions[j]) && !is_polygon(&scene->regions[j]))
        TRY(check_gap(config, list, scene, i, &scene->regions[j], a, wall->box[a + 3],
                      scene->regions[j].box[a]));
  }
cleanup:
  return status;
}

/* Largest number of regions for which pairs are checked: the work grows with its square, and scenes
 * with more regions were not written by hand. */
enum { PAIRED_REGIONS_MAX = 2000 };

enum status scene_check_geometry(struct config *config, config_node *list,
                                 const struct scene *scene) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < scene->region_count; i++)
    TRY(check_extent(config, config_item(list, i), scene, &scene->regions[i]));
  if (scene->region_count > PAIRED_REGIONS_MAX) return STATUS_OK;
  for (size_t i = 0; i < scene->region_count; i++) {
    for (size_t j = i + 1; j < scene->region_count; j++) TRY(check_pair(config, list, scene, i, j));
    if (is_resting_wall(&scene->regions[i])) TRY(check_throats(config, list, scene, i));
  }
cleanup:
  return status;
}

bool scene_in_wall(const struct scene *scene, const double point[3]) {
  const int region = region_at(scene, point);
  return region >= 0 && is_resting_wall(&scene->regions[region]);
}
