/* Windows of a scan in which the properties of its scanner are measured; and the same windows of a
 * simulated scan, whose scanner is known. */
#ifndef TOSUI_CT2MODEL_SCANNER_WINDOWS_H
#define TOSUI_CT2MODEL_SCANNER_WINDOWS_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/scanner.h"

struct grey_phases;

/* Largest number of windows. */
enum { WINDOWS = 6 };

/* One window of the scan: its first voxel in the region and its size. Arrays [z][y][x]: grey, 0 in
 * pores and 1 in grains; smoothed grey; signed distance to the surface, in shortest voxel edges,
 * positive in pores; work space. */
struct window {
  size_t first[3], size[3];
  float *grey, *smooth, *distance, *work;
};

struct windows {
  const struct region *region;
  double stretch[3];  /* voxel edges over the shortest one */
  double unit;        /* m: the shortest voxel edge */
  double pore, grain; /* greys of the region that are 0 and 1 in the windows */
  size_t count;
  struct window window[WINDOWS];
};

size_t window_voxels(const struct window *window);
/* Reads up to WINDOWS windows, spread from corner to corner of the region. Free with windows_end,
 * on failure too. */
enum status windows_read(const struct region *region, const struct grey_phases *phases,
                         struct windows *windows);
void windows_end(struct windows *windows);
/* Reads one window in the middle of the region, of up to `side` voxels a side. Free with
 * windows_end, on failure too. */
enum status windows_read_middle(const struct region *region, const struct grey_phases *phases,
                                size_t side, struct windows *windows);
/* Rescales the greys so that `pore` and `grain`, greys of the windows, become 0 and 1. */
void windows_rescale(struct windows *windows, double pore, double grain);
/* Smooths the greys as far as their noise requires, and finds the distances to the surface where
 * they are 1/2, limited to `limit` (shortest voxel edges). */
enum status windows_find_surfaces(struct windows *windows, double contrast_to_noise, double limit);
/* The darkest and the brightest grey if the scan is clipped there, that is if more voxels have it
 * than the next grey; otherwise -infinity and
 * infinity. */
void windows_find_clipping(const struct windows *windows, double ends[2]);
/* Limits depths to the distance to the side of the window, as there may be a surface beyond. */
void windows_bound_depth(struct windows *windows);
/* Simulations use every windows_step()th window, three at most. */
size_t windows_step(const struct windows *scan);
/* Simulates these windows: the grains of `scan`, as its distances show them (the share of grain in
 * a voxel is 1/2 minus its distance, limited to 0 and 1), imaged by a scanner with the given blur
 * (voxels), fringe, noise (standard deviation over the contrast) and correlation length of the
 * noise (voxels). The noise is the same at every call, and its negative if `noise` is negative.
 * Free with windows_end, on failure too. */
enum status windows_simulate(const struct windows *scan, double blur, double fringe, double noise,
                             double length, struct windows *made);
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
