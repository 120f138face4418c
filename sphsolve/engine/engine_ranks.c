#include "sphsolve/engine/engine_ranks.h"

#include <omp.h>

#include "common/memory.h"

/* Cuts lie at multiples of so many clusters: blocks of sums belong to one rank. */
#define UNIT 256
#define FIELD_BYTES (CLUSTER * sizeof(float))

enum status engine_share_out(struct engine *engine) {
  enum status status = STATUS_OK;
  struct engine_ranks *ranks = &engine->ranks;
  ranks->fluid.tag = 3;
  ranks->walls.tag = 4;
  ranks->fluid.bytes_most = ranks->walls.bytes_most = GHOST_FIELDS * FIELD_BYTES;
  TRY(ghosts_cut(&ranks->fluid, engine->particles.clusters, UNIT, ranks->work));
  if (ranks->walls.cut == NULL)
    TRY(ghosts_cut(&ranks->walls, engine->particles.wall_clusters, UNIT, NULL));
cleanup:
  return status;
}

/* Which clusters of others the rows [begin, end) of a list name: marked as wanted. Returns whether
 * there is any. */
static bool want(struct ghosts *g, const struct neighbour_list *list, size_t begin, size_t end) {
  bool any = false;
  for (size_t row = begin; row < end; row++) {
    size_t words;
    struct list_reader reader = {.word = list_row(list, row, &words)};
    reader.end = reader.word + words;
    while (list_next(&reader))
      for (size_t c = reader.cluster; c <= reader.cluster + (reader.pair ? 1 : 0); c++)
        if (c < g->begin || c >= g->end) g->wanted[c] = any = true;
  }
  return any;
}

static double words_of(const struct neighbour_list *list, size_t begin, size_t end) {
  double sum = 0;
  for (size_t row = begin; row < end; row++) {
    size_t words;
    list_row(list, row, &words);
    sum += (double)words;
  }
  return sum;
}

enum status engine_find_ghosts(struct engine *engine) {
  enum status status = STATUS_OK;
  struct engine_ranks *ranks = &engine->ranks;
  const struct particles *p = &engine->particles;
  struct ghosts *fluid = &ranks->fluid, *walls = &ranks->walls;
  const bool states = engine->fields.wall_state;
  const size_t blocks = (fluid->end - fluid->begin + BLOCK - 1) / BLOCK;
  memory_free(&ranks->blocks);
  TRY(memory_allocate(&ranks->blocks, blocks + 1, sizeof *ranks->blocks, "blocks of rows"));
  TRY(memory_allocate(&fluid->wanted, p->clusters + 1, 1, "ghosts"));
  TRY(memory_allocate(&walls->wanted, p->wall_clusters + 1, 1, "ghosts"));
  ranks->count = blocks;
  ranks->inner = 0;
  size_t outer = blocks;
  for (size_t b = 0; b < blocks; b++) {
    const size_t begin = fluid->begin + b * BLOCK;
    const size_t end = begin + BLOCK < fluid->end ? begin + BLOCK : fluid->end;
    bool ghost = want(fluid, &engine->fluid_fluid, begin, end);
    if (states) ghost = want(walls, &engine->fluid_wall, begin, end) || ghost;
    ranks->blocks[ghost ? --outer : ranks->inner++] = (uint32_t)b;
  }
  if (engine->wall_fluid.rows > 0) want(fluid, &engine->wall_fluid, walls->begin, walls->end);
  TRY(ghosts_agree(fluid, p->clusters));
  if (states) TRY(ghosts_agree(walls, p->wall_clusters));
  /* Work is what the pair loops look at. */
  const size_t units = (fluid->end - fluid->begin + UNIT - 1) / UNIT;
  memory_free(&ranks->work);
  TRY(memory_allocate(&ranks->work, units + 1, sizeof *ranks->work, "work of the ranks"));
  ranks->work_sum = 0;
  for (size_t u = 0; u < units; u++) {
    const size_t begin = fluid->begin + u * UNIT;
    const size_t end = begin + UNIT < fluid->end ? begin + UNIT : fluid->end;
    ranks->work[u] =
        words_of(&engine->fluid_fluid, begin, end) + words_of(&engine->fluid_wall, begin, end);
    ranks->work_sum += ranks->work[u];
  }
cleanup:
  memory_free(&fluid->wanted);
  memory_free(&walls->wanted);
  return status;
}

#define FIELD(name)                                                                                \
  { p->name, FIELD_BYTES }

void engine_send(struct engine *engine, enum engine_sent what) {
  struct particles *p = &engine->particles;
  const struct ghost_field all[] = {FIELD(x[0]), FIELD(x[1]), FIELD(x[2]), FIELD(v[0]),
                                    FIELD(v[1]), FIELD(v[2]), FIELD(state)};
  const struct ghost_field place[] = {FIELD(x[0]), FIELD(x[1]), FIELD(x[2]), FIELD(state)};
  const struct ghost_field wall[] = {FIELD(wall_state), FIELD(wall_v[0]), FIELD(wall_v[1]),
                                     FIELD(wall_v[2])};
  const bool frozen = engine->settings.wall == PASS_FROZEN;
  if (!engine_is_shared(engine)) return;
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
  case SENT_ALL:
    ghosts_post(&engine->ranks.fluid, 7, all);
    break;
  }
}

void engine_settle(struct engine *engine) {
  if (!engine_is_shared(engine)) return;
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

void engine_run_shared(struct engine *engine, pass_function *function, bool wall) {
  const struct engine_ranks *ranks = &engine->ranks;
  if (wall) {
    const struct ghosts *w = &ranks->walls;
    engine_settle(engine);
    run_blocks(engine, function, NULL, (w->end - w->begin + BLOCK - 1) / BLOCK, w->begin, w->end);
    return;
  }
  const size_t begin = ranks->fluid.begin, end = ranks->fluid.end;
  run_blocks(engine, function, ranks->blocks, ranks->inner, begin, end);
  engine_settle(engine);
  run_blocks(engine, function, ranks->blocks + ranks->inner, ranks->count - ranks->inner, begin,
             end);
}

void engine_gather(struct engine *engine) {
  struct particles *p = &engine->particles;
  if (!engine_is_shared(engine)) return;
  engine_settle(engine);
  const size_t size = FIELD_BYTES;
  for (int a = 0; a < 3; a++) {
    ghosts_gather(&engine->ranks.fluid, p->x[a], size);
    ghosts_gather(&engine->ranks.fluid, p->v[a], size);
    if (p->shift[a] != NULL) ghosts_gather(&engine->ranks.fluid, p->shift[a], size);
  }
  ghosts_gather(&engine->ranks.fluid, p->state, size);
}

enum status engine_gather_blocks(const struct engine *engine, size_t slots, void *sums,
                                 size_t size) {
  enum status status = STATUS_OK;
  const size_t *cut = engine->ranks.fluid.cut, ranks = (size_t)ranks_count();
  size_t *start = NULL;
  if (!engine_is_shared(engine)) return STATUS_OK;
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "block sums"));
  for (size_t r = 0; r <= ranks; r++) start[r] = (cut[r] * CLUSTER + slots - 1) / slots;
  ranks_gather(sums, start, size);
cleanup:
  memory_free(&start);
  return status;
}
