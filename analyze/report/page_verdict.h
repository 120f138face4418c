/* The head of the page: what k is, how well it is known, what that is good for, and what other
 * formulas would say. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_VERDICT_H
#define TOSUI_ANALYZE_REPORT_PAGE_VERDICT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/analysis.h"
#include "analyze/report/page_model.h"
#include "analyze/run_file.h"

/* The results of the runs, one for each body, fluid, method and wall: runs that differ in spacing
 * alone are one result. `darcy` and `converge` are those analyses' JSON, NULL where they are not.
 * A new array of {"name", "note", "path", "k_m_per_s", "k_low_m_per_s", "k_high_m_per_s",
 * "k_relative_error", "intrinsic_permeability_m2", "spacing_m", "error_budget",
 * "dlnk_dvoid_ratio"}, the first the page's own; empty without a k. */
json_t *verdict_results(const struct run *runs, size_t n, const json_t *darcy,
                        const json_t *converge);

/* Whether two runs are of one body at whatever spacing: equal lengths but for rounding, and
 * porosity.
 */
bool verdict_one_body(const struct run *a, const struct run *b);

/* Adds to the first result what it is good for: "good_for", "class_din", "class_casagrande",
 * "advice", "formulas" {"kozeny_carman", "hazen", "terzaghi"} in m/s. */
void verdict_judge(json_t *results, const struct run *run, const struct page_model *model);

/* The card, with the tensor of its body if a run holds one, and a table of further results.
 * `data`: JSON of the analyses by their names, `verdict` among them; without a result of that the
 * card of `seepage` or `moisture` of the first run, if it is there, or why there is none. */
enum status verdict_write(const json_t *data, const struct subject *subject, FILE *stream);

#endif
