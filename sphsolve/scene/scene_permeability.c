/* Soil with a given permeability: one number, or one along each principal axis. */
#include "sphsolve/scene/scene_permeability.h"

#include <math.h>

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
