/* Region of interest: the part of the scan to which the measured void ratio refers, without
 * container walls and surrounding air. In voxels of the whole stack. */
#ifndef TOSUI_CT2MODEL_SCAN_ROI_H
#define TOSUI_CT2MODEL_SCAN_ROI_H

#include <stddef.h>

#include "common/error.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

enum roi_kind { ROI_NONE, ROI_BOX, ROI_CYLINDER, ROI_MASK };

struct roi {
  enum roi_kind kind;
  double value[6];  /* box: x0, y0, z0, nx, ny, nz; cylinder along z: centre x, centre y, radius */
  const char *path; /* mask: a stack of the same size, 0 outside; points into the parsed text */
};

/* Parses "box:X0,Y0,Z0,NX,NY,NZ", "cylinder:CX,CY,R" or "mask:PATH"; usage errors. */
enum status roi_parse(const char *text, struct roi *roi);
/* Adds to `histogram` the greys of all voxels of the stack whose centre is inside; `region` gives
 * the stack and the scale of greys. An input error if nothing is inside or the mask has another
 * size. */
enum status roi_count(const struct roi *roi, const struct region *region,
                      struct grey_histogram *histogram);

#endif
