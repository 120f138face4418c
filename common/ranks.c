#define _GNU_SOURCE // NOLINT: the name glibc wants, for memfd_create
#include "common/ranks.h"

#include "common/log.h"
#include "common/node_memory.h"

#ifndef TOSUI_MPI

int ranks_end(enum status status) {
  if (status != STATUS_OK) log_pending_error();
  return (int)status;
}

#else
#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

/* bytes of a message at most: MPI counts them in an int */
#define MESSAGE_BYTES_MAX ((size_t)1 << 30)
/* s that failed ranks wait for the others to fail too, before they abort. */
#define ABORT_DELAY 2.0

static int own, count = 1;
static struct ranks_traffic traffic;
static MPI_Comm node; /* the ranks on this machine */
static int node_own, node_count;
static MPI_Request *pending;
static int pending_count, pending_room;

static double processor_seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Called around all communication that may wait. Waiting may spin, which is not counted as work. */
static struct { double wall, processor; } began;
static void wait_begin(void) {
  began.wall = clock_seconds();
  began.processor = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
}
static void wait_end(void) {
  traffic.seconds += clock_seconds() - began.wall;
  traffic.spun += processor_seconds(CLOCK_THREAD_CPUTIME_ID) - began.processor;
}

void ranks_start(int *argc, char ***argv) {
  int provided;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &own);
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, own, MPI_INFO_NULL, &node);
  MPI_Comm_rank(node, &node_own);
  MPI_Comm_size(node, &node_count);
  /* Only the first rank prints results. */
  if (own > 0 && freopen("/dev/null", "w", stdout) == NULL) fclose(stdout);
}

int ranks_end(enum status status) {
  MPI_Request all;
  int here = 0;
  if (status != STATUS_OK && own == 0) log_pending_error();
  MPI_Ibarrier(MPI_COMM_WORLD, &all);
  const double started = clock_seconds();
  for (MPI_Test(&all, &here, MPI_STATUS_IGNORE); !here; MPI_Test(&all, &here, MPI_STATUS_IGNORE)) {
    if (status != STATUS_OK && clock_seconds() - started > ABORT_DELAY) {
      if (own > 0) fprintf(stderr, "%s: rank %d: %s\n", log_program(), own, error_message());
      MPI_Abort(MPI_COMM_WORLD, (int)status);
    }
    usleep(1000);
  }
  /* MPI_Finalize also ends HDF5, which crashes on a file left half closed by a full disk. */
  if (status != STATUS_OK) MPI_Abort(MPI_COMM_WORLD, (int)status);
  MPI_Finalize();
  free(pending);
  return (int)status;
}

int ranks_count(void) {
  return count;
}
int ranks_own(void) {
  return own;
}

void ranks_sum_all(double *values, size_t n) {
  if (count == 1) return;
  wait_begin();
  MPI_Allreduce(MPI_IN_PLACE, values, (int)n, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  traffic.reductions++;
  wait_end();
}

void ranks_max_all(double *values, size_t n) {
  if (count == 1) return;
  wait_begin();
  MPI_Allreduce(MPI_IN_PLACE, values, (int)n, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  traffic.reductions++;
  wait_end();
}

void ranks_sum_whole(int64_t *values, size_t n) {
  if (count == 1) return;
  wait_begin();
  for (size_t done = 0; done < n; done += INT_MAX) {
    const size_t piece = n - done < INT_MAX ? n - done : INT_MAX;
    MPI_Allreduce(MPI_IN_PLACE, values + done, (int)piece, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  }
  traffic.reductions++;
  traffic.gathered_bytes += n * sizeof *values;
  wait_end();
}

void ranks_swap_counts(const size_t *send, size_t *receive) {
  wait_begin();
  MPI_Alltoall(send, sizeof *send, MPI_BYTE, receive, sizeof *send, MPI_BYTE, MPI_COMM_WORLD);
  traffic.reductions++;
  wait_end();
}

/* The first of the ranks with the most severe status broadcasts its error message. */
enum status ranks_agree(enum status status) {
  char cause[512];
  const int worst = (int)ranks_max((double)status);
  if (worst == 0 || count == 1) return status;
  const int first = count - 1 - (int)ranks_max((int)status == worst ? count - 1 - own : 0);
  snprintf(cause, sizeof cause, "%s", error_message());
  MPI_Bcast(cause, sizeof cause, MPI_BYTE, first, MPI_COMM_WORLD);
  return status == STATUS_OK ? FAIL((enum status)worst, "%s", cause) : status;
}

size_t ranks_offset(size_t mine, size_t *total) {
  uint64_t value = mine, before = 0, sum = mine;
  if (count > 1) {
    wait_begin();
    MPI_Exscan(&value, &before, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(&value, &sum, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    traffic.reductions += 2;
    wait_end();
  }
  *total = sum;
  return own == 0 ? 0 : before;
}

void ranks_gather(void *data, const size_t *start, size_t size) {
  if (count == 1) return;
  wait_begin();
  /* Ranks broadcast their items one after another. */
  for (int r = 0; r < count; r++) {
    char *from = (char *)data + start[r] * size;
    for (size_t left = (start[r + 1] - start[r]) * size; left > 0;) {
      const int piece = (int)(left < MESSAGE_BYTES_MAX ? left : MESSAGE_BYTES_MAX);
      MPI_Bcast(from, piece, MPI_BYTE, r, MPI_COMM_WORLD);
      if (r != own) traffic.gathered_bytes += (uint64_t)piece;
      from += piece;
      left -= (size_t)piece;
    }
  }
  wait_end();
}

/* An anonymous file in memory, which the other ranks on this machine open through /proc of its
 * creator; -1 on failure. */
static int open_shared_memory(size_t bytes) {
  struct {
    pid_t process;
    int file;
  } of = {getpid(), -1};
  struct rlimit most;
  if (node_own == 0 && getrlimit(RLIMIT_FSIZE, &most) == 0 && bytes <= most.rlim_cur) {
    of.file = memfd_create("tosui", MFD_CLOEXEC);
    if (of.file >= 0 && ftruncate(of.file, (off_t)bytes) != 0) {
      close(of.file);
      of.file = -1;
    }
  }
  const int made = of.file;
  char path[64];
  MPI_Bcast(&of, sizeof of, MPI_BYTE, 0, node);
  if (node_own == 0 || of.file < 0) return made;
  snprintf(path, sizeof path, "/proc/%ld/fd/%d", (long)of.process, of.file);
  return open(path, O_RDWR | O_CLOEXEC);
}

enum status node_allocate(void *pointer, size_t items, size_t size, const char *what) {
  size_t bytes;
  void *none = NULL;
  memcpy(pointer, &none, sizeof none);
  if (count == 1 || !size_multiply(items, size, &bytes) || bytes == 0)
    return memory_allocate(pointer, items, size, what);
  const int file = open_shared_memory(bytes);
  enum status status = STATUS_OK;
  if (ranks_any(file < 0))
    status = memory_allocate(pointer, items, size, what);
  else
    status = memory_map(pointer, file, bytes, bytes / (size_t)node_count, what);
  status = ranks_agree(status);
  if (file >= 0) close(file);
  if (status != STATUS_OK) memory_free(pointer);
  return status;
}

void node_share(void *data, const size_t *start, size_t size) {
  if (count == 1 || data == NULL) return;
  /* Ranks on one machine write to the same shared memory. */
  if (ranks_any(!memory_is_mapped(data) || node_count < count)) ranks_gather(data, start, size);
  MPI_Barrier(MPI_COMM_WORLD);
}

/* A free entry in the list of pending requests. */
static MPI_Request *next_pending(void) {
  if (pending_count == pending_room) {
    pending_room = 2 * pending_room + 64;
    MPI_Request *more = realloc(pending, (size_t)pending_room * sizeof *pending);
    if (more == NULL) MPI_Abort(MPI_COMM_WORLD, STATUS_RUN);
    pending = more;
  }
  return &pending[pending_count++];
}

/* Messages between two ranks keep their order, so that the pieces of a long message arrive in
 * sequence. */
void ranks_send(const void *from, size_t bytes, int rank, int tag) {
  const char *next = from;
  traffic.messages++;
  traffic.bytes += bytes;
  do {
    const size_t piece = bytes < MESSAGE_BYTES_MAX ? bytes : MESSAGE_BYTES_MAX;
    MPI_Isend(next, (int)piece, MPI_BYTE, rank, tag, MPI_COMM_WORLD, next_pending());
    next += piece;
    bytes -= piece;
  } while (bytes > 0);
}

void ranks_receive(void *to, size_t bytes, int rank, int tag) {
  char *next = to;
  do {
    const size_t piece = bytes < MESSAGE_BYTES_MAX ? bytes : MESSAGE_BYTES_MAX;
    MPI_Irecv(next, (int)piece, MPI_BYTE, rank, tag, MPI_COMM_WORLD, next_pending());
    next += piece;
    bytes -= piece;
  } while (bytes > 0);
}

void ranks_wait(void) {
  wait_begin();
  MPI_Waitall(pending_count, pending, MPI_STATUSES_IGNORE);
  pending_count = 0;
  wait_end();
}

struct ranks_traffic ranks_traffic(void) {
  traffic.busy = processor_seconds(CLOCK_PROCESS_CPUTIME_ID) - traffic.spun;
  return traffic;
}
#endif
