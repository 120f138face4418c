/* Wells and drains: regions that take water out of soil. A well takes a given rate; a drain takes
 * what is needed to hold its pressure at that of a given head, or at atmospheric pressure, and
 * never adds water. Equations: isph/well.c, of which nothing is called without such a region. */
#ifndef TOSUI_SPHSOLVE_ISPH_WELL_H
#define TOSUI_SPHSOLVE_ISPH_WELL_H

#include "sphsolve/isph/state.h"

/* A well or a drain. In 2-D amounts and rates are per m along y. */
struct isph_well {
  const struct region *region;
  double taken;   /* kg, taken as whole particles */
  double pending; /* kg that left but is not yet taken as a particle; less than the mass of one */
  double flow;    /* m^3/s (m^2/s), of the last step, out of the soil */
  int starved;    /* number of steps in a row in which the soil did not yield its rate */
};

/* Outflow at a particle. */
struct isph_outlet {
  int32_t well;   /* 1 + number of the well or drain that its flow goes to; 0: none */
  int32_t inside; /* 1 + number of the drain that holds the particle; 0: none */
  bool within;    /* in its region, or half a particle from it: may be taken */
  bool leaves;    /* whether it is taken at the end of this step */
  bool gives;     /* to a drain: its pressure is above the drain's */
  double flow;    /* m^3/s (m^2/s) out of the soil there */
  double passed;  /* of it what v* brings, in the present solve */
  double tie;     /* to a drain: outflow over the excess of the pressure over `held` */
  double held;    /* Pa, the drain's pressure there */
  double pull[3]; /* gradient of the pressure over that excess, 1/m, by links that are cut */
};

/* Sets up the wells and drains of the scene; isph_free frees them. */
enum status isph_wells_create(struct isph *s);
/* Whether x lies in a well or a drain. */
bool isph_in_well(const struct isph *s, const double x[3]);
/* Between predictor and pressure: sets the outflow of each particle of a well, and which particles
 * of drains give water. */
void isph_wells_begin(struct isph *s, double dt);
/* Adds the well's or drain's terms to row i of the pressure equation, after all other terms. */
void isph_wells_row(const struct isph *s, size_t i, struct effect_row *row);
/* Adds to the gradient of the pressure at particle i what links have more that a drain cuts. */
void isph_wells_gradient(const struct isph *s, size_t i, double gradient[3]);
/* Whether what the velocities bring to particle i goes to a drain, and not into its row. */
static inline bool isph_wells_take_source(const struct isph *s, size_t i) {
  return s->outlet[i].gives;
}
/* After a solve: adds the outflow of drains at the pressure found. */
void isph_wells_solved(struct isph *s);
/* Updates which particles of drains give water at the pressure found; returns whether any changed,
 * so that the solve has to be repeated. */
bool isph_wells_change(struct isph *s);
/* After the pressure is final: accumulates the mass that leaves, and marks whole particles to be
 * removed for it. */
void isph_wells_take(struct isph *s, double dt);

#endif
