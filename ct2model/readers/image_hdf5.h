/* A dataset of an HDF5 file as an image: FILE.h5:/dataset, [z][y][x] or [y][x]. */
#ifndef TOSUI_CT2MODEL_READERS_IMAGE_HDF5_H
#define TOSUI_CT2MODEL_READERS_IMAGE_HDF5_H

#include "ct2model/readers/image.h"

/* Where the dataset's name starts in `path` ("/dataset"), NULL where `path` names a plain file, or
 * what stands before ":/" is none. */
const char *image_hdf5_dataset(const char *path);
void image_hdf5_end(struct image_dataset *dataset);

#endif
