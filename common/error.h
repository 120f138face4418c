/* Errors as values. A function that can fail returns enum status; STATUS_OK is 0.
 *
 * The first failure records one message (what, where, and what to do); callers add context in
 * front of it while the status travels up. `main` prints it as one line and exits with the status,
 * which is also the exit code. The record is one per process and guarded, so that a failure inside
 * a parallel region is not lost. */
#ifndef TOSUI_COMMON_ERROR_H
#define TOSUI_COMMON_ERROR_H

enum status {
  STATUS_OK = 0,
  STATUS_RUN = 1,          /* I/O, memory */
  STATUS_USAGE = 2,        /* wrong command line */
  STATUS_INPUT = 3,        /* bad input: names the file, the line or slice, and what to do */
  STATUS_NUMERIC = 4,      /* numerical failure */
  STATUS_INTERRUPTED = 130 /* SIGINT, SIGTERM */
};

/* Records a failure and returns `status`. While a failure is pending, a second one is dropped: the
 * first is the cause. */
enum status error_set(enum status status, const char *file, int line, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Puts "context: " in front of the pending message. Returns `status`. */
enum status error_context(enum status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Notes that the pending failure passed through file:line (shown by --verbose). */
void error_trace(const char *file, int line);

/* The pending message, "" if none; and the trail "file:line < file:line ...". */
const char *error_message(void);
const char *error_trail(void);

/* Forgets the pending failure, for callers that recover from it. */
void error_clear(void);

/* `return FAIL(STATUS_INPUT, "%s: ...", path);` The value is repeated here so that static analysers
 * see it. */
#define FAIL(code, ...) (error_set((code), __FILE__, __LINE__, __VA_ARGS__), (enum status)(code))

/* Forwards a failure to the label `cleanup` of a function that has `enum status status`. */
#define TRY(expression)                                                                            \
  do {                                                                                             \
    status = (expression);                                                                         \
    if (status != STATUS_OK) {                                                                     \
      error_trace(__FILE__, __LINE__);                                                             \
      goto cleanup;                                                                                \
    }                                                                                              \
  } while (0)

/* Records a new failure and goes to the label `cleanup`. */
#define TRY_FAIL(code, ...)                                                                        \
  do {                                                                                             \
    status = FAIL((code), __VA_ARGS__);                                                            \
    goto cleanup;                                                                                  \
  } while (0)

#endif
