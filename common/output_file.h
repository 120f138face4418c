/* Files written beside and renamed, so that none is ever half there; and the one point where tests
 * make any write fail. */
#ifndef TOSUI_COMMON_OUTPUT_FILE_H
#define TOSUI_COMMON_OUTPUT_FILE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

#define OUTPUT_NAME_MAX PATH_MAX

/* Writes `size` bytes to PATH.part and renames it to PATH (that of output_follow); an error names
 * the cause, and no part is left. */
enum status output_write(const char *path, const char *data, size_t size);
/* The name that `path` is a symbolic link to, over all links, or `path`; no file need be there.
 * Outputs are written to that, as cp and the shell do, and the link stays. */
enum status output_follow(const char *path, char target[OUTPUT_NAME_MAX]);
/* rename(2) as a status; an input of this run is never replaced. */
enum status output_rename(const char *from, const char *to);
/* Waits until what was written to an open file is on the disk; not after a signal, as a gigabyte
 * takes seconds: then the system writes it later. False: it failed. */
bool output_sync(int descriptor);

/* From here on inputs are noted: of a program, not of what writes and reads for itself alone. */
void output_note_inputs(void);
/* Notes `path` as an input: no output may replace it, by whatever name, hard or soft link. */
void output_protect(const char *path);
/* STATUS_USAGE where `path` is a file noted as an input. */
enum status output_check_inputs(const char *path);

/* To be called last: STATUS_RUN where what was printed did not get out (a full disk, a closed
 * pipe). */
enum status output_flush(void);

/* Called before every write, HDF5 write and rename of ours; true where a test wants it to fail. */
bool output_fails(void);
/* Tests only: each of them fails where this is true (NULL: none). */
void output_ask_fails(bool (*fails)(void));

#endif
