/* Dispersion coefficients from the mean square displacements of the walkers as functions of time.
 *
 * Walkers start uniformly distributed over the pore and stay so. The statistics of their
 * displacements over a time tau therefore do not depend on when it begins, and each walker provides
 * successive displacements. Lags double: tau_k = 2^k intervals of WALK_INTERVAL steps. With the
 * central second moments M_k of the displacements
 *   D*(tau_k) = (M_k - M_(k-1)) / (2 (tau_k - tau_(k-1))),
 * the growth of the moment between half the lag and the lag: this excludes the times in which
 * walkers are still correlated with their initial pore (Brenner 1980; Aris 1956). The standard
 * error is that between independent groups of walkers. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_MOMENTS_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_MOMENTS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

#define WALK_INTERVAL 32 /* steps between two samples of the walkers' positions */
#define WALK_GROUPS 64
#define WALK_LAGS 32

/* A walker at one time: its position in the unwrapped periodic box, in cells, as cell and offset so
 * that precision is kept over any distance; and the velocity of the water along the mean flow, over
 * the mean. */
struct walk_spot {
  int32_t cell[3];
  float x[3];
  float along;
};

/* Sums over displacements: displacement (3), its products (6: xx yy zz xy yz zx), velocity at the
 * start times that at the end, velocity at the start and its square. */
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
  int group[2];   /* groups of this rank: from the first to before the second; other sums are 0 */
  size_t first, count; /* walkers of these groups */
  uint64_t intervals;  /* sampled so far */
  int lags;
  double stretch[3];                 /* spacings along the axes over the first */
  struct walk_spot *start;           /* [count], by id beginning with `first`, as all below */
  struct walk_spot *from[WALK_LAGS]; /* where the current displacement over each lag began */
  double sums[WALK_LAGS][WALK_GROUPS][WALK_SUMS];
};

/* The first walker of a group; for group WALK_GROUPS the number of walkers. */
size_t walk_group_start(size_t walkers, int group);
/* Divides the groups among the ranks; start stays NULL. A rank has whole groups, so that their sums
 * are the same on any number of ranks. */
void walk_moments_begin(size_t walkers, const double stretch[3], struct walk_moments *moments);
/* Adds the positions of the walkers one interval later. */
enum status walk_moments_add(struct walk_moments *moments, const struct walk_spot *now);
void walk_moments_free(struct walk_moments *moments);

/* Results at one lag: coefficients over the molecular one with standard errors; NAN where there are
 * fewer than two displacements of each walker. */
struct walk_lag {
  double time; /* tau, time units */
  double longitudinal, transverse, longitudinal_error, transverse_error;
  double tensor[6], tensor_error[6]; /* xx yy zz xy yz zx */
  double velocity;                   /* mean velocity of the displacements along the flow */
  double correlation;                /* autocorrelation of the velocity at this lag */
  double displacements;
};

/* Computes the results at all lags. `direction`: unit vector of the flow; `diffusion`: first
 * spacings^2 per time unit; `interval`: time units; `carried`: time units of advection in a step.
 * In two dimensions the transverse direction lies in the plane x, z. Returns the number of lags. */
int walk_moments_lags(const struct walk_moments *moments, const double direction[3], int dimensions,
                      double diffusion, double interval, double carried,
                      struct walk_lag lags[WALK_LAGS]);

/* The result: of the lags longer than the memory of the walkers, the one with the least error. The
 * error is the root of the sum of squares of the statistical error (95 %) and of the change still
 * seen at this lag and beyond, relative. The memory is `memory` time units for D_T = D, less where
 * walkers spread faster: at shorter times a coefficient may be constant for a while, between the
 * molecular diffusion that pores hinder and the mechanical dispersion that is still to develop. */
struct walk_verdict {
  int lag; /* -1: none yet */
  double longitudinal, transverse, longitudinal_error, transverse_error;
  double longitudinal_statistics, transverse_statistics, longitudinal_drift, transverse_drift;
};
/* Unit of these relative errors: the coefficient, but at least a tenth of D. */
double walk_error_unit(double coefficient);
struct walk_verdict walk_moments_judge(const struct walk_lag *lags, int count, double memory);

#endif
