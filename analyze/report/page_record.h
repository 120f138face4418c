/* What a file states about itself, as JSON. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_RECORD_H
#define TOSUI_ANALYZE_REPORT_PAGE_RECORD_H

#include <jansson.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* A group as {"attributes": {NAME: number, array or text}, DATASET: array or text, ...}; lists of
 * more than RECORD_MOST values, other ranks than 1 and 2, and groups in it are left out. A new
 * object, empty if there is no such group. */
#define RECORD_MOST 4096
enum status record_group(struct h5_file *file, const char *group, json_t **record);

/* {GROUP: record_group, ...} of those of the `n` groups that the file has; the keys are the last
 * parts of their names. Adds to `object`. */
enum status record_groups(struct h5_file *file, const char *const *groups, size_t n,
                          json_t *object);

#endif
