/* Neighbour lists on several ranks. Each rank sends the extent of its rows to all others as a few
 * coarse boxes, receives the clusters near them, makes its lists with these, and then keeps the
 * clusters that the lists name: its ghosts, in global order. */
#include <string.h>

#include "common/memory.h"
#include "sphsolve/wcsph/engine/engine_ranks.h"

/* Minimum number of rows in a coarse box, and approximate maximum number of boxes per rank. */
#define COARSE_ROWS_MIN 32
#define COARSE_BOXES_MAX 1024

/* A cluster of another rank: its global index and its box. */
struct near {
  uint32_t number;
  struct cluster_box box;
};

/* Clusters that a rank has while it makes lists: its own [set.begin, set.end) and nearby ones. */
struct gathered {
  struct cluster_set set;
  uint32_t *number; /* global index of each; later the index among the clusters held */
  uint8_t *wanted;
};

static void gathered_free(struct gathered *known) {
  cluster_set_free(&known->set);
  MEMORY_FREE(&known->number, &known->wanted);
}

/* Box around `count` boxes; differences from the first are those of periodic fixed-point
 * numbers. */
static struct cluster_box box_around(const struct cluster_box *boxes, size_t count) {
  struct cluster_box around = boxes[0];
  for (int a = 0; a < 3; a++) {
    int64_t low = INT64_MAX, high = INT64_MIN;
    for (size_t b = 0; b < count; b++) {
      const int64_t at = (int32_t)(boxes[b].centre[a] - boxes[0].centre[a]);
      low = at - boxes[b].half[a] < low ? at - boxes[b].half[a] : low;
      high = at + boxes[b].half[a] > high ? at + boxes[b].half[a] : high;
    }
    const int64_t half = (high - low + 1) / 2;
    around.centre[a] = boxes[0].centre[a] + (uint32_t)(low + half);
    around.half[a] = half < INT32_MAX ? (uint32_t)half : INT32_MAX;
  }
  return around;
}

/* Whether two boxes, or images of them, are within `range` of each other. */
static bool is_near(const struct frame *frame, const struct cluster_box *a,
                    const struct cluster_box *b, double range) {
  double square = 0;
  for (int k = 0; k < 3; k++) {
    if (frame->step[k] == 0) continue;
    const uint32_t d = frame_fold(frame, k, a->centre[k] - b->centre[k]);
    const uint32_t e = frame_fold(frame, k, b->centre[k] - a->centre[k]);
    const double gap =
        frame->unit[k] * ((double)(d < e ? d : e) - (double)a->half[k] - (double)b->half[k]);
    if (gap > 0) square += gap * gap;
  }
  return square < range * range;
}

static size_t coarse_rows(size_t rows) {
  const size_t least = (rows + COARSE_BOXES_MAX - 1) / COARSE_BOXES_MAX;
  return least > COARSE_ROWS_MIN ? least : COARSE_ROWS_MIN;
}
static size_t coarse_count(size_t rows) {
  return (rows + coarse_rows(rows) - 1) / coarse_rows(rows);
}

/* Collective: gathers the coarse boxes of the rows of all ranks, those of rank r from start[r] on;
 * of the fluid, and of walls if these are rows (`walls` not NULL). */
static enum status gather_rows(const struct ghosts *fluid, const struct cluster_box *own,
                               const struct ghosts *walls, const struct cluster_box *own_walls,
                               size_t *start, struct cluster_box **boxes) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  start[0] = 0;
  for (size_t r = 0; r < ranks; r++) {
    start[r + 1] = start[r] + coarse_count(fluid->partition[r + 1] - fluid->partition[r]);
    if (walls != NULL) start[r + 1] += coarse_count(walls->partition[r + 1] - walls->partition[r]);
  }
  TRY(memory_allocate(boxes, start[ranks] + 1, sizeof **boxes, "boxes of ranks"));
  struct cluster_box *to = *boxes + start[ranks_own()];
  for (int of_walls = 0; of_walls < 2; of_walls++) {
    const struct ghosts *g = of_walls ? walls : fluid;
    if (g == NULL) continue;
    const size_t rows = g->end - g->begin, unit = coarse_rows(rows);
    for (size_t r = 0; r < rows; r += unit)
      *to++ = box_around((of_walls ? own_walls : own) + r, r + unit < rows ? unit : rows - r);
  }
  ranks_gather(*boxes, start, sizeof **boxes);
cleanup:
  return status;
}

/* Finds own clusters near the rows of a rank, in their order: stored in `out`, or only counted
 * (NULL). */
static enum status find_near(const struct frame *frame, const struct ghosts *g,
                             const struct cluster_box *own, const struct cluster_box *rows,
                             size_t count, double range, struct near *out, size_t *found) {
  enum status status = STATUS_OK;
  const size_t clusters = g->end - g->begin, unit = coarse_rows(clusters);
  uint32_t *some = NULL;
  size_t n = 0, close = 0;
  if (clusters > 0) {
    TRY(memory_allocate(&some, 2 * count + 1, sizeof *some, "boxes of ranks"));
    const struct cluster_box all = box_around(own, clusters);
    for (size_t b = 0; b < count; b++)
      if (is_near(frame, &all, &rows[b], range)) some[close++] = (uint32_t)b;
  }
  for (size_t c = 0; c < clusters && close > 0; c += unit) {
    const size_t end = c + unit < clusters ? c + unit : clusters;
    const struct cluster_box around = box_around(own + c, end - c);
    size_t here = close;
    for (size_t b = 0; b < close; b++)
      if (is_near(frame, &around, &rows[some[b]], range)) some[here++] = some[b];
    for (size_t i = c; i < end; i++)
      for (size_t b = close; b < here; b++) {
        if (!is_near(frame, &own[i], &rows[some[b]], range)) continue;
        if (out != NULL) out[n] = (struct near){(uint32_t)(g->partition[ranks_own()] + i), own[i]};
        n++;
        break;
      }
  }
  *found = n;
cleanup:
  memory_free(&some);
  return status;
}

/* Collective: gathers own clusters, and those of other ranks near the rows of this rank. */
static enum status gather(const struct frame *frame, const struct ghosts *g,
                          const struct cluster_box *own, const size_t *rows_start,
                          const struct cluster_box *rows, double range, struct gathered *known) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), self = (size_t)ranks_own();
  const size_t clusters = g->end - g->begin;
  struct near *out = NULL, *in = NULL;
  size_t *send = NULL, *start = NULL, n = 0, found;
  TRY(memory_allocate(&send, ranks, sizeof *send, "ghosts"));
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "ghosts"));
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1) TRY(memory_allocate(&out, n + 1, sizeof *out, "ghosts"));
    n = 0;
    for (size_t r = 0; r < ranks; r++) {
      if (r == self) continue;
      const size_t count = rows_start[r + 1] - rows_start[r];
      TRY(find_near(frame, g, own, rows + rows_start[r], count, range, pass ? out + n : NULL,
                    &found));
      send[r] = found;
      n += found;
    }
  }
  TRY(ghosts_exchange(sizeof *out, send, out, start, &in));
  memory_free(&out);
  const size_t lower = start[self], come = start[ranks], all = clusters + come;
  known->set = (struct cluster_set){.clusters = all, .begin = lower, .end = lower + clusters};
  TRY(memory_allocate(&known->set.boxes, all + 1, sizeof *known->set.boxes, "cluster boxes"));
  TRY(memory_allocate(&known->number, all + 1, sizeof *known->number, "ghosts"));
  TRY(memory_allocate(&known->wanted, all + 1, 1, "ghosts"));
  for (size_t k = 0; k < come; k++) {
    const size_t at = k < lower ? k : k + clusters;
    known->set.boxes[at] = in[k].box;
    known->number[at] = in[k].number;
  }
  for (size_t c = 0; c < clusters; c++) {
    known->set.boxes[lower + c] = own[c];
    known->number[lower + c] = (uint32_t)(g->partition[self] + c);
  }
cleanup:
  MEMORY_FREE(&send, &start, &out, &in);
  return status;
}

/* Marks the clusters that rows [begin, end) of a list name; returns whether any belongs to another
 * rank. */
static bool mark_ghosts(struct gathered *known, const struct neighbour_list *list, size_t begin,
                        size_t end) {
  bool any = false;
  for (size_t row = begin; row < end; row++) {
    size_t words;
    struct list_reader reader = {.word = list_row(list, row, &words)};
    reader.end = reader.word + words;
    while (list_next(&reader))
      for (size_t c = reader.cluster; c <= reader.cluster + (reader.pair ? 1 : 0); c++)
        if (c < known->set.begin || c >= known->set.end) known->wanted[c] = any = true;
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

/* Measures work by the number of list words that the pair loops read. */
static enum status count_work(struct engine *engine, size_t begin, size_t end) {
  enum status status = STATUS_OK;
  struct engine_ranks *ranks = &engine->ranks;
  const size_t units = (end - begin + PARTITION_UNIT - 1) / PARTITION_UNIT;
  memory_free(&ranks->work);
  TRY(memory_allocate(&ranks->work, units + 1, sizeof *ranks->work, "work of the ranks"));
  ranks->work_sum = 0;
  for (size_t u = 0; u < units; u++) {
    const size_t first = begin + u * PARTITION_UNIT;
    const size_t last = first + PARTITION_UNIT < end ? first + PARTITION_UNIT : end;
    ranks->work[u] = words_of(&engine->fluid_fluid, first, last);
    if (engine->settings.wall != PASS_EULERIAN)
      ranks->work[u] += words_of(&engine->fluid_wall, first, last);
    ranks->work_sum += ranks->work[u];
  }
cleanup:
  return status;
}

/* Numbers the clusters to be held, own and wanted ones: known->number becomes their new index. */
static enum status choose_held(struct ghosts *g, struct gathered *known, size_t *held) {
  enum status status = STATUS_OK;
  const size_t begin = known->set.begin, end = known->set.end;
  size_t n = 0;
  for (size_t c = 0; c < known->set.clusters; c++) n += known->wanted[c] || (c >= begin && c < end);
  MEMORY_FREE(&g->number, &g->wanted);
  TRY(memory_allocate(&g->number, n + 1, sizeof *g->number, "ghosts"));
  TRY(memory_allocate(&g->wanted, n + 1, 1, "ghosts"));
  *held = 0;
  for (size_t c = 0; c < known->set.clusters; c++) {
    if (!known->wanted[c] && (c < begin || c >= end)) continue;
    g->wanted[*held] = known->wanted[c];
    g->number[*held] = known->number[c];
    known->number[c] = (uint32_t)(*held)++;
  }
cleanup:
  return status;
}

/* Collective: moves the chosen clusters to their new indices. */
static enum status place_clusters(struct engine *engine, struct gathered *fluid,
                                  struct gathered *walls) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  struct ghosts *g = &engine->ranks.fluid, *w = &engine->ranks.walls;
  size_t held, held_walls;
  const size_t rows = g->end - g->begin, wall_rows = w->end - w->begin;
  TRY(choose_held(g, fluid, &held));
  TRY(choose_held(w, walls, &held_walls));
  const size_t first = rows > 0 ? fluid->number[fluid->set.begin] : 0;
  const size_t first_wall = wall_rows > 0 ? walls->number[walls->set.begin] : 0;
  TRY(neighbours_renumber(&engine->fluid_fluid, fluid->number, first));
  TRY(neighbours_renumber(&engine->fluid_wall, walls->number, first));
  TRY(neighbours_renumber(&engine->wall_fluid, fluid->number, first_wall));
  /* Only the boxes of own rows are kept. */
  struct cluster_set *boxes = &engine->boxes;
  cluster_set_free(boxes);
  *boxes = fluid->set;
  fluid->set.boxes = NULL;
  memmove(boxes->boxes + first, boxes->boxes + boxes->begin, rows * sizeof *boxes->boxes);
  TRY(memory_resize(&boxes->boxes, held + 1, sizeof *boxes->boxes, "cluster boxes"));
  boxes->clusters = held, boxes->begin = first, boxes->end = first + rows;
  gathered_free(fluid);
  gathered_free(walls);
  TRY(particles_hold(p, g->begin, rows, first, held));
  TRY(particles_hold_walls(p, w->begin, wall_rows, first_wall, held_walls));
  g->begin = first, g->end = first + rows;
  w->begin = first_wall, w->end = first_wall + wall_rows;
  TRY(ghosts_plan_exchange(g, held));
  TRY(ghosts_plan_exchange(w, held_walls));
cleanup:
  MEMORY_FREE(&g->wanted, &w->wanted);
  return status;
}

enum status engine_list_distributed(struct engine *engine, double range, double widest) {
  enum status status = STATUS_OK;
  struct engine_ranks *ranks = &engine->ranks;
  const struct particles *p = &engine->particles;
  const struct frame *frame = &p->frame;
  struct ghosts *g = &ranks->fluid, *w = &ranks->walls;
  const bool rows_of_walls = engine->settings.wall == PASS_ADAMI;
  struct cluster_set wall_boxes = {0};
  struct cluster_bins bins = {0}, wall_bins = {0};
  struct cluster_box *rows = NULL;
  struct gathered fluid = {{0}, NULL, NULL}, walls = {{0}, NULL, NULL};
  size_t *start = NULL;
  ghosts_free_buffers(g);
  ghosts_free_buffers(w);
  TRY(memory_allocate(&start, (size_t)ranks_count() + 1, sizeof *start, "boxes of ranks"));
  TRY(cluster_boxes_wall(p, &wall_boxes));
  const struct cluster_box *own = engine->boxes.boxes + g->begin;
  const struct cluster_box *own_walls = wall_boxes.boxes + w->begin;
  TRY(gather_rows(g, own, rows_of_walls ? w : NULL, own_walls, start, &rows));
  TRY(gather(frame, g, own, start, rows, range, &fluid));
  TRY(gather(frame, w, own_walls, start, rows, range, &walls));
  memory_free(&rows);
  cluster_set_free(&wall_boxes);
  TRY(cluster_bins_make(frame, &fluid.set, range, &bins));
  TRY(neighbours_build(frame, &fluid.set, &bins, range, widest, &engine->fluid_fluid));
  if (rows_of_walls)
    TRY(neighbours_build(frame, &walls.set, &bins, range, widest, &engine->wall_fluid));
  cluster_bins_free(&bins);
  TRY(cluster_bins_make(frame, &walls.set, engine->settings.support, &wall_bins));
  TRY(neighbours_build(frame, &fluid.set, &wall_bins, range, widest, &engine->fluid_wall));
  cluster_bins_free(&wall_bins);

  const size_t begin = fluid.set.begin, end = fluid.set.end,
               blocks = (end - begin + BLOCK - 1) / BLOCK;
  memory_free(&ranks->blocks);
  TRY(memory_allocate(&ranks->blocks, blocks + 1, sizeof *ranks->blocks, "blocks of rows"));
  ranks->count = blocks;
  ranks->inner = 0;
  size_t outer = blocks;
  for (size_t b = 0; b < blocks; b++) {
    const size_t first = begin + b * BLOCK, last = first + BLOCK < end ? first + BLOCK : end;
    bool ghost = mark_ghosts(&fluid, &engine->fluid_fluid, first, last);
    ghost = (mark_ghosts(&walls, &engine->fluid_wall, first, last) && engine->fields.wall_state) ||
            ghost;
    ranks->blocks[ghost ? --outer : ranks->inner++] = (uint32_t)b;
  }
  if (rows_of_walls) mark_ghosts(&fluid, &engine->wall_fluid, walls.set.begin, walls.set.end);
  TRY(count_work(engine, begin, end));
  TRY(place_clusters(engine, &fluid, &walls));
  engine_send(engine, SENT_ALL);
  engine_send(engine, SENT_WALL_ALL);
  engine_await_ghosts(engine);
  if (!engine->fields.wall_state) ghosts_free_buffers(w); /* this was the last transfer of walls */
cleanup:
  MEMORY_FREE(&start, &rows);
  cluster_set_free(&wall_boxes);
  cluster_bins_free(&bins);
  cluster_bins_free(&wall_bins);
  gathered_free(&fluid);
  gathered_free(&walls);
  return status;
}
