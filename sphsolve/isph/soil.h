/* Soil at a place, and the boxes it is made of. */
#ifndef TOSUI_SPHSOLVE_ISPH_SOIL_H
#define TOSUI_SPHSOLVE_ISPH_SOIL_H

#include "sphsolve/isph/state.h"

struct soil_point {
  double porosity, fraction; /* fraction: of soil, 0..1, smoothed over the support */
  double inertia;            /* C_r / (eps G) */
  double a, b;               /* drag coefficients over G, 1/s and 1/m; across an interface */
  double normal[3];          /* of an interface between soils; 0 without */
  double along_a, along_b, plane;
  double velocity[3];
};
/* Soil at a place, with moving soil where it is a time `ahead` (s) from now. */
void isph_soil_at(const struct isph *s, const double position[3], double ahead,
                  struct soil_point *soil);
/* Properties of a soil away from its edges. */
struct isph_material {
  double porosity, inertia, a, b; /* as of struct soil_point */
};
struct isph_material isph_material_of(const struct isph *s, const struct region *region);
/* Box of soil region k a time `ahead` from now; infinite where it touches a closed side or fills a
 * periodic axis. */
struct isph_soil_place {
  double low[3], high[3], offset[3]; /* the box is at low + offset */
  double period[3], middle[3];       /* period of its images (0: none), and its middle */
};
struct isph_soil_place isph_soil_place(const struct isph *s, size_t k, double ahead);
struct isph_box {
  double low[3], high[3];
};
/* The box's image nearest to x. */
struct isph_box isph_soil_image(const struct isph_soil_place *place, const double x[3]);
/* Clips the path x + t step, from <= t <= to, to the part that lies in the box; returns whether any
 * is left. */
bool isph_box_clip(const struct isph_box *box, const double x[3], const double step[3],
                   double *from, double *to);
/* Whether a box of region k (its own, or its extent) is certainly farther than `reach` from x. */
bool isph_soil_is_far(const struct isph *s, const double box[6], size_t k, double reach,
                      const double x[3]);
struct isph_box isph_soil_box(const struct isph *s, size_t k, double ahead, const double x[3]);
double isph_soil_minimum(const struct scene *scene);
bool isph_soils_differ(const struct scene *scene);

#endif
