#include "sphsolve/plan/reynolds.h"

#include <math.h>

#include "common/units.h"
#include "sphsolve/plan/constants.h"

double hydraulic_diameter(const struct lattice *l) {
  size_t faces[3];
  double surface = 0.0;
  lattice_count_faces(l, faces);
  for (int a = 0; a < 3; a++) surface += (double)faces[a] / l->spacing[a];
  return surface > 0.0 ? 4.0 * (double)l->fluid_count / (surface * 2.0 / 3.0) : 0.0;
}

double hydraulic_diameter_of_grains(double grain_size, double porosity) {
  return 2.0 / 3.0 * grain_size * porosity / (1.0 - porosity);
}

double reynolds_number(const double darcy[3], double porosity, double diameter,
                       double kinematic_viscosity) {
  const double speed = hypot(hypot(darcy[0], darcy[1]), darcy[2]);
  return speed / porosity * diameter / kinematic_viscosity;
}

double reynolds_inertia_gradient(double permeability, double porosity, double kinematic_viscosity) {
  if (!(permeability > 0.0 && porosity > 0.0)) return NAN;
  const double beta =
      ERGUN_INERTIAL / sqrt(ERGUN_VISCOUS * permeability * porosity * porosity * porosity);
  const double viscous = kinematic_viscosity / permeability;
  const double v = INERTIA_SHARE / (1.0 - INERTIA_SHARE) * viscous / beta;
  return (viscous * v + beta * v * v) / GRAVITY_STANDARD;
}

double reynolds_of_soil(const struct scene *scene, double nu, const double darcy[3]) {
  const struct region *coarsest = NULL;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type == REGION_POROUS &&
        (coarsest == NULL || region->grain_size > coarsest->grain_size))
      coarsest = region;
  }
  if (coarsest == NULL || !(nu > 0)) return NAN;
  const double porosity = coarsest->porosity;
  return reynolds_number(darcy, porosity,
                         hydraulic_diameter_of_grains(coarsest->grain_size, porosity), nu);
}
