/* Particles of the pair loop: fluid that moves, wall that stays on its sites.
 *
 * Both lie in memory along a space-filling curve, in clusters of CLUSTER slots, the unit of the
 * neighbour lists. A cluster that would become wider than `reach` is closed early; its empty slots
 * carry NO_PARTICLE. Fluid positions are fixed-point fractions of the box, so that differences are
 * exact and periodic for free; a box narrower than the kernel's reach is taken 2, 4, ... times (see
 * frame_make), and lists name the image. Wall positions are the site's indices, packed. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLES_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/wcsph/engine/frame.h"

#define NO_PARTICLE UINT32_MAX
#define NO_SITE UINT32_MAX
/* Slots allocated beyond the last, so that full vectors may be read anywhere. */
#define SLOT_PADDING 32

struct particles {
  struct frame frame;
  double reach; /* m: widest extent of a cluster when it is made */

  size_t count, clusters, capacity; /* fluid particles, their clusters, slots allocated */
  uint32_t *x[3];
  float *v[3]; /* m/s */
  /* Frozen walls: rho_0 / rho. Else: the pressure p / (rho_0 c^2). */
  float *state;
  float *shift[3]; /* m/s: velocity of a particle beyond that of the fluid; NULL without */
  float *rate;     /* beside sub-voxel walls, from the force pass to the next: see struct pass */
  uint32_t *id;    /* site the particle started from */
  /* Eulerian (pairs_eulerian.h): what the sites around do, packed; and from the force pass to the
   * next, packed too, what the flux that the continuity equation balances has beyond the velocity.
   */
  float *site_terms[5], *flux[2];
  /* What a step makes: the new velocity, and in memory that lies idle (see engine_step) the
   * distance to the wall, m, negated where its field is not smooth, and the new state. Free between
   * steps. */
  float *v_next[3];
  float *distance, *state_next;

  size_t wall_count, wall_clusters; /* only walls that fluid can reach are kept */
  uint32_t *site;                   /* frame_wall_index */
  float *wall_state;                /* as state; frozen and adami */
  uint32_t *wall_sum;               /* frozen: in its memory, while densities are summed */
  float *wall_base;                 /* sum of W over wall neighbours / alpha; frozen */
  uint16_t *wall_depth;             /* below the surface, in units of depth_unit, subvoxel */
  double depth_unit;                /* m */
  float *wall_v[3];                 /* m/s: adami's dummy velocity */
  uint16_t *wall_region;            /* of each cluster, where walls move: lattice->region */
  float (*wall_velocity)[3];        /* m/s, of each region; NULL where nothing moves */
};

/* What the effects of a run need; the rest stays NULL. */
struct particle_fields {
  bool shift, rate, eulerian;
  bool wall_state, wall_base, wall_depth, wall_v, wall_region;
};

/* Walls within `range` of fluid, ordered, in clusters; how much fluid there is. */
enum status particles_make(const struct lattice *lattice, double range, double reach,
                           double clearance, const struct particle_fields *fields,
                           struct particles *particles);
/* Fluid at rest on its sites, unsorted: of all the `count` particles from `first` on. */
enum status particles_place(const struct lattice *lattice, const struct particle_fields *fields,
                            size_t first, size_t count, struct particles *particles);
/* Walls of planes [first, end) that fluid can reach, in the order of sites; *sites is to be freed.
 */
enum status particles_find_walls(const struct lattice *lattice, double range, size_t first,
                                 size_t end, uint32_t **sites, size_t *count);
/* Makes walls of sites in order; empty slots carry NO_PARTICLE. */
enum status particles_set_walls(const struct lattice *lattice, double range,
                                const struct particle_fields *fields, const uint32_t *order,
                                size_t used, struct particles *particles);
void particles_free(struct particles *particles);
/* Orders the fluid along the curve and cuts it into clusters; deterministic. */
enum status particles_sort(struct particles *particles);
/* Room for `clusters` clusters of fluid; what they hold is the caller's to fill. */
enum status particles_resize(struct particles *particles, size_t clusters);
/* Of the clusters here, `count` from `from` on go to `to`; there is then room for `clusters`, of
 * which the others are the caller's to fill (what a step makes is not kept). */
enum status particles_hold(struct particles *particles, size_t from, size_t count, size_t to,
                           size_t clusters);
/* Allocates site_terms and flux: after the ordering of the particles, which takes as much memory.
 */
enum status particles_make_site_terms(struct particles *particles);
/* Frees the walls and what is kept for them. */
void particles_drop_walls(struct particles *particles);
enum status particles_hold_walls(struct particles *particles, size_t from, size_t count, size_t to,
                                 size_t clusters);
/* Addresses of the fluid's arrays that travel with a particle; 4 bytes a slot each. */
size_t particles_kept(struct particles *particles, void **kept[16]);
/* m, inside the lattice's box. */
void particles_position(const struct particles *particles, const struct lattice *lattice,
                        size_t slot, double position[3]);
/* Bytes held per slot of fluid and of wall. */
size_t particles_bytes_fluid(const struct particle_fields *fields);
size_t particles_bytes_wall(const struct particle_fields *fields);

static inline size_t particles_slots(const struct particles *p) {
  return p->clusters * CLUSTER;
}
static inline size_t particles_wall_slots(const struct particles *p) {
  return p->wall_clusters * CLUSTER;
}
#endif
