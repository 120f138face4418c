/* Dispersion from walkers: the mean squares of their displacements against the time they took.
 *
 * Walkers start evenly spread over the pore and stay so. The statistics of their displacements over
 * a time tau then do not depend on when it begins, so that each walker gives one after another.
 * Lags double: tau_k = 2^k intervals of WALK_INTERVAL steps. With the central second moments M_k of
 * the displacements D*(tau_k) = (M_k - M_(k-1)) / (2 (tau_k - tau_(k-1))), the growth of the moment
 * between half the lag and the lag: times in which walkers still remember the pore they were in are
 * left out (Brenner 1980; Aris 1956). The statistical error is that between independent groups of
 * walkers. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_MOMENTS_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_MOMENTS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

#define WALK_INTERVAL 32 /* steps between two looks at the walkers */
#define WALK_GROUPS 64
#define WALK_LAGS 32

/* A walker at one time: its place in the box that repeats without end, cells, in two parts so that
 * no distance is too far; and the velocity of the water along the mean flow, over the mean. */
struct walk_spot {
  int32_t cell[3];
  float x[3];
  float along;
};

/* Displacement 3, products 6 (xx yy zz xy yz zx), velocity at the start times that at the end,
 * velocity and its square at the start. */
enum {
  WALK_DISPLACEMENT = 0,
  WALK_PRODUCTS = 3,
  WALK_PAIR = 9,
  WALK_ALONG,
  WALK_ALONG_SQUARE,
  WALK_SUMS
};

struct walk_moments {
  size_t walkers; /* of all ranks */
  int group[2];   /* this rank's are from the first to before the second; sums of the others 0 */
  size_t first, count; /* walkers of these groups */
  uint64_t intervals;  /* looked at so far */
  int lags;
  double stretch[3];                 /* spacings along the axes over the first */
  struct walk_spot *start;           /* [count], by id from `first` on, as all the next */
  struct walk_spot *from[WALK_LAGS]; /* where the current displacement over each lag began */
  double sums[WALK_LAGS][WALK_GROUPS][WALK_SUMS];
};

/* The first walker of a group; that of group WALK_GROUPS is their number. */
size_t walk_group_start(size_t walkers, int group);
/* Whose groups they are; start NULL. A rank has whole groups, so that their sums are the same on
 * any number of ranks. */
void walk_moments_begin(size_t walkers, const double stretch[3], struct walk_moments *moments);
/* The walkers one interval later. */
enum status walk_moments_add(struct walk_moments *moments, const struct walk_spot *now);
void walk_moments_free(struct walk_moments *moments);

/* Of one lag: coefficients over the molecular one with standard errors, NAN where there are not
 * two displacements of each walker. */
struct walk_lag {
  double time; /* tau, time units */
  double longitudinal, transverse, longitudinal_error, transverse_error;
  double tensor[6], tensor_error[6]; /* xx yy zz xy yz zx */
  double velocity;                   /* mean along the flow, of the displacements */
  double correlation;                /* of the velocity with itself after this lag */
  double displacements;
};

/* `direction`: unit vector; `diffusion`: first spacings^2 per time unit; `interval`, and `carried`,
 * for which the water carries walkers in a step: time units. In two dimensions nothing is
 * transverse but in the plane x, z. Returns the number of lags. */
int walk_moments_lags(const struct walk_moments *moments, const double direction[3], int dimensions,
                      double diffusion, double interval, double carried,
                      struct walk_lag lags[WALK_LAGS]);

/* The result: of the lags that are longer than the walkers' memory the one with the least error,
 * which is that of the statistics (95 %) and the change still to be seen at it and beyond, root of
 * the sum of squares, relative. The memory is `memory` time units at D_T = D, less where they
 * spread faster: before, a coefficient may stand still for a while between the molecular motion
 * that pores slow down and the mechanical one that is still to come. */
struct walk_verdict {
  int lag; /* -1: none yet */
  double longitudinal, transverse, longitudinal_error, transverse_error;
  double longitudinal_statistics, transverse_statistics, longitudinal_drift, transverse_drift;
};
/* What these errors are relative to: the coefficient, but a tenth of D at least. */
double walk_error_unit(double coefficient);
struct walk_verdict walk_moments_judge(const struct walk_lag *lags, int count, double memory);

#endif
