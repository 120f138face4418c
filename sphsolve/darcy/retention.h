/* Water retention and relative conductivity of a soil at a pressure head h (van Genuchten 1980,
 * with Mualem's model of 1976 for the conductivity):
 *   S = (1 + (alpha |h|)^n)^-m, m = 1 - 1/n                          effective saturation, h < 0
 *   k = S^l (1 - (1 - S^(1/m))^m)^2                                  K over that of saturated soil
 *   F = integral of k from -infinity to h                            Kirchhoff's transform, m
 * Or by Haverkamp et al. (1977): m = 1, and k = 1/(1 + (k_alpha |h|)^k_n) independently. Or by
 * Gardner (1958): k = S = exp(alpha h), so that F = k/alpha and Richards' equation is linear in F.
 * For h >= 0, S = k = 1, and F increases as h does. The water content is theta_r + (theta_s -
 * theta_r) S. */
#ifndef TOSUI_SPHSOLVE_DARCY_RETENTION_H
#define TOSUI_SPHSOLVE_DARCY_RETENTION_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

struct retention {
  double alpha, n, m, l;   /* 1/m, -, -, - */
  double k_alpha, k_n;     /* 1/m, -; 0: k is Mualem's */
  bool exponential;        /* Gardner's curve, which has no table */
  double theta_r, theta_s; /* residual and saturated water content */
  double conductivity[3];  /* m/s along x, y, z, of saturated soil */
  double driest;           /* m, lowest h: drier soil is not distinguished */
  /* Soil that stays full of water (darcy/saturated.h): component xz of its conductivity, m/s; b
   * of i = v/K + b v |v|, s^2/m^2 (Forchheimer 1901). */
  double shear, forchheimer;
  /* ln F, ln (F(0) - F) and their slopes at equal steps of ln(alpha |h|). */
  size_t count;
  double first, step, full; /* full: F(0) */
  double fall;              /* 1 - k at the first step of the table, up to which k falls linearly */
  double (*table)[4];
};

/* State of a place: h and the values there. */
struct retention_state {
  double h, theta, capacity; /* d theta / d h, 1/m */
  double saturation;         /* effective, with all digits in dry soil */
  double k, slope;           /* k and dk/dh */
  double potential, missing; /* F; F(0) - F, below 0 under pressure */
};

/* Tabulates the soil of a region with a retention curve. Free with retention_free. */
enum status retention_make(const struct region *region, struct retention *soil);
void retention_free(struct retention *soil);
/* The soil of a region that stays full of water, in a fluid of kinematic viscosity nu, m^2/s; false
 * if it has no drag. It has no table. */
bool retention_full(const struct region *region, double nu, struct retention *soil);
/* Difference of F, i minus j; for wet soil from the differences to F(0), so that no digits are
 * lost. */
static inline double retention_fall(const struct retention_state *i,
                                    const struct retention_state *j) {
  const bool dry = i->potential < i->missing && j->potential < j->missing;
  return dry ? i->potential - j->potential : j->missing - i->missing;
}
/* Whether two soils have the same properties. */
bool retention_is_same(const struct retention *a, const struct retention *b);

/* Evaluates the state of the soil at pressure head h, m. */
void retention_at(const struct retention *soil, double h, struct retention_state *state);
/* The head at which the effective saturation is S, 0 < S < 1. */
double retention_head(const struct retention *soil, double saturation);
/* Effective saturation at a water content. */
static inline double retention_saturation(const struct retention *soil, double theta) {
  return (theta - soil->theta_r) / (soil->theta_s - soil->theta_r);
}

#endif
