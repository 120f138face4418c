/* Stand-ins, each gives way to the method's own file when it lands. */
#include "sphsolve/method.h"
#define PENDING(name)                                                                              \
  __attribute__((weak)) enum status name##_scales(struct plan *plan) {                             \
    (void)plan;                                                                                    \
    return FAIL(STATUS_RUN, "method " #name " is not built in");                                   \
  }                                                                                                \
  __attribute__((weak)) enum status name##_plan(struct plan *plan, int threads) {                  \
    (void)plan, (void)threads;                                                                     \
    return FAIL(STATUS_RUN, "method " #name " is not built in");                                   \
  }                                                                                                \
  __attribute__((weak)) enum status name##_run(                                                    \
      const struct scene *scene, const struct plan *plan, const struct lattice *lattice,           \
      struct recorder *recorder, struct run_result *result) {                                      \
    (void)scene, (void)plan, (void)lattice, (void)recorder, (void)result;                          \
    return FAIL(STATUS_RUN, "method " #name " is not built in");                                   \
  }
PENDING(wcsph)
