/* The ledger of a run for the report: particles and mass, and the account of momentum and energy.
 */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_LEDGER_H
#define TOSUI_ANALYZE_REPORT_PAGE_LEDGER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Whether one of the runs has an account. */
enum status page_has_ledger(const struct run *runs, size_t n, bool *any);
/* Tables of the runs that have one. */
enum status page_ledger(const struct run *runs, size_t n, FILE *stream);

#endif
