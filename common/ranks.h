/* The processes that share a run. common/ranks.c is the only file that calls MPI; in a build
 * without it (MPI=0) there is one rank, and everything here is a constant that the compiler takes
 * away. "Collective": all ranks call it, in the same order. */
#ifndef TOSUI_COMMON_RANKS_H
#define TOSUI_COMMON_RANKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* What went over the network from this rank since the start. */
struct ranks_traffic {
  uint64_t messages, bytes; /* between neighbours: ghosts */
  uint64_t reductions;      /* sums, maxima and agreements of all */
  uint64_t gathered_bytes;  /* received by ranks_gather */
  double seconds;           /* spent in waiting for any of it */
  double spun, busy;        /* processor seconds in waiting, and out of it */
};

#ifdef TOSUI_MPI
#define RANKS 1

/* First in main, and last: prints the pending error once, whoever met it, and ends all ranks where
 * only some have failed. Returns the exit code. */
void ranks_start(int *argc, char ***argv);
int ranks_end(enum status status);
int ranks_count(void);
int ranks_own(void);
/* Collective; the same bits on every rank. */
void ranks_sum_all(double *values, size_t count);
void ranks_max_all(double *values, size_t count);
/* The same of whole numbers, of any count. */
void ranks_sum_whole(int64_t *values, size_t count);
/* Collective: send[r] goes to rank r, receive[r] comes from it. */
void ranks_swap_counts(const size_t *send, size_t *receive);
/* Collective: a failure of one is a failure of all. */
enum status ranks_agree(enum status status);
/* Collective: the sum of `own` over the ranks before this one; *total over all. */
size_t ranks_offset(size_t own, size_t *total);
/* Collective: rank r has items [start[r], start[r + 1]) of `size` bytes; then all have all. */
void ranks_gather(void *data, const size_t *start, size_t size);
/* Puts a message under way, and takes one of just as many bytes into `to`; both stay untouched
 * until ranks_wait. Messages between two ranks arrive in the order they were posted for a `tag`. */
void ranks_send(const void *from, size_t bytes, int rank, int tag);
void ranks_receive(void *to, size_t bytes, int rank, int tag);
void ranks_wait(void);
struct ranks_traffic ranks_traffic(void);

#else
#define RANKS 0

static inline void ranks_start(int *argc, char ***argv) {
  (void)argc, (void)argv;
}
int ranks_end(enum status status);
static inline int ranks_count(void) {
  return 1;
}
static inline int ranks_own(void) {
  return 0;
}
static inline void ranks_sum_all(double *values, size_t count) {
  (void)values, (void)count;
}
static inline void ranks_max_all(double *values, size_t count) {
  (void)values, (void)count;
}
static inline void ranks_sum_whole(int64_t *values, size_t count) {
  (void)values, (void)count;
}
static inline void ranks_swap_counts(const size_t *send, size_t *receive) {
  receive[0] = send[0];
}
static inline enum status ranks_agree(enum status status) {
  return status;
}
static inline size_t ranks_offset(size_t own, size_t *total) {
  *total = own;
  return 0;
}
static inline void ranks_gather(void *data, const size_t *start, size_t size) {
  (void)data, (void)start, (void)size;
}
static inline void ranks_send(const void *from, size_t bytes, int rank, int tag) {
  (void)from, (void)bytes, (void)rank, (void)tag;
}
static inline void ranks_receive(void *to, size_t bytes, int rank, int tag) {
  (void)to, (void)bytes, (void)rank, (void)tag;
}
static inline void ranks_wait(void) {}
static inline struct ranks_traffic ranks_traffic(void) {
  return (struct ranks_traffic){0};
}
#endif

static inline double ranks_sum(double value) {
  ranks_sum_all(&value, 1);
  return value;
}
static inline double ranks_max(double value) {
  ranks_max_all(&value, 1);
  return value;
}
static inline bool ranks_any(bool value) {
  return ranks_max(value ? 1 : 0) > 0;
}

#endif
