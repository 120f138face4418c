/* Parses the option --micro. */
#ifndef TOSUI_CT2MODEL_SCAN_MICRO_RULES_H
#define TOSUI_CT2MODEL_SCAN_MICRO_RULES_H

#include <stdbool.h>

#include "common/error.h"

enum { POROSITIES_MOST = 32 };

/* Porosity as a function of rising greys: linear between them, constant beyond the ends. */
struct porosity_table {
  int count;
  double grey[POROSITIES_MOST], porosity[POROSITIES_MOST];
};

/* The options --micro and --micro-permeability, in greys as stored. */
struct micro_rules {
  bool given;
  bool automatic;                  /* the bounds are half-way between the peaks of three phases */
  double low, high;                /* otherwise: the bounds of soil */
  struct porosity_table table;     /* count 0: linear between the peaks */
  double permeability, grain_size; /* m^2, or m; the other one is 0 */
};

/* Parses "auto", "80..170" or "80:0.6,120:0.4,170:0.1" (grey:porosity; the first and the last grey
 * are the bounds); usage errors. */
enum status micro_rules_parse(const char *text, struct micro_rules *rules);

#endif
