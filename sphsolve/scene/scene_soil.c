/* Soil with a given permeability: one number, or one along each principal axis. */

#include "sphsolve/scene/scene_soil.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/units.h"
#include "sphsolve/scene/keys.h"

/* Largest ratio of the principal permeabilities; beyond it the multi-point fluxes of
 * darcy/saturated.c may let h overshoot. */
#define RATIO_MAX 30.0

/* Drag of soil of permeability k (m/s, of the scene's fluid at standard gravity g). Darcy's law a v
 * = g i, with the hydraulic gradient i, requires the linear drag a = g/k, and M15 eq. 9c is
 *
 * a = alpha nu (1 - eps)^2 / (eps^3 D50^2).
 *
 * With a grain_size, alpha follows, and Forchheimer's term uses that grain size, too; without,
 * alpha is 1000, D50 follows, and there is no Forchheimer term. */
static enum status set_drag(struct config *config, config_node *group, const struct scene *scene,
                            double k, struct region *region) {
  const double e = region->porosity, nu = scene->fluid.viscosity / scene->fluid.density;
  const double scale = nu * (1 - e) * (1 - e) / (e * e * e), a = GRAVITY_STANDARD / k;
  config_node *node = config_child(group, "permeability");
  region->permeability = k;
  if (config_child(group, "alpha") != NULL)
    return config_error(config, config_child(group, "alpha"),
                        "permeability says already how large the drag is; leave one out");
  if (!(e < 1 && nu > 0))
    return config_error(config, node, "needs a porosity below 1 and a fluid with viscosity");
  if (region->grain_size > 0) {
    region->alpha = a / scale * region->grain_size * region->grain_size;
  } else {
    if (config_child(group, "beta") != NULL)
      return config_error(config, config_child(group, "beta"),
                          "needs a grain_size beside the permeability");
    region->grain_size = sqrt(region->alpha * scale / a);
    region->beta = 0;
  }
  return STATUS_OK;
}

/* Reads `bedding`, the unit direction of the first axis in the plane of x and z; x by default. */
static enum status read_bedding(struct config *config, config_node *group,
                                const struct scene *scene, double first[3]) {
  first[0] = 1, first[1] = first[2] = 0;
  config_node *node = config_child(group, "bedding");
  if (node == NULL) return STATUS_OK;
  enum status status = keys_read_vector(config, group, "bedding", scene, DIM_NONE, first);
  if (status != STATUS_OK) return status;
  if (first[1] != 0)
    return config_error(config, node, "beds are turned about y only: [x, 0.0, z] is wanted");
  const double length = hypot(first[0], first[2]);
  if (!(length > 0))
    return config_error(config, node,
                        "a direction is wanted, like [2.0, %s-1.0] for beds that "
                        "fall by 1 in 2 along x",
                        scene->dimensions == 3 ? "0.0, " : "");
  first[0] /= length, first[2] /= length;
  return STATUS_OK;
}

/* The geometric mean k of the principal permeabilities, and the tensor divided by it. */
static enum status read_tensor(struct config *config, config_node *group, const struct scene *scene,
                               double *k, struct region *region) {
  const int axes = scene->dimensions;
  config_node *node = config_child(group, "permeability");
  double along[3] = {1, 1, 1}, first[3], least = INFINITY, most = 0;
  int count = 3;
  enum status status = config_quantities(config, group, "permeability", DIM_VELOCITY, axes, axes,
                                         along, &count, NULL);
  if (status != STATUS_OK) return status;
  keys_spread(scene, count, along);
  if (axes == 2) along[1] = along[0];
  for (int a = 0; a < 3; a++) least = fmin(least, along[a]), most = fmax(most, along[a]);
  if (!(least > 0 && isfinite(most)))
    return config_error(config, node, "permeabilities above 0 are wanted");
  if (most > RATIO_MAX * least * (1 + 1e-6))
    return config_error(config, node,
                        "%g times as large along one axis as along another; method "
                        "darcy can do %g",
                        most / least, RATIO_MAX);
  if (region->grain_size > 0)
    return config_error(config, config_child(group, "grain_size"),
                        "Forchheimer's term is not known for soil with a permeability for each "
                        "axis; leave it out");
  status = read_bedding(config, group, scene, first);
  if (status != STATUS_OK) return status;
  *k = axes == 2 ? sqrt(along[0] * along[2]) : cbrt(along[0] * along[1] * along[2]);
  const double x = first[0], z = first[2], one = along[0] / *k, three = along[2] / *k;
  region->anisotropic = most > least * (1 + 1e-9);
  region->anisotropy[0] = one * x * x + three * z * z;
  region->anisotropy[2] = (one - three) * x * z;
  region->anisotropy[3] = axes == 2 ? 1 : along[1] / *k;
  region->anisotropy[5] = one * z * z + three * x * x;
  return STATUS_OK;
}

enum status scene_read_permeability(struct config *config, config_node *group,
                                    const struct scene *scene, struct region *region) {
  double k = 0;
  config_node *node = config_child(group, "permeability");
  const bool list = node != NULL && config_is_list(node);
  enum status status = list ? read_tensor(config, group, scene, &k, region)
                            : keys_read_number(config, group, "regions[]", "permeability", &k);
  if (status != STATUS_OK) return status;
  if (!list && config_child(group, "bedding") != NULL)
    return config_error(config, config_child(group, "bedding"),
                        "needs a permeability for each axis, like [\"1e-5 m/s\", %s\"1e-6 m/s\"]",
                        scene->dimensions == 3 ? "\"1e-5 m/s\", " : "");
  return k > 0 ? set_drag(config, group, scene, k, region) : STATUS_OK;
}

/* Variably saturated soil: retention curves of van Genuchten, Haverkamp or Gardner, and the initial
 * water content. */

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
