/* Which files may be written: no input of this run and, without --force, no file that Tosui has not
 * written. */
#ifndef TOSUI_COMMON_OUTPUT_GUARD_H
#define TOSUI_COMMON_OUTPUT_GUARD_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

/* Starts recording inputs (output_protect). `force`: files not written by Tosui may be replaced;
 * inputs never. */
void output_start(bool force);

/* To be called before the work starts and after the inputs are recorded (output_protect).
 * STATUS_USAGE if `path` is an input under any name, a folder or device, or a file not written by
 * Tosui; STATUS_RUN if its folder is missing or not writable. NULL is allowed. */
enum status output_allow(const char *path);

/* As output_allow, for a model or a run: a file that holds `group` ("/model", "/run") is of another
 * kind, `what`, and is not replaced without --force. */
enum status output_allow_kind(const char *path, const char *group, const char *what);

/* Name of an output file, into `named` of `size` bytes: `path` if it has one of `endings` (".hdf",
 * ..., NULL); if it has no ending the first one is added. STATUS_USAGE for another ending, with
 * `kind` as the reason ("a model is an HDF5 file"). An ending begins with a letter: "sand-0.725"
 * has none. */
enum status output_name(const char *path, const char *const *endings, const char *kind, char *named,
                        size_t size);

/* Whether a file exists and was written by one of the programs. */
bool output_is_product(const char *path);

/* Text that marks a file as written by Tosui: at the beginning of pages and tables, in the tags of
 * images. */
#define TOSUI_MARK "Tosui, permeability from CT"

#endif
