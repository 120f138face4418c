/* A snapshot of the particles, in the order of their ids. */
#ifndef TOSUI_SPHSOLVE_ISPH_SNAPSHOT_H
#define TOSUI_SPHSOLVE_ISPH_SNAPSHOT_H

#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* Collective. */
enum status isph_write_snapshot(const struct isph *s, struct recorder *recorder);

#endif
