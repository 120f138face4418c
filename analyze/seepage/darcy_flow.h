/* Darcy's law on the cells of a seepage run, by finite volumes: what the run is held against. */
#ifndef TOSUI_ANALYZE_SEEPAGE_DARCY_FLOW_H
#define TOSUI_ANALYZE_SEEPAGE_DARCY_FLOW_H

#include "analyze/seepage/head_field.h"

/* What flows through the faces of cells, m^2/s: u [nz][nx + 1] along x, w [nz + 1][nx] upwards. */
struct face_flux {
  double *u, *w;
};

/* Steady flow in the wet soil of a run between the heads of its waters, div K grad h = 0, with K by
 * the soil's drag at the run's own speeds. The edges of soil are sharp here, which particles smear;
 * where the water's surface is in soil is the run's. Solved on the run's
 * cells and on quarters of them, from which what is off by the cell's size is taken out. */
struct darcy_flow {
  bool known; /* else nothing else is */
  const struct head_field *field;
  double surface; /* share of a flux that a free surface in soil leaves open; 0: there is none */
  struct {
    struct face_flux flux; /* for each metre along y */
    double *head;          /* [nz][nx] m, of wet soil; NAN elsewhere */
  } level[2];
};

struct darcy_value {
  double value, error; /* NAN: not known */
};

/* Of a value on both grids: an error that goes with the size of the cells is taken out. Beside the
 * foot of a wall it goes with its root, 1 / (2^.5 - 1) of the difference and not one; the
 * uncertainty, 1.5 of it, holds both. */
struct darcy_value darcy_value_of(double coarse, double fine);

/* Of a field as head_field_read gives it, which has to live as long. Not known where soil moves, is
 * anisotropic in directions that are no axes, takes up rain or gives to a well, where the
 * equations' form is not Darcy's in steady flow (m15), and of runs of older versions. Free with
 * darcy_flow_free, also after a failure. */
enum status darcy_flow_find(const struct head_field *field, struct darcy_flow *flow);
void darcy_flow_free(struct darcy_flow *flow);

/* m^2/s along an axis (0 x, 1 z) through the middle of cell c; through the plane at `place` (m). */
struct darcy_value darcy_flow_cell(const struct darcy_flow *flow, int axis, size_t c);
struct darcy_value darcy_flow_through(const struct darcy_flow *flow, int axis, double place);
/* m^2/s into the drain of that name. */
struct darcy_value darcy_flow_taken(const struct darcy_flow *flow, const char *name);
/* m, at a place (x, z) in wet soil. */
struct darcy_value darcy_flow_head(const struct darcy_flow *flow, const double at[2]);

#endif
