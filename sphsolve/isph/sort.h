/* Particles in the order of their cells, and each rank's share of them. */
#ifndef TOSUI_SPHSOLVE_ISPH_SORT_H
#define TOSUI_SPHSOLVE_ISPH_SORT_H

#include "sphsolve/isph/state.h"

/* Sorts the particles [0, count) by cell, each rank those that it is to hold: before, it takes all
 * particles here as own, and divides them by the number of pairs in the last step. Collective. */
enum status isph_sort(struct isph *s);
/* Whether this rank is responsible for a place: it holds all particles within the kernel's reach,
 * and no rank before it does. */
bool isph_answers_for(const struct isph *s, const double x[3]);
/* Collective, after the neighbour search: the ghosts to be updated are those that the pairs refer
 * to. */
enum status isph_find_ghosts(struct isph *s);

#endif
