/* The voxel size in a TIFF: from the texts that ImageJ and OME write into its description, and from
 * its resolution tags. */
#ifndef TOSUI_CT2MODEL_READERS_TIFF_DESCRIPTION_H
#define TOSUI_CT2MODEL_READERS_TIFF_DESCRIPTION_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

/* The text after "key=" in ImageJ's description; false if there is none. */
bool tiff_description_value(const char *description, const char *key, char *value, size_t size);
/* Voxel size (m) from OME metadata, ImageJ's description ("unit=micron", "spacing=5.83") or the
 * resolution tags, in voxels per `metres` (NaN: no unit). Screen resolutions in dots per inch,
 * which programs write by default, are ignored. `description` may be NULL. *source names where the
 * size was found; it and the voxel are unchanged if there is none. */
void tiff_voxel_size(const char *description, const float resolution[2], double metres,
                     double voxel[3], const char **source);
/* Refuses (STATUS_INPUT) channels and time steps, which are no slices. */
enum status tiff_refuse_hyperstack(const char *path, const char *description);

#endif
