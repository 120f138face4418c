/* Where the planes and gauges of a run are. */
#ifndef TOSUI_ANALYZE_SEEPAGE_PLACES_H
#define TOSUI_ANALYZE_SEEPAGE_PLACES_H

#include <stdbool.h>

#include "analyze/run_file.h"

/* Axis (0 x, 1 y, 2 z) and place (m) of a plane; false where the run does not keep it. */
bool place_of_plane(const struct run *run, const char *name, int *axis, double *place);
/* Place (m) of a gauge; false where the run does not keep it. */
bool place_of_gauge(const struct run *run, const char *name, double place[3]);

#endif
