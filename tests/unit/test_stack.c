/* Stacks as labs write them: TIFF in its many layouts, PNG, raw, MetaImage, NRRD; and broken ones.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>
#include <zlib.h>

#include "common/error.h"
#include "ct2model/readers/slice_names.h"
#include "ct2model/readers/stack.h"

enum { NX = 37, NY = 21, NZ = 3 };
static char folder[256];

static const char *in_folder(const char *name) {
  static char path[4][400];
  static int turn;
  turn = (turn + 1) % 4;
  snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
  return path[turn];
}

static int group_setup(void **state) {
  (void)state;
  const char *build = getenv("BUILD");
  snprintf(folder, sizeof folder, "%s/stack-XXXXXX", build != NULL ? build : "/tmp");
  return mkdtemp(folder) == NULL;
}

static int group_teardown(void **state) {
  (void)state;
  char command[300];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

/* The pattern all images hold, in the range of 8 bits and a little smooth for JPEG. */
static int pattern(size_t x, size_t y, size_t z) {
  return (int)((3 * x + 5 * y + 40 * z) % 200);
}

struct layout {
  const char *name, *mode;
  uint16_t compression, bits, format, photometric, samples;
  int tile, rows;
};

static void put_sample(unsigned char *at, const struct layout *layout, int value) {
  double shifted = layout->format == SAMPLEFORMAT_INT ? value - 100 : value;
  uint16_t u16 = (uint16_t)(value * 256);
  int16_t i16 = (int16_t)(shifted * 100);
  uint32_t u32 = (uint32_t)value * 1000;
  float f32 = (float)shifted * 0.5f;
  double f64 = shifted * 0.25;
  if (layout->bits == 8)
    *at = (unsigned char)(int)shifted;
  else if (layout->bits == 16 && layout->format == SAMPLEFORMAT_INT)
    memcpy(at, &i16, 2);
  else if (layout->bits == 16)
    memcpy(at, &u16, 2);
  else if (layout->bits == 32 && layout->format == SAMPLEFORMAT_IEEEFP)
    memcpy(at, &f32, 4);
  else if (layout->bits == 32)
    memcpy(at, &u32, 4);
  else
    memcpy(at, &f64, 8);
}

static double expected(const struct layout *layout, size_t x, size_t y, size_t z) {
  double value = pattern(x, y, z);
  if (layout->photometric == PHOTOMETRIC_MINISWHITE) return 255.0 - value;
  if (layout->format == SAMPLEFORMAT_INT) value -= 100.0;
  if (layout->bits == 16) return layout->format == SAMPLEFORMAT_INT ? value * 100 : value * 256;
  if (layout->bits == 32) return layout->format == SAMPLEFORMAT_IEEEFP ? value * 0.5 : value * 1000;
  return layout->bits == 64 ? value * 0.25 : value;
}

static uint16_t orientation[NZ]; /* of the pages that are written; 0: no tag */

static void write_tiff(const char *path, const struct layout *layout) {
  TIFF *tiff = TIFFOpen(path, layout->mode);
  assert_non_null(tiff);
  for (size_t z = 0; z < NZ; z++) {
    size_t bytes = layout->bits / 8u * layout->samples;
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, NX);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, NY);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, layout->bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, layout->samples);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, layout->format);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout->compression);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, layout->photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 1e-2 / 5.83e-6);
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 1e-2 / 5.83e-6);
    if (orientation[z] > 0) TIFFSetField(tiff, TIFFTAG_ORIENTATION, orientation[z]);
    if (layout->photometric == PHOTOMETRIC_PALETTE) {
      uint16_t map[256];
      for (int i = 0; i < 256; i++) map[i] = (uint16_t)(i * 257);
      TIFFSetField(tiff, TIFFTAG_COLORMAP, map, map, map);
    }
    unsigned char block[64 * 64 * 8];
    if (layout->tile > 0) {
      size_t t = (size_t)layout->tile;
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, layout->tile);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, layout->tile);
      for (size_t y0 = 0; y0 < NY; y0 += t)
        for (size_t x0 = 0; x0 < NX; x0 += t) {
          for (size_t i = 0; i < t * t; i++)
            put_sample(block + i * bytes, layout, pattern(x0 + i % t, y0 + i / t, z));
          TIFFWriteTile(tiff, block, (uint32_t)x0, (uint32_t)y0, 0, 0);
        }
    } else {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layout->rows);
      for (size_t y = 0; y < NY; y++) {
        for (size_t x = 0; x < NX; x++)
          for (size_t s = 0; s < layout->samples; s++)
            put_sample(block + x * bytes + s * layout->bits / 8u, layout, pattern(x, y, z));
        TIFFWriteScanline(tiff, block, (uint32_t)y, 0);
      }
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

static void open_one(const char *path, const struct raw_layout *raw, struct stack *stack) {
  const char *paths[] = {path};
  enum status status = stack_open(paths, 1, raw, stack);
  if (status != STATUS_OK) print_message("# %s\n", error_message());
  assert_int_equal(status, STATUS_OK);
}

static void test_tiff_layouts(void **state) {
  (void)state;
  const uint16_t U = SAMPLEFORMAT_UINT, I = SAMPLEFORMAT_INT, F = SAMPLEFORMAT_IEEEFP;
  const struct layout layouts[] = {
      {"plain 8", "w", COMPRESSION_NONE, 8, U, 1, 1, 0, 5},
      {"16 little", "wl", COMPRESSION_NONE, 16, U, 1, 1, 0, NY},
      {"16 big", "wb", COMPRESSION_NONE, 16, U, 1, 1, 0, 4},
      {"BigTIFF", "w8", COMPRESSION_NONE, 16, U, 1, 1, 0, 7},
      {"BigTIFF big", "w8b", COMPRESSION_ADOBE_DEFLATE, 16, U, 1, 1, 0, 7},
      {"LZW", "w", COMPRESSION_LZW, 16, U, 1, 1, 0, 8},
      {"Deflate", "w", COMPRESSION_ADOBE_DEFLATE, 8, U, 1, 1, 0, 3},
      {"PackBits", "w", COMPRESSION_PACKBITS, 8, U, 1, 1, 0, 2},
      {"ZSTD", "w", COMPRESSION_ZSTD, 16, U, 1, 1, 0, 6},
      {"tiled", "w", COMPRESSION_NONE, 16, U, 1, 1, 16, 0},
      {"tiled LZW big", "wb", COMPRESSION_LZW, 16, U, 1, 1, 32, 0},
      {"signed 8", "w", COMPRESSION_NONE, 8, I, 1, 1, 0, 5},
      {"signed 16", "wb", COMPRESSION_NONE, 16, I, 1, 1, 0, 5},
      {"unsigned 32", "w", COMPRESSION_NONE, 32, U, 1, 1, 0, 5},
      {"float 32", "wl", COMPRESSION_NONE, 32, F, 1, 1, 0, 5},
      {"float 32 big", "wb", COMPRESSION_LZW, 32, F, 1, 1, 0, 5},
      {"float 64", "w", COMPRESSION_NONE, 64, F, 1, 1, 0, 5},
      {"white is zero", "w", COMPRESSION_NONE, 8, U, PHOTOMETRIC_MINISWHITE, 1, 0, 5},
      {"grey palette", "w", COMPRESSION_NONE, 8, U, PHOTOMETRIC_PALETTE, 1, 0, 5},
      {"grey RGB", "w", COMPRESSION_NONE, 8, U, PHOTOMETRIC_RGB, 3, 0, 5},
      {"JPEG", "w", COMPRESSION_JPEG, 8, U, 1, 1, 0, 16},
  };
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    const struct layout *layout = &layouts[i];
    const char *path = in_folder("layout.tif");
    struct stack stack;
    float slice[NX * NY];
    write_tiff(path, layout);
    open_one(path, NULL, &stack);
    assert_int_equal(stack.size[0], NX);
    assert_int_equal(stack.size[1], NY);
    assert_int_equal(stack.size[2], NZ);
    assert_true(fabs(stack.voxel[0] / 5.83e-6 - 1.0) < 1e-5);
    double bound = layout->compression == COMPRESSION_JPEG ? 60.0 : 1e-6;
    for (size_t z = NZ; z-- > 0;) { /* backwards: any page must be reachable */
      assert_int_equal(stack_read(&stack, z, slice), STATUS_OK);
      for (size_t y = 0; y < NY; y++)
        for (size_t x = 0; x < NX; x++)
          if (fabs((double)slice[y * NX + x] - expected(layout, x, y, z)) > bound)
            fail_msg("%s: %g at %zu,%zu,%zu, not %g", layout->name, (double)slice[y * NX + x], x, y,
                     z, expected(layout, x, y, z));
      if (!stack.has_levels) continue;
      unsigned char stored[NX * NY * 2];
      float again[NX * NY];
      assert_int_equal(stack_read_stored(&stack, z, stored), STATUS_OK);
      pixels_to_float(again, stored, NX * NY, stack.type);
      assert_memory_equal(slice, again, sizeof slice);
    }
    stack_close(&stack);
  }
}

static void write_png(const char *path, int bits, int colour, size_t z) {
  FILE *file = fopen(path, "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, NX, NY, bits, colour, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_color palette[256];
  for (int i = 0; i < 256; i++) palette[i] = (png_color){(png_byte)i, (png_byte)i, (png_byte)i};
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 256);
  png_write_info(png, info);
  int channels = colour == PNG_COLOR_TYPE_RGB ? 3 : 1;
  for (size_t y = 0; y < NY; y++) {
    png_byte row[NX * 6];
    for (size_t x = 0; x < NX; x++)
      for (int c = 0; c < channels; c++) {
        png_byte *at = row + (x * (size_t)channels + (size_t)c) * (size_t)bits / 8;
        at[0] = (png_byte)pattern(x, y, z);
        if (bits == 16) at[1] = 7;
      }
    png_write_row(png, row);
  }
  png_write_end(png, NULL);
  png_destroy_write_struct(&png, &info);
  fclose(file);
}

static void test_png(void **state) {
  (void)state;
  const struct {
    int bits, colour;
  } kinds[] = {{8, PNG_COLOR_TYPE_GRAY},
               {16, PNG_COLOR_TYPE_GRAY},
               {8, PNG_COLOR_TYPE_RGB},
               {16, PNG_COLOR_TYPE_RGB},
               {8, PNG_COLOR_TYPE_PALETTE}};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    struct stack stack;
    float slice[NX * NY];
    write_png(in_folder("one.png"), kinds[k].bits, kinds[k].colour, 1);
    open_one(in_folder("one.png"), NULL, &stack);
    assert_int_equal(stack_read(&stack, 0, slice), STATUS_OK);
    for (size_t i = 0; i < NX * NY; i++) {
      int value = pattern(i % NX, i / NX, 1);
      assert_true(slice[i] == (float)(kinds[k].bits == 16 ? value * 256 + 7 : value));
    }
    stack_close(&stack);
  }
}

static void write_bytes(const char *path, const char *head, size_t slices, size_t bytes) {
  FILE *file = fopen(path, "wb");
  fputs(head, file);
  for (size_t i = 0; i < slices * NX * NY * bytes; i++)
    fputc(bytes == 1 ? pattern(i % NX, i / NX % NY, i / NX / NY) : (int)(i % 251), file);
  fclose(file);
}

static void check_u8(const char *path, const struct raw_layout *raw, size_t slices) {
  struct stack stack;
  float slice[NX * NY];
  open_one(path, raw, &stack);
  assert_int_equal(stack.size[2], slices);
  for (size_t z = 0; z < slices; z++) {
    assert_int_equal(stack_read(&stack, z, slice), STATUS_OK);
    for (size_t i = 0; i < NX * NY; i++) assert_true(slice[i] == (float)pattern(i % NX, i / NX, z));
  }
  stack_close(&stack);
}

static void test_raw_meta_nrrd(void **state) {
  (void)state;
  struct raw_layout raw;
  assert_int_equal(raw_layout_parse("37x21x3:u8", &raw), STATUS_OK);
  write_bytes(in_folder("a.raw"), "", 3, 1);
  check_u8(in_folder("a.raw"), &raw, 3);
  FILE *file = fopen(in_folder("a.mhd"), "w");
  fputs("ObjectType = Image\nNDims = 3\nDimSize = 37 21 3\nElementSpacing = 0.1 0.1 0.1\n"
        "ElementType = MET_UCHAR\nElementDataFile = a.raw\n",
        file);
  fclose(file);
  check_u8(in_folder("a.mhd"), NULL, 3);
  write_bytes(in_folder("b.mha"),
              "NDims = 3\nDimSize = 37 21 2\nElementType = MET_UCHAR\n"
              "ElementDataFile = LOCAL\n",
              2, 1);
  check_u8(in_folder("b.mha"), NULL, 2);
  write_bytes(in_folder("c.nrrd"),
              "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 37 21 3\nencoding: raw\n"
              "space directions: (2,0,0) (0,2,0) (0,0,4)\nspace units: \"um\" \"um\" \"um\"\n\n",
              3, 1);
  check_u8(in_folder("c.nrrd"), NULL, 3);
  struct stack stack;
  open_one(in_folder("c.nrrd"), NULL, &stack);
  assert_true(fabs(stack.voxel[0] - 2e-6) < 1e-15 && fabs(stack.voxel[2] - 4e-6) < 1e-15);
  stack_close(&stack);
}

/* `head`, then the pattern packed by gzip (window 15 + 16) or zlib (15). */
static void write_packed(const char *path, const char *head, int window, size_t cut) {
  static unsigned char plain[NX * NY * NZ], packed[2 * NX * NY * NZ];
  for (size_t i = 0; i < sizeof plain; i++)
    plain[i] = (unsigned char)pattern(i % NX, i / NX % NY, i / NX / NY);
  z_stream stream = {
      .next_in = plain, .avail_in = sizeof plain, .next_out = packed, .avail_out = sizeof packed};
  assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
  assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
  FILE *file = fopen(path, "wb");
  fputs(head, file);
  fwrite(packed, 1, stream.total_out - cut, file);
  fclose(file);
  deflateEnd(&stream);
}

static void refuse(const char *path, const struct raw_layout *raw, const char *word);

static void test_compressed_meta_and_nrrd(void **state) {
  (void)state;
  const char *nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 37 21 3\nencoding: gzip\n\n";
  write_packed(in_folder("z.nrrd"), nrrd, 15 + 16, 0);
  check_u8(in_folder("z.nrrd"), NULL, 3);
  write_packed(in_folder("z.mha"),
               "NDims = 3\nDimSize = 37 21 3\nElementType = MET_UCHAR\nCompressedData = True\n"
               "ElementDataFile = LOCAL\n",
               15, 0);
  check_u8(in_folder("z.mha"), NULL, 3);
  write_packed(in_folder("cut.nrrd"), nrrd, 15 + 16, 60);
  refuse(in_folder("cut.nrrd"), NULL, "the header promises");
}

static void test_raw_layout_words(void **state) {
  (void)state;
  struct raw_layout raw;
  const char *const wrong[] = {"10x10x10", "10x10:u8",  "0x4x4:u8", "-1x4x4:u8",
                               "4x4x4:u9", "4x4x4:u16", "4x4x4:u8 "};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    assert_int_equal(raw_layout_parse(wrong[i], &raw), STATUS_USAGE);
    error_clear();
  }
  assert_int_equal(raw_layout_parse("4x5x6:i16be", &raw), STATUS_OK);
  assert_true(raw.type == PIXEL_I16 && raw.big_endian && raw.size[2] == 6);
}

static void refuse(const char *path, const struct raw_layout *raw, const char *word) {
  struct stack stack;
  const char *paths[] = {path};
  float slice[64 * 64];
  enum status status = stack_open(paths, 1, raw, &stack);
  for (size_t z = 0; status == STATUS_OK && z < stack.size[2]; z++)
    status = stack_read(&stack, z, slice);
  stack_close(&stack);
  if (status == STATUS_OK || strstr(error_message(), word) == NULL)
    fail_msg("%s: expected a message with '%s', got '%s'", path, word, error_message());
  assert_int_equal(status, STATUS_INPUT);
  error_clear();
}

/* Turned pixels are read as stored, and that is said; slices that lie unlike are refused. */
static void test_orientation(void **state) {
  (void)state;
  const struct layout plain = {"", "w", COMPRESSION_NONE, 8, SAMPLEFORMAT_UINT, 1, 1, 0, 5};
  struct stack stack;
  float slice[NX * NY];
  for (int z = 0; z < NZ; z++) orientation[z] = ORIENTATION_RIGHTTOP;
  write_tiff(in_folder("turned.tif"), &plain);
  open_one(in_folder("turned.tif"), NULL, &stack);
  assert_int_equal(stack.size[0], NX);
  assert_non_null(strstr(stack.files[0].note, "orientation 6 says to turn it"));
  assert_int_equal(stack_read(&stack, 1, slice), STATUS_OK);
  for (size_t i = 0; i < NX * NY; i++) assert_true(slice[i] == (float)pattern(i % NX, i / NX, 1));
  stack_close(&stack);
  orientation[2] = ORIENTATION_TOPLEFT;
  write_tiff(in_folder("mixed.tif"), &plain);
  refuse(in_folder("mixed.tif"), NULL, "page 2: orientation 1, but the first page has 6");
  for (int z = 0; z < NZ; z++) orientation[z] = ORIENTATION_BOTLEFT;
  write_tiff(in_folder("flipped.tif"), &plain);
  const char *paths[] = {in_folder("flipped.tif"), in_folder("turned.tif")};
  assert_int_equal(stack_open(paths, 2, NULL, &stack), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "orientation 6, but the first slice has 4"));
  error_clear();
  memset(orientation, 0, sizeof orientation);
}

static void test_broken_files(void **state) {
  (void)state;
  const struct layout plain = {"", "w", COMPRESSION_LZW, 16, SAMPLEFORMAT_UINT, 1, 1, 0, 8};
  write_tiff(in_folder("cut.tif"), &plain);
  for (long size = 2000; size > 0;
       size -= 137) { /* cut anywhere: an error or fewer pages, no crash */
    struct stack stack;
    const char *paths[] = {in_folder("cut.tif")};
    float slice[NX * NY];
    write_tiff(paths[0], &plain);
    assert_int_equal(truncate(paths[0], size), 0);
    enum status status = stack_open(paths, 1, NULL, &stack);
    if (status == STATUS_OK) {
      for (size_t z = 0; z < stack.size[2] && status == STATUS_OK; z++)
        status = stack_read(&stack, z, slice);
      stack_close(&stack);
    }
    assert_int_equal(status, STATUS_INPUT);
    error_clear();
    status = stack_open(paths, 1, NULL, &stack);
    if (status == STATUS_OK) {
      for (size_t z = 0; z < stack.size[2] && status == STATUS_OK; z++)
        status = stack_read_stored(&stack, z, slice);
      stack_close(&stack);
    }
    assert_int_equal(status, STATUS_INPUT);
    error_clear();
  }
  FILE *file = fopen(in_folder("empty.png"), "w");
  fclose(file);
  refuse(in_folder("empty.png"), NULL, "empty file");
  file = fopen(in_folder("text.tif"), "w");
  fputs("this is no image at all\n", file);
  fclose(file);
  refuse(in_folder("text.tif"), NULL, "--raw");
  write_png(in_folder("cut.png"), 8, PNG_COLOR_TYPE_GRAY, 0);
  assert_int_equal(truncate(in_folder("cut.png"), 60), 0);
  refuse(in_folder("cut.png"), NULL, "cut.png");
  struct raw_layout raw;
  (void)raw_layout_parse("37x21x4:u8", &raw);
  refuse(in_folder("a.raw"), &raw, "--raw says 4");
  (void)raw_layout_parse("38x21x3:u8", &raw);
  refuse(in_folder("a.raw"), &raw, "whole slices");
  refuse(in_folder("missing.tif"), NULL, "No such file");
}

static void test_folders(void **state) {
  (void)state;
  char path[420];
  snprintf(path, sizeof path, "%s/slices", folder);
  mkdir(path, 0700);
  const int order[] = {10, 9, 2, 11};
  for (size_t i = 0; i < 4; i++) {
    char name[40];
    snprintf(name, sizeof name, "slices/s_%d.png", order[i]);
    write_png(in_folder(name), 8, PNG_COLOR_TYPE_GRAY, (size_t)order[i]);
  }
  FILE *file = fopen(in_folder("slices/notes.txt"), "w");
  fputs("not an image", file);
  fclose(file);
  struct stack stack;
  float slice[NX * NY];
  const size_t sorted[] = {2, 9, 10, 11};
  open_one(in_folder("slices"), NULL, &stack);
  assert_int_equal(stack.size[2], 4);
  for (size_t z = 0; z < 4; z++) {
    assert_int_equal(stack_read(&stack, z, slice), STATUS_OK);
    assert_true(slice[0] == (float)pattern(0, 0, sorted[z]));
  }
  stack_close(&stack);
  write_png(in_folder("slices/s_12.png"), 16, PNG_COLOR_TYPE_GRAY, 0);
  refuse(in_folder("slices"), NULL, "s_12.png: 16-bit unsigned, but the first slice is 8-bit");
}

static void test_natural_order(void **state) {
  (void)state;
  assert_true(natural_compare("a9", "a10") < 0);
  assert_true(natural_compare("a009", "a10") < 0);
  assert_true(natural_compare("a2b3", "a2b21") < 0);
  assert_true(natural_compare("a01", "a1") != 0);
  assert_true(natural_compare("b1", "a2") > 0);
  assert_int_equal(natural_compare("x", "x"), 0);
  /* Programs add "-1", " 2" or "(2)" to the second of files, and nothing to the first. */
  assert_true(natural_compare("d/s.tif", "d/s-1.tif") < 0);
  assert_true(natural_compare("s (2).tif", "s.tif") > 0);
  assert_true(natural_compare("s 2.ome.tif", "s.ome.tif") > 0);
  assert_true(natural_compare("s.1.tif", "s.2.tif") < 0);
}

static int by_order(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Sorts `wanted` by bytes, then by its numbers, and expects it again, in even steps or not. */
static void in_order(const char *const *wanted, size_t n, long long step) {
  char *names[12];
  for (size_t i = 0; i < n; i++) names[i] = (char *)(uintptr_t)wanted[i];
  qsort(names, n, sizeof *names, by_order);
  const struct name_order order = name_order_find(names, n);
  for (size_t i = 1; i < n; i++) {
    if (name_compare(wanted[i - 1], wanted[i], &order) >= 0)
      fail_msg("%s is not before %s", wanted[i - 1], wanted[i]);
    long long a, b;
    assert_true(name_number(wanted[i - 1], &order, &a) && name_number(wanted[i], &order, &b));
    if (step > 0 && b - a != step)
      fail_msg("from %s to %s it is %lld, not %lld", wanted[i - 1], wanted[i], b - a, step);
  }
}

static void test_signs_and_fractions(void **state) {
  (void)state;
#define IN_ORDER(step, ...)                                                                        \
  do {                                                                                             \
    const char *const wanted[] = {__VA_ARGS__};                                                    \
    in_order(wanted, sizeof wanted / sizeof *wanted, step);                                        \
  } while (0)
  IN_ORDER(1, "d/z-2.tif", "d/z-1.tif", "d/z0.tif", "d/z1.tif", "d/z2.tif");
  IN_ORDER(5, "z-10.tif", "z-5.tif", "z0.tif", "z5.tif", "z10.tif");
  IN_ORDER(1, "-1.png", "0.png", "1.png");
  IN_ORDER(1, "z-002.tif", "z-001.tif", "z+000.tif", "z+001.tif");
  /* A '-' before every number is a dash, and so is that of a date. */
  IN_ORDER(1, "s-1.tif", "s-2.tif", "s-3.tif");
  IN_ORDER(1, "2026-11-01.tif", "2026-11-02.tif", "2026-11-03.tif");
  IN_ORDER(5, "z0.5.tif", "z1.0.tif", "z1.5.tif", "z2.0.tif");
  IN_ORDER(25, "z0.25", "z0.5", "z0.75", "z1", "z1.25");
  IN_ORDER(25, "z9.75.png", "z10.0.png", "z10.25.png", "z10.5.png");
  IN_ORDER(5, "z-0.5.tif", "z0.0.tif", "z0.5.tif");
  /* Chapters, and what scanners number with points. */
  IN_ORDER(1, "s1.8.tif", "s1.9.tif", "s1.10.tif", "s1.11.tif");
  IN_ORDER(1, "1.2.840.9.tif", "1.2.840.10.tif", "1.2.840.11.tif");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_tiff_layouts),     cmocka_unit_test(test_png),
      cmocka_unit_test(test_raw_meta_nrrd),    cmocka_unit_test(test_compressed_meta_and_nrrd),
      cmocka_unit_test(test_raw_layout_words), cmocka_unit_test(test_broken_files),
      cmocka_unit_test(test_folders),          cmocka_unit_test(test_natural_order),
      cmocka_unit_test(test_orientation),      cmocka_unit_test(test_signs_and_fractions),
  };
  return cmocka_run_group_tests(tests, group_setup, group_teardown);
}
