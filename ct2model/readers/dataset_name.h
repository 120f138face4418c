/* A dataset of a file: FILE.h5:/dataset. */
#ifndef TOSUI_CT2MODEL_READERS_DATASET_NAME_H
#define TOSUI_CT2MODEL_READERS_DATASET_NAME_H

/* Start of the dataset's name in `path` ("/dataset"); NULL if `path` names a plain file, or if no
 * file precedes ":/". */
const char *dataset_name(const char *path);

#endif
