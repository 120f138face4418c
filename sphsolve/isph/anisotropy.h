/* Anisotropic soil (in beds), which is more permeable along one axis than along another. Its
 * mobility is a tensor,
 *   v* = B [v + T (...)],  v = v* - K grad q,   B = (1 + T (A + 2 b |v|))^-1,  K = B T / rho,
 * where A is the tensor of linear drag: g times the inverse of the permeability tensor
 * (scene/scene.h).
 *
 * Discretisation of div(K grad q) by pairs. With one scalar mobility k per pair, the sum of 2 V_i
 * V_j k slope_ij (q_i - q_j) gives an operator whose tensor is the second moment of the
 * neighbourhood, E = sum_j V_j slope_ij r r (the identity for a complete neighbourhood). The weight
 * that is exact for neighbours spread evenly over all directions n is k(n) = ((d + 2) n.K.n - tr
 * K)/2 in d dimensions (Espanol, Revenga 2003, Phys. Rev. E 67, 026705). Across the beds it is
 * negative as soon as the ratio of the principal values of K exceeds 3 in 2-D or 2 in 3-D, and the
 * matrix is then not that of a diffusion. So the weight of a pair is k_ij = k exp(n.S.n) instead,
 * which is positive for any tensor S. The S of each particle is the one at which the second moment
 * is what it should be, K^1/2 E K^1/2 (with k the geometric mean of K). Of all weights with that
 * moment these are the nearest to the kernel's own in relative entropy (Jaynes 1957; for particle
 * methods Arroyo, Ortiz 2006, Int. J. Numer. Meth. Eng. 65, 2167). S minimises the convex function
 * sum_j V_j slope r^2 exp(n.S.n) - tr(S T), which is done by Newton's method. A pair takes the mean
 * of both ends' S, so that the matrix is symmetric with positive weights for any ratio. Which
 * moments can be reached is limited by the directions of the neighbours.
 *
 * Along the path of a link (isph/link.h) resistances add, each soil's divided by its own
 * exp(n.S.n): with the S of the end particles for the soils that they are in, and that of evenly
 * spread neighbours for soils between. */
#ifndef TOSUI_SPHSOLVE_ISPH_ANISOTROPY_H
#define TOSUI_SPHSOLVE_ISPH_ANISOTROPY_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/soil.h"

/* Whether soil of this scene is anisotropic. */
bool isph_is_anisotropic(const struct scene *scene);
/* Allocates what the soils of the scene need; isph_free frees it. */
enum status isph_anisotropy_create(struct isph *s);

/* Sets s->anisotropy[i] (except `relative`) from the soil at the particle's place; drag_a has to be
 * known. */
void isph_anisotropy_at(struct isph *s, size_t i, const struct soil_point *soil);
/* Collective, before a step of length dt (s): finds the relative mobility K and the shape S of the
 * particles. */
void isph_anisotropy_begin(struct isph *s, double dt);
/* Mobilities of all pairs in scenes without links; those of the particles have to be known. */
void isph_anisotropy_pairs(struct isph *s);

/* The soils on the path between two particles (NULL: water), with their shares of its length. What
 * exceeds ISPH_PARTS is added to the share of the last. */
#define ISPH_PARTS 8
struct isph_parts {
  size_t count;
  struct {
    const struct region *soil;
    double share;
  } at[ISPH_PARTS];
};

/* Mobility and linear drag (1/s) of a link from its parts, along the unit vector n from j to i. */
struct isph_turned {
  double mobility, drag;
};
struct isph_turned isph_anisotropy_way(const struct isph *s, size_t i, size_t j, const double n[3],
                                       const struct isph_parts *parts, double dt, double speed);
/* Corrects the gradient of q at particle i near an edge of soil, so that K times it gives the
 * links' flux across the edge. f: driving force, m/s^2. */
void isph_anisotropy_edge(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                          const double f[3], double gradient[3]);
/* Share of the second moment along each axis that is present at particle i, leaving out the walls.
 * Beside a wall that beds meet at an angle the gradient has a component normal to the wall,
 * although no water flows through it; dividing by this share compensates for that too. */
void isph_anisotropy_present(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                             double present[3]);

#endif
