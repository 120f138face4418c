/* k of the page, its uncertainty, what it is good for, and what would lessen its error. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_VERDICT_H
#define TOSUI_ANALYZE_REPORT_PAGE_VERDICT_H

#include <jansson.h>
#include <stdbool.h>

#include "analyze/run_file.h"

/* Results of the runs, one for each body, fluid, method and wall; runs that differ only in spacing
 * give one result. `darcy` and `converge` are the JSON of these analyses, or NULL. A new array of
 * {"name", "from", "path", "k_m_per_s", "k_low_m_per_s", "k_high_m_per_s", "k_relative_error",
 * "intrinsic_permeability_m2", "spacing_m", "error_budget", "dlnk_dvoid_ratio"}, of which the page
 * shows the first; empty without a k. "from" is "lattices" of one run, "extrapolated" over the
 * spacings of several, "too_near" or "scattered" where these do not allow it, "gradients", or "".
 */
json_t *verdict_results(const struct run *runs, size_t n, const json_t *darcy,
                        const json_t *converge);

/* Whether two runs have the same body, at any spacing: equal lengths but for rounding, and equal
 * porosity. */
bool verdict_one_body(const struct run *a, const struct run *b);

/* Voxel size of the scan of a run's model, m; NAN: unknown. */
double verdict_scanned_voxel(const struct run *run);

/* Adds to the first result "good_for" and "advice". Voxels finer than those that were `scanned`
 * have no more information. */
void verdict_judge(json_t *results, const struct run *run, double scanned);

#endif
