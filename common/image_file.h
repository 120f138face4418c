/* Lattice points as VTKHDF 1.0 ImageData, as read by ParaView: an array [z][y][x] for each field
 * under /VTKHDF/PointData. */
#ifndef TOSUI_COMMON_IMAGE_FILE_H
#define TOSUI_COMMON_IMAGE_FILE_H

#include <stddef.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* Writes the header: number of points, spacing and position of the first point (m), each in the
 * order x, y, z. The fields are added by h5_write or as links. */
enum status image_file_begin(struct h5_file *file, const size_t size[3], const double spacing[3],
                             const double origin[3]);

#endif
