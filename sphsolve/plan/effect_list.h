/* The effects of a method as an array EFFECTS, ended by NULL, from EFFECTS_REGISTRY. Its files are
 * read three times: for their functions, then, with these behind their include guards, for their
 * descriptors, and for a list of those. */
#include "sphsolve/plan/effect.h"
#include EFFECTS_REGISTRY
#undef EFFECT
#define EFFECT(symbol, ...)                                                                        \
  static const struct effect effect_##symbol = {.name = #symbol, __VA_ARGS__};
#include EFFECTS_REGISTRY
#undef EFFECT
#define EFFECT(symbol, ...) &effect_##symbol,
const struct effect *const EFFECTS[] = {
#include EFFECTS_REGISTRY
    NULL};
#undef EFFECT
#define EFFECT(symbol, ...)
