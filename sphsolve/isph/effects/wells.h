/* Wells of given rate and drains of given head take water out of soil: isph/well.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WELLS_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WELLS_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/method.h"
#include "sphsolve/output/history_columns.h"
#include "sphsolve/isph/well.h"

static inline bool isph_wells_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  size_t wells = 0, drains = 0;
  for (size_t k = 0; k < context->scene->region_count; k = context->scene->regions[k].end) {
    wells += context->scene->regions[k].type == REGION_WELL;
    drains += context->scene->regions[k].type == REGION_DRAIN;
  }
  if (wells + drains == 0)
    snprintf(why, EFFECT_WHY, "no well or drain region");
  else
    snprintf(why, EFFECT_WHY, "%zu well%s of given rate, %zu drain%s", wells, wells == 1 ? "" : "s",
             drains, drains == 1 ? "" : "s");
  return wells + drains > 0;
}

/* Least width of a well in spacings: a narrower one holds too few particles. */
#define WELL_WIDTH_MIN 3.0

/* Whether soil that does not move is at a site. The lattice only has the last region there, which
 * may be the water that fills the soil. */
static inline bool soil_stays_at(const struct effect_context *context, size_t site,
                                 const double x[3]) {
  const struct scene *scene = context->scene;
  const struct region *soil = NULL;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    bool inside = region->type == REGION_POROUS;
    for (int a = 0; a < 3; a++)
      if (isph_scene_uses_axis(context, a))
        inside = inside && x[a] > region->box[a] && x[a] < region->box[a + 3];
    if (inside) soil = region;
  }
  if (soil == NULL || context->lattice->kind[site] == SITE_WALL) return false;
  return soil->soil_velocity[0] == 0 && soil->soil_velocity[1] == 0 && soil->soil_velocity[2] == 0;
}

/* Wells have to be in soil that does not move; what they take has to come from somewhere. */
static inline enum status isph_refuse_wells(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const struct lattice *l = context->lattice;
  const double width_least = WELL_WIDTH_MIN * context->spacing;
  bool source = context->has_surface, inflow = context->has_surface;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    inflow = inflow || region->type == REGION_INFLOW;
    source = source || (region->type == REGION_INFLOW && region->boundary == BOUNDARY_HEAD);
  }
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *well = &scene->regions[r];
    const bool is_well = well->type == REGION_WELL;
    size_t site = 0;
    if (!is_well && well->type != REGION_DRAIN) continue;
    const char *kind = region_type_names[well->type];
    for (int a = 0; a < 3; a++)
      if (isph_scene_uses_axis(context, a) &&
          well->extent[a + 3] - well->extent[a] < width_least * (1 - 1e-6))
        return FAIL(STATUS_INPUT,
                    "%s:%d: this %s is %g m wide in %c, and holds too few particles; make it %g m, "
                    "three spacings, or domain.spacing %g m",
                    scene->path, well->line, kind, well->extent[a + 3] - well->extent[a], "xyz"[a],
                    width_least, (well->extent[a + 3] - well->extent[a]) / WELL_WIDTH_MIN);
    if (is_well ? !source && well->rate > 0 : !inflow)
      return FAIL(STATUS_INPUT,
                  "%s:%d: nothing gives what this %s takes; let an inflow region%s, or a free "
                  "surface, give it",
                  scene->path, well->line, kind, is_well ? " of given head" : "");
    for (size_t k = 0; k < l->size[2]; k++)
      for (size_t j = 0; j < l->size[1]; j++)
        for (size_t i = 0; i < l->size[0]; i++, site++) {
          const size_t at[3] = {i, j, k};
          double x[3];
          bool inside = true;
          for (int a = 0; a < 3; a++) {
            x[a] = l->origin[a] + (double)at[a] * l->spacing[a];
            if (isph_scene_uses_axis(context, a))
              inside = inside && x[a] > well->box[a] && x[a] < well->box[a + 3];
          }
          if (inside && !soil_stays_at(context, site, x))
            return FAIL(
                STATUS_INPUT,
                "%s:%d: a %s takes water out of soil that stays; at (%g, %g, %g) m there is "
                "none: keep it within a porous region",
                scene->path, well->line, kind, x[0], x[1], x[2]);
        }
  }
  return STATUS_OK;
}

/* Time, s, in which the well of the highest rate takes one particle, since it takes them one by
 * one. */
static inline double isph_wells_dt(const void *state) {
  const struct isph *s = state;
  const double size = s->spacing;
  double rate = 0;
  for (size_t k = 0; k < s->scene->region_count; k++)
    if (s->scene->regions[k].type == REGION_WELL) rate = fmax(rate, s->scene->regions[k].rate);
  return rate > 0 ? size * size * (s->scene->dimensions == 3 ? size : 1) / rate : INFINITY;
}

static inline enum status isph_wells_mobile(void *state, double dt) {
  isph_wells_begin(state, dt);
  return STATUS_OK;
}

static inline void isph_wells_add(void *state, size_t i, struct effect_row *row) {
  isph_wells_row(state, i, row);
}

static inline enum status isph_wells_give(void *state, double dt) {
  (void)dt;
  isph_wells_solved(state);
  return STATUS_OK;
}

static inline bool isph_wells_turn(void *state) {
  return isph_wells_change(state);
}

static inline enum status isph_wells_corrected(void *state, double dt) {
  isph_wells_take(state, dt);
  return STATUS_OK;
}

static inline void isph_wells_columns(struct history_columns *columns, const void *state) {
  const struct isph *s = state;
  for (const struct isph_well *w = s->wells; w < s->wells + s->well_count; w++) {
    history_number(columns, "m^3/s", w->flow * s->thickness, "outflow_%s", w->region->name);
    history_number(columns, "kg", w->taken * s->thickness, "taken_%s", w->region->name);
    history_number(columns, "kg", w->pending * s->thickness, "pending_%s", w->region->name);
  }
}

#endif

EFFECT(isph_wells, .model = "div v = -q in a region of soil; a drain's q holds its pressure",
       .citation = "Bear 1972, 7.1", .wanted = isph_wells_wanted, .drives = true,
       .switches_on = EFFECT_SWITCH(struct isph_switches, wells), .budget = 1u << BUDGET_LEFT,
       .refuse = isph_refuse_wells, .mobile = isph_wells_mobile, .row = isph_wells_add,
       .solved = isph_wells_give, .changes = isph_wells_turn, .corrected = isph_wells_corrected,
       .stable_dt = isph_wells_dt, .columns = isph_wells_columns)
