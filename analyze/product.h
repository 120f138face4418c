/* The output of an analysis: JSON, CSV, charts or a picture, and a summary. `analyze` (stdout, a
 * folder) or the report decides where it goes. */
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
  FILE *stream; /* for fprintf; text_finish makes `data` valid */
};
enum status text_start(struct text *text);
enum status text_finish(struct text *text);
void text_free(struct text *text);

struct product {
  const char *name; /* "darcy" */
  json_t *json;     /* an object */
  json_t *charts;   /* an array: chart.h */
  struct text csv, summary;
  struct text plot;  /* a gnuplot script of a picture that is no chart */
  int width, height; /* of the plot, pixels; no plot while width is 0 */
};

/* Starts with an empty JSON object and open texts. Free with product_free; `name` is not copied. */
enum status product_start(const char *name, struct product *product);
/* Ends writing: from here on the data of the texts are valid, and `plot` draws the charts, too. */
enum status product_finish(struct product *product);
void product_free(struct product *product);

/* Writes FOLDER/NAME.{json,csv,gp} and, by gnuplot, NAME.svg and NAME.png. The folder is created.
 * Without gnuplot there is a warning and the other files are written. */
enum status product_save(const struct product *product, const char *folder);

/* Appends the JSON of one of n runs to "runs"; for a single run its members are also added at the
 * top level. Takes ownership of `object`. */
void product_add_run(struct product *product, json_t *object, size_t n);

/* A CSV field, quoted where it must be (RFC 4180); an apostrophe stands before what a spreadsheet
 * would take for a formula. */
void csv_text(FILE *stream, const char *text);
/* A number with so many digits, below a million without an exponent: 1930, 300, 0.048. */
const char *short_number(double value, int digits, char text[32]);
/* "0.1540 +- 0.0021", "(1.004 +- 0.079)e-04": both with the digits that are significant by the
 * error; "0.154" if it is unknown. */
void value_with_error(char *text, size_t size, double value, double error, const char *sign);
/* "0.1540 +- 0.0021 cm/s (1.4 %)" with the digits that are significant by the error; `sign` is
 * "+-", `unit` " cm/s". */
void write_value_with_error(FILE *stream, double value, double error, const char *sign,
                            const char *unit);

/* 0.0012 as "0.12 %", 6.8 as "680 %": never with an exponent. */
void write_percent(FILE *stream, double share);

/* Prints a JSON value on stdout. */
void product_print_json(const json_t *json);

#endif
