/* A scene with a solute in a flow that is already solved. */
#include "sphsolve/scene/scene_solute.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/scene_file.h"

/* Rejects settings that are part of the solved flow: all groups but its own. */
static enum status refuse_other_groups(struct config *config) {
  static const char *const own[] = {"scene", "flow", "solute", "checkpoint"};
  for (size_t i = 0; i < config_count(config_root(config)); i++) {
    config_node *node = config_item(config_root(config), i);
    bool found = false;
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
      found = found || !strcmp(config_name(node), own[k]);
    if (!found)
      return config_error(config, node,
                          "a scene with flow = { file = ...; } takes a flow that is solved "
                          "already, with all of its settings; leave '%s' out",
                          config_name(node));
  }
  static const char *const times[] = {"end_time", "steady_tolerance"};
  config_node *scene = config_child(config_root(config), "scene");
  for (size_t i = 0; i < sizeof times / sizeof *times; i++)
    if (config_child(scene, times[i]) != NULL)
      return config_error(config, config_child(scene, times[i]),
                          "is of a scene that solves a flow; leave it out: a solute is followed "
                          "until its coefficients are known");
  return STATUS_OK;
}

static enum status read_peclet(struct config *config, config_node *group, struct scene *scene) {
  static const double decades[] = {0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000};
  enum status status = STATUS_OK;
  bool given;
  TRY(config_quantities(config, group, "peclet", DIM_NONE, 1, SOLUTE_PECLET_MAX,
                        scene->solute.peclet, &scene->solute.peclet_count, &given));
  for (int i = 0; i < scene->solute.peclet_count; i++)
    if (!(scene->solute.peclet[i] >= 0 && scene->solute.peclet[i] <= 1e6))
      TRY(config_error(config, config_child(group, "peclet"),
                       "Peclet numbers from 0 (no flow) to 1e6 are possible, like [0.1, 1.0, "
                       "10.0]"));
  if (given || !isnan(scene->solute.diffusion)) goto cleanup;
  scene->solute.peclet_count = sizeof decades / sizeof *decades;
  memcpy(scene->solute.peclet, decades, sizeof decades);
cleanup:
  return status;
}

enum status scene_read_solute(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *root = config_root(config);
  config_node *flow = config_child(root, "flow");
  config_node *group = config_child(root, "solute");
  if (flow == NULL && (group != NULL || scene->method == &method_solute))
    return config_error(config, group,
                        "a solute needs a flow that is solved already; write flow = { file = "
                        "\"run.hdf\"; }, the OUT.hdf of a run of method stokes");
  if (flow == NULL) return STATUS_OK;
  if (scene->method != NULL && scene->method != &method_solute)
    return config_error(config, config_child(config_child(root, "scene"), "method"),
                        "solves a flow, and this scene takes one that is solved already; leave it "
                        "out");
  if (group == NULL)
    return config_error(config, flow,
                        "the group 'solute' is missing: what the flow carries; write solute = { "
                        "peclet = [0.1, 1.0, 10.0]; };");
  scene->method = &method_solute;
  TRY(refuse_other_groups(config));
  TRY(scene_file_find(config, flow, "file", "\"run.hdf\"", "sphsolve run ... -o",
                      scene->flow_path));
  TRY(keys_read(config, group, "solute", 0, scene, scene));
  TRY(read_peclet(config, group, scene));
  scene->solute.error = NAN;
  TRY(keys_read(config, config_child(root, "checkpoint"), "checkpoint", 0, scene, scene));
cleanup:
  return status;
}
