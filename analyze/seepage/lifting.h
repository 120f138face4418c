/* Whether water lifts soil and walls: exit gradient, heave beside walls, pressure on walls. */
#ifndef TOSUI_ANALYZE_SEEPAGE_LIFTING_H
#define TOSUI_ANALYZE_SEEPAGE_LIFTING_H

#include "analyze/seepage/darcy_flow.h"
#include "analyze/seepage/head_field.h"

/* Where water leaves soil upwards. */
struct lifting_exit {
  bool found;
  bool resolved; /* no wall's foot is in the layer, and the error is under half of the gradient */
  size_t soil;   /* its region */
  size_t i, k;   /* topmost cell */
  double x, z;   /* m, on its upper face */
  double depth;  /* m below it: of the layer whose mean gradient this is */
  double gradient, critical;
  double deep;  /* the run's gradient at the layer's lower end */
  double error; /* of the gradient; NAN: not known */
};

/* Terzaghi's prism beside a wall (Terzaghi 1922): as deep as the wall goes into the soil, half as
 * wide. */
struct lifting_prism {
  size_t wall;
  int side; /* -1: on the side of low x */
  bool resolved; /* at least four of the soil's particles deep: else gradients beside the wall's foot
                    grow with finer spacing */
  double depth, width, porosity, gradient, critical;
  double error; /* of the gradient; NAN: not known */
};

/* Water's pressure on a wall, N per m along y. */
struct lifting_load {
  size_t wall;
  double force[2];                     /* x, z; of all faces */
  double uplift, pressure;             /* N/m upwards on its lower face; its mean pressure, Pa */
  double length;                       /* m of the lower face that is wet */
  double force_error[2], uplift_error; /* NAN: not known */
};

struct lifting {
  struct lifting_exit exit;
  size_t prism_count, load_count;
  struct lifting_prism *prisms; /* two for each region at most */
  struct lifting_load *loads;
};

/* By the heads of a field; grain_density in kg/m^3. Errors are not known yet. Free with
 * lifting_free, also after a failure. */
enum status lifting_find(const struct head_field *field, double grain_density,
                         struct lifting *lifting);
void lifting_free(struct lifting *lifting);

/* Sets the errors: what the same is by the heads of Darcy's law on cells, with its uncertainty. */
enum status lifting_hold_against(const struct darcy_flow *darcy, double grain_density,
                                 struct lifting *lifting);

/* m: that resolves the prisms beside all walls; NAN: this one does. */
double lifting_resolving_spacing(const struct lifting *lifting);

/* (Gs - 1) / (1 + e), the gradient at which water carries the grains (Terzaghi 1922). */
double lifting_critical(double grain_density, double density, double porosity);

#endif
