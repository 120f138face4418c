/* Measures a weak fringe, where the edge response alone does not tell it from a narrower blur. */
#ifndef TOSUI_CT2MODEL_SCANNER_FRINGE_H
#define TOSUI_CT2MODEL_SCANNER_FRINGE_H

#include "common/error.h"
#include "ct2model/scanner/edge_response.h"
#include "ct2model/scanner/windows.h"

/* How the surfaces of a scan are found (contrast to noise, range of the edge fit in voxels), and
 * its noise: standard deviation over the contrast, and correlation length in voxels. */
struct fringe_request {
  double contrast_to_noise, reach, noise, length;
};

/* Refines `fit`, which explains `seen`, the measured response of all windows, with hardly any
 * fringe. It is replaced by the fringe, possibly 0, and the blur with which a scan simulated from
 * the same grains resembles this one best; it is left unchanged where a simulated response cannot
 * be fitted. `ratio`: estimated blur over the apparent one, to start from. */
enum status fringe_find(const struct windows *scan, const struct edge_response *seen,
                        const struct fringe_request *request, double ratio, struct edge_fit *fit);

#endif
