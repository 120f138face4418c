/* Parts of the error of k other than the resolution. Each is computed from additional solves, on
 * lattices that differ from those of the cascade in the property in question. */
#ifndef TOSUI_SPHSOLVE_ERROR_CASCADE_PARTS_H
#define TOSUI_SPHSOLVE_ERROR_CASCADE_PARTS_H

#include "sphsolve/error/cascade.h"

/* Whether the effect of the sides is computed at the end, because a time limit was given. */
bool cascade_sides_wait(const struct cascade *cascade);
/* Computes the change of k when pores that end at a side (or at the first or last layer, where
 * these do not match) continue into their mirror image instead of what lies at the opposite side,
 * and the effect of the walls of a tube. On one coarse lattice, refined if the effect is large. */
enum status cascade_add_sides(struct cascade *cascade);
/* Computes the sensitivity of k to the void ratio and to the voxel size of the model, on a lattice
 * of the cascade. */
enum status cascade_add_model_parts(struct cascade *cascade, const struct lattice *lattice,
                                    double spacing, double k, const struct stokes_solver *from);
/* Whether the effect of the scan is to be computed on the last lattice; and whether it will be on
 * the next, because it grew from one lattice to the next. */
bool cascade_scan_is_due(const struct cascade *cascade);
bool cascade_scan_grows(const struct cascade *cascade);
/* Computes the effect of the scanner's blur on k: the surface is blurred once more. */
enum status cascade_add_scan_part(struct cascade *cascade, const struct lattice *lattice, double k,
                                  const struct stokes_solver *from);

#endif
