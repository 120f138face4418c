/* Number of threads that the particles of a scene keep busy. */
#ifndef TOSUI_SPHSOLVE_ISPH_THREADS_H
#define TOSUI_SPHSOLVE_ISPH_THREADS_H

#include "sphsolve/scene/scene.h"

/* Number of neighbours of a particle in an even arrangement. */
double isph_neighbours(const struct scene *scene);
/* Number of threads to use, at most `most`. */
int isph_threads(const struct scene *scene, double particles, int most);

#endif
