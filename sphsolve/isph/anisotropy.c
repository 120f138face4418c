#include "sphsolve/isph/anisotropy.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/effects/drag_forchheimer.h"
#include "sphsolve/isph/effects/drag_linear.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/interface.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/shape.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/wall.h"

static const double unit[6] = {1, 0, 0, 1, 0, 1};

bool isph_is_anisotropic(const struct scene *scene) {
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_POROUS && scene->regions[k].anisotropic) return true;
  return false;
}

enum status isph_anisotropy_create(struct isph *s) {
  return memory_allocate(&s->beds, s->scene->region_count, sizeof *s->beds, "regions");
}

/* 1 + the first region of the soil that contains x, taking edges as sharp; 0 in water. */
static int32_t bed_at(const struct isph *s, const double x[3]) {
  for (size_t k = s->scene->region_count; k-- > 0;) {
    const struct region *region = &s->scene->regions[k];
    if (region->type != REGION_POROUS) continue;
    if (region->is_part && isph_soil_is_far(s, region->box, k, 0, x)) continue;
    const struct isph_box box = isph_soil_box(s, k, 0, x);
    bool inside = true;
    for (int a = 0; a < 3; a++) inside = inside && x[a] >= box.low[a] && x[a] < box.high[a];
    if (inside) return (int32_t)region->first + 1;
  }
  return 0;
}

void isph_anisotropy_at(struct isph *s, size_t i, const struct soil_point *soil) {
  struct isph_anisotropy *own = &s->anisotropy[i];
  const double a = s->drag_a[i];
  own->bed = bed_at(s, s->position[i]);
  memcpy(own->normal, soil->wide_normal, sizeof own->normal);
  for (int k = 0; k < 6; k++) own->drag[k] = a > 0 ? soil->tensor[k] / a : unit[k];
  if (s->dimensions == 2 && a > 0) own->drag[1] = own->drag[4] = 0, own->drag[3] = 1;
}

/* Mobility tensor over the scalar mobility, (c + a d)^-1 (c + a): d is the relative drag tensor, a
 * the scalar drag and c the inertial part of the resistance. */
static void relative_mobility(double c, double a, const double d[6], double relative[6]) {
  double sum[6] = {0};
  for (int k = 0; k < 6; k++) sum[k] = c * unit[k] + a * d[k];
  symmetric_inverse(sum, relative);
  for (int k = 0; k < 6; k++) relative[k] *= c + a;
}

/* Relative mobility tensor K of each soil, and the S that gives it for neighbours spread evenly
 * over all directions. */
static void find_beds(struct isph *s, double dt) {
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *soil = &s->scene->regions[k];
    struct isph_bed *bed = &s->beds[k];
    memset(bed, 0, sizeof *bed);
    memcpy(bed->mobility, unit, sizeof unit);
    if (soil->type != REGION_POROUS || !soil->anisotropic || soil->first != k) continue;
    const struct isph_material of = isph_material_of(s, soil);
    double drag[6];
    symmetric_inverse(soil->anisotropy, drag);
    relative_mobility(of.inertia / dt, of.a, drag, bed->mobility);
    isph_shape_even(s->dimensions, bed->mobility, bed->shape);
  }
}

/* S of particle i; 0 where its mobility is a scalar. */
static void find_shape(struct isph *s, const struct isph_chunk *chunk, size_t i) {
  static const double none[6] = {0};
  const struct isph_anisotropy *own = &s->anisotropy[i];
  const struct isph_bed *bed = own->bed > 0 ? &s->beds[own->bed - 1] : NULL;
  const double *mobility = s->on.links ? (bed != NULL ? bed->mobility : unit) : own->relative;
  struct isph_directions around = {.count = 0};
  double off = 0, root[6] = {0}, even[6] = {0}, target[6];
  memset(s->shape[i], 0, sizeof s->shape[i]);
  for (int k = 0; k < 6; k++) off = fmax(off, fabs(mobility[k] - unit[k]));
  if (!(off > 1e-6)) return;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const double volume = s->volume[chunk->pair[p] & PAIR_MASK];
    double r[3];
    isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
    isph_directions_add(&around, r, volume * (double)chunk->slope[p], even);
  }
  if (s->dimensions == 2) even[3] = 1;
  symmetric_root(mobility, root);
  symmetric_between(root, even, target);
  isph_shape_find(s->dimensions, &around, target, bed != NULL ? bed->shape : none, s->shape[i]);
}

void isph_anisotropy_begin(struct isph *s, double dt) {
  find_beds(s, dt);
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double t = dt / s->inertia[i], b = s->drag_b[i];
      struct isph_anisotropy *own = &s->anisotropy[i];
      relative_mobility(1 + 2 * t * b * isph_speed_through_soil(s, i), t * s->drag_a[i], own->drag,
                        own->relative);
      find_shape(s, &s->chunks[c], i);
    }
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->shape)});
}

/* n.S.n for an S in single precision. */
static double along(const float shape[6], const double n[3]) {
  double wide[6] = {0};
  for (int k = 0; k < 6; k++) wide[k] = (double)shape[k];
  return symmetric_along(wide, n);
}

static void direction(const struct isph *s, const struct isph_chunk *chunk, size_t p, size_t i,
                      double n[3]) {
  double square = 0;
  isph_separation(s, s->position[i], s->position, chunk->pair[p], n);
  for (int a = 0; a < 3; a++) square += n[a] * n[a];
  for (int a = 0; a < 3 && square > 0; a++) n[a] /= sqrt(square);
}

void isph_anisotropy_pairs(struct isph *s) {
  if (s->on.links) return;
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++)
      for (size_t p = s->pair_first[i], end = p + s->pair_number[i]; p < end; p++) {
        const size_t j = chunk->pair[p] & PAIR_MASK;
        double n[3];
        direction(s, chunk, p, i, n);
        chunk->mobility[p] = (float)(0.5 * (s->mobility[i] * exp(along(s->shape[i], n)) +
                                            s->mobility[j] * exp(along(s->shape[j], n))));
      }
  }
}

/* n.K.n of a soil's relative mobility, averaged over the interface normals n at both ends of a
 * pair; 0 if neither end has a normal. */
static double across_interface(const struct isph *s, size_t i, size_t j, const double tensor[6]) {
  const double *a = s->anisotropy[i].normal, *b = s->anisotropy[j].normal;
  const double first = symmetric_along(tensor, a), second = symmetric_along(tensor, b);
  return first > 0 && second > 0 ? 0.5 * (first + second) : first + second;
}

struct isph_turned isph_anisotropy_way(const struct isph *s, size_t i, size_t j, const double n[3],
                                       const struct isph_parts *parts, double dt, double speed) {
  struct isph_turned turned = {0, 0};
  double resistance = 0, across = 0, shaped = 0;
  bool meets = parts->count > 1;
  for (size_t k = 0; k < parts->count; k++) {
    const struct region *soil = parts->at[k].soil;
    const double share = parts->at[k].share;
    struct isph_material of = {.porosity = 1, .inertia = 1};
    double shape = 0, mobility = 1;
    const double *relative = unit;
    if (soil != NULL) of = isph_material_of(s, soil);
    if (!s->on.drag_linear) of.a = 0;
    if (!s->on.drag_forchheimer) of.b = 0;
    if (soil != NULL && soil->anisotropic) {
      const int32_t bed = (int32_t)soil->first + 1;
      const bool from = s->anisotropy[i].bed == bed, to = s->anisotropy[j].bed == bed;
      if (from || to)
        shape = (from ? along(s->shape[i], n) : 0) + (to ? along(s->shape[j], n) : 0);
      else
        shape = symmetric_along(s->beds[bed - 1].shape, n);
      if (from && to) shape *= 0.5;
      mobility = symmetric_along(soil->anisotropy, n);
      relative = s->beds[bed - 1].mobility;
    }
    const double own = share * (of.inertia / dt + of.a + 2 * of.b * speed);
    const double normal = meets ? across_interface(s, i, j, relative) : 0;
    resistance += own * exp(-shape);
    meets = meets && normal > 0;
    if (meets) across += own / normal, shaped += share * exp(shape) / normal;
    turned.drag += share * of.a / mobility;
  }
  turned.mobility = meets ? shaped / (s->density * across) : 1 / (s->density * resistance);
  return turned;
}

void isph_anisotropy_edge(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                          const double f[3], double gradient[3]) {
  const double k = s->mobility[i], rho = s->density, *relative = s->anisotropy[i].relative;
  struct isph_edge edge = {.level = 0};
  double plain[3] = {0}, flux[3] = {0}, n[3], to[3], across = 0, out = 0;
  for (size_t p = s->pair_first[i], end = p + s->pair_number[i]; p < end; p++) {
    const size_t j = chunk->pair[p] & PAIR_MASK;
    double r[3];
    isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
    const double weight = s->volume[j] * (double)chunk->slope[p];
    const double fall =
        s->pressure[i] - s->pressure[j] - rho * (f[0] * r[0] + f[1] * r[1] + f[2] * r[2]);
    const double kij = (double)chunk->plain[p] / k;
    isph_edge_add(&edge, kij, weight, r);
    for (int a = 0; a < 3; a++) plain[a] += weight * kij * fall * r[a];
    for (int a = 0; a < 3; a++) flux[a] += weight * (double)chunk->mobility[p] / k * fall * r[a];
  }
  const double *interface = s->on.interfaces ? s->interface[i].normal : NULL;
  struct isph_edge_frame frame;
  isph_edge_find(&edge, interface, &frame);
  if (frame.share == 0) return;
  memcpy(n, frame.normal, sizeof n);
  isph_edge_turn(&frame, plain, gradient);
  for (int a = 0; a < 3; a++) across += n[a] * gradient[a];
  for (int a = 0; a < 3; a++) gradient[a] -= across * n[a];
  symmetric_times(relative, n, to);
  for (int a = 0; a < 3; a++) out += n[a] * flux[a] - to[a] * gradient[a];
  for (int a = 0; a < 3; a++) gradient[a] += n[a] * out / symmetric_along(relative, n);
}

void isph_anisotropy_present(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                             double present[3]) {
  for (int a = 0; a < 3; a++) present[a] = 1;
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    const size_t j = chunk->wall[p] & PAIR_MASK;
    if (s->boundary_kind[j] == BOUNDARY_OPEN_HEAD) continue;
    const double weight = isph_wall_volume(s, j) * (double)chunk->wall_slope[p];
    double r[3];
    isph_separation(s, s->position[i], s->boundary_position, chunk->wall[p], r);
    for (int a = 0; a < 3; a++) present[a] -= s->soil_fraction[i] * weight * r[a] * r[a];
  }
}
