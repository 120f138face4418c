#include "common/log.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "common/error.h"
#include "common/text.h"
#include "common/units.h"

static const char *program = "tosui";
static enum log_level level = LOG_NORMAL;
static bool line_is_live; /* the terminal shows a progress line without a line end */

/* Erases a progress line, so that the next message takes its place. */
static void clear_live_line(void) {
  if (line_is_live) fputs("\r\033[K", stderr);
  line_is_live = false;
}

void log_start(const char *name, enum log_level new_level) {
  program = name;
  level = new_level;
}
const char *log_program(void) {
  return program;
}
enum log_level log_level(void) {
  return level;
}

/* What a message quotes, such as a file's name, must not act on the terminal. */
static void write_line(const char *format, va_list arguments) {
  char line[4096];
  vsnprintf(line, sizeof line, format, arguments);
  text_make_plain(line);
  fputs(line, stderr);
  fputc('\n', stderr);
}

void log_info(const char *format, ...) {
  if (level < LOG_NORMAL) return;
  clear_live_line();
  va_list arguments;
  va_start(arguments, format);
  write_line(format, arguments);
  va_end(arguments);
}

void log_verbose(const char *format, ...) {
  if (level < LOG_VERBOSE) return;
  clear_live_line();
  va_list arguments;
  va_start(arguments, format);
  write_line(format, arguments);
  va_end(arguments);
}

void log_warning(const char *format, ...) {
  if (level < LOG_NORMAL) return;
  clear_live_line();
  fprintf(stderr, "%s: warning: ", program);
  va_list arguments;
  va_start(arguments, format);
  write_line(format, arguments);
  va_end(arguments);
}

void log_pending_error(void) {
  clear_live_line();
  fprintf(stderr, "%s: %s\n", program, error_message());
  if (level >= LOG_VERBOSE) fprintf(stderr, "  at %s\n", error_trail());
}

double clock_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double clock_processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_start(struct progress *progress, const char *what, const char *unit, double total) {
  progress->what = what;
  progress->unit = unit;
  progress->total = total;
  progress->started = progress->last = clock_seconds();
  progress->terminal = isatty(STDERR_FILENO) != 0;
  progress->shown = false;
}

void progress_update(struct progress *progress, double done, const char *note) {
  if (level < LOG_NORMAL) return;
  double now = clock_seconds();
  if (now - progress->last < (progress->terminal ? 0.2 : 10.0)) return;
  progress->last = now;
  double elapsed = now - progress->started;
  double fraction = progress->total > 0 ? done / progress->total : 0;
  char eta[32], rate[48] = "";
  if (progress->unit != NULL && elapsed > 0)
    snprintf(rate, sizeof rate, "  %.3g %s/s", done / elapsed, progress->unit);
  duration_format(fraction > 0 ? elapsed * (1 - fraction) / fraction : INFINITY, eta, sizeof eta);
  fprintf(stderr, "%s%s %3.0f %%%s  ETA %s%s%s%s", progress->terminal ? "\r\033[K" : "",
          progress->what, 100 * fraction, rate, eta, note ? "  " : "", note ? note : "",
          progress->terminal ? "" : "\n");
  fflush(stderr);
  progress->shown = true;
  line_is_live = progress->terminal;
}

void progress_end(struct progress *progress) {
  if (progress->shown) clear_live_line();
  progress->shown = false;
}
