/* Windows of a scan whose grains are restored by deblurring. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAIN_WINDOWS_H
#define TOSUI_CT2MODEL_SCANNER_GRAIN_WINDOWS_H

#include "ct2model/scanner/blur_and_noise.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/windows.h"

/* Restores the grains of a window under `scanner` and sets `distance` to the distances to their
 * surface, in shortest voxel edges, limited to WALL_RANGE. `deblur`: space for the voxels of
 * the window. */
enum status grain_window(const struct window *window, const double stretch[3],
                         const struct deblur_scanner *scanner, struct deblur *deblur,
                         float *distance);
/* Every windows_step()th window of `scan` with the distances to its restored surfaces, and without
 * greys. Blur, fringe, noise and levels of `scanner` must be known. Free with windows_end, on
 * failure too. */
enum status grain_windows(const struct windows *scan, const struct scanner *scanner,
                          struct windows *grains);

#endif
