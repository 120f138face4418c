/* The sites that a scene starts from: one per voxel of the model, or one per spacing of the domain.
 * wcsph places a particle on each site; stokes solves on the sites.
 *
 * Where the domain is closed along an axis that is not periodic, `wall_layers` layers of wall are
 * added outside on each side. The lattice itself is then periodic for wcsph and stokes, and no
 * kernel reaches around it. isph makes its own walls and asks for 0 layers. */
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
  /* Number of sites without the added wall layers: the bulk volume of the Darcy velocity. Not an
   * integer where a closed side of a domain lies within a site. */
  double bulk_count;
  uint8_t *kind; /* enum site_kind */
  /* Signed distance (m) from the centre of the site to the wall surface, positive in the fluid. It
   * comes from the model's wall_distance, otherwise from its grain_fraction, otherwise from the
   * voxel faces; for a domain it is exact. NULL if there is no wall. */
  float *wall_distance;
  /* Index + 1 of the region that a site belongs to, 0 for none (outer walls); NULL for a model.
   * Wall velocity and slip come from scene.regions. */
  uint16_t *region;
  /* Soil with pores smaller than the sites (soil.h): porosity (0..1) and permeability (m^2) of
   * fluid sites, 0 where there is no soil. NULL if no site is soil. */
  float *micro_porosity, *micro_permeability;
  /* Factor by which micro_permeability was multiplied to find the sensitivity of k; 0: unchanged.
   * Where the solver's choices depend on a permeability, they use the one without this factor. */
  double micro_moved;
  struct model_facts model;
  bool y_mirrored; /* built so that sites j and size[1] - 1 - j are identical */
  /* The lattice whose wall distances are the surface from which this one was sampled, with walls
   * `surface_moved` (m) further in the grains; NULL: this one. After so many of its periods along
   * an axis its mirror image follows; 0: it only repeats. Not owned, unless it is `own_surface`. */
  const struct lattice *surface;
  struct lattice *own_surface;
  double surface_moved;
  size_t folded[3];
  /* Of a domain in which a wall region is thinner than the spacing: the scene, whose regions are
   * the surface, and the least thickness of these walls, m. Otherwise NULL. */
  const struct scene *boxes;
  double thinnest;
  /* The same of a domain in which walls may separate sites that are no wall: those thinner than the
   * spacing, and polygons and bodies, which are made of points. */
  const struct scene *shapes;
  /* Bit a: a wall thinner than the spacing separates the site from the next one along axis a
   * (thin_wall.h). NULL if there is none. */
  uint8_t *cut;
  bool filled; /* sites beside such walls were made wall (thin_wall_fill) */
};

/* Arrays of a lattice that are stored in a file on disk during the computation. */
struct lattice_spill {
  struct scratch_file file;
  bool distances, regions;
};

/* Builds the sites of a scene, with `wall_layers` of wall outside closed axes. Collective: the
 * ranks of one machine share one copy of kinds and distances. Free with lattice_free. */
enum status lattice_build(const struct scene *scene, int wall_layers, struct lattice *lattice);
void lattice_free(struct lattice *lattice);

/* Moves an array that the method does not read while it runs to a file on disk, next to its results
 * (`beside`). lattice_restore reads the arrays back and frees `spill`, also on failure. */
enum status lattice_spill_distances(struct lattice *lattice, const char *beside,
                                    struct lattice_spill *spill);
enum status lattice_spill_regions(struct lattice *lattice, const char *beside,
                                  struct lattice_spill *spill);
enum status lattice_restore(struct lattice *lattice, struct lattice_spill *spill);

/* Whether anything holds back a fluid: walls, those between sites too, or soil. */
bool lattice_holds_fluid(const struct lattice *lattice);
/* Number of faces between sites of different kind, by the axis normal to them; periodic. */
void lattice_count_faces(const struct lattice *lattice, size_t faces[3]);
/* The site beyond a face of site `at` of a scene's lattice, or the lattice's count if there is
 * none.
 */
static inline size_t lattice_beyond(const bool periodic[3], const struct lattice *l, size_t at,
                                    int axis, bool low) {
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  const size_t n = l->size[axis], here = at / stride[axis] % n;
  if (low ? here > 0 : here + 1 < n) return low ? at - stride[axis] : at + stride[axis];
  if (!periodic[axis] || n == 1) return l->count;
  return low ? at + (n - 1) * stride[axis] : at - (n - 1) * stride[axis];
}

#endif
