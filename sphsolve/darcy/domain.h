/* What of a scene is at a site of the lattice, and beside it. */
#ifndef TOSUI_SPHSOLVE_DARCY_DOMAIN_H
#define TOSUI_SPHSOLVE_DARCY_DOMAIN_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"
#include "common/error.h"
#include "sphsolve/plan/effect.h"

/* Whether no soil of a scene can hold air: none has a retention curve. */
bool domain_is_full(const struct scene *scene);
/* Whether a box holds a place; in 2-D y does not count. */
bool domain_holds(const struct scene *scene, const double box[6], const double x[3]);
/* Region of the soil at a place, the last that contains it; region_count: none. */
size_t domain_soil_at(const struct scene *scene, const double x[3]);
/* The type of what is at a site but for walls: porous, water or empty. */
enum region_type domain_filled_at(const struct scene *scene, const struct lattice *lattice,
                                  size_t at);
/* Whether a site is of free water beside soil that need not be full; or open: of that, or empty. */
bool domain_is_water(const struct scene *scene, const struct lattice *lattice, size_t at);
bool domain_is_open(const struct scene *scene, const struct lattice *lattice, size_t at);
/* Place of the middle of site `at`, m. */
void domain_place(const struct lattice *lattice, size_t at, double x[3]);
/* Share of the face of a site at `x`, normal to `axis`, that lies in a box. */
double domain_share(const struct lattice *lattice, const double x[3], int axis,
                    const double box[6]);
/* The inflow region that gives no flux at a face of a site at x on a side of the domain: the last
 * that covers half of it; NULL: none. A wall between the site and the side closes it. */
const struct region *domain_window_at(const struct scene *scene, const struct lattice *lattice,
                                      const double x[3], int axis, bool low);
/* The first region from `from` on that brings a given amount of water to a face of site `at`, and
 * the *share of the face that it covers: an inflow region with a flux, on a side of the domain; or
 * rain, on an upper face with nothing above it. region_count: none. */
size_t domain_source_at(const struct scene *scene, const struct lattice *lattice, size_t at,
                        int axis, bool low, size_t from, double *share);

/* Whether a scene is of soil that is full of water and stays so, whose flow is steady at each time
 * (darcy/saturated.h); `why`, in any case. */
enum status richards_confined(const struct effect_context *context, bool *confined,
                              char why[EFFECT_WHY]);

#endif
