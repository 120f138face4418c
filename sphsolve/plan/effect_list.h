/* The effects of a method (EFFECTS_REGISTRY) as an array EFFECTS that ends with NULL. The files are
 * included three times: for their functions; for their descriptors, which stand after the include
 * guards; and for the list of the descriptors. */
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
