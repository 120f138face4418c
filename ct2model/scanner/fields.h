/* The fields of a scanner that are told (fields.def), as the model file, --json and `info` name
 * them. */
#ifndef TOSUI_CT2MODEL_SCANNER_FIELDS_H
#define TOSUI_CT2MODEL_SCANNER_FIELDS_H

#include "ct2model/scanner/scanner.h"

struct scanner_field {
  const char *attribute, *key, *label, *unit, *meaning; /* label: NULL if `info` does not show it */
  size_t offset;                                        /* of a double in struct scanner */
  double times, shown; /* factors: of the member that is told, and of that as `info` shows it */
};

extern const struct scanner_field scanner_fields[];
extern const size_t scanner_field_count;

/* What is told of the field. */
double scanner_field_value(const struct scanner_field *field, const struct scanner *scanner);

#endif
