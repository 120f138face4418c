/* Finite volume solution of Darcy's law on the cells of a seepage run, with which the results of
 * the run are compared. */
#ifndef TOSUI_ANALYZE_SEEPAGE_DARCY_FLOW_H
#define TOSUI_ANALYZE_SEEPAGE_DARCY_FLOW_H

#include "analyze/seepage/head_field.h"

/* Fluxes through the faces of cells, m^2/s: u [nz][nx + 1] along x, w [nz + 1][nx] upwards. */
struct face_flux {
  double *u, *w;
};

/* Steady flow in the wet soil of a run, div K grad h = 0, between the heads of its bodies of water,
 * with K from the drag of the soil at the speeds of the run. The edges of soil are sharp here,
 * while particles smear them; a free surface in soil is taken from the run. Solved on the cells of
 * the run and on cells of half the size, to extrapolate the error of the cell size. */
struct darcy_flow {
  bool known; /* false: no other member is valid */
  const struct head_field *field;
  /* Relative uncertainty of a flux due to a free surface in soil; 0 if there is none. */
  double surface;
  struct {
    struct face_flux flux; /* per metre along y */
    double *head;          /* [nz][nx] m, in wet soil; NAN elsewhere */
  } level[2];
};

struct darcy_value {
  double value, error; /* error: 95 %; NAN if unknown */
};

/* Richardson extrapolation of a value on both grids, for an error proportional to the cell size.
 * Near the foot of a wall the error is proportional to its root instead, and the correction is 1 /
 * (2^.5 - 1) times the difference instead of 1; the uncertainty of 1.5 times the difference covers
 * both. */
struct darcy_value darcy_value_of(double coarse, double fine);

/* Solves for a field read by head_field_read, which must live as long as `flow`. Not known if soil
 * moves, is anisotropic with principal directions other than the axes, has rain or wells, or if the
 * equations' form does not give Darcy's law in steady flow (m15), and for runs of older versions.
 * Free with darcy_flow_free, also after a failure. */
enum status darcy_flow_find(const struct head_field *field, struct darcy_flow *flow);
void darcy_flow_free(struct darcy_flow *flow);

/* Flux in m^2/s along an axis (0 x, 1 z): through the middle of cell c; through the plane at
 * `place` (m). */
struct darcy_value darcy_flow_cell(const struct darcy_flow *flow, int axis, size_t c);
struct darcy_value darcy_flow_through(const struct darcy_flow *flow, int axis, double place);
/* Flux in m^2/s into the drain with that name. */
struct darcy_value darcy_flow_into_drain(const struct darcy_flow *flow, const char *name);
/* Head in m at a point (x, z) in wet soil. */
struct darcy_value darcy_flow_head(const struct darcy_flow *flow, const double at[2]);

#endif
