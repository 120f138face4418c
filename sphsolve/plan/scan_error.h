/* The error of k by the scanner's blur and noise: from the properties of the scan in the model's
 * file and from the change of k when its surface is blurred once more. */
#ifndef TOSUI_SPHSOLVE_PLAN_SCAN_ERROR_H
#define TOSUI_SPHSOLVE_PLAN_SCAN_ERROR_H

#include <stdbool.h>

/* /scanner of a model, SI. */
struct scan_quality {
  double blur, blur_error; /* standard deviation as measured; 1 sigma of it */
  double resolution;       /* period seen at a tenth of its contrast */
  double noise_power;      /* m^3: variance over contrast^2, times the volume that it is alike in */
  double between; /* m^2: variance by what is drawn between slices far apart, of one axis */
  double shape;            /* relative error of k where pores are too narrow to show their shape */
  bool labels;             /* segmented before: `resolution` alone is known */
  bool assumed;            /* the scan told none of them */
  bool removed;            /* the model's surface is that of the scan without its blur */
  bool averaged;           /* which was taken out of means of several voxels */
};

/* False where the model's file knows of no scan, or there is no file. Where the scanner could not
 * be measured a blur of 1.2 voxels is assumed. */
bool scan_quality_read(const char *model_path, struct scan_quality *scan);

/* The standard deviation (m) of a Gaussian that resolves as much as the scanner. */
double scan_deviation(const struct scan_quality *scan);

/* Relative 95 % half width of k in pores of a mean width (4 V / S, m), where the blur of
 * scan_deviation once more changes ln k by `change`. */
double scan_error(const struct scan_quality *scan, double change, double width);

/* What of it is for pores too narrow to show their shape; 0: they show it. */
double scan_shape_error(const struct scan_quality *scan, double width);

/* The change to expect in pores of that width, before anything is solved. */
double scan_change_expected(const struct scan_quality *scan, double width);

#endif
