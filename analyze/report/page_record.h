/* What a file states about itself, as JSON. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_RECORD_H
#define TOSUI_ANALYZE_REPORT_PAGE_RECORD_H

#include <jansson.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* Adds to `object` those of the groups, a list that ends with NULL, that the file has, each under
 * the last part of its name: {"attributes": {NAME: number, array or text}, DATASET: array or text,
 * ...}. Left out are lists of more than RECORD_MOST values, ranks above 2, and groups in it. */
#define RECORD_MOST 4096
enum status record_groups(struct h5_file *file, const char *const *groups, json_t *object);

#endif
