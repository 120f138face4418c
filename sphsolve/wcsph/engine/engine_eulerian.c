#include "sphsolve/wcsph/engine/engine_eulerian.h"

#include <math.h>
#include <string.h>

#include "sphsolve/wcsph/effects/wall_subvoxel.h"
#include "sphsolve/geometry/moment.h"
#include "sphsolve/wcsph/engine/site_terms.h"
#include "sphsolve/geometry/wall_shape.h"
#include "sphsolve/wcsph/constants.h"

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
