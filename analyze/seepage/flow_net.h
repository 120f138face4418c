/* Stream function of a seepage field, and lines of equal value. */
#ifndef TOSUI_ANALYZE_SEEPAGE_FLOW_NET_H
#define TOSUI_ANALYZE_SEEPAGE_FLOW_NET_H

#include <stdio.h>

#include "analyze/seepage/head_field.h"

/* Stream function psi [nz + 1][nx + 1] at the corners of the cells, m^2/s: u = d psi/dz, w = -d
 * psi/dx, so that the flow between two corners is the difference. NAN away from wet soil; the least
 * value is 0. Free with memory_free. */
enum status flow_net_stream(const struct head_field *field, double **psi);

/* Writes the line value = level as separate segments in gnuplot's format ("x z" pairs, empty lines
 * between), from values on nx x nz points at ((i + offset) dx, (k + offset) dz). Squares with a NAN
 * are skipped. */
void flow_net_contour(const double *values, size_t nx, size_t nz, double dx, double dz,
                      double offset, double level, FILE *stream);

#endif
