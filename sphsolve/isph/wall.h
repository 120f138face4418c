/* Walls: exact boxes, filled with wall particles that mirror the water. */
#ifndef TOSUI_SPHSOLVE_ISPH_WALL_H
#define TOSUI_SPHSOLVE_ISPH_WALL_H

#include "sphsolve/isph/state.h"

/* Finds the boxes of the scene's walls; the first is the tank around the domain. */
enum status isph_wall_find(struct isph *s);
/* Adds the wall particles of the tank, and those of a box, except where a later box is. */
enum status isph_wall_fill_tank(struct isph *s, size_t *capacity);
enum status isph_wall_fill_box(struct isph *s, size_t index, size_t *capacity);
/* Whether a wall box is in the domain; one that has left it does not drive the water. */
bool isph_wall_is_inside(const struct isph *s, const struct isph_wall_box *box);
/* Whether x is in a wall other than the tank. */
bool isph_wall_holds(const struct isph *s, const double x[3]);
/* Moves boxes and their particles by dt, and sets the boundary pressures at time s->time. */
void isph_wall_move(struct isph *s, double dt);
/* Projection tensor (symmetric.h) on the directions along which boundary particle j at xj (its
 * periodic image) mirrors particle i, and j's distance from the wall over that of i, unless
 * NULL. */
void isph_wall_mirror(const struct isph *s, size_t i, size_t j, const double xj[3],
                      double mirror[6], double *ratio);
/* Reduces the velocity v (pore velocity scale * v) of a particle at x that would carry it through a
 * wall within dt. */
void isph_wall_guard(const struct isph *s, const double x[3], double scale, double dt, double v[3]);

/* Bulk volume of boundary particle j. */
static inline double isph_wall_volume(const struct isph *s, size_t j) {
  return s->boundary_volume != NULL ? s->boundary_volume[j] : s->wall_volume;
}

/* Velocity of boundary particle j. */
static inline const double *isph_wall_velocity(const struct isph *s, size_t j) {
  const size_t box = s->boundary_box[j];
  return s->boundary_kind[j] == BOUNDARY_WALL ? s->wall_boxes[box].velocity
                                              : s->sides[box].velocity;
}

#endif
