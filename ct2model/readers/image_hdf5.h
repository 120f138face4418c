/* A dataset of an HDF5 file as an image: FILE.h5:/dataset, [z][y][x] or [y][x]. */
#ifndef TOSUI_CT2MODEL_READERS_IMAGE_HDF5_H
#define TOSUI_CT2MODEL_READERS_IMAGE_HDF5_H

#include "ct2model/readers/image.h"

/* Start of the dataset's name in `path` ("/dataset"); NULL if `path` names a plain file, or if no
 * file precedes ":/". */
const char *image_hdf5_dataset(const char *path);
void image_hdf5_end(struct image_dataset *dataset);

#endif
