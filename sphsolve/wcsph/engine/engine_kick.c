/* Forces of effects with their own file (struct effect). They act before the pair passes:
 *
 * v' = v + dt a(x, v), then the step from v'
 *
 * (first-order splitting), so that pair loops do not depend on them, and inactive ones cost
 * nothing. Their contributions are summed where they act: a, and the power a . (v + v')/2. */
#include "sphsolve/wcsph/engine/engine_ranks.h"

#include "common/log.h"
#include "common/memory.h"

/* Slots per block of the sums, whose order is independent of threads and ranks. */
#define SUM_BLOCK 2048

static void kick_block(struct engine *engine, size_t begin, size_t end,
                       struct engine_force_sum *sum) {
  struct particles *p = &engine->particles;
  const double dt = engine->settings.dt;
  for (size_t i = begin; i < end; i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    for (int a = 0; a < 3; a++) {
      const double v = (double)p->v[a][i], by = engine->acceleration[i][a];
      p->v[a][i] = (float)(v + dt * by);
      if (sum == NULL) continue;
      sum->impulse[a] += by;
      sum->work += by * (v + 0.5 * dt * by);
    }
  }
}

enum status engine_kick(struct engine *engine, bool sums) {
  enum status status = STATUS_OK;
  struct engine_force_sum *block = NULL;
  const size_t first = engine_first_slot(engine), last = engine_end_slot(engine);
  const size_t blocks = (engine_all_slots(engine) + SUM_BLOCK - 1) / SUM_BLOCK;
  const size_t before = engine_number(engine, first) / SUM_BLOCK;
  const double start = clock_seconds();
  if (engine->settings.own_count == 0) return STATUS_OK;
  TRY(memory_resize(&engine->acceleration, particles_slots(&engine->particles),
                    sizeof *engine->acceleration, "accelerations"));
  for (int k = 0; k < engine->settings.own_count; k++) {
    struct engine_force_sum *own = &engine->own_sum[k];
    if (sums) {
      memory_free(&block);
      TRY(memory_allocate(&block, blocks, sizeof *block, "block sums"));
    }
    engine->settings.own[k].force(engine, engine->acceleration);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
    for (size_t b = 0; b < (last - first + SUM_BLOCK - 1) / SUM_BLOCK; b++) {
      const size_t end = first + (b + 1) * SUM_BLOCK;
      kick_block(engine, first + b * SUM_BLOCK, end < last ? end : last,
                 sums ? &block[before + b] : NULL);
    }
    if (!sums) continue;
    TRY(engine_gather_blocks(engine, SUM_BLOCK, block, sizeof *block));
    *own = (struct engine_force_sum){{0}, 0};
    for (size_t b = 0; block != NULL && b < blocks; b++) {
      for (int a = 0; a < 3; a++) own->impulse[a] += block[b].impulse[a];
      own->work += block[b].work;
    }
  }
  if (RANKS && engine_is_distributed(engine)) { /* updates ghosts on other ranks */
    engine_await_ghosts(engine);
    engine_send(engine, SENT_MOTION);
  }
  engine->seconds[PHASE_FORCE] += clock_seconds() - start;
cleanup:
  memory_free(&block);
  return status;
}
