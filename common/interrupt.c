#include "common/interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"

static volatile sig_atomic_t requested;
static char said[256];

static void on_signal(int number) {
  if (requested) {
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  requested = 1;
  /* Of what a handler may call, write(2) alone says something. */
  const ssize_t ignored = write(STDERR_FILENO, said, strlen(said));
  (void)ignored;
}

void interrupt_start(const char *doing) {
  said[0] = '\0';
  if (log_level() > LOG_QUIET) {
    const char *parts[] = {isatty(STDERR_FILENO) ? "\r\033[K" : "", log_program(),
                           ": stopping: ", doing, "\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
      strncat(said, parts[i], sizeof said - strlen(said) - 1);
  }
  requested = 0;
  struct sigaction action = {.sa_handler = on_signal};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

bool interrupt_requested(void) {
  return requested != 0;
}
