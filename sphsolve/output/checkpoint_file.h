/* Checkpoint files: PREFIX.ckpt.hdf and the previous one, PREFIX.ckpt.1.hdf. Each is an HDF5 file
 * with a trailer that contains the XXH3 hash of all bytes before it, so that an incomplete or
 * corrupted file is detected. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_CHECKPOINT_FILE_H
#define TOSUI_SPHSOLVE_OUTPUT_CHECKPOINT_FILE_H

#include "common/error.h"
#include "common/hdf5_file.h"

/* Creates a new file next to the checkpoints of PREFIX, for checkpoint_commit. */
enum status checkpoint_create(const char *prefix, struct h5_file **file);
/* Appends the trailer, moves the file into place and keeps the previous checkpoint. Takes ownership
 * of the file. */
enum status checkpoint_commit(const char *prefix, struct h5_file *file);
/* Opens the newest valid checkpoint; *file is NULL if there is none at all. Warns if it has to use
 * the older one; fails if both are damaged. */
enum status checkpoint_open(const char *prefix, struct h5_file **file);
/* Removes the checkpoints of a run that needs none any more; files without a trailer are not
 * checkpoints and stay. */
void checkpoint_remove(const char *prefix);

#endif
