/* A weak fringe, where the edge response alone does not tell it from a narrower blur. */
#ifndef TOSUI_CT2MODEL_SCANNER_FRINGE_H
#define TOSUI_CT2MODEL_SCANNER_FRINGE_H

#include "common/error.h"
#include "ct2model/scanner/edge_response.h"
#include "ct2model/scanner/windows.h"

/* What surfaces were found with in a scan, and its noise: standard deviation over the contrast, and
 * length (voxels). */
struct fringe_request {
  double contrast_to_noise, reach, noise, length;
};

/* `fit` explains `seen`, the response of the windows, with hardly any fringe: it becomes that of
 * the fringe, or of none, with which a scan made up of the same grains looks most like this one.
 * `ratio`: blur over the one that its response seems to have. */
enum status fringe_find(const struct windows *scan, const struct edge_response *seen,
                        const struct fringe_request *request, double ratio, struct edge_fit *fit);

#endif
