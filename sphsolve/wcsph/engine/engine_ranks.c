#include "sphsolve/wcsph/engine/engine_ranks.h"

#include <omp.h>

#include "common/memory.h"

#define FIELD_BYTES (CLUSTER * sizeof(float))

/* Only own clusters are held. */
static void hold_own(struct ghosts *g) {
  g->begin = 0;
  g->end = g->partition[ranks_own() + 1] - g->partition[ranks_own()];
  memory_free(&g->number);
}

enum status engine_partition(struct engine *engine, size_t clusters) {
  enum status status = STATUS_OK;
  struct engine_ranks *ranks = &engine->ranks;
  ranks->fluid.tag = 3;
  ranks->fluid.bytes_most = 6 * FIELD_BYTES;
  TRY(ghosts_partition(&ranks->fluid, clusters, PARTITION_UNIT, ranks->work));
  if (engine_is_distributed(engine)) hold_own(&ranks->fluid);
cleanup:
  return status;
}

enum status engine_adopt_partition(struct engine *engine) {
  enum status status = STATUS_OK;
  struct ghosts *g = &engine->ranks.fluid;
  const size_t ranks = (size_t)ranks_count();
  size_t *each = NULL;
  if (!engine_is_distributed(engine)) return STATUS_OK;
  TRY(memory_allocate(&each, ranks + 1, sizeof *each, "shares of the ranks"));
  for (size_t r = 0; r <= ranks; r++) each[r] = r;
  g->partition[0] = 0;
  g->partition[ranks_own() + 1] = engine->particles.clusters;
  ranks_gather(g->partition + 1, each, sizeof *g->partition);
  for (size_t r = 0; r < ranks; r++) g->partition[r + 1] += g->partition[r];
  hold_own(g);
  engine->terms_known = false;
  memory_free(&engine->ranks.work); /* belongs to the old partition */
cleanup:
  memory_free(&each);
  return status;
}

enum status engine_drop_ghosts(struct engine *engine) {
  struct ghosts *g = &engine->ranks.fluid;
  const size_t own = g->end - g->begin;
  const enum status status = particles_hold(&engine->particles, g->begin, own, 0, own);
  if (status == STATUS_OK) hold_own(g);
  return status;
}

#define FIELD(name)                                                                                \
  { p->name, FIELD_BYTES }

void engine_send(struct engine *engine, enum engine_sent what) {
  struct particles *p = &engine->particles;
  const struct ghost_field all[] = {FIELD(x[0]), FIELD(x[1]), FIELD(x[2]),  FIELD(v[0]),
                                    FIELD(v[1]), FIELD(v[2]), FIELD(state), FIELD(id)};
  const struct ghost_field place[] = {FIELD(x[0]), FIELD(x[1]), FIELD(x[2]), FIELD(state)};
  const struct ghost_field flux[] = {FIELD(v_next[0]), FIELD(v_next[1]), FIELD(v_next[2])};
  const struct ghost_field wall[] = {FIELD(wall_state), FIELD(wall_v[0]), FIELD(wall_v[1]),
                                     FIELD(wall_v[2])};
  const struct ghost_field still[] = {
      FIELD(site), {p->wall_depth, FIELD_BYTES / 2}, {p->wall_region, sizeof *p->wall_region}};
  struct ghost_field held[4];
  int count = 0;
  const bool frozen = engine->settings.wall == PASS_FROZEN;
  if (!engine_is_distributed(engine)) return;
  switch (what) {
  case SENT_MOTION:
    ghosts_post(&engine->ranks.fluid, 6, all);
    break;
  case SENT_DENSITY:
    ghosts_post(&engine->ranks.fluid, 1, place + 3);
    break;
  case SENT_WALL:
    ghosts_post(&engine->ranks.walls, frozen ? 1 : 4, wall);
    break;
  case SENT_PLACE:
    ghosts_post(&engine->ranks.fluid, 4, place);
    break;
  case SENT_FLUX:
    ghosts_post(&engine->ranks.fluid, 3, flux);
    break;
  case SENT_STATE:
    ghosts_post(&engine->ranks.fluid, 4, all + 3);
    break;
  case SENT_ALL:
    ghosts_post(&engine->ranks.fluid, 6, all);
    ghosts_post(&engine->ranks.fluid, 2, all + 6);
    break;
  case SENT_WALL_ALL:
    for (size_t f = 0; f < sizeof still / sizeof *still; f++)
      if (still[f].data != NULL) held[count++] = still[f];
    if (count > 0) ghosts_post(&engine->ranks.walls, count, held);
    count = 0;
    for (int f = 0; f < 4; f++)
      if (wall[f].data != NULL) held[count++] = wall[f];
    if (count > 0) ghosts_post(&engine->ranks.walls, count, held);
    break;
  }
}

void engine_await_ghosts(struct engine *engine) {
  if (!engine_is_distributed(engine)) return;
  ghosts_finish(&engine->ranks.fluid);
  ghosts_finish(&engine->ranks.walls);
}

static void run_blocks(struct engine *engine, pass_function *function, const uint32_t *blocks,
                       size_t count, size_t begin, size_t end) {
#pragma omp parallel num_threads(engine->threads)
  {
    struct local *local = &engine->locals[omp_get_thread_num()];
#pragma omp for schedule(dynamic, 1)
    for (size_t b = 0; b < count; b++) {
      const size_t first = begin + BLOCK * (blocks != NULL ? blocks[b] : b);
      function(&engine->pass, local, first, first + BLOCK < end ? first + BLOCK : end);
    }
  }
}

void engine_run_distributed(struct engine *engine, pass_function *function, bool wall) {
  const struct engine_ranks *ranks = &engine->ranks;
  if (wall) {
    const struct ghosts *w = &ranks->walls;
    engine_await_ghosts(engine);
    run_blocks(engine, function, NULL, (w->end - w->begin + BLOCK - 1) / BLOCK, w->begin, w->end);
    return;
  }
  const size_t begin = ranks->fluid.begin, end = ranks->fluid.end;
  run_blocks(engine, function, ranks->blocks, ranks->inner, begin, end);
  engine_await_ghosts(engine);
  run_blocks(engine, function, ranks->blocks + ranks->inner, ranks->count - ranks->inner, begin,
             end);
}

enum status engine_gather_blocks(const struct engine *engine, size_t slots, void *sums,
                                 size_t size) {
  enum status status = STATUS_OK;
  const size_t *partition = engine->ranks.fluid.partition, ranks = (size_t)ranks_count();
  size_t *start = NULL;
  if (!engine_is_distributed(engine)) return STATUS_OK;
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "block sums"));
  for (size_t r = 0; r <= ranks; r++) start[r] = (partition[r] * CLUSTER + slots - 1) / slots;
  ranks_gather(sums, start, size);
cleanup:
  memory_free(&start);
  return status;
}
