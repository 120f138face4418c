/* Windows of a scan, in which its scanner is measured; and the same windows of a scan that is made
 * up, whose scanner is known. */
#ifndef TOSUI_CT2MODEL_SCANNER_WINDOWS_H
#define TOSUI_CT2MODEL_SCANNER_WINDOWS_H

#include "ct2model/scan/region.h"

struct grey_phases;

enum { WINDOWS = 6 };

/* One window of the scan, greys 0 in the pore and 1 in the grain. */
struct window {
  size_t first[3], size[3];
  float *grey, *smooth, *distance, *work;
};

struct windows {
  const struct region *region;
  double stretch[3], unit, pore, grain;
  size_t count;
  struct window window[WINDOWS];
};

size_t window_voxels(const struct window *window);
/* From corner to corner of the region. Free with windows_end, on failure too. */
enum status windows_read(const struct region *region, const struct grey_phases *phases,
                         struct windows *windows);
void windows_end(struct windows *windows);
/* One window in the middle, of up to `side` voxels a side; likewise. */
enum status windows_read_middle(const struct region *region, const struct grey_phases *phases,
                                size_t side, struct windows *windows);
/* The greys that are `pore` and `grain` become 0 and 1. */
void windows_take_levels(struct windows *windows, double pore, double grain);
/* The greys smoothed as their noise asks for, and the distances to where they are 1/2, at most
 * `limit`. */
enum status windows_find_surfaces(struct windows *windows, double contrast_to_noise, double limit);
/* The darkest and the brightest grey, where the scan is cut off there: noise beyond is seen as that
 * grey, and more voxels have it than the one next to it. Elsewhere infinite. */
void windows_find_ends(const struct windows *windows, double ends[2]);
/* No voxel is known to lie deeper than the window's side is far. */
void windows_bound_depth(struct windows *windows);
/* What is made up is every so many of the windows, three at most. */
size_t windows_step(const struct windows *scan);
/* Those windows with the grains of `scan`, as its distances show them (a voxel's share
 * of grain is 1/2 less its distance, within 0 and 1), under a scanner of that blur, noise and
 * length of the noise's correlation (voxels, of the contrast, voxels). The same noise at every
 * call, its negative where `noise` is below 0. Free with windows_end, on failure too. */
enum status windows_make_up(const struct windows *scan, double blur, double fringe, double noise,
                            double length, struct windows *made);

#endif
