/* Soil whose pores are smaller than the voxels: porosity and permeability per voxel, from the
 * labels of a segmented image or from greys between pore and grain, and their resampling to the
 * voxels of a model. */
#ifndef TOSUI_CT2MODEL_SCAN_MICRO_H
#define TOSUI_CT2MODEL_SCAN_MICRO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct soil {
  double porosity;     /* between 0 and 1, exclusive */
  double permeability; /* m^2 */
};

/* Permeability (m^2) of soil with grains of one diameter (m): d^2 n^3 / (180 (1 - n)^2). Kozeny
 * 1927, Carman 1937. */
double soil_kozeny_carman(double porosity, double grain_size);

/* Parses "0.35, 1.8e-15 m^2", or with a grain size instead of the permeability "0.35, 2um". Usage
 * errors name `option`. */
enum status soil_parse(const char *option, const char *text, struct soil *soil);
/* Parses a permeability or a grain size, from which the permeability follows by Kozeny and Carman:
 * one of the two is set, the other one is 0. */
enum status soil_parse_permeability(const char *option, const char *text, double *permeability,
                                    double *grain_size);

enum { MICRO_PORE = 0, MICRO_GRAIN = 255, MICRO_KINDS = 256 };

/* The kind of each voxel of a region: MICRO_PORE, MICRO_GRAIN or an index of `soil`. */
struct micro {
  size_t size[3];
  uint8_t *kind;                 /* [z][y][x]; NULL: no voxel is soil */
  struct soil soil[MICRO_KINDS]; /* of kinds 1 .. 254 */
};

/* Frees `kind`. */
void micro_end(struct micro *micro);

/* Input error if the pores of a soil are wider than the model's voxels (m). */
enum status micro_check(const struct micro *micro, const double spacing[3]);

/* Porosity and permeability of the model's voxels [n z][n y][n x]. A model voxel is soil if most of
 * the scan's voxels that it covers, grain excluded, are soil; otherwise both are 0, as they are
 * where `solid` is not 0. Porosity is the mean over soil and pores, permeability (m^2) the
 * geometric mean over the soil. Axis d of the model is axis (d + turn) mod 3 of the region. */
void micro_resample(const struct micro *micro, int turn, const size_t n[3], const uint8_t *solid,
                    float *porosity, float *permeability);

enum { POROSITIES_MOST = 32 };

/* Porosity as a function of rising greys: linear between them, constant beyond the ends. */
struct porosity_table {
  int count;
  double grey[POROSITIES_MOST], porosity[POROSITIES_MOST];
};

/* The options --micro and --micro-permeability, in greys as stored. */
struct micro_rules {
  bool given;
  bool automatic;                  /* the bounds are half-way between the peaks of three phases */
  double low, high;                /* otherwise: the bounds of soil */
  struct porosity_table table;     /* count 0: linear between the peaks */
  double permeability, grain_size; /* m^2, or m; the other one is 0 */
};

/* Parses "auto", "80..170" or "80:0.6,120:0.4,170:0.1" (grey:porosity; the first and the last grey
 * are the bounds); usage errors. */
enum status micro_rules_parse(const char *text, struct micro_rules *rules);

#endif
