/* The parts of the uncertainty of k, as used by sphsolve, stored in the attributes of /run/error
 * and read by analyze. Relative values at 95 %; NAN: unknown. */
#ifndef TOSUI_COMMON_UNCERTAINTY_PARTS_H
#define TOSUI_COMMON_UNCERTAINTY_PARTS_H

#include "common/error.h"
#include "common/hdf5_file.h"

/* resolution   spacing of the lattice
 * scan         blur and noise of the scan
 * sides        treatment of the sample's sides
 * void_ratio   difference between the void ratios of the model and the specimen
 * threshold    uncertainty of the measured void ratio
 * micro        uncertainty of the permeability of soil with pores below the voxel size
 * averaging    averaging over time
 * steadiness   change still to come, or the residual of the solver
 * The sensitivities of k:
 * slope_void_ratio  d ln k / d e
 * slope_threshold   d ln k / d T, per grey level
 * slope_micro       d ln k / d ln of the permeability of soil with pores below the voxel size
 * sides_closed      ln k with walls at the sample's sides, minus ln k
 * And:
 * blur_assumed      m: the blur used for `scan` if it could not be estimated from the scan
 * sides_unknown     1 if `sides` was estimated on a lattice through which no pore leads */
#define UNCERTAINTY_PARTS_MEMBERS                                                                  \
  double resolution, scan, sides, void_ratio, threshold, micro, averaging, steadiness;             \
  double slope_void_ratio, slope_threshold, slope_micro, sides_closed, blur_assumed, sides_unknown;

enum { UNCERTAINTY_SHARES = 8, UNCERTAINTY_PARTS = 14 };
struct uncertainty_parts {
  union {
    struct {
      UNCERTAINTY_PARTS_MEMBERS
    };
    double value[UNCERTAINTY_PARTS];
  };
};
extern const char *const uncertainty_part_names[UNCERTAINTY_PARTS]; /* names of their attributes */

/* All parts NAN. */
struct uncertainty_parts uncertainty_parts_none(void);
/* Root of the sum of squares of the known parts, with `resolution` in place of the stored one; NAN
 * if none is known. */
double uncertainty_parts_total(const struct uncertainty_parts *parts, double resolution);
/* Relative uncertainty due to the sides, from the permeabilities k[count]: k[0] of the periodic
 * sample, then each with one more axis mirrored (0: not computed). The changes along two axes may
 * cancel by chance, which they would not do in other samples. Therefore the result is the larger of
 * the total change and the root of the sum of squares of the single changes. It is 1 if no pore
 * leads through the mirrored sample, and NAN if k[0] or k[count - 1] is unknown. */
double uncertainty_share_of_sides(const double *k, int count);
/* Read from and written to attributes of `group`; missing ones are NAN. */
enum status uncertainty_parts_read(struct h5_file *file, const char *group,
                                   struct uncertainty_parts *parts);
enum status uncertainty_parts_write(const struct uncertainty_parts *parts, struct h5_file *file,
                                    const char *group);

#endif
