/* What a scanner makes of the sand: grey values with partial volume, blur, edge fringe, noise,
 * rings and drift. Levels are in units of the final grey, quartz at 100. */
#ifndef TOSUI_DATA_SAMPLES_SCAN_ARTEFACTS_H
#define TOSUI_DATA_SAMPLES_SCAN_ARTEFACTS_H

#include "data-samples/grain_field.h"

struct scan_settings {
  double grain_grey, pore_grey;
  double grain_spread;   /* standard deviation from grain to grain, share of the grain's grey */
  double texture_spread; /* the same inside a grain */
  double bright_share;   /* share of grains of a heavy mineral, twice to 2.5 times as bright */
  double blur;           /* standard deviation of the Gaussian, m */
  int blur_kept;         /* 0: brought to 0.8 to 1.9 voxels */
  double fringe;         /* strength of the Laplacian that makes the fringe, per blur^2 */
  double noise_ratio;    /* contrast / standard deviation of the noise (CNR) */
  double noise_length;   /* standard deviation of the Gaussian that correlates it, voxels */
  double ring;           /* height of the strongest rings, share of the contrast */
  double beam;           /* hardening: greys rise by this share from the axis to the far corner */
  double drift;          /* standard deviation from slice to slice, grey levels */
};

extern const struct scan_settings SCAN_DEFAULTS;

enum { SCAN_CHUNK = 32 }; /* slices rendered at once */

/* Standard deviation of the Gaussian that is drawn, voxels. */
double scan_blur(const struct scan_settings *settings, double voxel);
/* Voxels around the scan that its filters reach, FIELD_HALO or more. */
long scan_halo(const struct scan_settings *settings, double voxel);

struct scan_artefacts {
  const struct grain_field *field;
  struct scan_settings settings;
  uint64_t seed;
  struct noise_lattice texture;
  float *grain_grey; /* [grains + 1] */
  float *ring;       /* by distance from the axis of rotation, half voxels */
  long ring_count;
  float *chunk[2]; /* [SCAN_CHUNK + 2 halo][extent y][extent x] */
};

/* Keeps `field`, which must outlive it. Free with _destroy. */
enum status scan_artefacts_create(struct scan_artefacts *scan, const struct grain_field *field,
                                  const struct scan_settings *settings, long grains, uint64_t seed);
void scan_artefacts_destroy(struct scan_artefacts *scan);

/* Grey of slices z0 to z0 + count - 1, count <= SCAN_CHUNK, into grey [count][ny][nx]. The result
 * for a slice does not depend on the chunk it is rendered in. */
void scan_artefacts_render(struct scan_artefacts *scan, long z0, long count, float *grey);

#endif
