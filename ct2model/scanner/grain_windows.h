/* Windows of a scan with their grains restored from under the scanner's blur. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAIN_WINDOWS_H
#define TOSUI_CT2MODEL_SCANNER_GRAIN_WINDOWS_H

#include "ct2model/scanner/blur_and_noise.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/windows.h"

/* Voxels: shares of grain further from walls are 0 and 1. */
#define GRAIN_WINDOW_FAR 0.5

/* `distance` of a window, in voxels times `stretch` and at most GRAIN_WINDOW_FAR, becomes that
 * to the surfaces restored of its greys under `scanner`. `deblur`: room for its voxels. */
enum status grain_window(const struct window *window, const double stretch[3],
                         const struct deblur_scanner *scanner, struct deblur *deblur,
                         float *distance);
/* Every windows_step of them with such distances, and no greys, under a scanner of which blur,
 * fringe, noise and levels are known. Free with windows_end, on failure too. */
enum status grain_windows(const struct windows *scan, const struct scanner *scanner,
                          struct windows *grains);

#endif
