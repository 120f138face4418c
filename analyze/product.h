/* What an analysis leaves: JSON, CSV, a gnuplot script and a summary for people. Where they go is
 * decided by `analyze` (stdout, a folder) or by the report. */
#ifndef TOSUI_ANALYZE_PRODUCT_H
#define TOSUI_ANALYZE_PRODUCT_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "common/error.h"
#include "common/json_number.h"

struct text {
  char *data;
  size_t size;
  FILE *stream; /* fprintf here; product_finish makes `data` valid */
};

struct product {
  const char *name; /* "darcy" */
  json_t *json;     /* an object */
  struct text csv, plot, summary;
  int width, height; /* of the plot, pixels; no plot while width is 0 */
};

/* An empty JSON object and open texts. Free with product_free; `name` is not copied. */
enum status product_start(const char *name, struct product *product);
/* Ends writing: the texts' data are valid from here on. */
enum status product_finish(struct product *product);
void product_free(struct product *product);

/* Writes FOLDER/NAME.{json,csv,gp} and, by gnuplot, NAME.svg and NAME.png. The folder is made.
 * Without gnuplot one warning says so and the rest is there. */
enum status product_save(const struct product *product, const char *folder);

/* Appends what is told of one of n runs to "runs" in the JSON; of a single run its members stand
 * beside "runs" too. Takes `object` over. */
void product_add_run(struct product *product, json_t *object, size_t n);

/* A CSV field, quoted where it must be (RFC 4180). */
void csv_text(FILE *stream, const char *text);
/* To so many digits, and below a million without an exponent: 1930, 300, 0.048. */
const char *short_number(double value, int digits, char text[32]);
/* "0.1540 +- 0.0021", "(1.004 +- 0.079)e-04": both to the digits that the error leaves sense to;
 * "0.154" where it is not known. */
void value_with_error(char *text, size_t size, double value, double error, const char *sign);
/* "0.1540 +- 0.0021 cm/s (1.4 %)", as many digits as the error leaves sense to; `sign` is "+-",
 * `unit` " cm/s". */
void write_value_with_error(FILE *stream, double value, double error, const char *sign,
                            const char *unit);

/* 0.0012 as "0.12 %", 6.8 as "680 %": never with an exponent. */
void write_percent(FILE *stream, double share);

#endif
