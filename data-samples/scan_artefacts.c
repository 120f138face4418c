#include "data-samples/scan_artefacts.h"

#include <math.h>

#include "common/memory.h"

enum { RADIUS_MAX = 31 };

static const double TEXTURE_LENGTH = 30e-6; /* m, lattice spacing of the variation in a grain */

/* Levels as measured on scans of quartz sandstone: pore 40, quartz 119, edge 10-90 % 3 voxels,
 * fringe 6 levels; here brought to quartz at 100. */
const struct scan_settings SCAN_DEFAULTS = {.grain_grey = 100,
                                            .pore_grey = 22,
                                            .grain_spread = 0.04,
                                            .texture_spread = 0.02,
                                            .bright_share = 0.005,
                                            .blur = 11.1e-6,
                                            .fringe = 0.70,
                                            .noise_ratio = 8,
                                            .noise_length = 0.7,
                                            .ring = 0.06,
                                            .drift = 1.2};

enum status scan_artefacts_create(struct scan_artefacts *scan, const struct grain_field *field,
                                  const struct scan_settings *settings, long grains,
                                  uint64_t seed) {
  enum status status = STATUS_OK;
  const double contrast = settings->grain_grey - settings->pore_grey;
  const uint64_t grey_key = random_key(seed, RANDOM_GREY);
  const long *extent = field->extent;
  const size_t voxels =
      (size_t)extent[0] * (size_t)extent[1] * (size_t)(SCAN_CHUNK + 2 * field->halo);
  *scan = (struct scan_artefacts){.field = field, .settings = *settings, .seed = seed};
  TRY(noise_lattice_create(&scan->texture, seed, RANDOM_TEXTURE));
  TRY(memory_allocate(&scan->grain_grey, (size_t)grains + 1, sizeof(float), "grain greys"));
  for (long g = 1; g <= grains; g++) {
    struct random_sequence random = random_sequence_start(seed, RANDOM_GREY, (uint64_t)g);
    double factor = 1 + settings->grain_spread * random_normal(grey_key, (uint64_t)g << 32);
    if (random_uniform(&random, 0, 1) < settings->bright_share)
      factor = random_uniform(&random, 2.0, 2.5);
    scan->grain_grey[g] = (float)(settings->grain_grey * factor);
  }
  /* Every detector column is a little off, and one in 25 a lot, over 1 to 3 voxels. */
  scan->ring_count = 2 * (field->size[0] + field->size[1]) + 2;
  TRY(memory_allocate(&scan->ring, (size_t)scan->ring_count + 8, sizeof(float), "rings"));
  for (long r = 0; r < scan->ring_count; r++) {
    struct random_sequence random = random_sequence_start(seed, RANDOM_RING, (uint64_t)r);
    scan->ring[r] += (float)(contrast * settings->ring * random_uniform(&random, -0.15, 0.15));
    if (random_uniform(&random, 0, 1) > 0.02) continue;
    const double height = contrast * settings->ring * random_uniform(&random, -1, 1);
    const int width = (int)random_uniform(&random, 2, 7);
    for (int i = 0; i < width; i++) scan->ring[r + i] += (float)height;
  }
  for (int i = 0; i < 2; i++)
    TRY(memory_allocate(&scan->chunk[i], voxels, sizeof(float), "slices being rendered"));
cleanup:
  if (status != STATUS_OK) scan_artefacts_destroy(scan);
  return status;
}

void scan_artefacts_destroy(struct scan_artefacts *scan) {
  noise_lattice_destroy(&scan->texture);
  memory_free(&scan->grain_grey);
  memory_free(&scan->ring);
  for (int i = 0; i < 2; i++) memory_free(&scan->chunk[i]);
}

static int gaussian_radius(double sigma, long most) {
  const int radius = (int)ceil(3.3 * sigma);
  return radius < most ? radius : (int)most;
}

double scan_blur(const struct scan_settings *settings, double voxel) {
  const double blur = settings->blur / voxel;
  return settings->blur_kept ? blur : fmin(fmax(blur, 0.8), 1.9);
}

long scan_halo(const struct scan_settings *settings, double voxel) {
  const double widest = fmax(scan_blur(settings, voxel), settings->noise_length);
  const long reach = gaussian_radius(widest, RADIUS_MAX) + 1; /* and one for the Laplacian */
  return reach > FIELD_HALO || widest > 2 ? reach + 1 : FIELD_HALO;
}

/* Normalised Gaussian weights of at most `most` voxels' reach, weight[0] the centre; returns the
 * radius. */
static int gaussian_weights(double sigma, long most, float weight[RADIUS_MAX + 1]) {
  double value[RADIUS_MAX + 1] = {0}, sum = 0;
  const int radius = gaussian_radius(sigma, most);
  for (int k = 0; k <= radius; k++) {
    value[k] = exponential_negative(-k * k / (2 * sigma * sigma));
    sum += k ? 2 * value[k] : value[k];
  }
  for (int k = 0; k <= radius; k++) weight[k] = (float)(value[k] / sum);
  return radius;
}

/* Filters along x, y and z by strides over the flat chunk: rows run into each other, but only in
 * the halo, which nothing reads afterwards. Input and result in chunk[0]. */
static void gaussian_filter(struct scan_artefacts *scan, long layers, double sigma) {
  const long stride[3] = {1, scan->field->extent[0],
                          scan->field->extent[0] * scan->field->extent[1]};
  const long total = layers * stride[2];
  float weight[RADIUS_MAX + 1] = {0};
  const int radius = gaussian_weights(sigma, scan->field->halo - 2, weight);
  for (int axis = 0; axis < 3; axis++) {
    const float *from = scan->chunk[0];
    float *to = scan->chunk[1];
    const long s = stride[axis], margin = radius * s;
#pragma omp parallel for schedule(static)
    for (long row = margin / stride[1]; row < (total - margin) / stride[1]; row++) {
      const long begin = row * stride[1] < margin ? margin : row * stride[1];
      const long end =
          (row + 1) * stride[1] > total - margin ? total - margin : (row + 1) * stride[1];
      for (long i = begin; i < end; i++) to[i] = weight[0] * from[i];
      for (int k = 1; k <= radius; k++)
        for (long i = begin; i < end; i++) to[i] += weight[k] * (from[i - k * s] + from[i + k * s]);
    }
    scan->chunk[1] = scan->chunk[0];
    scan->chunk[0] = to;
  }
}

/* The object itself: partial volume from the distance, and the grain's own grey. */
static void draw_object(const struct scan_artefacts *scan, long z, float *layer) {
  const struct grain_field *field = scan->field;
  const struct scan_settings *settings = &scan->settings;
  const long nx = field->extent[0], ny = field->extent[1];
  const size_t base = (size_t)z * (size_t)(nx * ny);
  const float per_cell = (float)(field->voxel / TEXTURE_LENGTH);
  const uint64_t key = random_key(scan->seed, RANDOM_TEXTURE);
  const float pore = (float)settings->pore_grey, texture = (float)settings->texture_spread;
  for (long y = 0; y < ny; y++)
    for (long x = 0; x < nx; x++) {
      const size_t i = base + (size_t)(y * nx + x);
      float solid = 0.5F - (field->distance[i] - (float)field->offset);
      solid = solid < 0 ? 0 : solid > 1 ? 1 : solid;
      float value = pore;
      if (solid > 0) {
        const uint32_t g = field->label[i];
        const uint64_t shift = random_bits(key, g);
        const float grey =
            scan->grain_grey[g] *
            (1 + texture * noise_lattice_value(&scan->texture,
                                               (float)(shift & 63) + (float)x * per_cell,
                                               (float)(shift >> 6 & 63) + (float)y * per_cell,
                                               (float)(shift >> 12 & 63) + (float)z * per_cell));
        value += solid * (grey - pore);
      }
      layer[y * nx + x] = value;
    }
}

/* Slow wander over some forty slices, and a little jitter from each to the next. */
static double slice_drift(const struct scan_artefacts *scan, long z) {
  const uint64_t key = random_key(scan->seed, RANDOM_DRIFT);
  const long node = z / 40;
  const double weight = (double)(z % 40) / 40;
  const double wander = (1 - weight) * random_normal(key, (uint64_t)node) +
                        weight * random_normal(key, (uint64_t)node + 1);
  return scan->settings.drift *
         (wander + 0.25 * random_normal(key, ((uint64_t)1 << 32) + (uint64_t)z));
}

/* Pixels from the axis of rotation, which is not the middle of the crop. */
static double axis_distance(const struct scan_artefacts *scan, double x, double y) {
  const double dx = x - 0.47 * (double)scan->field->size[0];
  const double dy = y - 0.54 * (double)scan->field->size[1];
  return sqrt(dx * dx + dy * dy);
}

/* Outer parts look brighter where the soft part of the beam is lost on the way in (cupping). */
static float beam_factor(const struct scan_artefacts *scan, long x, long y) {
  const double r = axis_distance(scan, (double)x, (double)y);
  const double most = axis_distance(scan, (double)scan->field->size[0], 0);
  return (float)(1 + scan->settings.beam * (r / most) * (r / most));
}

static float ring_value(const struct scan_artefacts *scan, long x, long y) {
  const double r = 2 * axis_distance(scan, (double)x, (double)y);
  const long below = (long)r;
  const double weight = r - (double)below;
  return (float)((1 - weight) * scan->ring[below] + weight * scan->ring[below + 1]);
}

/* chunk[0], from layer z of the extent on: white noise that the filter will bring to `deviation`.
 */
static void draw_noise(const struct scan_artefacts *scan, long z, float amplitude, float *layer) {
  const long voxels = scan->field->extent[0] * scan->field->extent[1];
  const uint64_t key = random_key(scan->seed, RANDOM_NOISE);
  for (long i = 0; i < voxels; i++)
    layer[i] = amplitude * random_normal(key, (uint64_t)(z * voxels + i));
}

void scan_artefacts_render(struct scan_artefacts *scan, long z0, long count, float *grey) {
  const struct grain_field *field = scan->field;
  const struct scan_settings *settings = &scan->settings;
  const long nx = field->size[0], ny = field->size[1], row = field->extent[0], halo = field->halo;
  const long layers = count + 2 * field->halo, layer = row * field->extent[1];
  const double blur = scan_blur(settings, field->voxel);
  const float fringe = (float)(settings->fringe * blur * blur);

  float *object = scan->chunk[0];
#pragma omp parallel for schedule(static)
  for (long z = 0; z < layers; z++) draw_object(scan, z0 + z, object + z * layer);
  gaussian_filter(scan, layers, blur);
  const float *blurred = scan->chunk[0];
#pragma omp parallel for schedule(static)
  for (long z = 0; z < count; z++) {
    const float drift = (float)slice_drift(scan, z0 + z);
    for (long y = 0; y < ny; y++)
      for (long x = 0; x < nx; x++) {
        const float *at = blurred + ((z + halo) * field->extent[1] + y + halo) * row + x + halo;
        /* Propagation-based phase contrast adds the negative Laplacian (Bronnikov 2002, eq. 2). */
        const float laplacian =
            at[-1] + at[1] + at[-row] + at[row] + at[-layer] + at[layer] - 6 * at[0];
        grey[(z * ny + y) * nx + x] =
            (at[0] - fringe * laplacian) * beam_factor(scan, x, y) + drift + ring_value(scan, x, y);
      }
  }

  float weight[RADIUS_MAX + 1] = {0};
  const int radius = gaussian_weights(settings->noise_length, halo - 2, weight);
  double square = (double)weight[0] * weight[0];
  for (int k = 1; k <= radius; k++) square += 2 * (double)weight[k] * weight[k];
  const double deviation = (settings->grain_grey - settings->pore_grey) / settings->noise_ratio;
  const float amplitude = (float)(deviation / (square * sqrt(square))); /* three axes */
  float *noise = scan->chunk[0];
#pragma omp parallel for schedule(static)
  for (long z = 0; z < layers; z++) draw_noise(scan, z0 + z, amplitude, noise + z * layer);
  gaussian_filter(scan, layers, settings->noise_length);
  noise = scan->chunk[0];
#pragma omp parallel for schedule(static)
  for (long z = 0; z < count; z++)
    for (long y = 0; y < ny; y++)
      for (long x = 0; x < nx; x++)
        grey[(z * ny + y) * nx + x] +=
            noise[((z + halo) * field->extent[1] + y + halo) * row + x + halo];
}
