/* The processes (ranks) that share a run. Only common/ranks.c calls MPI. In a build without it
 * (MPI=0) there is one rank, and the functions here reduce to constants at compile time.
 * "Collective": all ranks call the function, in the same order. */
#ifndef TOSUI_COMMON_RANKS_H
#define TOSUI_COMMON_RANKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Communication of this rank since the start. */
struct ranks_traffic {
  uint64_t messages, bytes; /* between neighbours: ghost planes and particles */
  uint64_t reductions;      /* sums, maxima and agreements over all ranks */
  uint64_t gathered_bytes;  /* received by ranks_gather */
  double seconds;           /* spent waiting for communication */
  double spun, busy;        /* processor time spent waiting, and otherwise, in s */
};

#ifdef TOSUI_MPI
#define RANKS 1

/* ranks_start is the first call in main. ranks_end is the last: it prints the pending error once,
 * whichever rank it occurred on, ends all ranks if only some have failed, and returns the exit
 * code. */
void ranks_start(int *argc, char ***argv);
int ranks_end(enum status status);
/* Number of ranks, and the number of this one, from 0. */
int ranks_count(void);
int ranks_own(void);
/* Collective; bitwise equal results on every rank. */
void ranks_sum_all(double *values, size_t count);
void ranks_max_all(double *values, size_t count);
/* The same for integers, in any number. */
void ranks_sum_whole(int64_t *values, size_t count);
/* Collective: send[r] is sent to rank r, receive[r] is received from it. */
void ranks_swap_counts(const size_t *send, size_t *receive);
/* Collective: a failure on one rank becomes a failure on all. */
enum status ranks_agree(enum status status);
/* Collective: returns the sum of `own` over the ranks before this one; *total is the sum over
 * all. */
size_t ranks_offset(size_t own, size_t *total);
/* Collective: rank r has the items [start[r], start[r + 1]) of `size` bytes; afterwards all ranks
 * have all items. */
void ranks_gather(void *data, const size_t *start, size_t size);
/* Start sending a message, and receiving one of the same length into `to`; neither buffer may be
 * touched until ranks_wait. Messages between two ranks with the same `tag` arrive in the order of
 * sending. */
void ranks_send(const void *from, size_t bytes, int rank, int tag);
void ranks_receive(void *to, size_t bytes, int rank, int tag);
/* Waits for all messages posted by ranks_send and ranks_receive. */
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
