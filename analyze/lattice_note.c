#include "analyze/lattice_note.h"

#include <math.h>
#include <stdbool.h>

static bool differs(const struct run *run) {
  return run->levels.count > 1 && run->k_finest > 0.0 && run->k > 0.0 &&
         fabs(run->k_finest / run->k - 1.0) > 1e-3;
}

double lattice_note_k(const struct run *run) {
  return run->k_finest > 0.0 ? run->k_finest : run->k;
}

double lattice_note_scale(const struct run *run) {
  return differs(run) ? run->k / run->k_finest : 1.0;
}

void lattice_note_write(const struct run *run, const char *before, const char *after,
                        FILE *stream) {
  if (!differs(run)) return;
  fprintf(stream,
          "%sVelocities are of the finest lattice (%.3g um), k = %.4g cm/s; k from all lattices is "
          "%.4g cm/s%s",
          before, 1e6 * run->levels.spacing[run->levels.count - 1], 100.0 * run->k_finest,
          100.0 * run->k, after);
}
