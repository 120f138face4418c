/* The rows that a verification leaves: a JSON list of case, status, reference, measured, bound,
 * seconds, and a line a row on the terminal. Each program includes this once. */
#ifndef TOSUI_TESTS_VERIFY_ROWS_H
#define TOSUI_TESTS_VERIFY_ROWS_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/error.h"
#include "common/log.h"

static FILE *rows_file; /* NULL: to the terminal alone */
static int rows_count, rows_failed;

static inline void must(enum status status) {
  if (status == STATUS_OK) return;
  fprintf(stderr, "verification: %s\n", error_message());
  exit(1);
}

static inline void rows_open(const char *path) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  rows_file = fopen(path, "w");
  if (rows_file != NULL) return;
  fprintf(stderr, "verification: cannot write %s\n", path);
  exit(1);
}

/* The exit code of the program. */
static inline int rows_close(void) {
  if (rows_file != NULL) fprintf(rows_file, "\n]\n"), fclose(rows_file);
  printf("%d cases, %d failed\n", rows_count, rows_failed);
  return rows_failed > 0;
}

static inline void rows_number(const char *name, double value) {
  fprintf(rows_file, isfinite(value) ? ", \"%s\": %.8g" : ", \"%s\": null", name, value);
}

/* `status`: pass, fail or skip; `error` is what is held against the bound, both relative. */
static inline void rows_write(const char *name, const char *status, double reference,
                              double measured, double error, double bound, double seconds) {
  if (rows_file != NULL) {
    fprintf(rows_file, "%s{\"case\": \"%s\", \"status\": \"%s\"", rows_count ? ",\n" : "[\n", name,
            status);
    rows_number("reference", reference);
    rows_number("measured", measured);
    rows_number("bound", bound);
    rows_number("seconds", seconds);
    fputc('}', rows_file);
  }
  rows_count++;
  rows_failed += status[0] == 'f';
  printf("%-52s %-4s %12.6g %12.6g %+9.4f %% (bound %g %%) %6.2f s\n", name, status, reference,
         measured, 100 * error, 100 * bound, seconds);
}

static inline void report(const char *name, double reference, double measured, double bound,
                          double seconds) {
  const double error = measured / reference - 1;
  rows_write(name, fabs(error) <= bound ? "pass" : "fail", reference, measured, error, bound,
             seconds);
}

/* Seconds since `started` (clock_seconds). */
static inline double passed(double started) {
  return clock_seconds() - started;
}

struct verify_case {
  const char *name;
  void (*run)(void);
};

/* The main of a program PROGRAM RESULTS.json [CASE...]: all cases, or those whose names start with
 * CASE. */
static inline int rows_of_cases(int argc, char **argv, const struct verify_case *cases, size_t n) {
  if (argc < 2) return fprintf(stderr, "usage: %s RESULTS.json [CASE...]\n", argv[0]), 2;
  log_start("verification", LOG_QUIET);
  rows_open(argv[1]);
  for (size_t k = 0; k < n; k++) {
    bool wanted = argc == 2;
    for (int i = 2; i < argc; i++) wanted |= !strncmp(argv[i], cases[k].name, strlen(argv[i]));
    if (wanted) cases[k].run();
  }
  return rows_close();
}

/* What could not be measured here, as its data are missing. */
static inline void skip(const char *name, double reference, double bound) {
  rows_write(name, "skip", reference, NAN, NAN, bound, 0);
}

#endif
