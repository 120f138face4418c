#include "sphsolve/isph/reflection.h"

#include <math.h>

#include "sphsolve/isph/effects/surface.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/symmetric.h"

/* Share of sum V slope that comes from the lattice's rows behind a side (the first half a spacing
 * behind it), for a particle `distance` spacings before the side. */
static double behind_at(const struct isph *s, double distance) {
  const double ratio = s->scene->isph.support_ratio;
  const int reach = (int)ceil(ratio), reach_y = s->dimensions == 3 ? reach : 0;
  double sum = 0, w, slope;
  for (double z = distance + 0.5; z < ratio; z += 1)
    for (int j = -reach_y; j <= reach_y; j++)
      for (int i = -reach; i <= reach; i++) {
        const double r = sqrt(i * i + j * j + z * z);
        if (r >= ratio) continue;
        isph_kernel(s->scene->isph.kernel, s->dimensions, r, ratio, &w, &slope);
        sum += s->kernel_slope * slope;
      }
  return sum / s->slope_sum;
}

double isph_reflection_backs(const struct isph *s, size_t i) {
  const double size = s->size[i];
  double before = 1;
  for (int a = 0; a < 3; a++) {
    if (!s->reflects[a][0]) continue; /* nor does the other side */
    const double *x = s->position[i], near = fmin(x[a] - s->low[a], s->high[a] - x[a]) / size;
    const double at = fmax(0, near) * BEHIND_STEPS;
    if (!(at < BEHIND - 1)) continue;
    const size_t k = (size_t)at;
    before *= 1 - (s->behind[k] + (at - (double)k) * (s->behind[k + 1] - s->behind[k]));
  }
  return fmin(1, (1 - before) / s->behind[BEHIND_STEPS / 2]);
}

static bool has_window(const struct isph *s, int a, bool high) {
  bool any = false;
  for (size_t k = 0; k < s->side_count; k++)
    any = any || (s->sides[k].axis == a && (s->sides[k].inward < 0) == high);
  return any;
}

void isph_images_create(struct isph *s) {
  for (int k = 0; k < BEHIND; k++) s->behind[k] = behind_at(s, (double)k / BEHIND_STEPS);
  const bool soil = s->on.soil && !s->on.surface, free = !s->on.soil && !s->on.open_sides;
  for (int a = 0; a < 3; a++)
    for (int high = 0; high < 2; high++)
      s->reflects[a][high] = (soil || free) && !s->periodic[a] && isph_uses_axis(s, a) &&
                             s->high[a] - s->low[a] >= s->support_max && !has_window(s, a, high);
  for (int code = 0; code < 27; code++) {
    const int step[3] = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
    struct isph_image *image = &s->image[code];
    for (int a = 0; a < 3; a++) {
      const bool turned = step[a] != 0 && s->reflects[a][step[a] > 0];
      image->turn[a] = turned ? -1 : 1;
      image->reflected = image->reflected || turned;
      if (s->periodic[a]) image->shift[a] = step[a] * (s->high[a] - s->low[a]);
      if (turned) image->shift[a] = 2 * (step[a] < 0 ? s->low[a] : s->high[a]);
    }
  }
}

bool isph_next_leg(const struct isph_image *image, struct isph_leg *leg) {
  if (leg->to == 1) return false;
  if (leg->crossed > 0) {
    const int a = leg->crossed - 1;
    leg->start[a] = image->shift[a] - leg->start[a], leg->step[a] = -leg->step[a];
    leg->turned[a] = true;
  }
  leg->from = leg->to, leg->to = 1, leg->crossed = 0;
  for (int a = 0; a < 3; a++) {
    if (image->turn[a] > 0 || leg->turned[a]) continue;
    const double at = (0.5 * image->shift[a] - leg->start[a]) / leg->step[a];
    if (at < leg->to) leg->to = fmax(leg->from, at), leg->crossed = a + 1;
  }
  return true;
}

double isph_reflection_gap(const struct isph *s, size_t i, uint32_t entry, const double r[3]) {
  const double *turn = s->image[entry >> PAIR_BITS].turn;
  double mirror[6] = {0};
  for (int a = 0; a < 3; a++) mirror[symmetric_diagonal[a]] = turn[a] < 0;
  return surface_gap(s, i, r, mirror);
}

/* Both particles are on the same side of the mirror, so that r points away from it for both. */
void isph_reflection_part(struct isph *s) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      if (s->images[i] != IMAGES_REFLECTED) continue;
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
        const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
        double r[3];
        if (!isph_is_reflected(IMAGES_REFLECTED, s, entry) ||
            (s->surface[i] == 0 && s->surface[j] == 0))
          continue;
        isph_separation(s, s->position[i], s->position, entry, r);
        const double own = s->surface[i] * isph_reflection_gap(s, i, entry, r);
        const double other = s->surface[j] * isph_reflection_gap(s, j, entry, r);
        chunk->slope[p] *= (float)(1 - fmax(own, other));
      }
    }
  }
}

double isph_reflection_ratio(const struct isph *s, const double xi[3], uint32_t entry,
                             const double r[3]) {
  const struct isph_image *image = &s->image[entry >> PAIR_BITS];
  double near = 0, far = 0;
  for (int a = 0; a < 3; a++) {
    if (image->turn[a] > 0) continue;
    const double own = xi[a] - 0.5 * image->shift[a], other = r[a] - own;
    near += own * own, far += other * other;
  }
  return sqrt(far) / fmax(sqrt(near), WALL_NEAREST * s->spacing);
}
