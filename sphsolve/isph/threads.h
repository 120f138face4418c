/* How many threads the particles of a scene keep busy. */
#ifndef TOSUI_SPHSOLVE_ISPH_THREADS_H
#define TOSUI_SPHSOLVE_ISPH_THREADS_H

#include "sphsolve/scene/scene.h"

/* Pairs a particle, where they are evenly spread. */
double isph_neighbours(const struct scene *scene);
/* Of `most` threads. */
int isph_threads(const struct scene *scene, double particles, int most);

#endif
