/* Arrays of the engine, and their bytes per particle. */
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/engine.h"

struct particle_fields engine_fields(const struct engine_settings *s) {
  bool frozen = s->wall == PASS_FROZEN, adami = s->wall == PASS_ADAMI;
  return (struct particle_fields){
      .shift = s->shift,
      .rate = s->wall == PASS_SUBVOXEL,
      .eulerian = s->wall == PASS_EULERIAN,
      .wall_state = frozen || adami,
      .wall_base = frozen,
      .wall_depth = s->wall == PASS_SUBVOXEL || s->wall == PASS_EULERIAN,
      .wall_v = adami,
      .wall_region = s->wall_moves && s->region_count > 0,
  };
}

/* Memory is largest while lists are made: particles, lists, boxes of rows and bins of columns. For
 * the ordering (16 bytes of keys per particle) and for snapshots (24 of points) the lists are
 * freed. */
double engine_bytes_fluid(const struct engine_settings *settings) {
  struct particle_fields fields = engine_fields(settings);
  return SLOTS_FLUID * ((double)particles_bytes_fluid(&fields) + BOXES + BINS) +
         (fields.eulerian ? LISTS_EULERIAN : LISTS_FLUID) +
         (settings->own_count > 0 ? SLOTS_FLUID * 3 * sizeof(double) : 0);
}

double engine_bytes_wall(const struct engine_settings *settings) {
  struct particle_fields fields = engine_fields(settings);
  return SLOTS_WALL * ((double)particles_bytes_wall(&fields) + BINS) +
         (fields.wall_region ? (double)sizeof(uint16_t) / CLUSTER : 0) +
         (settings->wall == PASS_ADAMI ? BOXES + LISTS_WALL : 0);
}
