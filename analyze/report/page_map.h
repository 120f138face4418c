/* Pictures for presentations: speed with streamlines, and pressure, as colour maps with smooth
 * outlines of the grains. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_MAP_H
#define TOSUI_ANALYZE_REPORT_PAGE_MAP_H

#include <stdio.h>

#include "analyze/report/page_plane.h"

enum map_of { MAP_SPEED, MAP_PRESSURE };

/* Writes a complete <svg class="map">. */
enum status map_write(const struct plane *plane, enum map_of what, FILE *stream);

/* Writes evenly spaced streamlines of the velocity in the plane (after Jobard, Lefer 1997) as
 * <path> elements in pixels: `scale` pixels per spacing, y downwards from `height`. */
enum status map_streamlines(const struct plane *plane, double scale, double height, FILE *stream);

#endif
