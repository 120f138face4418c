/* generate_sand: writes a synthetic CT stack of a sand similar to Toyoura sand, with an exact void
 * ratio, as a substitute for scans that are not public. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "common/error.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"
#include "data-samples/scan_artefacts.h"
#include "data-samples/slice_writer.h"

static const char HELP[] =
    "usage: generate_sand --output DIR [options]\n"
    "Makes a CT stack of a synthetic sand: angular grains of 105 to 215 um that touch and do not\n"
    "overlap, with the artefacts of a scanner. The same options give the same bytes, on any "
    "number\n"
    "of threads. Writes DIR/slice_NNNN.tif (or .png) and, last, DIR/sand.json.\n\n"
    "  --output DIR          where to write; earlier slices there are removed (required)\n"
    "  --format FORMAT       tiff16 (16 bit, grey * 256; default) or png8 (8 bit)\n"
    "  --size NXxNYxNZ       voxels (default 480x480x256)\n"
    "  --voxel-size Q        edge of a voxel (default 5.83um)\n"
    "  --void-ratio E        pore volume over grain volume (default 0.725)\n"
    "  --noise-ratio R       contrast over standard deviation of the noise (default 8)\n"
    "  --ring R              height of the strongest rings over contrast (default 0.06)\n"
    "  --beam R              beam hardening: greys rise by this share outwards (default 0)\n"
    "  --blur Q              standard deviation of the blur (default 11.1um, 0.8 to 1.9 voxels)\n"
    "  --fringe R            strength of the edge fringe, a Laplacian per blur^2 (default 0.7)\n"
    "  --noise-length R      voxels over which noise is correlated (default 0.7)\n"
    "  --grain-size Q        mean diameter of the grains (default 160um, 107.5 to 212.5um)\n"
    "  --grains FORM         angular (default), round or long\n"
    "  --fines R             share of the solid in grains of a third of the size (default 0)\n"
    "  --seed N              another sand for every number (default 1)\n"
    "  --truth FILE          the true voxels, raw, 1 byte each, x fastest: 1 grain, 0 pore\n"
    "  --truth-refine N      those of the same sand at N times as many voxels a side (default 1)\n"
    "  --threads N           (default: all cores)\n"
    "  --quiet, --help\n\n"
    "example: generate_sand --output dense --void-ratio 0.725 --seed 2006\n";

struct request {
  const char *output, *truth;
  enum slice_format format;
  long size[3];
  double voxel, void_ratio;
  uint64_t seed;
  int truth_refine;
  struct grain_recipe grains;
  struct scan_settings settings;
};

/* Sieve limits and mean diameter of the sand, m. The relief of the surface and the adjustment of
 * the void ratio change the final size of a grain by up to 2 %, hence the margins. */
static const double SMALLEST = 107.5e-6, LARGEST = 212.5e-6, MEAN = 160e-6;

static enum status parse_number(const char *option, const char *text, double low, double high,
                                double *value) {
  char *end;
  *value = strtod(text, &end);
  if (end == text || *end != '\0' || !(*value >= low && *value <= high))
    return FAIL(STATUS_USAGE, "--%s: '%s' is not a number from %g to %g", option, text, low, high);
  return STATUS_OK;
}

static enum status parse_length(const char *option, const char *text, double low, double high,
                                double *value) {
  if (quantity_parse(text, DIM_LENGTH, value) != STATUS_OK)
    return error_context(STATUS_USAGE, "--%s", option);
  if (!(*value >= low && *value <= high))
    return FAIL(STATUS_USAGE, "--%s: '%s' is not from %gum to %gum", option, text, low * 1e6,
                high * 1e6);
  return STATUS_OK;
}

static enum status parse_size(const char *text, long size[3]) {
  char rest;
  if (sscanf(text, "%ldx%ldx%ld%c", &size[0], &size[1], &size[2], &rest) != 3)
    return FAIL(STATUS_USAGE, "--size: '%s' is not of the form 480x480x256", text);
  for (int i = 0; i < 3; i++)
    if (size[i] < 8 || size[i] > 4096)
      return FAIL(STATUS_USAGE, "--size: '%s': each side must have 8 to 4096 voxels", text);
  return STATUS_OK;
}

static enum status parse_request(int argc, char **argv, struct request *request, int *help) {
  static const struct option options[] = {
      {"output", 1, NULL, 'o'},       {"format", 1, NULL, 'f'},       {"size", 1, NULL, 's'},
      {"voxel-size", 1, NULL, 'v'},   {"void-ratio", 1, NULL, 'e'},   {"seed", 1, NULL, 'S'},
      {"noise-ratio", 1, NULL, 'n'},  {"truth", 1, NULL, 't'},        {"threads", 1, NULL, 'j'},
      {"ring", 1, NULL, 'r'},         {"blur", 1, NULL, 'B'},         {"fringe", 1, NULL, 'F'},
      {"noise-length", 1, NULL, 'l'}, {"grain-size", 1, NULL, 'g'},   {"grains", 1, NULL, 'G'},
      {"fines", 1, NULL, 'i'},        {"truth-refine", 1, NULL, 'T'}, {"beam", 1, NULL, 'b'},
      {"quiet", 0, NULL, 'q'},        {"help", 0, NULL, 'h'},         {NULL, 0, NULL, 0}};
  enum status status = STATUS_OK;
  double number;
  opterr = 0;
  for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;) {
    switch (c) {
    case 'o':
      request->output = optarg;
      break;
    case 't':
      request->truth = optarg;
      break;
    case 'q':
      log_start("generate_sand", LOG_QUIET);
      break;
    case 'h':
      *help = 1;
      return STATUS_OK;
    case 's':
      TRY(parse_size(optarg, request->size));
      break;
    case 'v':
      TRY(parse_length("voxel-size", optarg, 1e-6, 30e-6, &request->voxel));
      break;
    case 'e':
      TRY(parse_number("void-ratio", optarg, 0.6, 1.1, &request->void_ratio));
      break;
    case 'n':
      TRY(parse_number("noise-ratio", optarg, 1, 1e4, &request->settings.noise_ratio));
      break;
    case 'r':
      TRY(parse_number("ring", optarg, 0, 1, &request->settings.ring));
      break;
    case 'b':
      TRY(parse_number("beam", optarg, 0, 1, &request->settings.beam));
      break;
    case 'F':
      TRY(parse_number("fringe", optarg, 0, 2, &request->settings.fringe));
      break;
    case 'l':
      TRY(parse_number("noise-length", optarg, 0.1, 4, &request->settings.noise_length));
      break;
    case 'i':
      TRY(parse_number("fines", optarg, 0, 0.5, &request->grains.fines));
      break;
    case 'T':
      TRY(parse_number("truth-refine", optarg, 1, 8, &number));
      request->truth_refine = (int)number;
      break;
    case 'B':
      TRY(parse_length("blur", optarg, 1e-7, 100e-6, &request->settings.blur));
      request->settings.blur_kept = 1;
      break;
    case 'g':
      TRY(parse_length("grain-size", optarg, 50e-6, 2e-3, &number));
      request->grains.smallest = number / MEAN * SMALLEST;
      request->grains.largest = number / MEAN * LARGEST;
      break;
    case 'G':
      if (strcmp(optarg, "angular") != 0 && strcmp(optarg, "round") != 0 &&
          strcmp(optarg, "long") != 0)
        TRY_FAIL(STATUS_USAGE, "--grains: '%s' is none of angular, round and long", optarg);
      request->grains.form = optarg[0] == 'a'   ? GRAIN_ANGULAR
                             : optarg[0] == 'r' ? GRAIN_ROUND
                                                : GRAIN_LONG;
      break;
    case 'S':
      TRY(parse_number("seed", optarg, 0, 4294967295.0, &number));
      request->seed = (uint64_t)number;
      break;
    case 'j':
      TRY(parse_number("threads", optarg, 1, 1024, &number));
#ifdef _OPENMP
      omp_set_num_threads((int)number);
#endif
      break;
    case 'f':
      if (strcmp(optarg, "tiff16") != 0 && strcmp(optarg, "png8") != 0)
        TRY_FAIL(STATUS_USAGE, "--format: '%s' is neither tiff16 nor png8", optarg);
      request->format = optarg[0] == 't' ? SLICE_TIFF16 : SLICE_PNG8;
      break;
    default:
      TRY_FAIL(STATUS_USAGE, "%s: no such option, or its value is missing; see --help",
               argv[optind - 1]);
    }
  }
  if (scan_halo(&request->settings, request->voxel) > 30)
    TRY_FAIL(STATUS_USAGE, "--blur: more than 8 voxels");
  if (optind < argc) TRY_FAIL(STATUS_USAGE, "%s: unexpected; see --help", argv[optind]);
  if (!request->output) TRY_FAIL(STATUS_USAGE, "--output DIR is missing; see --help");
cleanup:
  return status;
}

static enum status write_truth(const char *path, const struct grain_field *field) {
  enum status status = STATUS_OK;
  unsigned char *row = NULL;
  FILE *file = fopen(path, "wb");
  if (!file) return FAIL(STATUS_RUN, "%s: cannot be written", path);
  TRY(memory_allocate(&row, (size_t)field->size[0], 1, "row of voxels"));
  for (long z = 0; z < field->size[2]; z++)
    for (long y = 0; y < field->size[1]; y++) {
      for (long x = 0; x < field->size[0]; x++)
        row[x] = field->distance[grain_field_index(field, x, y, z)] < (float)field->offset;
      if (fwrite(row, 1, (size_t)field->size[0], file) != (size_t)field->size[0])
        TRY_FAIL(STATUS_RUN, "%s: writing failed", path);
    }
cleanup:
  if (fclose(file) != 0 && status == STATUS_OK)
    status = FAIL(STATUS_RUN, "%s: writing failed", path);
  memory_free(&row);
  return status;
}

static enum status write_slices(const struct request *request, struct scan_artefacts *scan) {
  enum status status = STATUS_OK;
  const long *size = request->size, voxels = size[0] * size[1];
  float *grey = NULL;
  struct progress progress;
  TRY(memory_allocate(&grey, (size_t)voxels * SCAN_CHUNK, sizeof *grey, "slices"));
  progress_start(&progress, "scanning", "slices", (double)size[2]);
  for (long z0 = 0; z0 < size[2]; z0 += SCAN_CHUNK) {
    const long count = size[2] - z0 < SCAN_CHUNK ? size[2] - z0 : SCAN_CHUNK;
    int failed = 0;
    scan_artefacts_render(scan, z0, count, grey);
#pragma omp parallel for schedule(dynamic, 1) reduction(| : failed)
    for (long z = 0; z < count; z++)
      failed |= slice_write(request->output, z0 + z, request->format, grey + z * voxels, size[0],
                            size[1], request->voxel) != STATUS_OK;
    if (failed) TRY_FAIL(STATUS_RUN, "%s: slices cannot be written", request->output);
    progress_update(&progress, (double)(z0 + count), NULL);
  }
  progress_end(&progress);
cleanup:
  memory_free(&grey);
  return status;
}

/* Writes the true voxels of the same sand in the same position, on finer voxels. */
static enum status write_fine_truth(const struct request *request,
                                    const struct grain_packing *packing) {
  enum status status = STATUS_OK;
  struct grain_field field = {0};
  struct field_request fine = {.voxel = request->voxel / request->truth_refine,
                               .halo = FIELD_HALO,
                               .refine = request->truth_refine,
                               .void_ratio = request->void_ratio,
                               .seed = request->seed};
  for (int i = 0; i < 3; i++) fine.size[i] = request->size[i] * request->truth_refine;
  TRY(grain_field_create(&field, packing, &fine));
  TRY(write_truth(request->truth, &field));
cleanup:
  grain_field_destroy(&field);
  return status;
}

/* Written under a temporary name and renamed: a folder that contains sand.json holds a complete
 * stack. */
static enum status write_description(const struct request *request, const char *path,
                                     const struct grain_field *field,
                                     const struct grain_statistics *statistics) {
  const struct scan_settings *s = &request->settings;
  const long *n = request->size;
  const double voxels = (double)n[0] * (double)n[1] * (double)n[2], solid = (double)field->solid;
  char partial[4200];
  snprintf(partial, sizeof partial, "%s.partial", path);
  FILE *file = fopen(partial, "w");
  if (!file) return FAIL(STATUS_RUN, "%s: cannot be written", partial);
  fprintf(file,
          "{\n"
          "  \"what\": \"synthetic sand CT stack, made by generate_sand\",\n"
          "  \"seed\": %llu,\n"
          "  \"size\": [%ld, %ld, %ld],\n"
          "  \"voxel_size_m\": %.6g,\n"
          "  \"format\": \"%s\",\n"
          "  \"grey_per_level\": %d,\n",
          (unsigned long long)request->seed, n[0], n[1], n[2], request->voxel,
          request->format == SLICE_TIFF16 ? "tiff16" : "png8",
          request->format == SLICE_TIFF16 ? 256 : 1);
  fprintf(file,
          "  \"void_ratio_requested\": %.6g,\n"
          "  \"void_ratio\": %.9f,\n"
          "  \"porosity\": %.9f,\n"
          "  \"solid_voxels\": %ld,\n"
          "  \"surface_offset_m\": %.4g,\n"
          "  \"overlap_cut\": %.5f,\n"
          "  \"grains\": %ld,\n"
          "  \"whole_grains\": %ld,\n"
          "  \"grain_diameter_m\": {\"min\": %.4g, \"mean\": %.4g, \"max\": %.4g},\n"
          "  \"coordination\": %.3f,\n"
          "  \"largest_cluster\": %.5f,\n",
          request->void_ratio, (voxels - solid) / solid, 1 - solid / voxels, field->solid,
          field->offset * field->voxel, field->shared, statistics->grains, statistics->whole_grains,
          statistics->diameter_min, statistics->diameter_mean, statistics->diameter_max,
          statistics->coordination, statistics->largest_cluster);
  if (s->beam > 0) fprintf(file, "  \"beam\": %g,\n", s->beam);
  fprintf(file,
          "  \"grain_grey\": %g,\n"
          "  \"pore_grey\": %g,\n"
          "  \"contrast_to_noise\": %g,\n"
          "  \"grain_spread\": %g,\n"
          "  \"texture_spread\": %g,\n"
          "  \"bright_grain_share\": %g,\n"
          "  \"blur_m\": %g,\n"
          "  \"noise_correlation_voxels\": %g,\n"
          "  \"fringe\": %g,\n"
          "  \"ring\": %g,\n"
          "  \"drift_levels\": %g\n"
          "}\n",
          s->grain_grey, s->pore_grey, s->noise_ratio, s->grain_spread, s->texture_spread,
          s->bright_share, s->blur, s->noise_length, s->fringe, s->ring, s->drift);
  const int failed = ferror(file);
  if (fclose(file) != 0 || failed || rename(partial, path) != 0)
    return FAIL(STATUS_RUN, "%s: writing failed", path);
  return STATUS_OK;
}

static enum status generate(const struct request *request) {
  enum status status = STATUS_OK;
  struct grain_packing packing = {0};
  struct grain_field field = {0};
  struct scan_artefacts scan = {0};
  struct grain_statistics statistics;
  double box[3];
  char description[4096];
  snprintf(description, sizeof description, "%s/sand.json", request->output);
  TRY(slice_folder_prepare(request->output));
  unlink(description);
  struct field_request wanted = {.voxel = request->voxel,
                                 .halo = scan_halo(&request->settings, request->voxel),
                                 .refine = 1,
                                 .void_ratio = request->void_ratio,
                                 .seed = request->seed};
  for (int i = 0; i < 3; i++) wanted.size[i] = request->size[i];
  grain_field_box(request->size, request->voxel, request->grains.largest, box);
  TRY(grain_packing_create(&packing, box, 1 / (1 + request->void_ratio), &request->grains,
                           request->seed));
  TRY(grain_field_create(&field, &packing, &wanted));
  TRY(grain_field_measure(&field, packing.count, &statistics));
  log_info("%ld grains, %.1f contacts each, %.2f %% of the solid in one skeleton; void ratio %.6f",
           statistics.grains, statistics.coordination, 100 * statistics.largest_cluster,
           (double)request->size[0] * (double)request->size[1] * (double)request->size[2] /
                   (double)field.solid -
               1);
  if (request->truth && request->truth_refine == 1) TRY(write_truth(request->truth, &field));
  if (request->truth && request->truth_refine > 1) TRY(write_fine_truth(request, &packing));
  TRY(scan_artefacts_create(&scan, &field, &request->settings, packing.count, request->seed));
  TRY(write_slices(request, &scan));
  TRY(write_description(request, description, &field, &statistics));
  log_info("%s: %ld slices; peak memory %.0f MB", request->output, request->size[2],
           (double)memory_peak() * 1e-6);
cleanup:
  grain_packing_destroy(&packing);
  grain_field_destroy(&field);
  scan_artefacts_destroy(&scan);
  return status;
}

int main(int argc, char **argv) {
  int help = 0;
  struct request request = {.format = SLICE_TIFF16,
                            .size = {480, 480, 256},
                            .voxel = 5.83e-6,
                            .void_ratio = 0.725,
                            .seed = 1,
                            .truth_refine = 1,
                            .grains = {.smallest = SMALLEST, .largest = LARGEST},
                            .settings = SCAN_DEFAULTS};
  log_start("generate_sand", LOG_NORMAL);
  enum status status = parse_request(argc, argv, &request, &help);
  if (status == STATUS_OK && help) fputs(HELP, stdout);
  if (status == STATUS_OK && !help) status = generate(&request);
  if (status != STATUS_OK) log_pending_error();
  return status;
}
