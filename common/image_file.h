/* Points of a lattice as ParaView sees them: VTKHDF 1.0 ImageData, an array [z][y][x] for each
 * field under /VTKHDF/PointData. */
#ifndef TOSUI_COMMON_IMAGE_FILE_H
#define TOSUI_COMMON_IMAGE_FILE_H

#include <stddef.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* x, y, z: points, m between them, and where the first is. Fields follow by h5_write or as links.
 */
enum status image_file_begin(struct h5_file *file, const size_t size[3], const double spacing[3],
                             const double origin[3]);

#endif
