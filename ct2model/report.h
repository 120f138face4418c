/* What ct2model tells: text for people, JSON for programs. */
#ifndef TOSUI_CT2MODEL_REPORT_H
#define TOSUI_CT2MODEL_REPORT_H

#include "common/error.h"
#include "common/options.h"
#include "ct2model/pipeline.h"
#include "ct2model/sweep_table.h"

/* To stdout. `table` is NULL for build. */
enum status report_print(const struct pipeline *pipeline, const struct options *options,
                         const struct sweep_table *table);

#endif
