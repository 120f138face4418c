/* Candidates for the neighbours of particles. The few particles of a group, which lie side by side,
 * share theirs; each then chooses from them. */
#ifndef TOSUI_SPHSOLVE_ISPH_CANDIDATES_H
#define TOSUI_SPHSOLVE_ISPH_CANDIDATES_H

#include "sphsolve/isph/cells.h"

/* Not a power of two, or the arrays would compete for the same lines of the cache. */
#define CANDIDATES_ROOM (ISPH_CANDIDATES + 24)

/* Points near a group of particles: entries of lists, places as seen from the group, the part that
 * a point has in the support of a pair, and its volume; `turned` is that of reflected images. */
struct isph_candidates {
  size_t count;
  uint32_t entry[CANDIDATES_ROOM];
  double x[3][CANDIDATES_ROOM], half[CANDIDATES_ROOM], volume[CANDIDATES_ROOM],
      turned[CANDIDATES_ROOM];
};

/* Particles of a chunk that lie side by side in a row of cells, and the box around them. */
struct isph_group {
  size_t begin, end;
  double low[3], high[3], support; /* the largest of them */
};

/* The group that begins with particle i; of this one alone if `alone`. */
struct isph_group isph_group_from(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                                  bool alone);
/* Finds the particles (or, if `walls`, the wall particles) near a group. False if there are too
 * many of them. */
bool isph_find_candidates(const struct isph *s, const struct isph_group *g, bool walls,
                          struct isph_candidates *c);
/* Finds the candidates closer to x than half + their own half, except the entry `own`; returns how
 * many there are. `chosen` has CANDIDATES_ROOM places. */
size_t isph_choose(const struct isph_candidates *c, const double x[3], double half, uint32_t own,
                   uint16_t *chosen);

#endif
