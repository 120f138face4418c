#include "sphsolve/geometry/soil.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

enum status lattice_soil_allocate(struct lattice *l) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(&l->micro_porosity, l->count, sizeof *l->micro_porosity, "the soil"));
  TRY(memory_allocate(&l->micro_permeability, l->count, sizeof *l->micro_permeability, "the soil"));
cleanup:
  return status;
}

double lattice_soil_most(const struct lattice *l) {
  double most = 0.0;
  for (size_t i = 0; l->micro_permeability != NULL && i < l->count; i++)
    most = fmax(most, (double)l->micro_permeability[i]);
  return most;
}

enum status lattice_soil_scale(const struct lattice *lattice, double factor,
                               struct lattice *scaled) {
  enum status status = STATUS_OK;
  *scaled = *lattice;
  scaled->micro_permeability = NULL;
  TRY(memory_allocate(&scaled->micro_permeability, lattice->count, sizeof(float), "the soil"));
  for (size_t i = 0; i < lattice->count; i++)
    scaled->micro_permeability[i] = (float)(factor * (double)lattice->micro_permeability[i]);
cleanup:
  return status;
}

/* The sites of a finer lattice that one site covers along an axis: from `low` to `high`, in fine
 * spacings, extended by `more` sites on each side; indices are periodic. */
struct covered {
  double low, high;
  size_t first, count, size;
};

static struct covered find_covered(size_t i, double spacing, size_t size, double fine_spacing,
                                   size_t more) {
  /* Adds whole periods, so that no index is negative. */
  const size_t boxes = (more + size - 1) / size;
  const double low =
      (double)i * spacing / fine_spacing - (double)more + (double)boxes * (double)size;
  const double high = low + spacing / fine_spacing + 2.0 * (double)more;
  const double first = floor(low + 1e-9);
  return (struct covered){low, high, (size_t)first, (size_t)ceil(high - 1e-9 - first), size};
}

static size_t covered_index(const struct covered *c, size_t n) {
  return (c->first + n) % c->size;
}

/* Covered length of the n-th site, in fine spacings. */
static double covered_length(const struct covered *c, size_t n) {
  const double at = (double)(c->first + n);
  return fmin(c->high, at + 1.0) - fmax(c->low, at);
}

/* Soil of `site` from the covered fine sites; false if all of them are walls. */
static bool average_soil(const struct lattice *fine, const struct covered c[3], struct lattice *out,
                         size_t site) {
  double pores = 0.0, soils = 0.0, porosity = 0.0, logarithm = 0.0;
  for (size_t k = 0; k < c[2].count; k++)
    for (size_t j = 0; j < c[1].count; j++)
      for (size_t i = 0; i < c[0].count; i++) {
        const double volume =
            covered_length(&c[0], i) * covered_length(&c[1], j) * covered_length(&c[2], k);
        const size_t row = covered_index(&c[2], k) * fine->size[1] + covered_index(&c[1], j);
        const size_t at = row * fine->size[0] + covered_index(&c[0], i);
        if (fine->kind[at] != SITE_FLUID) continue;
        if (!lattice_is_soil(fine, at)) {
          pores += volume;
          continue;
        }
        soils += volume;
        porosity += volume * (double)fine->micro_porosity[at];
        logarithm += volume * log((double)fine->micro_permeability[at]);
      }
  if (soils <= pores) return pores > 0.0;
  out->micro_porosity[site] = (float)((pores + porosity) / (pores + soils));
  out->micro_permeability[site] = (float)exp(logarithm / soils);
  return true;
}

enum status lattice_soil_resample(const struct lattice *fine, struct lattice *out) {
  enum status status = STATUS_OK;
  if (fine->micro_porosity == NULL) return STATUS_OK;
  TRY(lattice_soil_allocate(out));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < out->size[1] * out->size[2]; row++) {
    for (size_t i = 0; i < out->size[0]; i++) {
      const size_t at[3] = {i, row % out->size[1], row / out->size[1]}; // NOLINT: has rows
      const size_t site = row * out->size[0] + i;
      bool found = out->kind[site] != SITE_FLUID;
      /* Walls lie between sites: a fluid site may cover only walls, so its neighbourhood is
       * searched, too. */
      for (size_t more = 0; more < 3 && !found; more++) {
        struct covered c[3];
        for (int a = 0; a < 3; a++)
          c[a] = find_covered(at[a], out->spacing[a], fine->size[a], fine->spacing[a], more);
        found = average_soil(fine, c, out, site);
      }
    }
  }
cleanup:
  return status;
}

bool lattice_soil_same(const struct lattice *l, size_t low, size_t high, size_t count) {
  if (l->micro_porosity == NULL) return true;
  return memcmp(l->micro_porosity + low, l->micro_porosity + high, count * sizeof(float)) == 0 &&
         memcmp(l->micro_permeability + low, l->micro_permeability + high, count * sizeof(float)) ==
             0;
}

void lattice_soil_mirror(struct lattice *l) {
  const size_t plane = l->size[0] * l->size[1], nz = l->size[2];
  for (size_t k = 0; l->micro_porosity != NULL && k < nz / 2; k++) {
    const size_t from = k * plane, to = (nz - 1 - k) * plane;
    memcpy(l->micro_porosity + to, l->micro_porosity + from, plane * sizeof(float));
    memcpy(l->micro_permeability + to, l->micro_permeability + from, plane * sizeof(float));
  }
}
