/* Uncertainty of a body's volume when it is counted in the voxels of a segmented image. */
#ifndef TOSUI_CT2MODEL_SCAN_LABEL_VOLUME_H
#define TOSUI_CT2MODEL_SCAN_LABEL_VOLUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Standard error of the grains' volume fraction in grain[z][y][x] (1 grain, 0 all else). `reflect`:
 * axes that end; the others are periodic. */
enum status label_volume_error(const uint8_t *grain, const size_t size[3], const bool reflect[3],
                               double *error);

#endif
