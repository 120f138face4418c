#include "sphsolve/recorder.h"

#include <math.h>

void result_from_darcy(const struct scene *scene, const double darcy_velocity[3],
                       struct run_result *result) {
  double along = 0, square = 0;
  for (int a = 0; a < 3; a++) {
    result->darcy_velocity[a] = darcy_velocity[a];
    along += darcy_velocity[a] * scene->driving[a];
    square += scene->driving[a] * scene->driving[a];
  }
  double driving = sqrt(square);
  result->k = result->intrinsic_permeability = NAN;
  if (!(driving > 0)) return;
  along /= driving;
  result->k = along / scene_hydraulic_gradient(scene);
  result->intrinsic_permeability = along * scene->fluid.viscosity / scene->fluid.density / driving;
}
