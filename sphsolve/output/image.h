/* The flow on the whole lattice, for slices, volumes and streamlines: PREFIX-image.hdf. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_IMAGE_H
#define TOSUI_SPHSOLVE_OUTPUT_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* Writes the image from `count` fluid sites with velocity (m/s, 3 components) and pressure (Pa);
 * walls are at rest. The distance to the wall (m) is that of the lattice. Single process only. */
enum status image_write(const char *prefix, const struct lattice *lattice, double viscosity,
                        double time, int64_t step, uint64_t flow, size_t count,
                        const uint64_t *site, const float *velocity, const float *pressure);

#endif
