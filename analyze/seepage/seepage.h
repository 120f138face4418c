/* Results of a seepage run for an engineer: flow, exit gradients, heave, forces on walls, flow
 * net. */
#ifndef TOSUI_ANALYZE_SEEPAGE_SEEPAGE_H
#define TOSUI_ANALYZE_SEEPAGE_SEEPAGE_H

#include "analyze/product.h"
#include "analyze/run_file.h"
#include "analyze/seepage/darcy_flow.h"
#include "analyze/seepage/head_field.h"
#include "analyze/seepage/lifting.h"

/* Where the free surface in soil ends at an upright face, and water comes out below it. */
struct surface_exit {
  double x, z, error; /* m; of z, 95 % */
  double outside;     /* m: level of the water outside; NAN: none */
};

struct seepage {
  const struct run *run;
  struct head_field field;
  struct asked_heads asked;
  struct head_field law;   /* the field with the prescribed heads; owns nothing */
  struct darcy_flow darcy; /* for `law`; not known while the soil fills or drains */
  double grain_density;
  bool sinks;        /* wells or drains: with them there is no stream function */
  double *psi;       /* m^2/s, at corners; NAN with sinks, as are the flows below */
  double flow;       /* m^2/s: largest difference of psi in the soil */
  double flow_error; /* 95 %: deviation of velocities from psi, free surface, uptake, drift */
  double drift;      /* m^2/s: uncertainty because velocities still change in one direction */
  double uptake;     /* m^2/s: rate at which the soil fills, negative if it drains; NAN: unknown */
  double drop;       /* m: difference of the heads in the soil */
  double low;        /* m: lowest head in the soil */
  struct lifting lifting;
  double *phreatic; /* [nx] m, where the pressure is that of the air; NAN without a free surface */
  /* m, 95 %: of the free surface in soil; half a cell where Darcy's law is not known. */
  double surface_error;
  size_t exit_count;
  struct surface_exit exits[2]; /* towards low x, towards high x */
};

/* grain_density in kg/m^3; 2650 if NAN. Free with seepage_free, also after a failure. */
enum status seepage_find(const struct run *run, double grain_density, struct seepage *seepage);
void seepage_free(struct seepage *seepage);

/* Whether a flow net of the run is meaningful: the heads in its soil differ by more than a spacing.
 * False also if the run has no such field. */
enum status seepage_applies(const struct run *run, bool *applies);

/* seepage_plot.c: the gnuplot commands of the flow net. */
void seepage_plot(const struct seepage *seepage, struct product *product);

#endif
