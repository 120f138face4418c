#include "common/interrupt.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"
#include "common/ranks.h"

static volatile sig_atomic_t requested;
static atomic_long queries_left; /* for tests: queries left until one is answered with yes */
static char notice[256];

static void on_signal(int number) {
  if (requested) {
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  requested = 1;
  /* Of the output functions only write(2) may be called in a signal handler. */
  const ssize_t ignored = write(STDERR_FILENO, notice, strlen(notice));
  (void)ignored;
}

void interrupt_start(const char *doing) {
  notice[0] = '\0';
  if (log_level() > LOG_QUIET) {
    const char *parts[] = {isatty(STDERR_FILENO) ? "\r\033[K" : "", log_program(),
                           ": stopping: ", doing, "\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
      strncat(notice, parts[i], sizeof notice - strlen(notice) - 1);
  }
  requested = 0;
  struct sigaction action = {.sa_handler = on_signal};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

bool interrupt_requested(void) {
  if (atomic_load_explicit(&queries_left, memory_order_relaxed) > 0 &&
      atomic_fetch_sub(&queries_left, 1) == 1)
    requested = 1;
  return requested != 0;
}

bool interrupt_came(void) {
  return requested != 0;
}

bool interrupt_alone(void) {
  return ranks_count() == 1 && interrupt_requested();
}

enum status interrupt_look(void) {
  return interrupt_alone() ? FAIL(STATUS_INTERRUPTED, "interrupted") : STATUS_OK;
}

long interrupt_after(long n) {
  requested = 0;
  return atomic_exchange(&queries_left, n);
}
