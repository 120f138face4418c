/* Dispersion by random walk: walkers advected by the water and diffusing (walk_move.h), initially
 * distributed uniformly over the pore, until the growth of their mean square displacements gives
 * the coefficients with the wanted error (walk_moments.h). The method for solutes in pores is
 * described by Bijeljic, Muggeridge, Blunt 2004, Water Resour. Res. 40, W11501. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_H

#include <stdbool.h>

#include "common/hdf5_file.h"
#include "sphsolve/solute/walk_moments.h"
#include "sphsolve/solute/walk_steps.h"

#define WALK_PLANES 6   /* planes of first passage, at 1, 2, 4 ... box lengths along the flow */
#define WALK_TRACKED 64 /* walkers whose positions are recorded */
#define WALK_TRACK 1024 /* number of intervals for which they are recorded */

#define WALK_FRAMES 12 /* histograms of the plume, after 32, 64, 128 ... steps */
#define WALK_ALONG_BINS 96
#define WALK_ACROSS_BINS 32

/* Histogram of the displacements of the walkers, along the flow and across it, in first
 * spacings. */
struct walk_frame {
  double time; /* time units */
  double low[2], width[2];
  uint32_t count[WALK_ACROSS_BINS][WALK_ALONG_BINS];
};

struct walk_settings {
  double peclet;       /* mean speed of the water x first spacing / D; 0: at rest */
  double direction[3]; /* unit vector of the mean flow */
  double tolerance;    /* relative error wanted of both coefficients */
  size_t walkers;      /* 0: as many as the tolerance requires */
  double flight;       /* longest diffusive displacement, first spacings; 0: the default */
  double most_steps;   /* step limit of a walker; 0: none */
  uint32_t seed;
};

struct walk {
  const struct walk_cells *cells;
  struct walk_settings settings;
  struct walk_step step;
  double diffusion, dt;           /* first spacings^2 per time unit; time units */
  uint64_t steps;                 /* done by each walker so far */
  struct walker *walkers, *spare; /* the second array is used for sorting */
  struct walk_spot *now;          /* [walkers] current positions, by id */
  struct walk_moments moments;
  double plane[WALK_PLANES];       /* distance from each walker's start, first spacings */
  float *passage[WALK_PLANES];     /* by id, time units of the first passage; 0: not yet */
  float (*track)[WALK_TRACKED][3]; /* [WALK_TRACK] positions, first spacings */
  struct walk_frame *frame; /* [WALK_FRAMES], `frames` of them filled; this rank's walkers only */
  int frames;
  struct walk_rejected rejected;
};

/* Distributes the walkers; `cells` must outlive the walk. Free with walk_end. */
enum status walk_begin(const struct walk_cells *cells, const struct walk_settings *settings,
                       struct walk *walk);
/* Advances all walkers by one interval. Fails if a walker is lost. */
enum status walk_advance(struct walk *walk);
/* Statistics of the displacements so far; returns the number of lags. */
int walk_lags(const struct walk *walk, struct walk_lag lags[WALK_LAGS]);
/* Whether the result is within the tolerance, or the step limit is reached. */
bool walk_done(const struct walk *walk, struct walk_verdict *verdict);
void walk_end(struct walk *walk);

/* Displacement of walker w of this rank from its start to `spot`, along `direction`, first
 * spacings. */
static inline double walk_displacement(const struct walk *walk, const double direction[3],
                                       const struct walk_spot *spot, size_t w) {
  const struct walk_spot *start = &walk->moments.start[w];
  double sum = 0;
  for (int a = 0; a < 3; a++)
    sum += direction[a] * walk->moments.stretch[a] *
           ((double)(spot->cell[a] - start->cell[a]) + ((double)spot->x[a] - (double)start->x[a]));
  return sum;
}
/* Records a histogram of the plume if one is due; walk_frames_sum adds the counts of all ranks on
 * the first rank (walk_frames.c; collective). */
void walk_frames_take(struct walk *walk);
void walk_frames_sum(struct walk *walk);

/* Between ranks (walk_file.c; collective): walk_gather collects `own` (items of `size` bytes of
 * this rank's walkers) into `all` (of all walkers, in order of rank); walk_sum_track does so for
 * the positions of the tracked walkers. */
enum status walk_gather(const struct walk *walk, const void *own, size_t size, void *all);
enum status walk_sum_track(struct walk *walk);

/* Predicted pace of a walk: its time step (time units), and the number of steps for the relative
 * error `wanted` in a box whose width across the flow is `widest` first spacings, with D_T / D =
 * `across`. */
struct walk_pace {
  double dt, steps;
};
struct walk_pace walk_pace(double peclet, double widest, double across, double wanted);

/* Bytes of a walk without its cells, and of its cells; number of walkers for a tolerance. */
double walk_bytes(size_t walkers);
double walk_cells_bytes(size_t cells, size_t with_pores);
size_t walk_walkers(double tolerance);

/* Save and restore the complete state of a walk, bitwise (walk_file.c; collective; can be restored
 * on any number of ranks). The checksum of the file shows that it is our own. Restoring takes the
 * settings from the file and fails if it belongs to other cells. */
enum status walk_save(struct h5_file *file, const char *group, struct walk *walk);
enum status walk_load(struct h5_file *file, const char *group, const struct walk_cells *cells,
                      struct walk *walk);

/* Record of a walk for output: curves by lag, times of first passage, tracks. */
#define WALK_QUANTILES 200
struct walk_record {
  struct walk_verdict verdict;
  struct walk_lag lags[WALK_LAGS];
  int count;
  bool settled; /* within the tolerance; otherwise the step limit was reached */
  double walkers, steps, dt, flight, interval, not_carried, not_flown;
  double plane[WALK_PLANES];
  double passage[WALK_PLANES][WALK_QUANTILES]; /* time at which the fraction (q + 1/2) / 200 of the
                                                  walkers has passed; NAN: not reached */
  float (*track)[WALK_TRACKED][3];             /* [WALK_TRACK], `tracked` of them filled; owned */
  size_t tracked;
  struct walk_frame *frame; /* [WALK_FRAMES], `frames` of them filled; owned */
  int frames;
};
/* Makes the record of a walk; takes over tracks and frames. Free with walk_record_free. */
enum status walk_record(struct walk *walk, struct walk_record *record);
void walk_record_free(struct walk_record *record);
/* Converts it to SI units, in which the first spacing is `length` m and the time unit `time` s, and
 * writes it. */
enum status walk_record_write(struct h5_file *file, const char *group, struct walk_record *record,
                              double length, double time);

#endif
