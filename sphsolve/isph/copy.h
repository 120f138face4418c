/* A copy in memory of what a checkpoint holds, to which a run can return; the watchdog's state is
 * not part of it. Restoring it leaves a fresh state. */
#ifndef TOSUI_SPHSOLVE_ISPH_COPY_H
#define TOSUI_SPHSOLVE_ISPH_COPY_H

#include "sphsolve/isph/state.h"

struct isph_copy {
  char *block;
  size_t count, counts[3];
  double time, viscosity_most;
  struct conservation_passed passed;
  struct budget budget;
  int64_t step;
  uint64_t next_id;
};
/* Copies the state; `copy` starts as {0} and may be reused. Free with isph_copy_free. */
enum status isph_copy_state(const struct isph *s, struct isph_copy *copy);
/* Replaces the pressures in a copy by the present ones, of the same particles in the same order:
 * returning to it may divide the particles among the ranks anew. */
void isph_copy_pressure(const struct isph *s, struct isph_copy *copy);
/* Collective: returns to the copied state, which is then fresh. */
enum status isph_restore_state(struct isph *s, const struct isph_copy *copy);
void isph_copy_free(struct isph_copy *copy);

#endif
