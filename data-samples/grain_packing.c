#include "data-samples/grain_packing.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

#define PI 3.14159265358979323846

enum { STEPS = 400, DIRECTIONS_TRIED = 6 };

/* Lengths in units of the mean grain diameter. */
static const double CONTACT_OVERLAP = 0.008; /* depth at which a contact is at rest */
static const double PULL_NEAR = 0.02;        /* gaps narrower than this close */
static const double PULL_FAR = 0.15;         /* the same for grains with too few contacts */
static const double PULL = 0.006;            /* against a push of 1 per unit of overlap */
static const double SKIN = 0.06;             /* travel after which pairs are looked up again */
static const double STEP = 0.10, MOMENTUM = 0.80;

enum { CONTACTS_WANTED = 4 };

struct pair {
  int32_t a, b;
  double normal[3]; /* unit, from a to b, along which the two are farthest apart */
  double gap;       /* m; negative: overlap */
};

struct pair_list {
  struct pair *pair;
  long count, capacity;
};

static double wrap(double x, double box) {
  if (x > 0.5 * box) return x - box;
  if (x < -0.5 * box) return x + box;
  return x;
}

/* The vector from the centre of a to the nearest image of the centre of b. */
static void separation(const struct grain_packing *packing, const double a[3], const double b[3],
                       double d[3]) {
  for (int i = 0; i < 3; i++) d[i] = wrap(b[i] - a[i], packing->box[i]);
}

static enum status pair_list_reserve(struct pair_list *list, long wanted) {
  if (wanted <= list->capacity) return STATUS_OK;
  const long capacity = wanted > 2 * list->capacity ? wanted + 4096 : 2 * list->capacity;
  const enum status status =
      memory_resize(&list->pair, (size_t)capacity, sizeof *list->pair, "pairs of grains");
  if (status == STATUS_OK) list->capacity = capacity;
  return status;
}

static enum status pair_list_add(struct pair_list *list, long a, long b, const double d[3]) {
  const enum status status = pair_list_reserve(list, list->count + 1);
  if (status != STATUS_OK) return status;
  struct pair *pair = &list->pair[list->count++];
  const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + 1e-12;
  *pair = (struct pair){.a = (int32_t)a, .b = (int32_t)b};
  for (int i = 0; i < 3; i++) pair->normal[i] = d[i] / length;
  return STATUS_OK;
}

static enum status pair_list_append(struct pair_list *list, const struct pair_list *more) {
  const enum status status = pair_list_reserve(list, list->count + more->count);
  if (status != STATUS_OK) return status;
  memcpy(list->pair + list->count, more->pair, (size_t)more->count * sizeof *more->pair);
  list->count += more->count;
  return STATUS_OK;
}

/* The bounding sphere of a grain: grains are too large to be walked through for their centres. */
struct ball {
  double centre[3], radius;
};

/* The grains in bins: those of a bin are first[bin], next[that], ... */
struct bins {
  long count[3];
  int32_t *first, *next;
  const struct ball *ball;
};

/* Pairs a < b of which a is in `bin`, whose bounding spheres come within `reach`. */
static enum status find_in_bin(const struct grain_packing *packing, const struct bins *bins,
                               long bin, double reach, struct pair_list *list) {
  const long *n = bins->count;
  for (int offset = 0; offset < 27; offset++) {
    const int step[3] = {offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1};
    const long at[3] = {bin % n[0], bin / n[0] % n[1], bin / (n[0] * n[1])};
    long other = 0;
    int repeated = 0;
    for (int i = 2; i >= 0; i--) {
      repeated |= n[i] == 1 && step[i] != 0;
      other = other * n[i] + (at[i] + step[i] + n[i]) % n[i];
    }
    if (repeated) continue;
    for (int32_t a = bins->first[bin]; a >= 0; a = bins->next[a])
      for (int32_t b = bins->first[other]; b >= 0; b = bins->next[b]) {
        if (b <= a) continue;
        double d[3];
        separation(packing, bins->ball[a].centre, bins->ball[b].centre, d);
        const double limit = bins->ball[a].radius + bins->ball[b].radius + reach;
        if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= limit * limit) continue;
        const enum status status = pair_list_add(list, a, b, d);
        if (status != STATUS_OK) return status;
      }
  }
  return STATUS_OK;
}

/* All pairs a < b whose bounding spheres come within `reach`, found by bins. */
static enum status pair_list_find(struct pair_list *list, const struct grain_packing *packing,
                                  double reach) {
  enum status status = STATUS_OK;
  int32_t *first = NULL, *next = NULL;
  struct ball *ball = NULL;
  double radius = 0;
  long bins[3], total = 1;
  TRY(memory_allocate(&ball, (size_t)packing->count, sizeof *ball, "bins of grains"));
  for (long g = 0; g < packing->count; g++) {
    const struct grain *grain = &packing->grain[g];
    ball[g].radius = grain->radius;
    for (int i = 0; i < 3; i++) ball[g].centre[i] = grain->centre[i];
    radius = fmax(radius, grain->radius);
  }
  for (int i = 0; i < 3; i++) {
    bins[i] = (long)(packing->box[i] / (2 * radius + reach));
    if (bins[i] < 3) bins[i] = 1; /* too few for each neighbour to be another bin */
    total *= bins[i];
  }
  list->count = 0;
  TRY(memory_allocate(&first, (size_t)total, sizeof *first, "bins of grains"));
  TRY(memory_allocate(&next, (size_t)packing->count, sizeof *next, "bins of grains"));
  for (long bin = 0; bin < total; bin++) first[bin] = -1;
  for (long g = packing->count - 1; g >= 0; g--) {
    long bin = 0;
    for (int i = 2; i >= 0; i--) {
      long cell = (long)(ball[g].centre[i] / packing->box[i] * (double)bins[i]);
      if (cell >= bins[i]) cell = bins[i] - 1;
      bin = bin * bins[i] + cell;
    }
    next[g] = first[bin];
    first[bin] = (int32_t)g;
  }
  const struct bins all = {{bins[0], bins[1], bins[2]}, first, next, ball};
  /* Bins are appended in their order: the same list on any number of threads. */
  enum status found = STATUS_OK;
#pragma omp parallel
  {
    struct pair_list own = {0};
#pragma omp for ordered schedule(dynamic, 8)
    for (long bin = 0; bin < total; bin++) {
      own.count = 0;
      enum status here = find_in_bin(packing, &all, bin, reach, &own);
#pragma omp ordered
      {
        if (here == STATUS_OK && found == STATUS_OK) here = pair_list_append(list, &own);
        if (here != STATUS_OK) found = here;
      }
    }
    memory_free(&own.pair);
  }
  if (found != STATUS_OK) TRY_FAIL(found, "no memory for the pairs of grains");
cleanup:
  memory_free(&ball);
  memory_free(&first);
  memory_free(&next);
  return status;
}

/* Width of the slab of normal n that keeps the two grains apart; negative where they overlap.
 * Support functions: the gap of two convex bodies is the maximum of this over all n. */
static double slab_width(const struct grain *a, const struct grain *b, const double d[3],
                         const double n[3]) {
  const float *far_a = a->support[direction_set_find(n[0], n[1], n[2])];
  const float *far_b = b->support[direction_set_find(-n[0], -n[1], -n[2])];
  double width = 0;
  for (int i = 0; i < 3; i++) width += n[i] * (d[i] + far_b[i] - far_a[i]);
  return width;
}

/* Improves the pair's normal by trying directions on a cone of slope `slope` around it. */
static void pair_refine(struct pair *pair, const struct grain_packing *packing, double slope) {
  /* cosine and sine of multiples of 60 degrees */
  static const double circle[DIRECTIONS_TRIED][2] = {
      {1, 0},  {0.5, 0.866025403784},   {-0.5, 0.866025403784},
      {-1, 0}, {-0.5, -0.866025403784}, {0.5, -0.866025403784}};
  const struct grain *a = &packing->grain[pair->a], *b = &packing->grain[pair->b];
  double d[3], u[3], v[3], best[3];
  const double *n = pair->normal;
  separation(packing, a->centre, b->centre, d);
  pair->gap = slab_width(a, b, d, n);
  const int axis = fabs(n[0]) < 0.6 ? 0 : 1;
  double length = 0;
  for (int i = 0; i < 3; i++) {
    best[i] = n[i];
    u[i] = (i == axis) - n[axis] * n[i];
    length += u[i] * u[i];
  }
  for (int i = 0; i < 3; i++) u[i] /= sqrt(length);
  for (int i = 0; i < 3; i++)
    v[i] = n[(i + 1) % 3] * u[(i + 2) % 3] - n[(i + 2) % 3] * u[(i + 1) % 3];
  for (int t = 0; t < DIRECTIONS_TRIED; t++) {
    double trial[3];
    for (int i = 0; i < 3; i++)
      trial[i] =
          (n[i] + slope * (circle[t][0] * u[i] + circle[t][1] * v[i])) / sqrt(1 + slope * slope);
    const double gap = slab_width(a, b, d, trial);
    if (gap > pair->gap) {
      pair->gap = gap;
      for (int i = 0; i < 3; i++) best[i] = trial[i];
    }
  }
  for (int i = 0; i < 3; i++) pair->normal[i] = best[i];
}

/* Drops pairs too far apart to meet before the next look-up: long grains have many of them, and the
 * gap found is never more than the true one. */
static void pair_list_trim(struct pair_list *list, double reach) {
  long kept = 0;
  for (long p = 0; p < list->count; p++)
    if (list->pair[p].gap < reach) list->pair[kept++] = list->pair[p];
  list->count = kept;
}

/* Positive: pushes the two apart. `pull` ramps up from 0 to 1 as the packing settles. */
static double pair_force(const struct pair *pair, const int *contacts, double unit, double pull) {
  const double overlap = -pair->gap / unit;
  if (overlap > 0) {
    const double push = overlap - pull * CONTACT_OVERLAP;
    return push > -PULL * pull ? push : -PULL * pull;
  }
  const int lonely = contacts[pair->a] < CONTACTS_WANTED || contacts[pair->b] < CONTACTS_WANTED;
  return -overlap < (lonely ? PULL_FAR : PULL_NEAR) ? -pull * PULL : 0;
}

static enum status grain_packing_settle(struct grain_packing *packing, double unit) {
  enum status status = STATUS_OK;
  struct pair_list list = {0};
  double *velocity = NULL;
  int *contacts = NULL, *contacts_next = NULL;
  double travelled = 1e30;
  const double reach = (PULL_FAR + 2 * SKIN) * unit;
  struct progress progress;
  TRY(memory_allocate(&velocity, (size_t)packing->count * 3, sizeof(double), "grain velocities"));
  TRY(memory_allocate(&contacts, (size_t)packing->count, sizeof(int), "grain contacts"));
  TRY(memory_allocate(&contacts_next, (size_t)packing->count, sizeof(int), "grain contacts"));
  progress_start(&progress, "packing", "steps", STEPS);
  for (int step = 0; step < STEPS; step++) {
    const int renewed = travelled > SKIN * unit;
    if (renewed) {
      TRY(pair_list_find(&list, packing, reach));
      travelled = 0;
    }
    /* Pairs are independent: the same bits on any number of threads. */
#pragma omp parallel for schedule(static)
    for (long p = 0; p < list.count; p++) {
      if (renewed)
        for (double slope = 0.8; slope > 0.15 && list.pair[p].gap < reach; slope *= 0.7)
          pair_refine(&list.pair[p], packing, slope);
      pair_refine(&list.pair[p], packing, step % 2 ? 0.25 : 0.07);
    }
    if (renewed) pair_list_trim(&list, reach);
    const double pull = step < STEPS / 4 ? 0 : step < STEPS / 2 ? 4.0 * step / STEPS - 1 : 1;
    for (long i = 0; i < 3 * packing->count; i++) velocity[i] *= MOMENTUM;
    for (long g = 0; g < packing->count; g++) contacts_next[g] = 0;
    for (long p = 0; p < list.count; p++) {
      const struct pair *pair = &list.pair[p];
      const double force = STEP * unit * pair_force(pair, contacts, unit, pull);
      for (int i = 0; i < 3; i++) {
        velocity[3 * pair->a + i] -= force * pair->normal[i];
        velocity[3 * pair->b + i] += force * pair->normal[i];
      }
      contacts_next[pair->a] += pair->gap < 0;
      contacts_next[pair->b] += pair->gap < 0;
    }
    double fastest = 0;
    for (long g = 0; g < packing->count; g++) {
      double square = 0;
      for (int i = 0; i < 3; i++) square += velocity[3 * g + i] * velocity[3 * g + i];
      const double limit = 0.05 * unit, scale = square > limit * limit ? limit / sqrt(square) : 1;
      for (int i = 0; i < 3; i++) {
        double *x = &packing->grain[g].centre[i];
        velocity[3 * g + i] *= scale;
        *x += velocity[3 * g + i];
        if (*x < 0) *x += packing->box[i];
        if (*x >= packing->box[i]) *x -= packing->box[i];
      }
      contacts[g] = contacts_next[g];
      if (sqrt(square) * scale > fastest) fastest = sqrt(square) * scale;
    }
    travelled += fastest;
    progress_update(&progress, step + 1, NULL);
  }
  progress_end(&progress);
cleanup:
  memory_free(&list.pair);
  memory_free(&velocity);
  memory_free(&contacts);
  memory_free(&contacts_next);
  return status;
}

/* Grains on a jittered lattice, in random order: sizes are drawn independently, so the order of
 * the lattice is as good as any. */
static void grain_packing_scatter(struct grain_packing *packing, uint64_t seed) {
  struct random_sequence random = random_sequence_start(seed, RANDOM_PLACE, 0);
  const double volume = packing->box[0] * packing->box[1] * packing->box[2];
  double spacing = 1e-3 * sqrt(packing->box[0] * packing->box[1]);
  long cells[3];
  do {
    spacing *= 1.001;
    for (int i = 0; i < 3; i++) cells[i] = (long)ceil(packing->box[i] / spacing);
  } while (spacing * spacing * spacing * (double)packing->count < volume &&
           cells[0] * cells[1] * cells[2] > packing->count);
  while (cells[0] * cells[1] * cells[2] < packing->count) cells[2]++;
  const long total = cells[0] * cells[1] * cells[2];
  long g = 0;
  for (long cell = 0; cell < total && g < packing->count; cell++) {
    const double wanted = (double)(packing->count - g) / (double)(total - cell);
    if (random_uniform(&random, 0, 1) >= wanted) continue;
    const long at[3] = {cell % cells[0], cell / cells[0] % cells[1], cell / (cells[0] * cells[1])};
    for (int i = 0; i < 3; i++)
      packing->grain[g].centre[i] =
          ((double)at[i] + random_uniform(&random, 0, 0.999)) / (double)cells[i] * packing->box[i];
    g++;
  }
}

enum status grain_packing_create(struct grain_packing *packing, const double box[3],
                                 double solid_fraction, const struct grain_recipe *recipe,
                                 uint64_t seed) {
  enum status status = STATUS_OK;
  struct direction_set *set = NULL;
  double volume = 1, filled = 0;
  long capacity;
  *packing = (struct grain_packing){0};
  for (int i = 0; i < 3; i++) {
    packing->box[i] = box[i];
    volume *= box[i];
  }
  const double mean = 0.5 * (recipe->smallest + recipe->largest);
  const double coarse =
      1 - grain_fines_number(recipe); /* fines add to the number, not the volume */
  capacity = (long)(1.05 * solid_fraction * volume / (PI / 6 * mean * mean * mean) *
                    (1 - recipe->fines) / coarse) +
             64;
  TRY(memory_allocate(&set, 1, sizeof *set, "directions"));
  TRY(memory_allocate(&packing->grain, (size_t)capacity, sizeof *packing->grain, "grains"));
  direction_set_create(set);
#pragma omp parallel for schedule(dynamic, 16)
  for (long g = 0; g < capacity; g++)
    grain_create(&packing->grain[g], set, seed, (uint64_t)g, recipe);
  while (packing->count < capacity && filled < solid_fraction * volume) {
    const double d = packing->grain[packing->count++].diameter;
    filled += PI / 6 * d * d * d;
  }
  grain_packing_scatter(packing, seed);
  TRY(grain_packing_settle(packing, mean));
cleanup:
  memory_free(&set);
  if (status != STATUS_OK) grain_packing_destroy(packing);
  return status;
}

void grain_packing_destroy(struct grain_packing *packing) {
  memory_free(&packing->grain);
}
