/* Darcy flux between two places in one soil, and between two soils.
 *
 * Between two places it is that of a soil whose k is an exponential of h with the rate r = (k_i -
 * k_j)/(F_i - F_j) (Gardner 1958). Over a distance d, along which gravity has the component p (over
 * 9.80665 m/s^2),
 *   q = K (k_m ((h_i - h_j)/d + p B(r (h_i - h_j))) + p (k_i - k_j) w(p d r)),
 *   k_m = (F_i - F_j)/(h_i - h_j),   w(P) = 1/(1 - e^-P) - 1/P,   B(P) = P/(e^P - 1).
 * The flux by suction alone is exactly int K dh (Kirchhoff), that in saturated soil exactly
 * Darcy's, and zero for water at rest, whatever the soil. For a soil with exponential k steady flow
 * is exact (exponential fitting of Scharfetter and Gummel 1969; Szymkiewicz 2009 compares means of
 * K). Where gravity outweighs suction over d, k is that upstream, so that no profile oscillates.
 * Where a water table lies between, the soil saturated below it and not above, this holds down to
 * the table, and below it Darcy's law. With a mean r over both parts more water would flow down to
 * a higher head, which by the steady flow between two heads is never so, and soil under which water
 * is perched would have no steady state that Newton's method finds.
 *
 * Between two soils the two halves of the path are in series: h at the interface is where both
 * carry the same flux. The flux in a half is held within the bounds that it has in any soil
 * (hold_within_bounds), and where h = 0 in it, whichever end is saturated, Darcy's law holds
 * beyond: for n < 2 it is else up to 13 % larger or 15 % smaller than that of saturated soil
 * drained by gravity, at pressure heads within 1 cm of 0, several h carry the same flux, which
 * jumps from one to another, and no heads balance a site, at any time step. Within one soil the
 * bounds would make the flux less smooth, and more steps fail. */
#ifndef TOSUI_SPHSOLVE_DARCY_FLUX_H
#define TOSUI_SPHSOLVE_DARCY_FLUX_H

#include "sphsolve/darcy/retention.h"

struct flux {
  double q;      /* m/s, from i to j */
  double di, dj; /* dq/dh at either end, 1/s */
};

/* `conductivity`: of saturated soil along the path, m/s; `pull`: gravity from i to j, over 9.80665
 * m/s^2; `distance`: m. */
void flux_in_soil(double conductivity, double distance, double pull,
                  const struct retention_state *i, const struct retention_state *j,
                  struct flux *flux);
/* That through a share of a face. */
static inline void flux_scale(struct flux *flux, double share) {
  flux->q *= share, flux->di *= share, flux->dj *= share;
}
/* Flux between the centres of two sites with the interface of their soils half way. */
void flux_between_soils(const struct retention *soil_i, const struct retention *soil_j, int axis,
                        double distance, double pull, const struct retention_state *i,
                        const struct retention_state *j, struct flux *flux);

#endif
