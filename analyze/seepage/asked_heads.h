/* The heads that the windows and drains of a seepage run's scene ask for. */
#ifndef TOSUI_ANALYZE_SEEPAGE_ASKED_HEADS_H
#define TOSUI_ANALYZE_SEEPAGE_ASKED_HEADS_H

#include "analyze/seepage/head_field.h"

struct asked_heads {
  /* [nz][nx] m: of the run, but still water before a window at its head, and drains that take at
   * theirs. */
  double *head;
  bool met;            /* the run's water stands there; else: */
  size_t window;       /* number of the inflow region whose water is the farthest off */
  double found, asked; /* m, there */
};

/* Of a field as head_field_read gives it. Where a run does not keep the heads of its scene, and
 * where they change, they are the run's own. Free with asked_heads_free, also after a failure. */
enum status asked_heads_find(const struct head_field *field, struct asked_heads *asked);
void asked_heads_free(struct asked_heads *asked);

#endif
