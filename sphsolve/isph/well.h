/* Wells and drains: regions of soil that take water out of it. A well takes a given rate, a drain
 * what it needs to hold its pressure at that of a given head, or at the air's, and never gives any.
 * What they do to the pressure is in isph/well.c; without one nothing of it is called. */
#ifndef TOSUI_SPHSOLVE_ISPH_WELL_H
#define TOSUI_SPHSOLVE_ISPH_WELL_H

#include "sphsolve/isph/state.h"

/* Solves of a step at most, for which particles of drains give. */
#define WELL_ROUNDS 20

/* A well or a drain. Numbers are per m along y in 2-D. */
struct isph_well {
  const struct region *region;
  double taken;   /* kg, in whole particles */
  double pending; /* kg that left since, less than a particle holds */
  double flow;    /* m^3/s (m^2/s), of the last step, out of the soil */
  int starved;    /* steps in a row in which the soil did not bring its rate */
};

/* Of a particle. */
struct isph_outlet {
  int32_t well; /* 1 + its number; 0: in none */
  bool leaves;  /* at the end of this step */
  double flow;  /* m^3/s (m^2/s) out of the soil there */
  double tie;   /* of a drain: flow over the pressure above the drain's */
};

/* Whether a scene has a well or a drain. */
bool isph_has_wells(const struct scene *scene);
enum status isph_wells_create(struct isph *s);
/* Whether x lies in a well or a drain. */
bool isph_in_well(const struct isph *s, const double x[3]);
/* Between predictor and pressure: what each particle gives. */
void isph_wells_begin(struct isph *s, double dt);
/* The row of particle i of the pressure equation, after all else of it. */
void isph_wells_row(const struct isph *s, size_t i, double *diagonal, double *source, double *tied);
/* After a solve: what drains take by it. */
void isph_wells_solved(struct isph *s);
/* Whether particles began or ceased to give by that solve: then it is to be done anew. */
bool isph_wells_change(struct isph *s);
/* After the pressure is final: books what leaves, and marks whole particles for it. */
void isph_wells_take(struct isph *s, double dt);

#endif
