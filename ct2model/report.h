/* The results of ct2model: text for people, JSON for programs. */
#ifndef TOSUI_CT2MODEL_REPORT_H
#define TOSUI_CT2MODEL_REPORT_H

#include <jansson.h>

#include "common/error.h"
#include "common/options.h"
#include "ct2model/state.h"

/* The results as a new object, as --json prints them. */
json_t *report_json(const struct pipeline *pipeline, const struct options *options);
/* Prints the results to stdout, with --json as one object, which contains the table of a sweep. The
 * object of a coarser model is added to the array `key` ("coarser") of *first, that of the finest
 * model, which the caller prints with report_end. */
enum status report_print(const struct pipeline *pipeline, const struct options *options,
                         const char *key, json_t **first);
/* Prints and frees *first if it is not NULL. */
enum status report_end(json_t **first);

#endif
