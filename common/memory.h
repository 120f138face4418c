/* Memory whose size comes from checked arithmetic and whose total is counted and limited. */
#ifndef TOSUI_COMMON_MEMORY_H
#define TOSUI_COMMON_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* a * b into *product; false on overflow. */
bool size_multiply(size_t a, size_t b, size_t *product);

/* count * size bytes, zeroed, aligned to 64 bytes, into *pointer; `what` names it in the error
 * ("density of 219600 particles"). A count of 0 gives NULL and succeeds. Free with memory_free. */
enum status memory_allocate(void *pointer, size_t count, size_t size, const char *what);

/* The same, but of which this rank touches only about `used` items: what is never touched takes no
 * memory and is not counted. */
enum status memory_allocate_sparse(void *pointer, size_t count, size_t size, size_t used,
                                   const char *what);
/* sphsolve-mpi only: `bytes` of an open file that other processes map too; counted as `own`. */
enum status memory_map(void *pointer, int file, size_t bytes, size_t own, const char *what);
bool memory_is_mapped(const void *data);

/* Like realloc for a block of memory_allocate; new bytes are zero. On failure the block stays. */
enum status memory_resize(void *pointer, size_t count, size_t size, const char *what);

/* The first `length` bytes of `text` as a string in new memory. */
enum status memory_copy_text(const char *text, size_t length, char **copy);

/* Frees what `pointer` (a T **) points to and sets it to NULL. */
void memory_free(void *pointer);

/* Bytes held now and at the highest; for /run/timing and explain. */
size_t memory_in_use(void);
size_t memory_peak(void);
/* Bytes that the machine and the limits of this process leave, as far as they say. */
double memory_available(void);

/* Refuses allocations that would bring the bytes in use above `bytes` (--max-memory); 0: above the
 * machine's memory, which is where every program starts. */
void memory_set_limit(size_t bytes);

/* What memory_set_limit gave, or that of the machine. */
double memory_limit(void);

/* Whether as much would still be below the limit. */
bool memory_has_room(size_t count, size_t size);

/* Tests only: each allocation that is asked for fails where this is true (NULL: none). */
void memory_ask_fails(bool (*fails)(void));

#endif
