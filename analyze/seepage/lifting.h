/* Stability of soil and walls against the water pressure: exit gradient, heave beside walls,
 * pressure on walls. */
#ifndef TOSUI_ANALYZE_SEEPAGE_LIFTING_H
#define TOSUI_ANALYZE_SEEPAGE_LIFTING_H

#include "analyze/seepage/darcy_flow.h"
#include "analyze/seepage/head_field.h"

/* Where water leaves soil upwards, at the highest ratio of gradient to critical gradient. */
struct lifting_exit {
  bool found;
  bool resolved; /* no wall's foot is in the layer, and the error is below half of the gradient */
  size_t soil;   /* its region */
  size_t i, k;   /* topmost cell */
  double x, z;   /* m, on its upper face */
  double depth;  /* thickness in m of the layer over which the gradient is the mean */
  double gradient, critical;
  double deep;  /* gradient of the run at the lower end of the layer */
  double error; /* of the gradient, 95 %; NAN: unknown */
};

/* Prism of soil beside a wall (Terzaghi 1922): as deep as the embedment of the wall, half as
 * wide. */
struct lifting_prism {
  size_t wall;
  int side; /* -1: on the side of low x, 1: of high x */
  /* At least four particles of the soil deep; in a shallower prism the gradient beside the wall's
   * foot depends on the spacing. */
  bool resolved;
  double depth, width, porosity, gradient, critical;
  double error; /* of the gradient, 95 %; NAN: unknown */
};

/* Water pressure on a wall, N per m along y. */
struct lifting_load {
  size_t wall;
  double force[2]; /* x, z; sum over all faces */
  /* Force upwards on the lower face, N/m; mean pressure there, Pa. */
  double uplift, pressure;
  double length;                       /* wetted length of the lower face, m */
  double force_error[2], uplift_error; /* 95 %; NAN: unknown */
};

struct lifting {
  struct lifting_exit exit;
  size_t prism_count, load_count;
  struct lifting_prism *prisms; /* two for each region at most */
  struct lifting_load *loads;
};

/* Computes all of this from the heads of a field; grain_density in kg/m^3. Errors are set by
 * lifting_set_errors. Free with lifting_free, also after a failure. */
enum status lifting_find(const struct head_field *field, double grain_density,
                         struct lifting *lifting);
void lifting_free(struct lifting *lifting);

/* Sets the errors: the deviation from the same quantity by the heads of Darcy's law on cells, plus
 * the uncertainty of that. */
enum status lifting_set_errors(const struct darcy_flow *darcy, double grain_density,
                               struct lifting *lifting);

/* The spacing in m that resolves the prisms beside all walls; NAN if the present one does. */
double lifting_resolving_spacing(const struct lifting *lifting);

/* Critical gradient (Gs - 1) / (1 + e), at which the effective stress vanishes (Terzaghi 1922). */
double lifting_critical(double grain_density, double density, double porosity);

#endif
