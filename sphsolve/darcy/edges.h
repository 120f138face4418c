/* Boundary faces, wells and drains. */
#ifndef TOSUI_SPHSOLVE_DARCY_EDGES_H
#define TOSUI_SPHSOLVE_DARCY_EDGES_H

#include "sphsolve/darcy/state.h"

/* What holds at an edge: a pressure head outside, m, as far as the inward flux that it drives lies
 * between `least` and `most`, m/s; otherwise that of the two which it exceeds. */
struct richards_law {
  double head, least, most;
};
struct richards_law richards_law_at(const struct richards *s, const struct richards_edge *edge,
                                    double time);
/* Inward flux through an edge from a pressure head outside it, m; `di` is its derivative by that
 * head, `dj` by that of the site. */
void richards_flux_from_head(const struct richards *s, const struct richards_edge *edge,
                             double head, struct flux *flux);
/* Inward flux through an edge at a time by its law, with no water that stands on it; `di` and `dj`
 * are its derivative by the head of the site. */
void richards_edge_flux(const struct richards *s, const struct richards_edge *edge, double time,
                        struct flux *flux);
/* Fluxes through the boundary faces at a time, from the states of the sites, with no water that
 * stands on them. */
void richards_edge_fluxes(struct richards *s, double time);
/* Distributes the rates of wells for a step, evenly over their sites under pressure. */
void richards_share_wells(struct richards *s);
/* Whether it is a boundary face, through which water flows along its axis. */
static inline bool richards_is_face(const struct richards_edge *edge) {
  return edge->kind != EDGE_WELL && edge->kind != EDGE_DRAIN;
}
/* The head that a region gives at a time, m. */
double richards_head_given(const struct region *region, double time);
/* Whether the water of a head, or of a body of water, stands at a boundary face. */
bool richards_is_covered(const struct richards *s, const struct richards_edge *edge, double time);
/* What a source gives to its boundary face, m/s, averaged over the face; and all sources of a
 * face. */
double richards_source_at(const struct richards_source *source, double time);
double richards_given_at(const struct richards *s, const struct richards_edge *edge, double time);
/* Largest flux that a well takes there, m/s. */
double richards_well_at(const struct richards *s, const struct richards_edge *edge, double time);

#endif
