#include "sphsolve/engine/engine_ranks.h"

#include <omp.h>

#include "common/memory.h"

enum status engine_share_out(struct engine *engine) {
  enum status status = STATUS_OK;
  struct engine_ranks *ranks = &engine->ranks;
  const size_t count = (size_t)ranks_count();
  double *work = NULL;
  size_t *start = NULL;
  ranks->fluid.tag = 3;
  ranks->walls.tag = 4;
  if (ranks->work > 0) {
    TRY(memory_allocate(&work, count, sizeof *work, "work of the ranks"));
    TRY(memory_allocate(&start, count + 1, sizeof *start, "work of the ranks"));
    for (size_t r = 0; r <= count; r++) start[r] = r;
    work[ranks_own()] = ranks->work - 1;
    ranks_gather(work, start, sizeof *work);
  }
  TRY(ghosts_cut(&ranks->fluid, engine->particles.clusters, work));
  if (ranks->walls.cut == NULL)
    TRY(ghosts_cut(&ranks->walls, engine->particles.wall_clusters, NULL));
cleanup:
  memory_free(&work);
  memory_free(&start);
  return status;
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
    bool ghost = ghosts_want(fluid, &engine->fluid_fluid, begin, end);
    if (states) ghost = ghosts_want(walls, &engine->fluid_wall, begin, end) || ghost;
    ranks->blocks[ghost ? --outer : ranks->inner++] = (uint32_t)b;
  }
  if (states) ghosts_want(fluid, &engine->wall_fluid, walls->begin, walls->end);
  TRY(ghosts_agree(fluid, p->clusters));
  if (states) TRY(ghosts_agree(walls, p->wall_clusters));
  /* Work is what the pair loops look at; 1 tells that there is any. */
  ranks->work = 1 + words_of(&engine->fluid_fluid, fluid->begin, fluid->end) +
                words_of(&engine->fluid_wall, fluid->begin, fluid->end);
cleanup:
  memory_free(&fluid->wanted);
  memory_free(&walls->wanted);
  return status;
}

void engine_send(struct engine *engine, enum engine_sent what) {
  struct particles *p = &engine->particles;
  void *const all[] = {p->x[0], p->x[1], p->x[2], p->v[0], p->v[1], p->v[2], p->state};
  void *const place[] = {p->x[0], p->x[1], p->x[2], p->state};
  void *const wall[] = {p->wall_state, p->wall_v[0], p->wall_v[1], p->wall_v[2]};
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

enum status engine_gather(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  if (!engine_is_shared(engine)) return STATUS_OK;
  engine_settle(engine);
  const size_t size = CLUSTER * sizeof(float);
  for (int a = 0; a < 3; a++) {
    TRY(ghosts_gather(&engine->ranks.fluid, p->x[a], size));
    TRY(ghosts_gather(&engine->ranks.fluid, p->v[a], size));
    if (p->shift[a] != NULL) TRY(ghosts_gather(&engine->ranks.fluid, p->shift[a], size));
  }
  TRY(ghosts_gather(&engine->ranks.fluid, p->state, size));
cleanup:
  return status;
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
