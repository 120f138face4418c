#include "sphsolve/isph/threads.h"

#include <math.h>

#include "common/threads.h"

/* Pairs per thread from which on two threads take a tenth less time than one on an idle machine; on
 * a busy machine they wait for each other. */
#define PAIRS_PER_THREAD 30e3

double isph_neighbours(const struct scene *scene) {
  return scene->dimensions == 3 ? 4.0 / 3 * M_PI * pow(scene->isph.support_ratio, 3)
                                : M_PI * pow(scene->isph.support_ratio, 2);
}

int isph_threads(const struct scene *scene, double particles, int most) {
  return threads_for(particles * isph_neighbours(scene), PAIRS_PER_THREAD, most);
}
