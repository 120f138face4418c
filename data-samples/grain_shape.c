#include "data-samples/grain_shape.h"

#include <math.h>

#define PI 3.14159265358979323846

static const double FINES_SIZE = 1.0 / 3; /* of the other grains */

void direction_set_create(struct direction_set *set) {
  double sum = 0;
  for (int face = 0, n = 0; face < 6; face++)
    for (int j = 0; j < GRAIN_TABLE; j++)
      for (int i = 0; i < GRAIN_TABLE; i++, n++) {
        const double u = (2 * i + 1.0) / GRAIN_TABLE - 1, v = (2 * j + 1.0) / GRAIN_TABLE - 1;
        const double length = sqrt(1 + u * u + v * v);
        const int axis = face / 2;
        set->direction[n][axis] = (face % 2 ? -1 : 1) / length;
        set->direction[n][(axis + 1) % 3] = u / length;
        set->direction[n][(axis + 2) % 3] = v / length;
        set->weight[n] = 1 / (length * length * length);
        sum += set->weight[n];
      }
  for (int n = 0; n < GRAIN_DIRECTIONS; n++) set->weight[n] /= sum;
}

int direction_set_find(double x, double y, double z) {
  const double v[3] = {x, y, z};
  int axis = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(v[i]) > fabs(v[axis])) axis = i;
  const double scale = GRAIN_TABLE / (2 * fabs(v[axis]));
  int i = (int)(v[(axis + 1) % 3] * scale + GRAIN_TABLE / 2.0);
  int j = (int)(v[(axis + 2) % 3] * scale + GRAIN_TABLE / 2.0);
  if (i > GRAIN_TABLE - 1) i = GRAIN_TABLE - 1;
  if (j > GRAIN_TABLE - 1) j = GRAIN_TABLE - 1;
  return ((2 * axis + (v[axis] < 0)) * GRAIN_TABLE + j) * GRAIN_TABLE + i;
}

/* Signed distance, but for a scale, of the point t * u from the surface. */
static double grain_level(const struct grain *grain, const double u[3], double t) {
  float level = -1e30F;
  for (int f = 0; f < grain->faces; f++) {
    const float *n = grain->normal[f];
    const float d = (float)(t * (n[0] * u[0] + n[1] * u[1] + n[2] * u[2])) - grain->distance[f];
    level = f ? grain_round(level, d, (float)grain->edge_radius) : d;
  }
  return level;
}

/* Distance from the centre to the surface along u; the level grows with t, and is convex. */
static double grain_surface(const struct grain *grain, const double u[3]) {
  double high = 4, low = 0;
  for (int f = 0; f < grain->faces; f++) {
    const float *n = grain->normal[f];
    const double slope = n[0] * u[0] + n[1] * u[1] + n[2] * u[2];
    if (slope * high > grain->distance[f]) high = grain->distance[f] / slope;
  }
  double level_low = grain_level(grain, u, low), level_high = grain_level(grain, u, high);
  for (int i = 0; i < 12 && level_high - level_low > 1e-7; i++) {
    const double t = low - level_low * (high - low) / (level_high - level_low);
    const double level = grain_level(grain, u, t);
    if (fabs(level) < 1e-6) return t;
    if (level < 0) {
      low = t;
      level_low = level;
    } else {
      high = t;
      level_high = level;
    }
  }
  return low;
}

/* Faces spread over the sphere: each the farthest from its forerunners among six drawn. */
static void draw_faces(struct grain *grain, struct random_sequence *random, enum grain_form form) {
  static const double wide[][2] = {{0.65, 1.0}, {0.85, 1.0}, {0.45, 0.55}};
  double drawn[GRAIN_FACES_MAX][3];
  double ratio[3] = {1, random_uniform(random, wide[form][0], wide[form][1]), 0}, axis[3][3];
  const double thick = form == GRAIN_LONG ? 0.8 : wide[form][0];
  ratio[2] = ratio[1] * random_uniform(random, thick, 1.0);
  random_direction(random, axis[0]);
  double dot;
  do {
    random_direction(random, axis[1]);
    dot = axis[0][0] * axis[1][0] + axis[0][1] * axis[1][1] + axis[0][2] * axis[1][2];
  } while (fabs(dot) > 0.9);
  for (int i = 0; i < 3; i++) axis[1][i] = (axis[1][i] - dot * axis[0][i]) / sqrt(1 - dot * dot);
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    axis[2][i] = axis[0][j] * axis[1][k] - axis[0][k] * axis[1][j];
  }
  grain->faces = 10 + (int)random_uniform(random, 0, GRAIN_FACES_MAX - 9);
  for (int f = 0; f < grain->faces; f++) {
    double best = 2;
    for (int candidate = 0; candidate < 6; candidate++) {
      double u[3], nearest = -1;
      random_direction(random, u);
      for (int g = 0; g < f; g++) {
        const double cosine = u[0] * drawn[g][0] + u[1] * drawn[g][1] + u[2] * drawn[g][2];
        if (cosine > nearest) nearest = cosine;
      }
      if (nearest < best) {
        best = nearest;
        for (int i = 0; i < 3; i++) drawn[f][i] = u[i];
      }
    }
    double n[3] = {0}, length = 0;
    for (int a = 0; a < 3; a++)
      for (int i = 0; i < 3; i++) n[i] += drawn[f][a] / ratio[a] * axis[a][i];
    for (int i = 0; i < 3; i++) length += n[i] * n[i];
    length = sqrt(length);
    for (int i = 0; i < 3; i++) grain->normal[f][i] = (float)(n[i] / length);
    grain->distance[f] = (float)(random_uniform(random, 0.70, 1.0) / length);
  }
}

double grain_fines_number(const struct grain_recipe *recipe) {
  const double volume = FINES_SIZE * FINES_SIZE * FINES_SIZE;
  return recipe->fines / (recipe->fines + (1 - recipe->fines) * volume);
}

void grain_create(struct grain *grain, const struct direction_set *set, uint64_t seed,
                  uint64_t item, const struct grain_recipe *recipe) {
  struct random_sequence random = random_sequence_start(seed, RANDOM_SIZE, item);
  double hump = 0; /* few grains near the limits, most in the middle */
  for (int i = 0; i < 3; i++) hump += random_uniform(&random, 0, 1) / 3;
  grain->diameter = recipe->smallest + (recipe->largest - recipe->smallest) * hump;
  if (recipe->fines > 0 && random_uniform(&random, 0, 1) < grain_fines_number(recipe))
    grain->diameter *= FINES_SIZE;

  random = random_sequence_start(seed, RANDOM_SHAPE, item);
  draw_faces(grain, &random, recipe->form);
  grain->edge_radius = recipe->form == GRAIN_ROUND ? random_uniform(&random, 0.35, 0.60)
                                                   : random_uniform(&random, 0.04, 0.20);

  double surface[GRAIN_DIRECTIONS], volume = 0, radius = 0;
  for (int n = 0; n < GRAIN_DIRECTIONS; n++) {
    surface[n] = grain_surface(grain, set->direction[n]);
    volume += 4 * PI / 3 * set->weight[n] * surface[n] * surface[n] * surface[n];
  }
  /* Bodies of the same volume: (pi/6 d^3 / volume)^(1/3), by Newton to the last bits. */
  const double target = PI / 6 / volume;
  double scale = 1;
  for (int i = 0; i < 40; i++) scale -= (scale - target / (scale * scale)) / 3;
  scale *= grain->diameter;

  for (int f = 0; f < grain->faces; f++) grain->distance[f] *= (float)scale;
  grain->edge_radius *= scale;
  for (int n = 0; n < GRAIN_DIRECTIONS; n++) {
    surface[n] *= scale;
    if (surface[n] > radius) radius = surface[n];
  }
  grain->radius = radius * 1.02; /* the table may miss a corner by its spacing */
  for (int n = 0; n < GRAIN_DIRECTIONS; n++) {
    const double *u = set->direction[n];
    double best = -1;
    int farthest = 0;
    for (int m = 0; m < GRAIN_DIRECTIONS; m++) {
      const double *v = set->direction[m];
      const double reach = surface[m] * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
      if (reach > best) {
        best = reach;
        farthest = m;
      }
    }
    for (int i = 0; i < 3; i++)
      grain->support[n][i] = (float)(surface[farthest] * set->direction[farthest][i]);
  }
  for (int i = 0; i < 3; i++) grain->centre[i] = 0;
}
