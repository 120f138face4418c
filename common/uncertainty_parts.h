/* The parts that the error of k is made of: the same in sphsolve, in the attributes of /run/error,
 * and in analyze. Relative, 95 %; NAN: unknown. */
#ifndef TOSUI_COMMON_UNCERTAINTY_PARTS_H
#define TOSUI_COMMON_UNCERTAINTY_PARTS_H

#include "common/error.h"
#include "common/hdf5_file.h"

/* resolution   what the spacing of the lattice leaves
 * scan         what the scanner's blur and noise did
 * sides        how the sample's sides are closed
 * void_ratio   the model's void ratio off the measured one
 * threshold    from the uncertainty of the measured void ratio
 * micro        from the uncertainty of the permeability of soil below the voxel
 * averaging    over time
 * steadiness   the change still to come, or what the solver left
 * and beside these shares how k answers:
 * slope_void_ratio  d ln k / d e
 * slope_threshold   d ln k / d T, per grey level
 * slope_micro       d ln k / d ln of the permeability of soil below the voxel
 * sides_closed      ln k with walls at the sample's sides, less ln k
 * and
 * blur_assumed      m: where the scan told no blur, the one that `scan` is found with
 * sides_unknown     1 where `sides` was looked for on a lattice through which no pore leads */
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
extern const char *const uncertainty_part_names[UNCERTAINTY_PARTS]; /* of their attributes */

/* All parts NAN. */
struct uncertainty_parts uncertainty_parts_none(void);
/* Root of the sum of squares of the known shares, with another resolution; NAN if none is known. */
double uncertainty_parts_total(const struct uncertainty_parts *parts, double resolution);
/* Share of the sides, from k of a sample as it is wrapped and with one axis more mirrored each time
 * (0: not found). Two axes may move k by as much and cancel in their sum, which no other sample's
 * would: so it is the larger of the whole change and of the root of the sum of squares of the
 * steps; 1 where the mirrored sample is shut. NAN: not known, as the wrapped one is. */
double uncertainty_share_of_sides(const double *k, int count);
/* Attributes of `group`; what is not there is NAN. */
enum status uncertainty_parts_read(struct h5_file *file, const char *group,
                                   struct uncertainty_parts *parts);
enum status uncertainty_parts_write(const struct uncertainty_parts *parts, struct h5_file *file,
                                    const char *group);

#endif
