/* Windows spread over a scan whose grain surface is representative of the whole: a sweep stores
 * their greys while it reads the scan, and measures them once the threshold is known. */
#ifndef TOSUI_CT2MODEL_SURFACE_SURFACE_SAMPLE_H
#define TOSUI_CT2MODEL_SURFACE_SURFACE_SAMPLE_H

#include "ct2model/scan/region.h"
#include "ct2model/surface/wall_distance.h"

enum { SAMPLE_WINDOWS = 8 };

struct surface_sample {
  const struct region *region;
  size_t count, size[3];           /* windows, and the size of each; count 0: not started */
  size_t first[SAMPLE_WINDOWS][3]; /* first voxel of each in the region */
  float *greys;                    /* [count][z][y][x] */
};

/* Chooses the windows. Free with surface_sample_end. */
enum status surface_sample_start(const struct region *region, struct surface_sample *sample);
void surface_sample_end(struct surface_sample *sample);
/* Stores the part of slice z that lies in the windows; by any thread, once per slice. */
void surface_sample_keep(struct surface_sample *sample, size_t z, const struct pixel_rows *rows);
/* Surface per bulk volume (1/m), and its standard error by the scatter of the windows (NAN with one
 * window). `request` is that of the whole region, without distances. */
enum status surface_sample_measure(const struct surface_sample *sample,
                                   const struct wall_request *request, double *surface,
                                   double *error);

#endif
