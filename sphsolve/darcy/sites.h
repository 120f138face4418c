/* The sites of soil of a scene, the faces between them and the boundary faces. */
#ifndef TOSUI_SPHSOLVE_DARCY_SITES_H
#define TOSUI_SPHSOLVE_DARCY_SITES_H

#include "sphsolve/darcy/state.h"

/* Sets up sites, faces and the initial heads of a scene. Free with richards_free, also after a
 * failure. */
enum status richards_create(const struct scene *scene, const struct lattice *lattice,
                            struct richards *s);
void richards_free(struct richards *s);

#endif
