/* Windows of a scan, spread over it, whose grain surface stands for the whole: a sweep keeps them
 * while it reads and measures them once it has the threshold. */
#ifndef TOSUI_CT2MODEL_SURFACE_SURFACE_SAMPLE_H
#define TOSUI_CT2MODEL_SURFACE_SURFACE_SAMPLE_H

#include "ct2model/scan/region.h"
#include "ct2model/surface/wall_distance.h"

enum { SAMPLE_WINDOWS = 8 };

struct surface_sample {
  const struct region *region;
  size_t count, size[3];           /* windows, and each one's size; count 0: not begun */
  size_t first[SAMPLE_WINDOWS][3]; /* in the region */
  float *greys;                    /* [count][z][y][x] */
};

/* Chooses the windows. Free with surface_sample_end. */
enum status surface_sample_start(const struct region *region, struct surface_sample *sample);
void surface_sample_end(struct surface_sample *sample);
/* Takes from slice z what lies in the windows; any thread, each slice once. */
void surface_sample_keep(struct surface_sample *sample, size_t z, const struct pixel_rows *rows);
/* Surface per bulk volume (1/m), and its standard error from one window to the next (NAN: one
 * window). `request` is that of the whole region, without distances. */
enum status surface_sample_measure(const struct surface_sample *sample,
                                   const struct wall_request *request, double *surface,
                                   double *error);

#endif
