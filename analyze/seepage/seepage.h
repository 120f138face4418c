/* What an engineer asks of a seepage run: flow, exit gradients, heave, forces on walls, flow net.
 */
#ifndef TOSUI_ANALYZE_SEEPAGE_SEEPAGE_H
#define TOSUI_ANALYZE_SEEPAGE_SEEPAGE_H

#include "analyze/product.h"
#include "analyze/run_file.h"
#include "analyze/seepage/asked_heads.h"
#include "analyze/seepage/darcy_flow.h"
#include "analyze/seepage/head_field.h"
#include "analyze/seepage/lifting.h"

struct seepage {
  const struct run *run;
  struct head_field field;
  struct asked_heads asked;
  struct head_field law;   /* the field with the heads that are asked for; owns nothing */
  struct darcy_flow darcy; /* of `law`; not known while soil fills or drains */
  double grain_density;
  bool sinks;        /* wells or drains: what flows into them has no stream function */
  double *psi;       /* m^2/s, at corners; NAN with sinks, as is all of the flow below */
  double flow;       /* m^2/s: most of psi between two places in soil */
  double flow_error; /* of it, 95 %: velocities less psi, the surface, uptake, drift */
  double drift;      /* m^2/s: what velocities that still go one way leave open of it */
  double uptake;     /* m^2/s: that the soil fills with, below 0 drains of; NAN: not known */
  double drop;       /* m: of head in the soil */
  double low;        /* m: least head in soil */
  struct lifting lifting;
  double *phreatic; /* [nx] m; NAN where there is no surface */
};

/* grain_density in kg/m^3, NAN: 2650. Free with seepage_free, also after a failure. */
enum status seepage_find(const struct run *run, double grain_density, struct seepage *seepage);
void seepage_free(struct seepage *seepage);

/* Whether the soil fills or drains so fast that what flows in it is no flow through it. */
bool seepage_is_filling(double flow, double error, double uptake);

/* Whether water seeps in a run so that a flow net says something: head falls in its soil by more
 * than a spacing. False also where there is no such field. */
enum status seepage_applies(const struct run *run, bool *applies);
/* What a factor of safety against being lifted means, in a few words. */
const char *seepage_judge(double factor);

/* seepage_plot.c: gnuplot's body of the flow net. */
void seepage_plot(const struct seepage *seepage, struct product *product);

#endif
