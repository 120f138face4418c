/* The scan without its blur and noise as what the model is made of: levels of the share of grain,
 * and the one among them at which the surface lies. */
#ifndef TOSUI_CT2MODEL_SCANNER_RESTORED_H
#define TOSUI_CT2MODEL_SCANNER_RESTORED_H

#include <stdbool.h>

#include "ct2model/resample/resample.h"
#include "ct2model/scan/enclosed.h"
#include "ct2model/scanner/scanner.h"
#include "ct2model/surface/coarse.h"

struct restored {
  struct coarse scan; /* no levels: the scan is left as it is */
  double threshold;   /* the level at which walls enclose the void ratio */
  double middle;      /* void ratio at the level in the middle: where its own edges lie */
  double void_ratio;  /* that they do enclose */
};

/* Takes `blur` (m) out. No levels come back, with a warning, where the edges of the scan do not
 * allow that void ratio or memory would not hold it. `reflect`: axes that will be mirrored. Free
 * with restored_end. */
enum status restored_take(const struct region *region, const struct scanner *scanner, double blur,
                          double void_ratio, const struct enclosed_sides *sides,
                          struct restored *restored);
void restored_end(struct restored *restored);
/* As a region of levels. */
struct region restored_region(const struct restored *restored, const struct region *region);
/* Resampled into volume[size z][size y][size x], by a filter that takes rows. */
enum status restored_resample(const struct restored *restored, enum filter filter,
                              const size_t size[3], float *volume);

#endif
