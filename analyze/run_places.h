/* Positions of the planes and gauges of a run. */
#ifndef TOSUI_ANALYZE_RUN_PLACES_H
#define TOSUI_ANALYZE_RUN_PLACES_H

#include <stdbool.h>

#include "analyze/run_file.h"

/* Axis (0 x, 1 y, 2 z) and position (m) of a plane; false if the run file does not contain it. */
bool place_of_plane(const struct run *run, const char *name, int *axis, double *place);
/* Position (m) of a gauge; false if the run file does not contain it. */
bool place_of_gauge(const struct run *run, const char *name, double place[3]);

#endif
