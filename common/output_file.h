/* Files are written under a temporary name and renamed, so that no incomplete file is ever visible.
 * Also the single point where tests make any write fail. */
#ifndef TOSUI_COMMON_OUTPUT_FILE_H
#define TOSUI_COMMON_OUTPUT_FILE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

#define OUTPUT_NAME_MAX PATH_MAX

/* Writes `size` bytes to PATH.part and renames it to PATH (as resolved by output_follow). On
 * failure the error names the cause and the part file is removed. */
enum status output_write(const char *path, const char *data, size_t size);
/* Resolves `path` through all symbolic links; the file itself need not exist. Outputs are written
 * to the target, as by cp and the shell, and the link is kept. */
enum status output_follow(const char *path, char target[OUTPUT_NAME_MAX]);
/* rename(2) as a status. An input of this run is never replaced. */
enum status output_rename(const char *from, const char *to);
/* Waits until the data of an open file are on disk. After a signal it does not wait, because a
 * gigabyte takes seconds, and leaves the writing to the system. False on failure. */
bool output_sync(int descriptor);

/* From here on input files are recorded; called by programs only, not by code that reads its own
 * temporary files. */
void output_note_inputs(void);
/* Records `path` as an input: no output may replace it under any name, hard link or symbolic
 * link. */
void output_protect(const char *path);
/* STATUS_USAGE if `path` is recorded as an input. */
enum status output_check_inputs(const char *path);

/* To be called last: STATUS_RUN if printed output could not be delivered (full disk, closed
 * pipe). */
enum status output_flush(void);

/* Called before every write and rename; true if a test wants it to fail. */
bool output_fails(void);
/* Tests only: a write fails whenever `fails` returns true (NULL: none fails). */
void output_ask_fails(bool (*fails)(void));

#endif
