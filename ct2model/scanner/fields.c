#include "ct2model/scanner/fields.h"

#include <stddef.h>

const struct scanner_field scanner_fields[] = {
#define SCANNER_FIELD(member, times, attribute, key, label, shown, unit, meaning)                  \
  {attribute, key, label, unit, meaning, offsetof(struct scanner, member), times, shown},
#include "ct2model/scanner/fields.def"
#undef SCANNER_FIELD
};
const size_t scanner_field_count = sizeof scanner_fields / sizeof *scanner_fields;

double scanner_field_value(const struct scanner_field *field, const struct scanner *scanner) {
  return field->times * *(const double *)(const void *)((const char *)scanner + field->offset);
}
