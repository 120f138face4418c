/* Variably saturated soil: retention curves of van Genuchten, Haverkamp or Gardner, and the initial
 * water content. */
#include "sphsolve/scene/scene_retention.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/units.h"
#include "sphsolve/scene/keys.h"

/* theta_r lies below the water content of full soil, which the table of keys does not know. */
static enum status check_residual(struct config *config, config_node *group,
                                  const struct region *region) {
  const double theta_r = region->retention.theta_r;
  if (theta_r >= 0 && theta_r < region->porosity) return STATUS_OK;
  return config_error(config, config_child(group, "theta_r"),
                      "from 0 to below the porosity, %g, is possible: the porosity is the water "
                      "content of full soil, theta_s",
                      region->porosity);
}

/* Reads the curve of the group; the heads at which half of the water, and of K, remain become
 * Haverkamp's parameters. */
static enum status read_curve(struct config *config, config_node *group, const char *name,
                              struct region *region) {
  enum status status = STATUS_OK;
  struct retention_curve *soil = &region->retention;
  const bool haverkamp = !strcmp(name, "haverkamp");
  char path[64];
  snprintf(path, sizeof path, "regions[].%s", name);
  soil->exponential = !strcmp(name, "gardner");
  TRY(keys_read(config, group, path, 0, NULL, region));
  if (haverkamp &&
      (isnan(soil->alpha) || isnan(soil->n) || isnan(soil->k_alpha) || isnan(soil->k_n)))
    TRY(config_error(config, group,
                     "h_theta, beta, h_k and gamma are wanted, like { h_theta = \"37 cm\"; beta "
                     "= 3.96; h_k = \"19 cm\"; gamma = 4.74; theta_r = 0.075; }"));
  if (soil->exponential && isnan(soil->alpha))
    TRY(config_error(config, group, "alpha is wanted, like { alpha = \"2 1/m\"; theta_r = 0.1; }"));
  if (!soil->exponential && (isnan(soil->alpha) || isnan(soil->n)))
    TRY(config_error(config, group,
                     "alpha and n are wanted, like { alpha = \"3.35 1/m\"; n = "
                     "2.0; theta_r = 0.102; }"));
  TRY(check_residual(config, group, region));
  if (haverkamp) soil->alpha = 1 / soil->alpha, soil->k_alpha = 1 / soil->k_alpha;
cleanup:
  return status;
}

enum status scene_read_retention(struct config *config, config_node *group, struct region *region) {
  static const struct {
    const char *key;
    enum soil_start by;
  } starts[] = {
      {"head", START_HEAD}, {"pressure_head", START_PRESSURE}, {"water_content", START_WATER}};
  enum status status = STATUS_OK;
  static const char *const curves[] = {"van_genuchten", "haverkamp", "gardner"};
  config_node *curve = NULL, *second = NULL;
  const char *name = NULL;
  struct retention_curve *soil = &region->retention;
  int given = 0;
  for (size_t i = 0; i < sizeof curves / sizeof *curves; i++) {
    config_node *node = config_child(group, curves[i]);
    if (node == NULL) continue;
    if (curve == NULL)
      curve = node, name = curves[i];
    else
      second = node;
  }
  for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
    config_node *node = config_child(group, starts[i].key);
    if (node == NULL) continue;
    if (curve == NULL)
      TRY(config_error(config, node,
                       "is of soil with van_genuchten = { alpha = ...; n = ...; }, haverkamp or "
                       "gardner, which this is not"));
    given++;
    soil->starts_by = starts[i].by;
    if (starts[i].by == START_WATER)
      TRY(config_number(config, group, starts[i].key, &soil->start, NULL));
    else
      TRY(config_quantity(config, group, starts[i].key, DIM_LENGTH, &soil->start, NULL));
  }
  if (curve == NULL) return STATUS_OK;
  if (second != NULL)
    TRY(config_error(config, second, "soil has one curve, and %s is given, too", name));
  soil->given = true;
  TRY(read_curve(config, curve, name, region));
  if (!(region->permeability > 0))
    TRY(config_error(config, group,
                     "permeability is missing: that of the soil when it is full, "
                     "K_s, like permeability = \"9e-5 m/s\""));
  if (given != 1)
    TRY(config_error(config, group,
                     "how wet the soil starts is wanted, once: head = \"0.65 m\" "
                     "(water at rest under that level), pressure_head = \"-10 m\" "
                     "or water_content = 0.1"));
  if (soil->starts_by == START_WATER &&
      !(soil->start > soil->theta_r && soil->start <= region->porosity))
    TRY(config_error(config, config_child(group, "water_content"),
                     "above theta_r, %g, to the porosity, %g, is possible", soil->theta_r,
                     region->porosity));
cleanup:
  return status;
}
