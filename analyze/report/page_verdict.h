/* The head of the page: k, its uncertainty, an assessment, and k by other formulas. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_VERDICT_H
#define TOSUI_ANALYZE_REPORT_PAGE_VERDICT_H

#include <jansson.h>
#include <stdbool.h>

#include "analyze/analysis.h"
#include "analyze/report/page_model.h"
#include "analyze/run_file.h"

/* Results of the runs, one for each body, fluid, method and wall; runs that differ only in spacing
 * give one result. `darcy` and `converge` are the JSON of these analyses, or NULL. A new array of
 * {"name", "note", "path", "k_m_per_s", "k_low_m_per_s", "k_high_m_per_s", "k_relative_error",
 * "intrinsic_permeability_m2", "spacing_m", "error_budget", "dlnk_dvoid_ratio"}, of which the page
 * shows the first; empty without a k. */
json_t *verdict_results(const struct run *runs, size_t n, const json_t *darcy,
                        const json_t *converge);

/* Whether two runs have the same body, at any spacing: equal lengths but for rounding, and equal
 * porosity. */
bool verdict_one_body(const struct run *a, const struct run *b);

/* Adds an assessment to the first result: "good_for", "class_din", "class_casagrande", "advice",
 * "formulas" {"kozeny_carman"} in m/s, "notes" [text]. */
void verdict_judge(json_t *results, const struct run *run, const struct page_model *model);

/* Adds to `data` what the page begins with, beside `verdict`: "tensor" (of the body of the first
 * result, if a run has one) and "headline" {"value", "error", "unit", "text", "sentences"}: without
 * a result the flow of `seepage`, the water of `moisture` or free water of the first run, or the
 * reason why there is no k. */
enum status verdict_headline(json_t *data, const struct subject *subject);

#endif
