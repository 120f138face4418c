/* Which files may be written: no input of this run, and nothing that is no product of Tosui's,
 * unless --force says so. */
#ifndef TOSUI_COMMON_OUTPUT_GUARD_H
#define TOSUI_COMMON_OUTPUT_GUARD_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

/* A program starts: from here on inputs are noted (output_protect). `force`: files that are no
 * products may be replaced; inputs never. */
void output_start(bool force);

/* To be called before the work, and after the inputs are known (output_protect): STATUS_USAGE where
 * `path` is an input under whatever name, a folder or device, or a file of another origin;
 * STATUS_RUN where its folder is absent or may not be written. NULL is fine. */
enum status output_allow(const char *path);

/* Likewise for a run or a model: a file that holds `group` ("/model", "/run") is of another kind,
 * `what`, and is not replaced unless --force says so. */
enum status output_allow_kind(const char *path, const char *group, const char *what);

/* The name of a file of a kind: `path` as it is where it has one of `endings` (".hdf", ..., NULL),
 * with the first of them where it has none, into `named` of `size` bytes. STATUS_USAGE where it has
 * another, with `kind` as the reason ("a model is an HDF5 file"). The 725 of "sand-0.725" is no
 * ending. */
enum status output_name(const char *path, const char *const *endings, const char *kind, char *named,
                        size_t size);

/* Whether a file is there, and whether it bears the mark of one of the programs. */
bool output_is_product(const char *path);

/* Text that marks a product: in the head of pages and tables, the tags of images. */
#define TOSUI_MARK "Tosui, permeability from CT"

#endif
