/* What --micro says of greys. */
#ifndef TOSUI_CT2MODEL_SCAN_MICRO_RULES_H
#define TOSUI_CT2MODEL_SCAN_MICRO_RULES_H

#include <stdbool.h>

#include "common/error.h"

enum { POROSITIES_MOST = 32 };

/* Porosity of greys that rise: linear between them, at the ends as there. */
struct porosity_table {
  int count;
  double grey[POROSITIES_MOST], porosity[POROSITIES_MOST];
};

/* What --micro and --micro-permeability say, in greys as stored. */
struct micro_rules {
  bool given;
  bool automatic;                  /* the bounds half-way between the peaks of three phases */
  double low, high;                /* else: soil lies between them */
  struct porosity_table table;     /* count 0: linear between the peaks */
  double permeability, grain_size; /* m^2 or m, the other 0 */
};

/* "auto", "80..170" or "80:0.6,120:0.4,170:0.1" (grey:porosity, the first and the last the bounds);
 * usage errors. */
enum status micro_rules_parse(const char *text, struct micro_rules *rules);

#endif
