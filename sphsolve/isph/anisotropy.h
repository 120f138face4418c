/* Soil that lets water through along one axis more easily than along another: beds. Its mobility is
 * a tensor,
 *   v* = B [v + T (...)],  v = v* - K grad q,   B = (1 + T (A + 2 b |v|))^-1,  K = B T / rho,
 * A the tensor of linear drag, g times the inverse of its permeability (scene/scene.h).
 *
 * div(K grad q) on pairs. With one number k a pair the sum of 2 V_i V_j k slope_ij (q_i - q_j)
 * makes of the second moment of the neighbourhood, E = sum_j V_j slope_ij r r (1 where it is
 * whole), the operator's tensor. The weight that is exact for neighbours spread evenly over all
 * directions n is k(n) = ((d + 2) n.K.n - tr K)/2 (Espanol, Revenga 2003, Phys. Rev. E 67, 026705,
 * in d dimensions); it is negative across the beds as soon as K's ratio is above 3 in 2-D, 2 in
 * 3-D, and the matrix is then none of a diffusion any more. So here the weight of a pair is k_ij =
 * k exp(n.S.n), positive for any tensor S, with the S of each particle at which its second moment
 * is what it should be, K^1/2 E K^1/2 (k is the geometric mean of K): of all weights with that
 * moment the nearest to the kernel's own in relative entropy (Jaynes 1957; for particle methods
 * Arroyo, Ortiz 2006, Int. J. Numer. Meth. Eng. 65, 2167). S minimises sum_j V_j slope r^2
 * exp(n.S.n) - tr(S T), convex: Newton's method. A pair takes the mean of both ends' S, so that the
 * matrix is symmetric, with positive weights, for any ratio; the neighbours' directions limit what
 * moments can be had.
 *
 * Along the way of a link (isph/link.h) resistances add, each soil's over its own exp(n.S.n): those
 * of the ends for the soils they are in, that of evenly spread neighbours for soils between. */
#ifndef TOSUI_SPHSOLVE_ISPH_ANISOTROPY_H
#define TOSUI_SPHSOLVE_ISPH_ANISOTROPY_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/isph/state.h"

/* Whether soil of this scene is anisotropic. */
bool isph_is_anisotropic(const struct scene *scene);
enum status isph_anisotropy_create(struct isph *s);

/* Soils of drag a (1/s) with their fraction w at a place; starts from {.count = 0}. */
#define ISPH_LAYERS 8
struct isph_layers {
  size_t count;
  struct {
    double w, a;
    const struct region *soil;
  } at[ISPH_LAYERS];
};
void isph_layers_add(struct isph_layers *layers, double w, double a, const struct region *soil);
/* From soil->normal and plane: soil->tensor, the tensor of drag, 1/s. */
void isph_layers_close(const struct isph_layers *layers, struct soil_point *soil);

/* What is anisotropic about particle i at its place; after its drag_a. */
void isph_anisotropy_at(struct isph *s, size_t i, const struct soil_point *soil);
/* Collective, before a step of length dt, s: K and S of the particles. */
void isph_anisotropy_begin(struct isph *s, double dt);
/* Mobilities of all pairs where there are no links; after those of the particles. */
void isph_anisotropy_pairs(struct isph *s);

/* What lies on a way: soils, NULL for water, with their parts; what is beyond ISPH_PARTS counts for
 * the last. */
#define ISPH_PARTS 8
struct isph_parts {
  size_t count;
  struct {
    const struct region *soil;
    double share;
  } at[ISPH_PARTS];
};

/* What a way of link resists: from its parts, along n from j to i. */
struct isph_turned {
  double mobility, drag;
};
struct isph_turned isph_anisotropy_way(const struct isph *s, size_t i, size_t j, const double n[3],
                                       const struct isph_parts *parts, double dt, double speed);
/* The gradient of q at particle i near an edge of soil, of which K makes the flux of the links
 * across it. f: driving force, m/s^2. */
void isph_anisotropy_edge(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                          const double f[3], double gradient[3]);
/* Beside a wall that beds meet at an angle the gradient has a part across the wall, of which no
 * water goes through it. What is present of the moment along each axis, walls left out, makes up
 * for it too. */
void isph_anisotropy_present(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                             double present[3]);

#endif
