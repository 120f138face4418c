/* The sites a scene starts from: one per voxel of the model, or per spacing of the domain. wcsph
 * puts a particle on each site, stokes solves on the sites.
 *
 * Where an axis is not periodic and the domain is closed there, `wall_layers` layers of wall are
 * added outside on each side, so that the lattice itself is periodic for wcsph and stokes and no
 * kernel reaches around. isph makes its own walls and asks for 0 layers. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_LATTICE_H
#define TOSUI_SPHSOLVE_GEOMETRY_LATTICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/scratch_file.h"
#include "sphsolve/geometry/model_facts.h"
#include "sphsolve/scene/scene.h"

enum site_kind { SITE_EMPTY = 0, SITE_FLUID = 1, SITE_WALL = 2 };

struct lattice {
  int dimensions;    /* 2: size[1] == 1 and y is no direction of the kernel */
  size_t size[3];    /* x, y, z; site (i, j, k) at index (k * ny + j) * nx + i */
  double spacing[3]; /* m */
  double origin[3];  /* m: centre of site (0, 0, 0) */
  size_t count;      /* product of size */
  size_t fluid_count, wall_count;
  /* Sites without added wall layers: the bulk of the Darcy velocity. Not a whole number where a
   * closed side of a domain lies within a site. */
  double bulk_count;
  uint8_t *kind; /* enum site_kind */
  /* Signed distance from the site's centre to the wall surface, m, positive in the fluid. From the
   * model's wall_distance, else its grain_fraction, else the voxel faces; from the boxes of a
   * domain exactly. NULL when there is no wall. */
  float *wall_distance;
  /* Region that claimed a site + 1, 0 for none (outer walls); NULL for a model. Wall velocity and
   * slip come from scene.regions. */
  uint16_t *region;
  /* Soil with pores below the sites (soil.h): porosity 0..1 and permeability, m^2, of fluid sites,
   * 0 where there is none. NULL where no site is soil. */
  float *micro_porosity, *micro_permeability;
  /* The factor by which micro_permeability has been multiplied to find how k responds; 0: none.
   * What the solver decides by a permeability it decides by that without the factor. */
  double micro_moved;
  struct model_facts model;
  bool y_mirrored; /* made so that sites j and size[1] - 1 - j are alike */
};

/* Arrays of a lattice that are set aside in a file on disk, and which. */
struct lattice_spill {
  struct scratch_file file;
  bool distances, regions;
};

/* The sites of a scene, with `wall_layers` of wall outside closed axes. Collective: ranks of one
 * machine hold kinds and distances once. Free with lattice_free. */
enum status lattice_build(const struct scene *scene, int wall_layers, struct lattice *lattice);
void lattice_free(struct lattice *lattice);

/* Puts what a method does not read while it runs into a file on disk, `beside` its results.
 * Taking it back frees `spill`, also where it fails. */
enum status lattice_spill_distances(struct lattice *lattice, const char *beside,
                                    struct lattice_spill *spill);
enum status lattice_spill_regions(struct lattice *lattice, const char *beside,
                                  struct lattice_spill *spill);
enum status lattice_restore(struct lattice *lattice, struct lattice_spill *spill);

/* Faces between sites of different kind, by the axis they are normal to; periodic. */
void lattice_count_faces(const struct lattice *lattice, size_t faces[3]);

#endif
