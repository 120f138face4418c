/* Surface tension: the pressure under a surface of curvature kappa (positive: convex water) is
 *   P_s = sigma kappa                                                 (Young 1805; Laplace 1806)
 * above that outside. It replaces P = 0 (surface.h), half a particle above the outermost particles,
 * so that a drop at rest has P = sigma kappa everywhere and no force acts in it. This is the
 * continuum surface force of Brackbill, Kothe, Zemach (1992), Morris (2000), sigma kappa n delta,
 * in the limit of a sharp surface.
 *
 * Normals n_i are those of the sum V grad W of a particle and its neighbours on the surface; the
 * curvature is the slope of the normals along the surface, by least squares,
 *   kappa_i = (D - 1) sum_j w_ij (n_j - n_i).t_ij / sum_j w_ij |t_ij|^2,
 * with t_ij the component of x_j - x_i normal to the mean of both normals: exact on circles and
 * spheres. At the surface, half a particle further out, it is kappa/(1 + kappa size/2/(D - 1)), and
 * then the mean over the neighbours on the surface is taken. Water meets walls at right angles.
 * There is none in soil, whose capillary pressure is different. Waves as short as particles limit
 * the step: Morris (2000), eq. 19. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_SURFACE_TENSION_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_SURFACE_TENSION_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"

static inline bool surface_tension_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  const double sigma = context->scene->fluid.surface_tension;
  const bool on = sigma > 0 && context->has_surface;
  snprintf(why, EFFECT_WHY,
           on          ? "surface_tension of the fluid, %g N/m"
           : sigma > 0 ? "no surface"
                       : "the fluid has no surface_tension",
           sigma);
  return on;
}

static inline double surface_tension_dt(const struct effect_context *context) {
  const struct fluid *fluid = &context->scene->fluid;
  return 0.25 *
         sqrt(fluid->density * pow(context->spacing, 3) / (2 * M_PI * fluid->surface_tension));
}

/* Weight of neighbour j of a particle of that size, relative to 1 for the particle itself; 0 off
 * the surface. */
static inline double surface_tension_weight(const struct isph *s, const struct isph_chunk *chunk,
                                            size_t p, double size) {
  const uint32_t j = chunk->pair[p] & PAIR_MASK;
  return s->surface[j] * s->volume[j] * (double)chunk->slope[p] * size * size / s->slope_sum;
}

/* Normal n_i of particle i. */
static inline void surface_tension_normal(const struct isph *s, const struct isph_chunk *chunk,
                                          size_t i, double normal[3]) {
  const double size = s->size[i];
  double square = 0;
  for (int a = 0; a < 3; a++) normal[a] = s->surface[i] * s->gradient_sum[i][a];
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const double w = surface_tension_weight(s, chunk, p, size);
    double other[3];
    isph_turn(IMAGES_REFLECTED, s, chunk->pair[p], s->gradient_sum[chunk->pair[p] & PAIR_MASK],
              other);
    for (int a = 0; a < 3 && w > 0; a++) normal[a] += w * other[a];
  }
  for (int a = 0; a < 3; a++) square += normal[a] * normal[a];
  for (int a = 0; a < 3; a++) normal[a] /= fmax(sqrt(square), 1e-30);
}

static inline double surface_tension_curvature(const struct isph *s, const struct isph_chunk *chunk,
                                               size_t i, double (*normal)[3]) {
  const double size = s->size[i], most = 1 / size, d = s->dimensions - 1;
  double turn = 0, span = 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t j = chunk->pair[p] & PAIR_MASK;
    const double w = surface_tension_weight(s, chunk, p, size);
    double r[3], other[3], across[3], square = 0, out = 0;
    if (!(w > 0)) continue;
    isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
    isph_turn(IMAGES_REFLECTED, s, chunk->pair[p], normal[j], other);
    for (int a = 0; a < 3; a++) {
      across[a] = normal[i][a] + other[a];
      square += across[a] * across[a], out += across[a] * r[a];
    }
    for (int a = 0; a < 3; a++) {
      const double t = r[a] - out / fmax(square, 1e-30) * across[a];
      turn += w * (normal[i][a] - other[a]) * t;
      span += w * t * t;
    }
  }
  const double curvature = span > 0 ? fmax(-most, fmin(most, turn / span)) : 0;
  return d * curvature / (1 + 0.5 * size * curvature);
}

static inline void surface_tension_pressure(void *state, double *pressure) {
  struct isph *s = state;
  double(*normal)[3] = s->scratch, *curvature = s->work[0];
  const double sigma = s->scene->fluid.surface_tension;
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      if (s->surface[i] > 0) surface_tension_normal(s, &s->chunks[c], i, normal[i]);
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(normal)});
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      curvature[i] = s->surface[i] > 0 ? surface_tension_curvature(s, &s->chunks[c], i, normal) : 0;
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(curvature)});
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const struct isph_chunk *chunk = &s->chunks[c];
      const double size = s->size[i];
      double sum = s->surface[i] * curvature[i], weight = s->surface[i];
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n && weight > 0; p++) {
        const double w = surface_tension_weight(s, chunk, p, size);
        if (!(w > 0)) continue;
        sum += w * curvature[chunk->pair[p] & PAIR_MASK], weight += w;
      }
      pressure[i] = weight > 0 ? sigma * sum / weight : 0;
      if (s->soil_fraction != NULL) pressure[i] *= 1 - s->soil_fraction[i];
    }
}

#endif

EFFECT(isph_surface_tension, .model = "P = sigma kappa at the surface",
       .citation = "Young 1805, Laplace 1806; Morris 2000, eqs. 2, 19",
       .wanted = surface_tension_wanted, .dt_max = surface_tension_dt, .drives = true,
       .surface_pressure = surface_tension_pressure)
