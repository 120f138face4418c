/* bench_scan BIN FOLDER JSON [SIDE [CODEC]]: ct2model on a stack of SIDE^3 16-bit voxels (1000):
 * memory, and pixels a second beside libtiff's plain decoding, on one thread and on as many, in the
 * same run. The stack is the sample sand, repeated by reflection so that no seam shows. Also info
 * on 2000 slices.
 */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <tiffio.h>
#include <unistd.h>

#include "common/log.h"

enum { TILE = 250 };
static FILE *json;
static int failures, records;

static void record(const char *name, double reference, double measured, double bound, bool least,
                   double seconds) {
  bool pass = least ? measured >= bound : measured <= bound;
  if (!pass) failures++;
  fprintf(json,
          "%s{\"case\": \"%s\", \"status\": \"%s\", \"reference\": %.6g, \"measured\": %.6g, "
          "\"bound\": %.6g, \"seconds\": %.3f}",
          records++ > 0 ? ",\n " : "[", name, pass ? "pass" : "fail", reference, measured, bound,
          seconds);
  printf("%-52s %10.4g (%s %.4g) %s\n", name, measured, least ? "at least" : "at most", bound,
         pass ? "" : "FAIL");
  fflush(stdout);
}

/* Runs a program; seconds of wall clock, and its peak of memory in MB. */
static double run(char *const words[], double *megabytes) {
  double started = clock_seconds();
  struct rusage usage;
  int code = 0;
  pid_t child = fork();
  if (child == 0) {
    execv(words[0], words);
    _exit(127);
  }
  wait4(child, &code, 0, &usage);
  if (code != 0) {
    fprintf(stderr, "bench_scan: %s %s ended with code %d\n", words[0], words[1], code);
    exit(1);
  }
  *megabytes = (double)usage.ru_maxrss / 1024.0;
  return clock_seconds() - started;
}

static void write_slice(const char *path, const uint16_t *pixels, uint32_t nx, uint32_t ny,
                        uint16_t compression) {
  TIFF *tiff = TIFFOpen(path, "w");
  const uint32_t rows = compression == COMPRESSION_NONE ? ny : 16;
  if (tiff == NULL) exit(1);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, nx);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, ny);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows);
  for (uint32_t y = 0; y < ny; y += rows) {
    uint32_t n = ny - y < rows ? ny - y : rows;
    TIFFWriteEncodedStrip(tiff, y / rows, (void *)(uintptr_t)(pixels + (size_t)y * nx),
                          (tmsize_t)((size_t)n * nx * 2));
  }
  TIFFClose(tiff);
}

static void decode_slice(const char *path, void *out) {
  TIFF *tiff = TIFFOpen(path, "r");
  if (tiff == NULL) exit(1);
  unsigned char *at = out;
  for (uint32_t strip = 0; strip < TIFFNumberOfStrips(tiff); strip++)
    at += TIFFReadEncodedStrip(tiff, strip, at, -1);
  TIFFClose(tiff);
}

static size_t reflected(size_t i) {
  size_t at = i % (2 * TILE);
  return at < TILE ? at : 2 * TILE - 1 - at;
}

static void make_stack(const char *base, const char *folder, size_t side, uint16_t compression) {
  uint16_t *tile = malloc(sizeof *tile * TILE * TILE * TILE);
  char path[600];
  mkdir(folder, 0700);
  for (size_t z = 0; z < TILE; z++) {
    snprintf(path, sizeof path, "%s/slice_%04zu.tif", base, z);
    decode_slice(path, tile + z * TILE * TILE);
  }
#pragma omp parallel
  {
    uint16_t *pixels = malloc(sizeof *pixels * side * side);
#pragma omp for schedule(dynamic)
    for (size_t z = 0; z < side; z++) {
      char name[600];
      const uint16_t *from = tile + reflected(z) * TILE * TILE;
      for (size_t i = 0; i < side * side; i++)
        pixels[i] = from[reflected(i / side) * TILE + reflected(i % side)];
      snprintf(name, sizeof name, "%s/slice_%04zu.tif", folder, z);
      write_slice(name, pixels, (uint32_t)side, (uint32_t)side, compression);
    }
    free(pixels);
  }
  free(tile);
}

static double decode_stack(const char *folder, size_t side, int threads) {
  double started = clock_seconds();
#pragma omp parallel num_threads(threads)
  {
    void *pixels = malloc(2 * side * side);
#pragma omp for schedule(dynamic)
    for (size_t z = 0; z < side; z++) {
      char name[600];
      snprintf(name, sizeof name, "%s/slice_%04zu.tif", folder, z);
      decode_slice(name, pixels);
    }
    free(pixels);
  }
  return clock_seconds() - started;
}

struct work {
  const char *command, *name;
  size_t size; /* of the model, a side; 0: that of the scan */
};

static void bench_work(char *program, const char *out, char *folder, const struct work *work,
                       const char *codec, const double decode[2], double pixels) {
  char model[520], size[80], name[120], threads[8];
  double megabytes;
  snprintf(model, sizeof model, "%s/model.hdf", out);
  snprintf(size, sizeof size, "%zux%zux%zu", work->size, work->size, work->size);
  snprintf(threads, sizeof threads, "%d", omp_get_max_threads());
  char *words[20] = {program,  (char *)(uintptr_t)work->command,
                     folder,   "--void-ratio",
                     "0.725",  "--voxel-size",
                     "5.83um", "--threads",
                     threads,  "--quiet",
                     "--json"};
  int n = 11;
  if (work->size > 0) {
    words[n++] = "--size";
    words[n++] = size;
  }
  if (strcmp(work->command, "build") == 0) {
    words[n++] = "-o";
    words[n++] = model;
  }
  fflush(stdout);
  int keep = dup(1);
  if (freopen("/dev/null", "w", stdout) == NULL) exit(1);
  double seconds = run(words, &megabytes);
  fflush(stdout);
  dup2(keep, 1);
  close(keep);
  snprintf(name, sizeof name, "%s %s: memory, MB", codec, work->name);
  record(name, 400.0, megabytes, 400.0, false, seconds);
  for (int t = 0; t < 2; t++) {
    snprintf(name, sizeof name, "%s %s: speed / libtiff's on %s", codec, work->name,
             t == 0 ? "one thread" : "as many threads");
    record(name, pixels / decode[t], decode[t] / seconds, 0.7, true, seconds);
  }
}

static void bench_codec(char *program, const char *out, size_t side, const char *codec,
                        uint16_t compression) {
  char base[500], folder[500];
  double pixels = (double)side * (double)side * (double)side, megabytes, decode[2];
  const struct work works[] = {{"sweep", "sweep", side / 8},
                               {"sweep", "sweep, full size", 0},
                               {"build", "build, an eighth", side / 8},
                               {"build", "build, 240 a side", 240 * side / 1000}};
  snprintf(base, sizeof base, "%s/tile", out);
  snprintf(folder, sizeof folder, "%s/%s", out, codec);
  make_stack(base, folder, side, compression);
  (void)decode_stack(folder, side, 1); /* into the page cache */
  decode[0] = decode_stack(folder, side, 1);
  decode[1] = decode_stack(folder, side, omp_get_max_threads());
  printf("%s: libtiff decodes %.0f million pixels a second on one thread, %.0f on %d\n", codec,
         pixels / decode[0] * 1e-6, pixels / decode[1] * 1e-6, omp_get_max_threads());
  for (size_t i = 0; i < sizeof works / sizeof *works; i++)
    bench_work(program, out, folder, &works[i], codec, decode, pixels);
  char *const rm[] = {"/bin/rm", "-rf", folder, NULL};
  (void)run(rm, &megabytes);
}

static void bench_info(char *program, const char *out) {
  char folder[500], path[600];
  double megabytes;
  uint16_t pixels[64 * 64] = {0};
  snprintf(folder, sizeof folder, "%s/many", out);
  mkdir(folder, 0700);
  for (int i = 0; i < 2000; i++) {
    snprintf(path, sizeof path, "%s/slice_%04d.tif", folder, i);
    write_slice(path, pixels, 64, 64, COMPRESSION_NONE);
  }
  char *const words[] = {program, "info", folder, "--quiet", NULL};
  double seconds = run(words, &megabytes);
  record("info on 2000 slices, s", 1.0, seconds, 1.0, false, seconds);
}

int main(int argc, char **argv) {
  if (argc < 4) return 2;
  size_t side = argc > 4 ? strtoul(argv[4], NULL, 10) : 1000;
  char program[500], generator[500], tile[500], size[40];
  double megabytes;
  snprintf(program, sizeof program, "%s/ct2model", argv[1]);
  snprintf(generator, sizeof generator, "%s/generate_sand", argv[1]);
  snprintf(tile, sizeof tile, "%s/tile", argv[2]);
  snprintf(size, sizeof size, "%dx%dx%d", TILE, TILE, TILE);
  mkdir(argv[2], 0700);
  json = fopen(argv[3], "w");
  if (json == NULL) return 1;
  char *const words[] = {generator, "--output", tile,      "--size", size,
                         "--seed",  "2006",     "--quiet", NULL};
  if (access(tile, R_OK) != 0) (void)run(words, &megabytes);
  TIFFSetWarningHandler(NULL);
  static const struct {
    const char *name;
    uint16_t compression;
  } CODECS[] = {{"uncompressed", COMPRESSION_NONE},
                {"lzw", COMPRESSION_LZW},
                {"deflate", COMPRESSION_ADOBE_DEFLATE}};
  bench_info(program, argv[2]);
  for (size_t i = 0; i < sizeof CODECS / sizeof *CODECS; i++)
    if (argc < 6 || strcmp(argv[5], CODECS[i].name) == 0)
      bench_codec(program, argv[2], side, CODECS[i].name, CODECS[i].compression);
  fputs("]\n", json);
  fclose(json);
  return failures > 0;
}
