/* Files that are read as a whole. */
#ifndef TOSUI_COMMON_INPUT_FILE_H
#define TOSUI_COMMON_INPUT_FILE_H

#include <stdio.h>

#include "common/error.h"

/* Opens a file to read; STATUS_INPUT, without waiting, for what is no file: a folder, or a pipe
 * into which nobody may ever write. */
enum status input_open(const char *path, FILE **file);

#endif
