/* The heads that the windows and drains in the scene of a seepage run prescribe. */
#ifndef TOSUI_ANALYZE_SEEPAGE_ASKED_HEADS_H
#define TOSUI_ANALYZE_SEEPAGE_ASKED_HEADS_H

#include "analyze/seepage/head_field.h"

struct asked_heads {
  /* [nz][nx] m: heads of the run, except for still water before a window and for drains, which have
   * the prescribed ones. */
  double *head;
  bool reached;             /* the water of the run is at the prescribed heads; if not: */
  size_t window;            /* number of the inflow region whose water deviates most */
  double found, prescribed; /* m, its head in the run and the prescribed one */
};

/* For a field read by head_field_read. Heads that the run file does not contain, or that change in
 * time, are taken from the run. Free with asked_heads_free, also after a failure. */
enum status asked_heads_find(const struct head_field *field, struct asked_heads *asked);
void asked_heads_free(struct asked_heads *asked);

#endif
