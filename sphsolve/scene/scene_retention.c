/* Variably saturated soil: retention curves of van Genuchten or Haverkamp, and the initial water
 * content. */
#include <math.h>

#include "common/units.h"
#include "sphsolve/scene/scene_internal.h"

/* Range of n: no soil lies outside, and the tabulated curves would be too steep or too flat. */
#define N_MIN 1.05
#define N_MAX 15.0

static enum status check_residual(struct config *config, config_node *group,
                                  const struct region *region) {
  const double theta_r = region->retention.theta_r;
  if (theta_r >= 0 && theta_r < region->porosity) return STATUS_OK;
  return config_error(config, config_child(config, group, "theta_r"),
                      "from 0 to below the porosity, %g, is possible: the porosity is the water "
                      "content of full soil, theta_s",
                      region->porosity);
}

/* Reads the heads at which half of the water, and of K, remain, and the exponents. */
static enum status read_haverkamp(struct config *config, config_node *group,
                                  struct region *region) {
  enum status status = STATUS_OK;
  struct retention_curve *soil = &region->retention;
  static const char *const keys[] = {"h_theta", "beta", "h_k", "gamma"};
  double value[4] = {0};
  for (int i = 0; i < 4; i++) {
    bool there;
    if (i % 2 == 0)
      TRY(config_quantity(config, group, keys[i], DIM_LENGTH, &value[i], &there));
    else
      TRY(config_number(config, group, keys[i], &value[i], &there));
    if (!there)
      TRY(config_error(config, group,
                       "h_theta, beta, h_k and gamma are wanted, like { h_theta = \"37 cm\"; beta "
                       "= 3.96; h_k = \"19 cm\"; gamma = 4.74; theta_r = 0.075; }"));
    if (i % 2 == 0 ? !(value[i] > 0) : !(value[i] >= N_MIN && value[i] <= N_MAX))
      TRY(config_error(config, config_child(config, group, keys[i]),
                       i % 2 == 0 ? "must be greater than 0" : "%g to %g is possible", N_MIN,
                       N_MAX));
  }
  TRY(config_number(config, group, "theta_r", &soil->theta_r, NULL));
  TRY(check_residual(config, group, region));
  soil->alpha = 1 / value[0], soil->n = value[1];
  soil->k_alpha = 1 / value[2], soil->k_n = value[3];
cleanup:
  return status;
}

static enum status read_curve(struct config *config, config_node *group, struct region *region) {
  enum status status = STATUS_OK;
  struct retention_curve *soil = &region->retention;
  bool alpha_given, n_given;
  soil->l = 0.5;
  TRY(config_quantity(config, group, "alpha", (struct dimension){-1, 0, 0}, &soil->alpha,
                      &alpha_given));
  TRY(config_number(config, group, "n", &soil->n, &n_given));
  TRY(config_number(config, group, "theta_r", &soil->theta_r, NULL));
  TRY(config_number(config, group, "l", &soil->l, NULL));
  if (!alpha_given || !n_given)
    TRY(config_error(config, group,
                     "alpha and n are wanted, like { alpha = \"3.35 1/m\"; n = "
                     "2.0; theta_r = 0.102; }"));
  if (!(soil->alpha > 0))
    TRY(config_error(config, config_child(config, group, "alpha"), "must be greater than 0"));
  if (!(soil->n >= N_MIN && soil->n <= N_MAX))
    TRY(config_error(config, config_child(config, group, "n"), "%g to %g is possible", N_MIN,
                     N_MAX));
  TRY(check_residual(config, group, region));
  if (!(soil->l > -2 && soil->l <= 10)) /* below, k would increase as the soil dries */
    TRY(config_error(config, config_child(config, group, "l"), "above -2 to 10 is possible"));
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
  config_node *genuchten = config_child(config, group, "van_genuchten"),
              *haverkamp = config_child(config, group, "haverkamp"),
              *curve = genuchten != NULL ? genuchten : haverkamp;
  struct retention_curve *soil = &region->retention;
  int given = 0;
  for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
    config_node *node = config_child(config, group, starts[i].key);
    if (node == NULL) continue;
    if (curve == NULL)
      TRY(config_error(config, node,
                       "is of soil with van_genuchten = { alpha = ...; n = ...; } or haverkamp, "
                       "which this is not"));
    given++;
    soil->starts_by = starts[i].by;
    if (starts[i].by == START_WATER)
      TRY(config_number(config, group, starts[i].key, &soil->start, NULL));
    else
      TRY(config_quantity(config, group, starts[i].key, DIM_LENGTH, &soil->start, NULL));
  }
  if (curve == NULL) return STATUS_OK;
  if (!config_is_group(curve))
    TRY(config_error(config, curve, "a group is wanted, like %s",
                     genuchten != NULL
                         ? "{ alpha = \"3.35 1/m\"; n = 2.0; theta_r = 0.102; }"
                         : "{ h_theta = \"37 cm\"; beta = 3.96; h_k = \"19 cm\"; gamma = 4.74; }"));
  if (genuchten != NULL && haverkamp != NULL)
    TRY(config_error(config, haverkamp, "soil has one curve, and van_genuchten is given, too"));
  soil->given = true;
  TRY(genuchten != NULL ? read_curve(config, curve, region)
                        : read_haverkamp(config, curve, region));
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
    TRY(config_error(config, config_child(config, group, "water_content"),
                     "above theta_r, %g, to the porosity, %g, is possible", soil->theta_r,
                     region->porosity));
cleanup:
  return status;
}
