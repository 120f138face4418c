/* What the texts that ImageJ, OME and tifffile write into a TIFF's description tell: the voxel
 * size, which its resolution tags may tell too, and the slices. */
#ifndef TOSUI_CT2MODEL_READERS_TIFF_DESCRIPTION_H
#define TOSUI_CT2MODEL_READERS_TIFF_DESCRIPTION_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

/* The text after "key=" in ImageJ's description; false if there is none. */
bool tiff_description_value(const char *description, const char *key, char *value, size_t size);
/* The value after "key": in tifffile's description, behind its bracket or quote; NULL if there is
 * none. */
const char *tiff_json_value(const char *description, const char *key);
/* Distance of slices in ImageJ's description, in its unit; NAN if there is none. `description` may
 * be NULL. */
double tiff_spacing(const char *description);
/* Voxel size (m) from OME metadata, ImageJ's description ("unit=micron", "spacing=5.83") or the
 * resolution tags, in voxels per `metres` (NaN: no unit). Screen resolutions in dots per inch,
 * which programs write by default, are ignored. `description` may be NULL. *source names where the
 * size was found; it and the voxel are unchanged if there is none. */
void tiff_voxel_size(const char *description, const float resolution[2], double metres,
                     double voxel[3], const char **source);
/* Refuses (STATUS_INPUT) channels that follow one another on the pages, as a text of ScanImage
 * tells, in the description or in the name of the program; `text` may be NULL. */
enum status tiff_told_channels(const char *path, const char *text);
/* Refuses `count` of what are no slices: channels, frames. */
enum status tiff_refuse_hyperstack(const char *path, unsigned long long count, const char *kind);
/* The number of slices; 0 if it is not told. *follow: they may follow the first without directories
 * of their own. Refuses (STATUS_INPUT) channels, time steps and arrays of more than three axes,
 * which are no slices. `page`: width, height and samples of a page; `description` may be NULL. */
enum status tiff_told_slices(const char *path, const char *description, const size_t page[3],
                             unsigned long long *slices, bool *follow);

#endif
