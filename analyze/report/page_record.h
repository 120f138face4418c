/* Record of a run for the report: effects, timings, scene and provenance. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_RECORD_H
#define TOSUI_ANALYZE_REPORT_PAGE_RECORD_H

#include <stddef.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Tables of effects and timings of a run. */
enum status page_effects(const struct run *run, FILE *stream);
/* Everything needed to repeat a run of flow or of a solute: all numbers of /run, the scene,
 * versions, hashes. */
enum status page_provenance(const char *name, const char *path, FILE *stream);

#endif
