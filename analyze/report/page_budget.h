/* The balance of a run for the report: particles, mass, momentum and energy. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_BUDGET_H
#define TOSUI_ANALYZE_REPORT_PAGE_BUDGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Whether any of the runs has a balance. */
enum status page_has_budget(const struct run *runs, size_t n, bool *any);
/* Tables of the runs that have one. */
enum status page_budget(const struct run *runs, size_t n, FILE *stream);

#endif
