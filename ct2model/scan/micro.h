/* Soil whose pores are smaller than the voxels: a porosity and a permeability a voxel, of a
 * segmented image's labels or of the greys between pore and grain, and the same carried to the
 * voxels of a model. */
#ifndef TOSUI_CT2MODEL_SCAN_MICRO_H
#define TOSUI_CT2MODEL_SCAN_MICRO_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

struct soil {
  double porosity;     /* 0 to 1, without both */
  double permeability; /* m^2 */
};

/* Permeability (m^2) of grains of one diameter (m): d^2 n^3 / (180 (1 - n)^2). Kozeny 1927, Carman
 * 1937. */
double soil_kozeny_carman(double porosity, double grain_size);

/* "0.35, 1.8e-15 m^2", or a grain size instead of the permeability: "0.35, 2um". Usage errors name
 * `option`. */
enum status soil_parse(const char *option, const char *text, struct soil *soil);
/* A permeability as it stands, or by Kozeny and Carman from a grain size: one of the two is set,
 * the other 0. */
enum status soil_parse_permeability(const char *option, const char *text, double *permeability,
                                    double *grain_size);

enum { MICRO_PORE = 0, MICRO_GRAIN = 255, MICRO_KINDS = 256 };

/* What each voxel of a region is: MICRO_PORE, MICRO_GRAIN or a row of `soil`. */
struct micro {
  size_t size[3];
  uint8_t *kind;                 /* [z][y][x]; NULL: no voxel is soil */
  struct soil soil[MICRO_KINDS]; /* of kinds 1 .. 254 */
};

/* Frees `kind`. */
void micro_end(struct micro *micro);

/* Soil of pores wider than the model's voxels (m) is an input error. */
enum status micro_check(const struct micro *micro, const double spacing[3]);

/* Porosity and permeability (f32) of the model's voxels [n z][n y][n x]: of the scan's voxels that
 * one covers, grain left out, those that most are; 0 where that is pore, and where `solid` is not
 * 0. Porosity is their mean, permeability the geometric mean of the soil among them. Axis d of the
 * model is axis (d + turn) mod 3 of the region. */
void micro_resample(const struct micro *micro, int turn, const size_t n[3], const uint8_t *solid,
                    float *porosity, float *permeability);

#endif
