/* Particles of method isph shared out among the ranks. All ranks hold all particles and sort them
 * alike; each computes a run of them, [share.begin, share.end), and exchanges what its neighbours'
 * sums read. On one rank the run is all of them, and nothing here does anything. */
#ifndef TOSUI_SPHSOLVE_ISPH_RANKS_H
#define TOSUI_SPHSOLVE_ISPH_RANKS_H

#include "sphsolve/isph/isph_state.h"

static inline bool isph_is_shared(const struct isph *s) {
  return RANKS && s->share.cut != NULL;
}
/* Collective, after a sort: which particles are whose, by the pairs of the last step. */
enum status isph_share_out(struct isph *s);
/* Collective, after the search: the ghosts are what the pairs name. */
enum status isph_find_ghosts(struct isph *s);
/* Collective: sends fields of the own particles to the ranks that read them. */
void isph_send(struct isph *s, int count, const struct ghost_field *fields);
/* Collective: of an item for each chunk of all particles, each rank has those of its own; then all
 * have all. */
void isph_gather_chunks(struct isph *s, void *data, size_t size);
#define ISPH_FIELD(array) ((struct ghost_field){(array), sizeof *(array)})
/* Collective: afterwards all ranks have all of the array. */
#define isph_gather(s, array) ghosts_gather(&(s)->share, (array), sizeof *(array))

#endif
