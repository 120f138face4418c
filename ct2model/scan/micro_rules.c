#include "ct2model/scan/micro_rules.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum status parse_table(const char *text, struct porosity_table *t) {
  const char *at = text;
  for (t->count = 0; t->count < POROSITIES_MOST; at++) {
    const int i = t->count++;
    char *end;
    t->grey[i] = strtod(at, &end);
    if (end == at || *end != ':' || !isfinite(t->grey[i])) break;
    t->porosity[i] = strtod(at = end + 1, &end);
    if (end == at || (*end != ',' && *end != '\0')) break;
    if (!(t->porosity[i] > 0.0 && t->porosity[i] < 1.0))
      return FAIL(STATUS_USAGE,
                  "--micro %s: grey %g: a porosity lies between 0 and 1; 0 is grain and 1 is pore, "
                  "and the first and the last grey say where these begin",
                  text, t->grey[i]);
    if (i > 0 && !(t->grey[i] > t->grey[i - 1]))
      return FAIL(STATUS_USAGE, "--micro %s: greys are wanted in rising order, and %g follows %g",
                  text, t->grey[i], t->grey[i - 1]);
    at = end;
    if (*end == ',') continue;
    if (t->count > 1) return STATUS_OK;
    break;
  }
  if (t->count == POROSITIES_MOST)
    return FAIL(STATUS_USAGE, "--micro %s: %d greys are possible", text, POROSITIES_MOST);
  return FAIL(STATUS_USAGE,
              "--micro %s: porosities of two greys or more are wanted, as 80:0.6,120:0.4,170:0.1",
              text);
}

enum status micro_rules_parse(const char *text, struct micro_rules *rules) {
  const char *dots = strstr(text, "..");
  char low[40], *end;
  rules->given = true;
  rules->automatic = strcmp(text, "auto") == 0;
  if (rules->automatic) return STATUS_OK;
  if (strchr(text, ':') != NULL) {
    const enum status status = parse_table(text, &rules->table);
    rules->low = rules->table.grey[0];
    rules->high = rules->table.grey[rules->table.count - 1];
    return status;
  }
  if (dots != NULL && (size_t)(dots - text) < sizeof low) {
    snprintf(low, sizeof low, "%.*s", (int)(dots - text), text);
    rules->low = strtod(low, &end);
    const bool first = end != low && *end == '\0' && isfinite(rules->low);
    rules->high = strtod(dots + 2, &end);
    if (first && end != dots + 2 && *end == '\0' && isfinite(rules->high) &&
        rules->low < rules->high)
      return STATUS_OK;
  }
  return FAIL(
      STATUS_USAGE,
      "--micro %s: auto is wanted, or the greys of soil, the lower first, as 80..170: below is "
      "pore, above is grain (turned round with --grain dark), or a table of their porosities, as "
      "80:0.6,170:0.1",
      text);
}
