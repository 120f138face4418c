/* Stream function of a seepage field, and lines of equal value. */
#ifndef TOSUI_ANALYZE_SEEPAGE_FLOW_NET_H
#define TOSUI_ANALYZE_SEEPAGE_FLOW_NET_H

#include <stdio.h>

#include "analyze/seepage/head_field.h"

/* psi [nz + 1][nx + 1] at the cells' corners, m^2/s: u = d psi/dz, w = -d psi/dx; the flow between
 * two corners is the difference. NAN where no wet soil is near; 0 is its least value. Free with
 * memory_free. */
enum status flow_net_stream(const struct head_field *field, double **psi);

/* Pieces of the line value = level as gnuplot's data ("x z", pairs, empty lines between), of
 * values on nx x nz points that stand (i + offset) dx, (k + offset) dz; squares with a NAN are left
 * out. */
void flow_net_contour(const double *values, size_t nx, size_t nz, double dx, double dz,
                      double offset, double level, FILE *stream);

#endif
