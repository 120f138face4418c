/* How far the flux of a plane is from what the balance of mass says it has to be. */
#ifndef TOSUI_ANALYZE_PLANE_BALANCE_H
#define TOSUI_ANALYZE_PLANE_BALANCE_H

#include "analyze/seepage/head_field.h"

/* Sections that lie in the support of one kernel are fits to the same particles and err alike: about
 * so many. */
#define SECTIONS_ALIKE 5.0

/* Of the plane of that name, whose flux is `mean` (m^2/s for each metre along y): in steady flow as
 * much goes through it as through the sections beside it that lie in soil alone, up to the next open
 * side. The difference to their mean, with the scatter of theirs (95 %); in free water particles are
 * shifted too, and a plane there is off by more than its mean over time shows. NAN: there is no such
 * section, or the run does not keep its planes. `in_water` (may be NULL): part of the plane lies in
 * free water. */
double plane_balance(const struct run *run, const struct head_field *field, const char *name,
                     double mean, bool *in_water);

#endif
