/* Links: resistance to flow on the straight path between two particles, through soils with sharp
 * faces.
 *
 * A pair of particles far from the edges of soil has a single mobility, or viscosity. At an edge
 * the porosity and drag of a particle are smoothed, as its volume must be (isph/soil.c), and any
 * mean of the two particles' own values gives a resistance that is too large or too small at each
 * edge, by that of some tenths of a particle. Instead, on the straight path from x_i to x_j, of
 * which a part w_k lies in soil k, resistances add:
 *   1/k_ij = rho (I_ij/dt + a_ij + 2 b_ij |v|),   I_ij = sum w_k I_k,  a_ij, b_ij alike,
 *   nu_ij = (nu + nu_T) / sum w_k eps_k            (stress is continuous across a face, not shear)
 * with k = B T / rho_w, B = 1/(1 + T (a + 2 b |v|)) as for a particle, I = C_r/(eps G) = dt/T. For
 * flow across plane layers of any thickness k_ij (q_i - q_j)/r is then the flux, wherever the
 * particles are: there is no error but that of the sums over neighbours.
 *
 * The part of a velocity v* normal to an edge that is left for the pressure must be consistent with
 * what the links carry, so it is there
 *   v*_n = v_n sum_j w_j rho k_ij (I_ij/dt + b_ij |v|) / sum_j w_j,   w_j = V_j slope_ij (r.n)^2.
 * With the particle's own B instead, velocities beside a face vary by a tenth, and the flux depends
 * on dt.
 *
 * Links are for scenes without a free surface, and for those with different soils. In others with a
 * surface the energy may not rise, which holds for the plain mean and the adjoint of the divergence
 * alone; but beside soil that is far less permeable, the plain mean joins two or three rows of it
 * to the permeable soil. With links the divergence has to count what a link carries and not the
 * velocity of the particle at its other end: beside clay the water of gravel moves 1e8 times as
 * fast as the link's. So under a surface the velocity at the face between i and j is (s_i v_i + s_j
 * v_j)/2,   s_i = k_ij / k_i,   k_i the mean of the links of i: of v*_n above, a mean over links,
 * it is the part of this link, where soils do not differ in I. And the divergence is 2 V_j slope
 * (v_i - v_face).r, for a link that carries nothing that of a wall. Only the part of r across the
 * edge counts so; along it the link carries s (v_i - v_j), with the lesser s, as the matrix weights
 * it. With s = 1 that is the plain V_j slope (v_i - v_j).r. A wall's velocity counts by s too, with
 * the mobility beside the wall for k, but of 1 at most: a plate that moves in water over clay does
 * not push the water in the clay. */
#ifndef TOSUI_SPHSOLVE_ISPH_LINK_H
#define TOSUI_SPHSOLVE_ISPH_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/soil.h"

/* Sums over the links of a particle near an edge. */
struct isph_links {
  double normal[3];          /* along grad ln k, not normalised; 0 away from edges */
  double carried[6], all[6]; /* sums of V slope (1 - rho k (I/dt + b |v|)) r r, and of V slope r r;
                             xx xy xz yy yz zz */
  double inertia[6], linear[6], forchheimer[6]; /* sums of V slope r r times I, a, and b |v| */
};

/* A soil, or water (index 0), on the paths of links: its properties and place. */
struct isph_ground {
  struct isph_material of;
  struct isph_soil_place place;
};

/* Whether the soils of this scene are treated by links. */
bool isph_links_wanted(const struct scene *scene, bool has_surface);
/* Allocates what the soils of the scene need; isph_free frees it. */
enum status isph_links_create(struct isph *s);
/* Before isph_link: finds the soils' properties and places, and the particles' speeds. Uses
 * work[0]. */
void isph_links_begin(struct isph *s);

/* The soil that fills the neighbourhood of x within the largest support: 1 + its region, 0 for
 * water, or GROUND_MIXED if an edge of soil is nearer. */
int32_t isph_ground(const struct isph *s, const double x[3]);

/* Finds the mobility and the mean porosity on the path of the pairs of particle i, for a step of
 * length dt (s), and the sums `links`. */
void isph_link(const struct isph *s, struct isph_chunk *chunk, size_t i, double dt,
               struct isph_links *links);
/* Collective, under a surface, after the mobility of all pairs is known: the mean mobility of each
 * particle's links, `linked_mobility`. */
void isph_links_close(struct isph *s);
/* Corrects `predicted`, v* of particle i relative to its soil, found with the particle's own drag
 * and T = t, to what the links carry across an edge. u is its velocity relative to its soil. */
void isph_link_predict(struct isph *s, size_t i, const struct isph_links *links, const double u[3],
                       double t, double predicted[3]);

/* Adds the vector of length `more` normal to an edge to x. */
static inline void isph_link_across(const struct isph_linked *linked, double more, double x[3]) {
  for (int a = 0; a < 3; a++) x[a] += more * linked->normal[a];
}

/* Of the velocity of a wall whose face is at x, the share s that the link to it from particle i
 * carries in a step of length dt (s). */
double isph_link_to_wall(const struct isph *s, size_t i, const double x[3], double dt);

/* What pair p of particle i at an edge adds to the divergence under a surface, over V slope. */
static inline double isph_link_difference(const struct isph *s, const struct isph_chunk *chunk,
                                          size_t p, size_t i, const double vi[3],
                                          const double vj[3], const double r[3]) {
  const double *n = s->linked[i].normal, k = (double)chunk->mobility[p];
  const double si = k / s->linked_mobility[i];
  const double sj = k / s->linked_mobility[chunk->pair[p] & PAIR_MASK];
  const double rn = dot(r, n), across = (2 - si) * dot(vi, n) - sj * dot(vj, n);
  const double along = dot(vi, r) - dot(vj, r) - (dot(vi, n) - dot(vj, n)) * rn;
  return across * rn + fmin(si, sj) * along;
}

#endif
