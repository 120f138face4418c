/* What a TIFF says of its voxels: the texts that ImageJ and OME put into its description, and its
 * resolution tags. */
#ifndef TOSUI_CT2MODEL_READERS_TIFF_DESCRIPTION_H
#define TOSUI_CT2MODEL_READERS_TIFF_DESCRIPTION_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

/* The rest of the line "key=..." of ImageJ's description; false where there is none. */
bool tiff_description_value(const char *description, const char *key, char *value, size_t size);
/* Voxel size from OME metadata, ImageJ's description ("unit=micron", "spacing=5.83") or the
 * resolution tags, in voxels per `metres` (NaN: no unit). Screen resolutions in dots per inch are
 * what programs write unasked: they do not count. `description` may be NULL. *source says where it
 * was found; it and the voxel are left alone where nothing was. */
void tiff_voxel_size(const char *description, const float resolution[2], double metres,
                     double voxel[3], const char **source);
/* STATUS_INPUT for channels and time steps, which are no slices. */
enum status tiff_refuse_hyperstack(const char *path, const char *description);

#endif
