/* Slices as grey image files that say how big a voxel is. */
#ifndef TOSUI_DATA_SAMPLES_SLICE_WRITER_H
#define TOSUI_DATA_SAMPLES_SLICE_WRITER_H

#include "common/error.h"

enum slice_format { SLICE_TIFF16, SLICE_PNG8 };

/* Writes grey [ny][nx], 0 to 255, as DIR/slice_NNNN.tif (16 bit, grey * 256, resolution in pixels
 * per centimetre) or .png (8 bit, pixels per metre). `voxel` in m. */
enum status slice_write(const char *folder, long index, enum slice_format format, const float *grey,
                        long nx, long ny, double voxel);

/* Makes the folder, and removes slices that an earlier run left there. */
enum status slice_folder_prepare(const char *folder);

#endif
