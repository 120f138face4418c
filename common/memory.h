/* Memory allocation with checked sizes and a counted, limited total. */
#ifndef TOSUI_COMMON_MEMORY_H
#define TOSUI_COMMON_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* a * b into *product; false on overflow. */
bool size_multiply(size_t a, size_t b, size_t *product);

/* Allocates count * size bytes, zeroed and aligned to 64 bytes, into *pointer; `what` names the
 * memory in the error message ("density of 219600 particles"). A count of 0 gives NULL and
 * succeeds. Free with memory_free. */
enum status memory_allocate(void *pointer, size_t count, size_t size, const char *what);

/* The same if this rank touches only about `used` items: memory that is never touched takes no
 * space and is not counted. */
enum status memory_allocate_sparse(void *pointer, size_t count, size_t size, size_t used,
                                   const char *what);
/* sphsolve-mpi only: maps `bytes` of an open file that other processes map too; counted as `own`
 * bytes. */
enum status memory_map(void *pointer, int file, size_t bytes, size_t own, const char *what);
/* Whether `data` comes from memory_map. */
bool memory_is_mapped(const void *data);

/* Like realloc for a block of memory_allocate; new bytes are zero. On failure the block stays. */
enum status memory_resize(void *pointer, size_t count, size_t size, const char *what);

/* The first `length` bytes of `text` as a string in new memory. */
enum status memory_copy_text(const char *text, size_t length, char **copy);

/* Frees what `pointer` (a T **) points to and sets it to NULL. */
void memory_free(void *pointer);
/* The same for several: MEMORY_FREE(&a, &b). */
#define MEMORY_FREE(...) memory_free_each((void *[]){__VA_ARGS__, NULL})
void memory_free_each(void **pointers);

/* Bytes in use, and their maximum so far. */
size_t memory_in_use(void);
size_t memory_peak(void);
/* Bytes that are available on this machine and within the limits of this process, as far as these
 * are known. */
double memory_available(void);

/* Sets the limit on the bytes in use (--max-memory); allocations beyond it fail. 0: the memory of
 * the machine, which is also the initial limit. */
void memory_set_limit(size_t bytes);

/* The limit set by memory_set_limit, or the memory of the machine. */
double memory_limit(void);

/* Whether count * size more bytes would stay within the limit. */
bool memory_has_room(size_t count, size_t size);

/* Tests only: an allocation fails whenever `fails` returns true (NULL: none fails). */
void memory_ask_fails(bool (*fails)(void));

#endif
