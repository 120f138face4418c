/* Messages for people while a program runs, on stderr. The programs themselves write results to
 * stdout. */
#ifndef TOSUI_COMMON_LOG_H
#define TOSUI_COMMON_LOG_H

#include <stdbool.h>
#include <stdint.h>

enum log_level { LOG_QUIET = 0, LOG_NORMAL = 1, LOG_VERBOSE = 2 };

/* `program` stands in front of warnings and errors. Not copied. */
void log_start(const char *program, enum log_level level);
const char *log_program(void);
enum log_level log_level(void);

/* A line on stderr, unless --quiet; log_verbose only with --verbose. */
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_verbose(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* "PROGRAM: warning: ..."; shown at every level but quiet. */
void log_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* "PROGRAM: MESSAGE" from the pending error; with --verbose also its trail. */
void log_pending_error(void);

/* Seconds on a monotonic clock. */
double clock_seconds(void);
/* Processor time of this process, summed over its threads, in s. */
double clock_processor_seconds(void);

/* Progress with rate and remaining time: a line that is overwritten on a terminal, one line every
 * 10 s elsewhere, nothing with --quiet. Without a `unit` no rate is shown. `note` (may be NULL) is
 * appended, e.g. "k 0.154 cm/s, density +1.2 %". */
struct progress {
  const char *what, *unit;
  double total, started, last;
  bool terminal, shown;
};
void progress_start(struct progress *progress, const char *what, const char *unit, double total);
void progress_update(struct progress *progress, double done, const char *note);
void progress_end(struct progress *progress);

#endif
