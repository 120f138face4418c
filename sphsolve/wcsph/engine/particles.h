/* Particles of the pair loops: moving fluid, and walls on their sites.
 *
 * Both are stored along a space-filling curve, in clusters of CLUSTER slots, the unit of the
 * neighbour lists. A cluster that would become wider than `reach` is closed early; its empty slots
 * contain NO_PARTICLE. Fluid positions are fixed-point fractions of the box, so that differences
 * are exact and periodic without extra cost; a box narrower than the reach of the kernel is
 * repeated 2, 4, ... times (see frame_make), and lists name the image. Wall positions are packed
 * site indices. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLES_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/wcsph/engine/frame.h"

#define NO_PARTICLE UINT32_MAX
#define NO_SITE UINT32_MAX
/* Slots allocated beyond the last one, so that full vectors may be read anywhere. */
#define SLOT_PADDING 32
#define SLOT_ARRAYS 24 /* room for lists of arrays */

struct particles {
  struct frame frame;
  double reach; /* m: widest extent of a cluster when it is made */

  size_t count, clusters, capacity; /* fluid particles, their clusters, slots allocated */
#define FIELD(use, type, shape, name, when) type *name shape;
#include "sphsolve/wcsph/engine/fields.def"
#undef FIELD
  /* Results of a step in temporarily unused memory (see engine_step): the distance to the wall, m,
   * negative where its field is not smooth, and the new state. */
  float *distance, *state_next;

  size_t wall_count, wall_clusters; /* only walls within reach of fluid are kept */
  uint32_t *site;                   /* frame_wall_index */
  uint32_t *wall_sum;               /* frozen walls: shares its memory while densities are summed */
  uint16_t *wall_depth;             /* below the surface, in units of depth_unit; sub-voxel walls */
  double depth_unit;                /* m */
  uint16_t *wall_region;            /* of each cluster, if walls move: lattice->region */
  float (*wall_velocity)[3];        /* m/s, of each region; NULL if nothing moves */
};

/* An array of fields.def. */
struct slot_array {
  const char *name;
  int component; /* of an array of several; else -1 */
  bool whole;    /* uint32_t, else float */
  void **array;
  bool wanted;
};

/* Arrays that the effects of a run need; the others are NULL. */
struct particle_fields {
  bool shift, rate, eulerian;
  bool wall_state, wall_base, wall_depth, wall_v, wall_region;
};

/* Makes the walls within `range` of fluid, ordered in clusters, and counts the fluid. */
enum status particles_make(const struct lattice *lattice, double range, double reach,
                           double clearance, const struct particle_fields *fields,
                           struct particles *particles);
/* Places fluid at rest on its sites, unsorted: the `count` particles from number `first` on. */
enum status particles_place(const struct lattice *lattice, const struct particle_fields *fields,
                            size_t first, size_t count, struct particles *particles);
/* Finds the walls of planes [first, end) within reach of fluid, in the order of sites; *sites must
 * be freed. */
enum status particles_find_walls(const struct lattice *lattice, double range, size_t first,
                                 size_t end, uint32_t **sites, size_t *count);
/* Makes the wall particles from sites in the given order; empty slots contain NO_PARTICLE. */
enum status particles_set_walls(const struct lattice *lattice, double range,
                                const struct particle_fields *fields, const uint32_t *order,
                                size_t used, struct particles *particles);
void particles_free(struct particles *particles);
/* Orders the fluid along the curve and divides it into clusters; deterministic. */
enum status particles_sort(struct particles *particles);
/* Allocates `clusters` clusters of fluid, to be filled by the caller. */
enum status particles_resize(struct particles *particles, size_t clusters);
/* Moves `count` clusters from `from` to `to` and allocates `clusters` clusters, of which the caller
 * must fill the others (results of a step are not kept). */
enum status particles_hold(struct particles *particles, size_t from, size_t count, size_t to,
                           size_t clusters);
/* Allocates site_terms and flux; called after the ordering of the particles, which needs as much
 * memory. */
enum status particles_make_site_terms(struct particles *particles);
/* Frees the walls and all their arrays. */
void particles_drop_walls(struct particles *particles);
/* As particles_hold, for the walls. */
enum status particles_hold_walls(struct particles *particles, size_t from, size_t count, size_t to,
                                 size_t clusters);
/* The arrays of the state of the fluid, KEPT in fields.def; returns their number. */
size_t particles_kept(struct particles *particles, struct slot_array kept[SLOT_ARRAYS]);
/* Position in m, inside the box of the lattice. */
void particles_position(const struct particles *particles, const struct lattice *lattice,
                        size_t slot, double position[3]);
/* Bytes per slot of fluid, of its state alone, and of wall. */
size_t particles_bytes_kept(const struct particle_fields *fields);
size_t particles_bytes_fluid(const struct particle_fields *fields);
size_t particles_bytes_wall(const struct particle_fields *fields);

static inline size_t particles_slots(const struct particles *p) {
  return p->clusters * CLUSTER;
}
static inline size_t particles_wall_slots(const struct particles *p) {
  return p->wall_clusters * CLUSTER;
}
#endif
