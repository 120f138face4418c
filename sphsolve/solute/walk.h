/* Dispersion by random walk: walkers that the water carries and that diffuse (walk_move.h), spread
 * evenly over the pore, until the growth of their mean square displacements gives the coefficients
 * with the wanted error (walk_moments.h). An account of the method for solutes in pores: Bijeljic,
 * Muggeridge, Blunt 2004, Water Resour. Res. 40, W11501. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_H

#include <stdbool.h>

#include "common/hdf5_file.h"
#include "sphsolve/solute/walk_moments.h"
#include "sphsolve/solute/walk_steps.h"

#define WALK_PLANES 6   /* first passages: box lengths along the flow, 1, 2, 4 ... */
#define WALK_TRACKED 64 /* walkers whose places are kept */
#define WALK_TRACK 1024 /* intervals for which they are */

#define WALK_FRAMES 12 /* pictures of the plume, after 32, 64, 128 ... steps */
#define WALK_ALONG_BINS 96
#define WALK_ACROSS_BINS 32

/* Walkers by their place from where they began, along the flow and across it: first spacings. */
struct walk_frame {
  double time; /* time units */
  double low[2], width[2];
  uint32_t count[WALK_ACROSS_BINS][WALK_ALONG_BINS];
};

struct walk_settings {
  double peclet;       /* mean speed of the water x first spacing / D; 0: at rest */
  double direction[3]; /* unit vector of the mean flow */
  double tolerance;    /* relative, of both coefficients */
  size_t walkers;      /* 0: as many as the tolerance takes */
  double flight;       /* longest flight, first spacings; 0: WALK_FLIGHT */
  double most_steps;   /* of a walker; 0: no limit */
  uint32_t seed;
};

struct walk {
  const struct walk_cells *cells;
  struct walk_settings settings;
  struct walk_step step;
  double diffusion, dt;           /* first spacings^2 per time unit; time units */
  uint64_t steps;                 /* of each walker so far */
  struct walker *walkers, *spare; /* the second to sort them into */
  struct walk_spot *now;          /* [walkers] by id */
  struct walk_moments moments;
  double plane[WALK_PLANES];       /* first spacings from where each walker began */
  float *passage[WALK_PLANES];     /* by id, time units of the first passage; 0: not yet */
  float (*track)[WALK_TRACKED][3]; /* [WALK_TRACK] places, first spacings */
  struct walk_frame *frame; /* [WALK_FRAMES], of which `frames` are taken; of this rank's walkers */
  int frames;
  struct walk_kept kept;
};

/* Spreads the walkers; `cells` have to outlive them. Free with walk_end. */
enum status walk_begin(const struct walk_cells *cells, const struct walk_settings *settings,
                       struct walk *walk);
/* One interval. Fails where a walker is lost. */
enum status walk_advance(struct walk *walk);
/* What the walkers have told so far; the number of lags. */
int walk_lags(const struct walk *walk, struct walk_lag lags[WALK_LAGS]);
/* Whether the verdict is within the tolerance, or the steps are used up. */
bool walk_done(const struct walk *walk, struct walk_verdict *verdict);
void walk_end(struct walk *walk);

/* From where walker w of this rank began to `spot`, along `direction`: first spacings. */
double walk_passed(const struct walk *walk, const double direction[3], const struct walk_spot *spot,
                   size_t w);
/* A picture of the plume where it is time for one; all ranks' counts to the first (walk_frames.c;
 * collective). */
void walk_frames_take(struct walk *walk);
void walk_frames_sum(struct walk *walk);

/* Between ranks (walk_file.c; collective): `own` of this rank's walkers, items of `size` bytes,
 * into `all` of all walkers, in order of rank; the places of the tracked walkers. */
enum status walk_gather(const struct walk *walk, const void *own, size_t size, void *all);
enum status walk_sum_track(struct walk *walk);

/* Of a walk to come: its time step (time units), and the steps that `wanted` takes where walkers
 * spread across a box of `widest` first spacings with D_T / D = `across`. */
struct walk_pace {
  double dt, steps;
};
struct walk_pace walk_pace(double peclet, double widest, double across, double wanted);

/* Bytes of a walk beside its cells, and its cells. */
double walk_bytes(size_t walkers);
double walk_cells_bytes(size_t cells, size_t with_pores);
size_t walk_walkers(double tolerance);

/* Everything that a walk is, bit for bit (walk_file.c; collective, and read on any number of
 * ranks). The file is ours by its checksum. Reading takes the settings from the file and fails
 * where it is of other cells. */
enum status walk_save(struct h5_file *file, const char *group, struct walk *walk);
enum status walk_load(struct h5_file *file, const char *group, const struct walk_cells *cells,
                      struct walk *walk);

/* What readers want of a walk: curves by lag, times of first passage, tracks. */
#define WALK_QUANTILES 200
struct walk_record {
  struct walk_verdict verdict;
  struct walk_lag lags[WALK_LAGS];
  int count;
  bool settled; /* within the tolerance; else its steps were used up */
  double walkers, steps, dt, flight, interval, not_carried, not_flown;
  double plane[WALK_PLANES];
  double passage[WALK_PLANES][WALK_QUANTILES]; /* when a share (q + 1/2) / 200 of the walkers has
                                                  first passed; NAN: not by the end */
  float (*track)[WALK_TRACKED][3]; /* [WALK_TRACK], of which `tracked` are filled; owned */
  size_t tracked;
  struct walk_frame *frame; /* [WALK_FRAMES], of which `frames` are taken; owned */
  int frames;
};
/* Takes tracks and frames over. Free with walk_record_free. */
enum status walk_record(struct walk *walk, struct walk_record *record);
void walk_record_free(struct walk_record *record);
/* In SI: the first spacing and the time unit are `length` m and `time` s. Tracks are in m after. */
enum status walk_record_write(struct h5_file *file, const char *group, struct walk_record *record,
                              double length, double time);

#endif
