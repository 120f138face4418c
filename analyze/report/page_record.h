/* What a run did and where it comes from, for the report: effects, timings, scene and
 * provenance. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_RECORD_H
#define TOSUI_ANALYZE_REPORT_PAGE_RECORD_H

#include <stddef.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Tables of effects and timings of one run. */
enum status page_effects(const struct run *run, FILE *stream);
/* Everything needed to repeat one run, of flow or of a solute: every number of /run, the scene,
 * versions, hashes. */
enum status page_provenance(const char *name, const char *path, FILE *stream);

#endif
