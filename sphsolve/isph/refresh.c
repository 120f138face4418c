#include "sphsolve/isph/refresh.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/neighbours.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/sort.h"

#define RATE_INTERVAL 1e-6 /* s, of the difference for d eps/dt */

/* Updates porosity, volume and support at the particles' places. */
static void update_volumes(struct isph *s) {
  double ratio = s->scene->isph.support_ratio;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < s->count; i++) {
    double eps = 1;
    if (s->on.soil) {
      struct soil_point soil;
      isph_soil_at(s, s->position[i], 0, &soil);
      eps = soil.porosity;
      s->porosity[i] = eps;
      s->soil_fraction[i] = soil.fraction;
      s->inertia[i] = soil.inertia;
      s->drag_a[i] = s->on.drag_linear ? soil.a : 0;
      s->drag_b[i] = s->on.drag_forchheimer ? soil.b : 0;
      if (s->on.interfaces) {
        struct isph_interface *interface = &s->interface[i];
        memcpy(interface->normal, soil.normal, sizeof soil.normal);
        interface->drag_a = s->on.drag_linear ? soil.along_a : 0;
        interface->drag_b = s->on.drag_forchheimer ? soil.along_b : 0;
        interface->plane = soil.plane;
      }
      if (s->on.links) s->ground[i] = isph_ground(s, s->position[i]);
      if (s->on.moving_soil) {
        struct soil_point later;
        isph_soil_at(s, s->position[i], RATE_INTERVAL, &later);
        s->porosity_rate[i] = (later.porosity - eps) / RATE_INTERVAL;
        memcpy(s->soil_velocity[i], soil.velocity, sizeof soil.velocity);
      }
    }
    if (s->facing != NULL) s->facing[i] = isph_outline_facing(s, s->position[i]);
    s->volume[i] = s->mass[i] / (eps * s->density);
    s->size[i] = isph_size_of(s, s->volume[i]);
    s->support[i] = fmin(ratio * s->size[i], s->support_max);
  }
  s->support_now = 0;
  for (size_t i = 0; i < s->count; i++) s->support_now = fmax(s->support_now, s->support[i]);
  s->support_now = ranks_max(s->support_now);
}

enum status isph_refresh(struct isph *s) {
  enum status status = STATUS_OK;
  double start = clock_seconds();
  TRY(isph_sort(s));
  update_volumes(s);
  TRY(isph_find_neighbours(s));
  s->seconds_lists += clock_seconds() - start;
cleanup:
  return status;
}
