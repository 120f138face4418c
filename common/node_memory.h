/* Memory shared by the ranks on one machine (ranks.c), for data that all of them read, such as the
 * model. Each rank fills a part; afterwards nobody writes. A rank counts its share of the bytes
 * against its memory limit. If sharing is impossible (no memfd, a limit on file sizes) each rank
 * has its own copy. */
#ifndef TOSUI_COMMON_NODE_MEMORY_H
#define TOSUI_COMMON_NODE_MEMORY_H

#include "common/memory.h"

#ifdef TOSUI_MPI
/* Collective: as memory_allocate. Free with memory_free, which is not collective. */
enum status node_allocate(void *pointer, size_t count, size_t size, const char *what);
/* Collective: rank r has filled the items [start[r], start[r + 1]) of `size` bytes of `data`, which
 * node_allocate returned; afterwards all ranks have all items. */
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
