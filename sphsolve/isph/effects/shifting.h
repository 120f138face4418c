/* Particle shifting by concentration (Lind et al. 2012; Skillen et al. 2013): particles drift from
 * where they are dense to where they are sparse,
 *   dx = - min(A U dt h, bound) grad C,   C = sum V W,
 * with U the larger of the particle's speed and h |S|; |dx| is at most a tenth of the particle's
 * size r. The velocity is changed accordingly, v += dx . grad v, so that shifting does not diffuse
 * momentum.
 *
 * The bound is 0.8 r^2 / s, with s the stiffness of grad C against displacements of neighbours,
 * found on the lattice: a factor of r^2 / s exactly reverses such a displacement, one of 2 r^2 / s
 * reverses it at full size. With the bound of Skillen et al., h^2 = 2.3 r^2 / s, particles
 * alternate from step to step, and the pressure with them: under a surface, in all of the water,
 * between 0 and twice its value; in a column of water that crosses coarse soil fast, by a tenth.
 * The bound is h^2 if nothing but the water itself and walls acts on it.
 *
 * A particle on the surface is not shifted, and one with a neighbour on the surface only along the
 * surface (Khayyer, Gotoh, Shimizu 2017, eq. 13): C falls towards the void even where particles are
 * evenly spread, and a shift down that gradient would lift the water in every step. In scenes with
 * soil this holds already where the neighbours are half on a level surface (by the square of the
 * cosine between its normal and the upward direction): the rows of thin, uneven water are partly on
 * the surface for long, and the remaining shift out of them would lift the row in every step by as
 * much as all its kinetic energy. On slopes it would prevent water that runs down from spreading. A
 * shift along the surface lifts, too, where the surface's normal is not that of the particle's own
 * void; that is bounded (isph/energy.c).
 *
 * As far as free water is calm (isph/calm.h), a particle on the surface is shifted along it too: in
 * an uneven arrangement one is pressed down into the second row sooner or later, and a wave loses
 * half of its energy at once. And where the water is thick the mean shift of a neighbourhood, with
 * weights V (- W'/r), is subtracted from each shift: differences from particle to particle even the
 * particles out, whereas a mean shift does work on the pressure and makes a wave on many rows grow.
 * So it is in soil, by the least fraction of soil in the neighbourhood, less near a surface: no
 * drag acts on a shift, and a mean shift, from where the water is denser by tenths of a per cent,
 * would let particles move several per cent slower than v carries them.
 *
 * Nor is a particle shifted beside a gap to a wall if it is more asymmetric than disorder makes it:
 * shifting would close the gap within three steps. Nothing is shifted at rest. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_SHIFTING_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_SHIFTING_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/energy.h"
#include "sphsolve/isph/linear.h"

#define SHIFT_STRENGTH 10.0 /* A */

/* Shift of a particle; `gradient_sum` = - grad C, `most`: the bound, `weight`: 0 .. 1. */
static inline void shift_of(const double gradient_sum[3], double h, double speed, double dt,
                            double size, double most, double weight, double shift[3]) {
  double scale = weight * fmin(SHIFT_STRENGTH * speed * dt * h, most);
  double length =
      scale * sqrt(gradient_sum[0] * gradient_sum[0] + gradient_sum[1] * gradient_sum[1] +
                   gradient_sum[2] * gradient_sum[2]);
  if (length > SHIFT_MOST * size) scale *= SHIFT_MOST * size / length;
  for (int a = 0; a < 3; a++) shift[a] = scale * gradient_sum[a];
}

/* Reduces the shift of a particle near a surface (`near`, 0 .. 1) to its component along the
 * surface. With `level` (0 .. 1; 0 without soil) the outward component vanishes already where water
 * is half on a surface. */
static inline void shift_along(const double normal[3], double near, double level, double shift[3]) {
  double out = shift[0] * normal[0] + shift[1] * normal[1] + shift[2] * normal[2];
  if (out > 0) near += level * (fmin(1, 2 * near) - near);
  for (int a = 0; a < 3; a++) shift[a] -= near * out * normal[a];
}

/* Whether the water may be lifted no more than friction pays for: under a surface, but for the free
 * water whose waves have to persist (isph/linear.h). */
static inline bool isph_shifting_is_bound(const struct isph *s) {
  return s->on.shifting && s->on.surface && isph_is_driven(s) && !isph_is_free_water(s);
}

/* isph/energy.c: limits the shifts `steps` whose `lift`, -f.dx, raises the water, all by the same
 * factor, to the energy that friction and the lowering shifts provide. */
void isph_energy_bound_lift(const struct isph *s, const double *lift, double (*steps)[3]);

static inline bool isph_shifting_wanted(const struct effect_context *context,
                                        char why[EFFECT_WHY]) {
  enum switch_state state = context->scene->shifting;
  if (state != SWITCH_AUTO) {
    snprintf(why, EFFECT_WHY,
             state == SWITCH_ON ? "the scene says so"
                                : "the scene says so; particles may clump where the water strains");
    return state == SWITCH_ON;
  }
  snprintf(why, EFFECT_WHY, "keeps particles evenly spread");
  return true;
}

static inline enum status isph_shifting_predicted(void *state, double dt) {
  struct isph *s = state;
  (void)dt;
  if (isph_shifting_is_bound(s) && !s->on.energy) isph_energy_find_friction(s);
  return STATUS_OK;
}

#endif

EFFECT(isph_shifting, .model = "particles drift to where they are sparse",
       .citation = "Lind et al. 2012; Skillen et al. 2013", .wanted = isph_shifting_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, shifting),
       .budget = 1u << BUDGET_SHIFTING, .predicted = isph_shifting_predicted)
