/* The report: one self-contained HTML page with everything that the runs support. Its markup,
 * style and script are page.html, page.js, page_solid.js and, of all pages of Tosui,
 * common/page.css, page_charts.js and page_maps.js; what it shows is one block of JSON in it
 * (docs/analyze.md). */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_H
#define TOSUI_ANALYZE_REPORT_PAGE_H

#include <jansson.h>
#include <stddef.h>

#include "analyze/run_file.h"

/* Writes the page to `path`, atomically, and its numbers, all of its JSON but "pictures", into
 * *json (a new object). `solutes`: files of solutes in the flows of the runs (solute_flow.h).
 * `command_line` is shown at the foot of the page. */
enum status report_write(const struct run *runs, size_t n, const char *const *solutes,
                         size_t solute_count, const char *path, const char *command_line,
                         json_t **json);

#endif
