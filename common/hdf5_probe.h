/* Files of unknown origin, read by a child process first; for common/hdf5_*.c only. */
#ifndef TOSUI_COMMON_HDF5_PROBE_H
#define TOSUI_COMMON_HDF5_PROBE_H

#include "common/error.h"

/* An input error if the HDF5 library crashes or hangs on the file. */
enum status h5_try(const char *path);

#endif
