#include "sphsolve/plan/reynolds.h"

#include <math.h>

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
