/* Checkpoint files: PREFIX.ckpt.hdf and the one before it, PREFIX.ckpt.1.hdf, each an HDF5 file
 * with a trailer that holds the XXH3 of all bytes before it, so that a torn or flipped file is
 * known. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_CHECKPOINT_FILE_H
#define TOSUI_SPHSOLVE_OUTPUT_CHECKPOINT_FILE_H

#include "common/error.h"
#include "common/hdf5_file.h"

/* A new file beside the checkpoints of PREFIX, for checkpoint_commit. */
enum status checkpoint_create(const char *prefix, struct h5_file **file);
/* Seals the file and moves it into place; the one before is kept. Takes the file over. */
enum status checkpoint_commit(const char *prefix, struct h5_file *file);
/* The newest whole checkpoint; *file is NULL when there is none at all. Warns when it has to take
 * the older one; fails when both are damaged. */
enum status checkpoint_open(const char *prefix, struct h5_file **file);
/* Removes what is left of them, of a run that needs none any more; a file without a seal is not ours
 * and stays. */
void checkpoint_remove(const char *prefix);

#endif
