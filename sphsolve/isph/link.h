/* Links: what resists the flow on the way from one particle to another, through soils with sharp
 * faces.
 *
 * A pair of particles far apart from an edge of soil has one mobility, or viscosity. At an edge
 * porosity and drag of a particle are smoothed, as its volume must be (isph/soil.c), and any mean
 * of the two particles' own leaves a resistance too much or too little at each edge, that of some
 * tenths of a particle. On the straight way from x_i to x_j, of which a part w_k lies in soil k,
 * resistances add:
 *   1/k_ij = rho (I_ij/dt + a_ij + 2 b_ij |v|),   I_ij = sum w_k I_k,  a_ij, b_ij alike,
 *   nu_ij = (nu + nu_T) / sum w_k eps_k            (stress is continuous across a face, not shear)
 * with k = B T / rho_w, B = 1/(1 + T (a + 2 b |v|)) as of a particle, I = C_r/(eps G) = dt/T. For
 * flow across plane layers of any thickness k_ij (q_i - q_j)/r is then the flux, whatever the
 * places of the particles: no error but that of sums over neighbours.
 *
 * A velocity v* across an edge has to leave for the pressure what the links carry, so it is
 *   v*_n = v_n sum_j w_j rho k_ij (I_ij/dt + b_ij |v|) / sum_j w_j,   w_j = V_j slope_ij (r.n)^2
 * there: with the particle's own B in its place velocities beside a face swing by a tenth, and the
 * flux depends on dt.
 *
 * Without a free surface: under one the energy may not rise, which holds for the plain mean and the
 * divergence's adjoint alone. */
#ifndef TOSUI_SPHSOLVE_ISPH_LINK_H
#define TOSUI_SPHSOLVE_ISPH_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/isph/state.h"

/* At a particle near an edge. */
struct isph_links {
  double normal[3];          /* grad ln k, 1/m, of any length; 0 away from edges */
  double carried[6], all[6]; /* sums of V slope (1 - rho k (I/dt + b |v|)) r r, and of V slope r r;
                             xx xy xz yy yz zz */
  double linear[6], forchheimer[6]; /* sums of V slope a r r, and of V slope b |v| r r */
};

/* A soil, or water, as ways meet it. */
struct isph_ground {
  struct isph_material of;
  struct isph_soil_place place;
};

/* Whether soil of this scene has links. */
bool isph_links_wanted(const struct scene *scene, bool has_surface);
enum status isph_links_create(struct isph *s);
/* Before isph_link: what the soils are and where, and how fast the particles. Takes work[0]. */
void isph_links_begin(struct isph *s);

#define GROUND_MIXED (-1)
/* 1 + the region of the soil that fills the largest support there can be about x, 0 for water,
 * GROUND_MIXED where an edge of soil is nearer. */
int32_t isph_ground(const struct isph *s, const double x[3]);

/* Finds mobility and way of the pairs of particle i for a step of length dt, s. */
void isph_link(const struct isph *s, struct isph_chunk *chunk, size_t i, double dt,
               struct isph_links *links);
/* Brings `predicted`, v* of particle i less its soil's, that was found with the particle's own drag
 * and T = t, to what the links carry across an edge; u is its velocity less its soil's. */
void isph_link_predict(struct isph *s, size_t i, const struct isph_links *links, const double u[3],
                       double t, double predicted[3]);

#endif
