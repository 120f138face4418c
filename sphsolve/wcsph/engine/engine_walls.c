#include "sphsolve/wcsph/engine/engine_walls.h"

#include <math.h>
#include <string.h>

#include "common/kernel.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/engine_ranks.h"
#include "sphsolve/wcsph/effects/wall_subvoxel.h"
#include "sphsolve/geometry/moment.h"
#include "sphsolve/wcsph/engine/site_terms.h"
#include "sphsolve/geometry/wall_shape.h"

enum status engine_sum_wall_base(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  const struct lattice *lattice = engine->lattice;
  const struct engine_settings *s = &engine->settings;
  double volume = 1;
  int reach[3];
  for (int a = 0; a < 3; a++) {
    bool flat = lattice->dimensions == 2 && a == 1;
    volume *= flat ? 1 : lattice->spacing[a];
    reach[a] = flat ? 0 : (int)floor(s->support / lattice->spacing[a]);
  }
  /* W depends only on the offset of two sites. */
  int span[3] = {2 * reach[0] + 1, 2 * reach[1] + 1, 2 * reach[2] + 1};
  size_t count = (size_t)span[0] * (size_t)span[1] * (size_t)span[2];
  double *weight = NULL;
  TRY(memory_allocate(&weight, count, sizeof *weight, "kernel values"));
  for (size_t t = 0; t < count; t++) {
    int offset[3] = {(int)(t % (size_t)span[0]) - reach[0],
                     (int)(t / (size_t)span[0] % (size_t)span[1]) - reach[1],
                     (int)(t / (size_t)span[0] / (size_t)span[1]) - reach[2]};
    double square = 0;
    for (int a = 0; a < 3; a++) square += pow(offset[a] * lattice->spacing[a], 2);
    weight[t] = kernel_w(s->kernel, lattice->dimensions, sqrt(square), s->smoothing_length);
  }
  size_t slots = particles_wall_slots(p);
#pragma omp parallel for schedule(static)
  for (size_t w = 0; w < slots; w++) {
    if (p->site[w] == NO_SITE) continue;
    double sum = 0;
    const double *next = weight;
    for (int k = -reach[2]; k <= reach[2]; k++)
      for (int j = -reach[1]; j <= reach[1]; j++)
        for (int i = -reach[0]; i <= reach[0]; i++, next++) {
          if (*next == 0) continue;
          const int offset[3] = {i, j, k};
          size_t at[3] = {0};
          for (int a = 0; a < 3; a++) {
            long n = (long)lattice->size[a];
            long own = (long)frame_wall_index(&p->frame, a, p->site[w]);
            at[a] = (size_t)(((own + offset[a]) % n + n) % n);
          }
          size_t site = (at[2] * lattice->size[1] + at[1]) * lattice->size[0] + at[0];
          if (lattice->kind[site] == SITE_WALL) sum += *next;
        }
    p->wall_base[w] = (float)(volume * sum);
  }
cleanup:
  memory_free(&weight);
  return status;
}

/* Difference of the distance along one axis, away from the wall. It is one-sided, since in the
 * middle of a pore two sites wide, between two walls, a central difference would vanish. */
static inline double slope_from_wall(double low, double here, double high) {
  double back = here - low, fore = high - here;
  double up = here < 0 ? fore : back, down = here < 0 ? back : fore;
  up = up > 0 ? up : 0;
  down = down < 0 ? down : 0;
  return up > -down ? up : down;
}

double engine_wall_distance(const struct engine *engine, size_t i) {
  const struct particles *p = &engine->particles;
  const struct lattice *lattice = engine->lattice;
  const float *field = lattice->wall_distance;
  const size_t stride[3] = {1, lattice->size[0], lattice->size[0] * lattice->size[1]};
  size_t near[3], site = 0;
  double offset[3]; /* offset from the nearest site in spacings */
  for (int a = 0; a < 3; a++) {
    /* Position in sites from the edge of the box, with 32 fractional bits. */
    uint64_t t = (uint64_t)(p->x[a][i] << p->frame.image_bits[a]) * lattice->size[a];
    if (p->frame.step[a] == 0) t = 0x80000000u;
    near[a] = t >> 32;
    offset[a] = ((double)(uint32_t)t - 0x1p31) * 0x1p-32;
    site += near[a] * stride[a];
  }
  double here = (double)field[site], along = 0, square = 0;
  bool smooth = true;
  for (int a = 0; a < 3; a++) {
    if (p->frame.step[a] == 0) continue;
    size_t last = lattice->size[a] - 1, back = last * stride[a];
    double high = (double)field[near[a] < last ? site + stride[a] : site - back];
    double low = (double)field[near[a] > 0 ? site - stride[a] : site + back];
    double spacing = lattice->spacing[a], most = WALL_SLOPE_MAX * spacing;
    double slope = slope_from_wall(low, here, high), steep = slope / spacing;
    smooth = smooth && fabs(high - here) < most && fabs(low - here) < most;
    along += slope * offset[a];
    square += steep * steep;
  }
  double d = here + (square > 1 ? along / sqrt(square) : along);
  double least = ENGINE_WALL_DISTANCE_MIN * engine->pass.spacing;
  d = d > least ? d : least;
  return smooth ? d : -d;
}

void engine_update_distance(struct engine *engine) {
  double start = clock_seconds();
  struct particles *p = &engine->particles;
  p->distance = p->v_next[0]; /* each row reads its distance before it writes its velocity */
  const size_t first = engine_first_slot(engine), end = engine_end_slot(engine);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = first; i < end; i++) p->distance[i] = (float)engine_wall_distance(engine, i);
  engine->seconds[PHASE_WALL] += clock_seconds() - start;
}

void engine_clear_wall_sums(struct engine *engine) {
  const struct ghosts *walls = &engine->ranks.walls;
  uint32_t *sums = engine->particles.wall_sum;
  size_t begin = 0, end = engine->particles.wall_clusters;
  if (engine_is_distributed(engine)) {
    begin = walls->begin;
    end = walls->end;
    for (size_t g = 0; g < walls->receive_start[ranks_count()]; g++)
      memset(sums + walls->receive[g] * CLUSTER, 0, CLUSTER * sizeof *sums);
  }
  if (end > begin) memset(sums + begin * CLUSTER, 0, (end - begin) * CLUSTER * sizeof *sums);
}

void engine_finish_wall_sums(struct engine *engine) {
  const double start = clock_seconds();
  const struct ghosts *walls = &engine->ranks.walls;
  const struct particles *p = &engine->particles;
  size_t begin = 0, end = p->wall_clusters;
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (int t = 0; t < engine->threads; t++)
    if (engine->locals[t].collected != NULL)
      collected_give_all(engine->locals[t].collected, p->wall_sum);
  if (engine_is_distributed(engine)) {
    ghosts_add(&engine->ranks.walls, p->wall_sum, CLUSTER);
    begin = walls->begin;
    end = walls->end;
  }
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t w = begin * CLUSTER; w < end * CLUSTER; w++) {
    const double own = (double)p->wall_base[w], sum = WALL_SUM_UNIT * (double)p->wall_sum[w];
    p->wall_state[w] = (float)(1 / (own + sum));
  }
  engine->seconds[PHASE_DENSITY] += clock_seconds() - start;
}

static double distance_of(const struct engine *engine, double there) {
  return fmax(there, WALL_SUBVOXEL_FLOOR * engine->pass.spacing);
}

void engine_eulerian_begin(struct engine *engine) {
  struct particles *p = &engine->particles;
  const float *field = engine->lattice->wall_distance;
  p->distance = p->v_next[0]; /* each row reads its distance before it writes its sums */
  const size_t first = engine_first_slot(engine), end = engine_end_slot(engine);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = first; i < end; i++)
    if (p->id[i] != NO_PARTICLE)
      p->distance[i] = (float)distance_of(engine, (double)field[p->id[i]]);
}

void engine_eulerian_finish(struct engine *engine) {
  struct particles *p = &engine->particles;
  const struct pass *pass = &engine->pass;
  const double h = pass->smoothing_length, moment = pass->g_scale * 2 * h;
  const bool flat = p->frame.step[1] == 0;
  const size_t first = engine_first_slot(engine), end = engine_end_slot(engine);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = first; i < end; i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    struct wall_shape wall;
    wall_shape_find(engine->lattice, p->id[i], pass->spacing, &wall);
    const double d = distance_of(engine, wall.distance);
    struct site_terms terms = {.weight = (double)p->v_next[0][i]};
    double beta = pass->l_scale * h * h * (double)p->v_next[1][i], m[6];
    const bool beside = terms.weight > 0;
    if (beta > 0) { /* curved wall: stokes/effects/wall_subvoxel.h */
      beta /= 1 - 0.5 * d * wall.curvature;
      terms.weight += fmax(beta * wall.curvature / (2 * pass->l_scale * d), -0.5 * terms.weight);
    }
    terms.kept = 1 - fmin(fmax(beta, 0), EULERIAN_BETA_MAX);
    for (int k = 0; k < 6; k++)
      m[k] = moment * (double)(k < 5 ? p->site_terms[k][i] : p->v_next[2][i]);
    double full[3][3] = {{m[0], m[3], m[4]}, {m[3], flat ? 1 : m[1], m[5]}, {m[4], m[5], m[2]}};
    if (beside) moment_free_normal(3, wall.normal, full);
    moment_invert(full, terms.correction);
    site_terms_store(p, i, &terms);
  }
}

void engine_eulerian_flux(struct engine *engine) {
  struct particles *p = &engine->particles;
  const size_t first = engine_first_slot(engine), end = engine_end_slot(engine);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = first; i < end; i++) {
    double more[3];
    uint32_t packed[2];
    for (int k = 0; k < 2; k++) memcpy(&packed[k], &p->flux[k][i], sizeof *packed);
    vector_unpack(packed, engine->pass.sound_speed, more);
    for (int a = 0; a < 3; a++) p->v_next[a][i] = (float)((double)p->v[a][i] + more[a]);
  }
}
