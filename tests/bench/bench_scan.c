/* bench_scan BIN FOLDER JSON [SIDE]: ct2model on a stack of SIDE^3 16-bit voxels (1000): memory,
 * and pixels a second beside libtiff's plain decoding on as many threads, in the same run. The
 * stack is the sample sand, repeated by reflection so that no seam shows. Also info on 2000 slices.
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

static double decode_stack(const char *folder, size_t side) {
  double started = clock_seconds();
#pragma omp parallel
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

static void bench_codec(char *program, const char *out, size_t side, const char *codec,
                        uint16_t compression) {
  char base[500], folder[500], model[520], size[80], name[80], threads[8];
  double pixels = (double)side * (double)side * (double)side, megabytes, rate[3];
  snprintf(base, sizeof base, "%s/tile", out);
  snprintf(folder, sizeof folder, "%s/%s", out, codec);
  snprintf(model, sizeof model, "%s/model.hdf", out);
  snprintf(size, sizeof size, "%zux%zux%zu", side / 8, side / 8, side / 8);
  snprintf(threads, sizeof threads, "%d", omp_get_max_threads());
  make_stack(base, folder, side, compression);
  (void)decode_stack(folder, side); /* into the page cache */
  double decode = decode_stack(folder, side);
  rate[0] = pixels / decode;
  printf("%s: libtiff decodes %.0f million pixels a second on %s threads\n", codec, rate[0] * 1e-6,
         threads);
  for (int build = 0; build < 2; build++) {
    char *const words[] = {program,  build ? "build" : "sweep",
                           folder,   "--void-ratio",
                           "0.725",  "--voxel-size",
                           "5.83um", "--size",
                           size,     "--threads",
                           threads,  "--quiet",
                           "--json", build ? "-o" : NULL,
                           model,    NULL};
    fflush(stdout);
    int keep = dup(1);
    if (freopen("/dev/null", "w", stdout) == NULL) exit(1);
    double seconds = run(words, &megabytes);
    fflush(stdout);
    dup2(keep, 1);
    close(keep);
    rate[1] = pixels / seconds;
    snprintf(name, sizeof name, "%s %s: memory, MB", codec, words[1]);
    record(name, 400.0, megabytes, 400.0, false, seconds);
    snprintf(name, sizeof name, "%s %s: speed / libtiff's", codec, words[1]);
    record(name, rate[0], rate[1] / rate[0], 0.7, true, seconds);
  }
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
  bench_info(program, argv[2]);
  bench_codec(program, argv[2], side, "uncompressed", COMPRESSION_NONE);
  bench_codec(program, argv[2], side, "lzw", COMPRESSION_LZW);
  bench_codec(program, argv[2], side, "deflate", COMPRESSION_ADOBE_DEFLATE);
  fputs("]\n", json);
  fclose(json);
  return failures > 0;
}
