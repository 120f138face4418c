/* Pictures for a slide: speed with streamlines, and pressure, as colour maps over the smooth
 * outlines of the grains. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_MAP_H
#define TOSUI_ANALYZE_REPORT_PAGE_MAP_H

#include <stdio.h>

#include "analyze/report/page_plane.h"

enum map_of { MAP_SPEED, MAP_PRESSURE };

/* One <svg class="map">, complete in itself. */
enum status map_write(const struct plane *plane, enum map_of what, FILE *stream);

/* Streamlines of the velocity in the plane, evenly spaced (after Jobard, Lefer 1997): <path>
 * elements in pixels, `scale` pixels a spacing, y downwards from `height`. */
enum status map_streamlines(const struct plane *plane, double scale, double height, FILE *stream);

#endif
