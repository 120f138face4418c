/* Restores the share of grain in each voxel from a blurred and noisy scan: of all images between 0
 * (pore) and 1 (grain) the one with the least surface that, blurred by the scanner, explains the
 * scan to within its noise. */
#ifndef TOSUI_CT2MODEL_SCANNER_RESTORE_H
#define TOSUI_CT2MODEL_SCANNER_RESTORE_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/surface/coarse.h"

/* Properties of the scanner as deblur_start expects them, with no weight of two phases. */
void restore_scanner(const struct region *region, const struct scanner *scanner, double blur,
                     struct deblur_scanner *work);

/* A scan that is restored in blocks, each with a part of its neighbours, one after the other: of
 * the scan only its levels, 0 to 255 for shares 0 to 1, and one block are held. The blocks follow
 * from the size of the scan and the blur, not from memory or threads, and so does the result. */
struct restore {
  const struct region *region;
  size_t count[3], overlap[3]; /* blocks along each axis; voxels of neighbours on either side */
  size_t beyond[3];            /* voxels beyond the faces of the scan, as in deblur.h */
  struct coarse levels;        /* histogram: of the blocks restored */
};

/* A block without its neighbours' parts: its first voxel in the scan, and its size. */
struct restore_block {
  size_t first[3], size[3];
};

/* Chooses the blocks, of up to `voxels` voxels with their neighbours' parts (RESTORE_VOXELS unless
 * tested), and the sample: a few of them, spread over the scan; all of a small scan. Free with
 * coarse_end(&restore->levels), on failure too. */
enum status restore_start(const struct region *region, double blur, double voxels,
                          struct restore *restore);
/* Number of blocks in the sample, and block number `i` of it. */
size_t restore_sampled(const struct restore *restore);
struct restore_block restore_sample_block(const struct restore *restore, size_t i);
/* Restores the sample, or all other blocks. `two_phases`: as in deblur.h. */
enum status restore_sample(struct restore *restore, const struct scanner *scanner,
                           double two_phases);
enum status restore_others(struct restore *restore, const struct scanner *scanner,
                           double two_phases);

#endif
