/* What ct2model tells: text for people, JSON for programs. */
#ifndef TOSUI_CT2MODEL_REPORT_H
#define TOSUI_CT2MODEL_REPORT_H

#include <jansson.h>

#include "common/error.h"
#include "common/options.h"
#include "ct2model/state.h"

/* To stdout, or with --json as one object, a sweep's with its table. A coarser model's object goes
 * into the array `key` ("coarser") of *first, the finest's; the caller prints *first with
 * report_end. */
enum status report_print(const struct pipeline *pipeline, const struct options *options,
                         const char *key, json_t **first);
/* Prints and frees *first, if there is one. */
enum status report_end(json_t **first);

#endif
