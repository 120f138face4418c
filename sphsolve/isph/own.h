/* Fields and numbers of effects (plan/effect.h), and their hooks. */
#ifndef TOSUI_SPHSOLVE_ISPH_OWN_H
#define TOSUI_SPHSOLVE_ISPH_OWN_H

#include <string.h>

#include "sphsolve/isph/state.h"

/* The field of that name of an active effect, a number for each particle. */
static inline double *isph_own_field(const struct isph *s, const char *name) {
  for (size_t k = 0, n = 0; k < s->on.active_count; k++)
    for (const struct effect_field *f = s->on.active[k]->fields; f != NULL && f->name != NULL;
         f++, n++)
      if (strcmp(f->name, name) == 0) return s->own_field[n];
  return NULL;
}

/* The numbers of that name of an active effect. */
static inline double *isph_own_numbers(const struct isph *s, const char *name) {
  for (size_t k = 0; k < s->on.active_count; k++)
    if (s->on.active[k]->numbers != NULL && strcmp(s->on.active[k]->numbers, name) == 0)
      return s->own_numbers[k];
  return NULL;
}

/* How many numbers active effect k has. */
static inline size_t isph_own_count(const struct isph *s, size_t k) {
  const struct effect *effect = s->on.active[k];
  return effect->numbers == NULL ? 0 : effect->things(s->scene) * (size_t)effect->numbers_each;
}

/* Calls a hook of all active effects; goes to `cleanup` at the first that fails. */
#define ISPH_HOOK(s, hook, dt)                                                                     \
  for (size_t hooked = 0; hooked < (s)->on.active_count; hooked++)                                 \
    if ((s)->on.active[hooked]->hook != NULL) TRY((s)->on.active[hooked]->hook(s, dt))

#endif
