#include "common/memory.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

/* Size of the header before each block, in bytes. It holds the size of the block, to count the
 * bytes in use, and the distance from the start of the underlying allocation. */
#define HEADER 64

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static size_t in_use, peak, limit;
static bool (*test_fails)(void);

bool size_multiply(size_t a, size_t b, size_t *product) {
  return !__builtin_mul_overflow(a, b, product);
}

/* Counts `bytes` as in use, in addition to *held; false if that exceeds the limit or a test wants
 * this allocation to fail. */
static bool reserve(size_t bytes, bool *over_limit, size_t *held) {
  pthread_mutex_lock(&lock);
  *held = in_use;
  if (limit == 0) limit = (size_t)sysconf(_SC_PHYS_PAGES) * (size_t)sysconf(_SC_PAGE_SIZE);
  bool injected = test_fails != NULL && test_fails();
  *over_limit = bytes > limit || in_use > limit - bytes;
  bool ok = !injected && !*over_limit;
  if (ok) {
    in_use += bytes;
    if (in_use > peak) peak = in_use;
  }
  pthread_mutex_unlock(&lock);
  return ok;
}

bool memory_has_room(size_t count, size_t size) {
  size_t bytes;
  pthread_mutex_lock(&lock);
  const bool room =
      size_multiply(count, size, &bytes) && in_use <= limit && bytes <= limit - in_use;
  pthread_mutex_unlock(&lock);
  return room;
}

static void release(size_t bytes) {
  pthread_mutex_lock(&lock);
  in_use -= bytes;
  pthread_mutex_unlock(&lock);
}

static size_t *block_size(void *data) {
  return (size_t *)(void *)((char *)data - HEADER);
}

/* Writes the header and returns the aligned memory behind it; `start` has 2 HEADER more bytes. */
static void *place(char *start, size_t bytes) {
  char *data = start + (2 * HEADER - (size_t)start % HEADER);
  block_size(data)[0] = bytes;
  block_size(data)[1] = (size_t)(data - HEADER - start);
  block_size(data)[2] = 0;
  return data;
}

/* Requests pages of 2 MB for a large block. The first access to such a page takes hardly longer
 * than to one of 4 kB, apart from zeroing, and the TLB is missed less often. Smaller blocks would
 * occupy more than they use. The request may be refused, which does no harm. */
#define LARGE_PAGE ((size_t)2 << 20)
static void ask_for_large_pages(char *start, size_t bytes) {
#ifdef MADV_HUGEPAGE
  if (bytes < 2 * LARGE_PAGE) return;
  const size_t before = (LARGE_PAGE - (size_t)start % LARGE_PAGE) % LARGE_PAGE;
  (void)madvise(start + before, (bytes - before) / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE);
#endif
}

enum status memory_allocate(void *pointer, size_t count, size_t size, const char *what) {
  void *data;
  size_t bytes, with_header, held;
  memset(pointer, 0, sizeof data); /* a null pointer */
  if (count == 0 || size == 0) return STATUS_OK;
  if (!size_multiply(count, size, &bytes) ||
      __builtin_add_overflow(bytes, (size_t)(2 * HEADER), &with_header))
    return FAIL(STATUS_RUN, "memory for %s: %zu x %zu bytes is more than can be addressed", what,
                count, size);
  bool over_limit;
  if (!reserve(bytes, &over_limit, &held)) {
    if (over_limit)
      return FAIL(STATUS_RUN,
                  "memory for %s: %.1f MB beside the %.1f MB in use would exceed the limit of %.1f "
                  "MB; --max-memory sets it",
                  what, (double)bytes / 1e6, (double)held / 1e6, (double)limit / 1e6);
    return FAIL(STATUS_RUN, "memory for %s: %.1f MB could not be had", what, (double)bytes / 1e6);
  }
  /* calloc takes large blocks from new pages, which are zero and use memory only once they are
   * touched. */
  char *start = calloc(with_header, 1);
  if (start == NULL) {
    release(bytes);
    return FAIL(STATUS_RUN, "memory for %s: %.1f MB could not be had", what, (double)bytes / 1e6);
  }
  ask_for_large_pages(start, with_header);
  data = place(start, bytes);
  memcpy(pointer, &data, sizeof data);
  return STATUS_OK;
}

enum status memory_resize(void *pointer, size_t count, size_t size, const char *what) {
  void *old, *data;
  memcpy(&old, pointer, sizeof old);
  enum status status = memory_allocate(&data, count, size, what);
  if (status != STATUS_OK) return status;
  if (old != NULL && data != NULL) {
    size_t had = *block_size(old), has = *block_size(data);
    memcpy(data, old, had < has ? had : has);
  }
  memory_free(&old);
  memcpy(pointer, &data, sizeof data);
  return STATUS_OK;
}

enum status memory_copy_text(const char *text, size_t length, char **copy) {
  enum status status = memory_allocate(copy, length + 1, 1, "a text");
  if (status == STATUS_OK && *copy != NULL) memcpy(*copy, text, length);
  return status;
}

#ifdef TOSUI_MPI
enum status memory_allocate_sparse(void *pointer, size_t count, size_t size, size_t used,
                                   const char *what) {
  size_t bytes, with_header, held;
  bool over_limit;
  char *data = NULL;
  memcpy(pointer, &data, sizeof data);
  /* Sizes that cannot be addressed are reported by memory_allocate. */
  if (used >= count || !size_multiply(count, size, &bytes) ||
      __builtin_add_overflow(bytes, (size_t)(2 * HEADER), &with_header))
    return memory_allocate(pointer, count, size, what);
  const bool booked = reserve(used * size, &over_limit, &held);
  char *start = booked ? calloc(with_header, 1) : NULL;
  if (start == NULL) {
    if (booked) release(used * size);
    return FAIL(STATUS_RUN, "memory for %s: %.1f MB could not be had", what,
                (double)(used * size) / 1e6);
  }
  data = place(start, used * size);
  memcpy(pointer, &data, sizeof data);
  return STATUS_OK;
}

/* The header is in a private page in front of the mapped file. */
enum status memory_map(void *pointer, int file, size_t bytes, size_t own, const char *what) {
  const size_t page = (size_t)sysconf(_SC_PAGE_SIZE), length = page + bytes;
  const int access = PROT_READ | PROT_WRITE;
  bool over_limit;
  size_t held;
  const bool booked = reserve(own, &over_limit, &held);
  char *start =
      booked ? mmap(NULL, length, access, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) : MAP_FAILED;
  if (start != MAP_FAILED &&
      mmap(start + page, bytes, access, MAP_SHARED | MAP_FIXED, file, 0) == MAP_FAILED) {
    munmap(start, length);
    start = MAP_FAILED;
  }
  if (start == MAP_FAILED) {
    if (booked) release(own);
    return FAIL(STATUS_RUN, "memory for %s: %.1f MB could not be had", what, (double)own / 1e6);
  }
  char *data = start + page;
  block_size(data)[0] = own;
  block_size(data)[1] = page;
  block_size(data)[2] = length;
  memcpy(pointer, &data, sizeof data);
  return STATUS_OK;
}

bool memory_is_mapped(const void *data) {
  return *(const size_t *)(const void *)((const char *)data - HEADER + 2 * sizeof(size_t)) > 0;
}
#else
enum status memory_allocate_sparse(void *pointer, size_t count, size_t size, size_t used,
                                   const char *what) {
  (void)used;
  return memory_allocate(pointer, count, size, what);
}
#endif

void memory_free(void *pointer) {
  void *data, *null = NULL;
  memcpy(&data, pointer, sizeof data);
  if (data == NULL) return;
  release(*block_size(data));
  if (block_size(data)[2] > 0)
    munmap((char *)data - block_size(data)[1], block_size(data)[2]);
  else
    free((char *)data - HEADER - block_size(data)[1]);
  memcpy(pointer, &null, sizeof null);
}

void memory_free_each(void **pointers) {
  for (; *pointers != NULL; pointers++) memory_free(*pointers);
}

size_t memory_in_use(void) {
  return in_use;
}
size_t memory_peak(void) {
  return peak;
}
double memory_available(void) {
  double left = INFINITY;
  char line[256];
  FILE *file = fopen("/proc/meminfo", "r");
  while (file != NULL && fgets(line, sizeof line, file) != NULL) {
    unsigned long long kilobytes;
    if (sscanf(line, "MemAvailable: %llu", &kilobytes) == 1) left = 1024.0 * (double)kilobytes;
  }
  if (file != NULL) fclose(file);
  struct rlimit address;
  if (getrlimit(RLIMIT_AS, &address) == 0 && address.rlim_cur != RLIM_INFINITY)
    left = fmin(left, (double)address.rlim_cur - (double)in_use);
  return limit > 0 ? fmin(left, (double)limit - (double)in_use) : left;
}
double memory_limit(void) {
  return limit > 0 ? (double)limit
                   : (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGE_SIZE);
}
void memory_set_limit(size_t bytes) {
  limit = bytes;
}
void memory_ask_fails(bool (*fails)(void)) {
  test_fails = fails;
}
