/* Memory that the ranks on one machine hold once (ranks.c): what all of them read, such as the
 * model. Filled by all, each a part; from then on none writes. Against its limit of memory each
 * rank counts its bytes divided by the ranks that share them. Where it cannot be had (no memfd, a
 * limit on the size of files), each has its own. */
#ifndef TOSUI_COMMON_NODE_MEMORY_H
#define TOSUI_COMMON_NODE_MEMORY_H

#include "common/memory.h"

#ifdef TOSUI_MPI
/* Collective: as memory_allocate; memory_free, which is not collective, gives it back. */
enum status node_allocate(void *pointer, size_t count, size_t size, const char *what);
/* Collective: of `data` from there, rank r has filled items [start[r], start[r + 1]) of `size`
 * bytes; then all are there for all. */
void node_share(void *data, const size_t *start, size_t size);
#else
static inline enum status node_allocate(void *pointer, size_t count, size_t size,
                                        const char *what) {
  return memory_allocate(pointer, count, size, what);
}
static inline void node_share(void *data, const size_t *start, size_t size) {
  (void)data, (void)start, (void)size;
}
#endif

#endif
