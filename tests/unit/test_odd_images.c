/* TIFF and PNG as other programs write them: sparse ones, thumbnails first, labels of less than a
 * byte or by the number of a colour, samples that nobody declared. The voxels are those that the
 * file means, or it is refused. */
#include "tests/unit/folder_rig.h"

#include <math.h>
#include <png.h>
#include <string.h>
#include <tiffio.h>
#include <zlib.h>

#include "common/error.h"
#include "ct2model/readers/stack.h"

enum { NX = 14, NY = 18 };
static char file[100];

static int make_file(void **state) {
  if (make_folder(state) != 0) return 1;
  snprintf(file, sizeof file, "%s/odd", folder);
  return 0;
}

static unsigned grey(size_t x, size_t y, unsigned page) {
  return (unsigned)(7 * x + 11 * y + 3 * page + x * y);
}

struct page {
  uint16_t bits, photometric, samples, extra, compression;
  unsigned subfile, number; /* `number` of the page in the pattern */
  bool tiled, sparse;       /* sparse: the second of its blocks is not written */
  const char *description;
  uint16_t (*colour)(int channel, unsigned entry);
  size_t shrunk;  /* a thumbnail: so many pixels less */
  uint32_t depth; /* slices in a page; 0: no tag */
  uint16_t told;  /* PageNumber; 0: no tag */
  uint16_t format;
  const char *gdal[2]; /* its tags 42112 (metadata) and 42113 (no data) */
  bool reversed;       /* the bits of each byte */
  bool opaque;         /* the second sample is the same everywhere */
  float resolution;    /* pixels per cm; 0: no tag */
  const char *program;
  struct {
    uint32_t number;
    TIFFDataType type;
    uint32_t count;
    const void *values;
  } own;       /* a private tag; number 0: none */
  float place; /* XPosition; 0: no tag */
};

static const struct page PLAIN = {.bits = 8,
                                  .photometric = PHOTOMETRIC_MINISBLACK,
                                  .samples = 1,
                                  .compression = COMPRESSION_NONE,
                                  .format = SAMPLEFORMAT_UINT};

/* Packs the samples of a row; a second sample is another pattern. */
static void put_row(unsigned char *row, const struct page *page, size_t y, size_t nx) {
  memset(row, 0, 256);
  for (size_t x = 0; x < nx; x++)
    for (size_t s = 0; s < page->samples; s++) {
      const unsigned mask = (1u << page->bits) - 1u,
                     value = s > 0 && page->opaque ? mask : grey(x + 5 * s, y, page->number) & mask;
      const size_t bit = (x * page->samples + s) * page->bits;
      row[bit / 8] = (unsigned char)(row[bit / 8] | value << (8 - page->bits - bit % 8));
    }
}

static void add_page(TIFF *tiff, const struct page *page) {
  const size_t nx = NX - page->shrunk, ny = NY - page->shrunk;
  TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, page->subfile);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, (uint32_t)nx);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, (uint32_t)ny);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, page->bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, page->samples);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, page->photometric);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, page->compression);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, page->format);
  if (page->reversed) TIFFSetField(tiff, TIFFTAG_FILLORDER, FILLORDER_LSB2MSB);
  if (page->samples > 1) {
    uint16_t kinds[4] = {page->extra, page->extra, page->extra, page->extra};
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, page->samples - 1, kinds);
  }
  static const TIFFFieldInfo GDAL[] = {
      {42112, -1, -1, TIFF_ASCII, FIELD_CUSTOM, true, false, (char *)"GDALMetadata"},
      {42113, -1, -1, TIFF_ASCII, FIELD_CUSTOM, true, false, (char *)"GDALNoData"}};
  for (uint32_t i = 0; i < 2; i++) {
    if (page->gdal[i] == NULL) continue;
    TIFFMergeFieldInfo(tiff, &GDAL[i], 1);
    TIFFSetField(tiff, 42112 + i, page->gdal[i]);
  }
  if (page->own.number > 0) {
    const TIFFFieldInfo info = {page->own.number, TIFF_VARIABLE2, TIFF_VARIABLE2, page->own.type,
                                FIELD_CUSTOM,     true,           true,           (char *)"own"};
    TIFFMergeFieldInfo(tiff, &info, 1);
    TIFFSetField(tiff, page->own.number, page->own.count, page->own.values);
  }
  if (page->place > 0.0f) TIFFSetField(tiff, TIFFTAG_XPOSITION, page->place);
  if (page->program != NULL) TIFFSetField(tiff, TIFFTAG_SOFTWARE, page->program);
  if (page->resolution > 0.0f) {
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, page->resolution);
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, page->resolution);
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
  }
  if (page->told > 0) TIFFSetField(tiff, TIFFTAG_PAGENUMBER, page->told, 9);
  if (page->depth > 0) TIFFSetField(tiff, TIFFTAG_IMAGEDEPTH, page->depth);
  if (page->description != NULL) TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, page->description);
  if (page->colour != NULL) {
    uint16_t maps[3][256];
    for (int c = 0; c < 3; c++)
      for (unsigned i = 0; i < 1u << page->bits; i++) maps[c][i] = page->colour(c, i);
    TIFFSetField(tiff, TIFFTAG_COLORMAP, maps[0], maps[1], maps[2]);
  }
  unsigned char row[256], block[16 * 16];
  if (page->tiled) { /* two tiles of 16x16 below each other */
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
    for (size_t y0 = 0; y0 < ny; y0 += 16) {
      if (page->sparse && y0 > 0) continue;
      for (size_t y = 0; y < 16; y++) {
        put_row(row, page, y0 + y, 16);
        memcpy(block + 16 * y, row, 16);
      }
      TIFFWriteTile(tiff, block, 0, (uint32_t)y0, 0, 0);
    }
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 6);
    for (size_t y0 = 0; y0 < ny; y0 += 6) {
      unsigned char strip[6 * 256];
      size_t used = 0;
      if (page->sparse && y0 == 6) continue;
      for (size_t y = y0; y < ny && y < y0 + 6; y++, used += (size_t)TIFFScanlineSize(tiff)) {
        put_row(row, page, y, nx);
        memcpy(strip + used, row, (size_t)TIFFScanlineSize(tiff));
      }
      TIFFWriteEncodedStrip(tiff, (uint32_t)(y0 / 6), strip, (tmsize_t)used);
    }
  }
  TIFFWriteDirectory(tiff);
}

static void write_pages(const char *mode, const struct page *pages, size_t n) {
  TIFF *tiff = TIFFOpen(file, mode);
  assert_non_null(tiff);
  for (size_t i = 0; i < n; i++) add_page(tiff, &pages[i]);
  TIFFClose(tiff);
}

static enum status read_all(struct stack *stack, float *pixels) {
  const char *path = file;
  enum status status = stack_open(&path, 1, NULL, stack);
  for (size_t z = 0; status == STATUS_OK && z < stack->size[2]; z++)
    status = stack_read(stack, z, pixels + z * NX * NY);
  return status;
}

static void refused(const char *word) {
  struct stack stack;
  float pixels[8 * NX * NY];
  const enum status status = read_all(&stack, pixels);
  if (status != STATUS_INPUT || strstr(error_message(), word) == NULL)
    fail_msg("not refused with '%s': %s", word, error_message());
  error_clear();
  stack_close(&stack);
}

static double no_data = NAN; /* value that is no measurement */

/* The file holds these pages, each pixel of which is value(its sample), and tells of `word`. */
static void holds(const unsigned *numbers, size_t n, unsigned bits,
                  double (*value)(unsigned sample), size_t zero_from, size_t zero_to,
                  const char *word) {
  struct stack stack;
  float pixels[8 * NX * NY];
  if (read_all(&stack, pixels) != STATUS_OK) fail_msg("%s", error_message());
  assert_int_equal(stack.size[0], NX);
  assert_int_equal(stack.size[1], NY);
  assert_int_equal(stack.size[2], n);
  for (size_t z = 0; z < n; z++)
    for (size_t i = 0; i < NX * NY; i++) {
      const unsigned sample = grey(i % NX, i / NX, numbers[z]) & ((1u << bits) - 1u);
      const bool zero = i / NX >= zero_from && i / NX < zero_to;
      const double wanted = zero ? 0.0 : value != NULL ? value(sample) : (double)sample;
      const double found = (double)pixels[z * NX * NY + i];
      if (wanted == no_data ? !isnan(found) : found != wanted)
        fail_msg("%zu,%zu,%zu: %g, not %g", i % NX, i / NX, z, (double)pixels[z * NX * NY + i],
                 wanted);
    }
  if (word == NULL ? stack.files[0].note[0] != '\0' : strstr(stack.files[0].note, word) == NULL)
    fail_msg("told '%s', not '%s'", stack.files[0].note, word != NULL ? word : "");
  stack_close(&stack);
}

static void test_sparse(void **state) {
  (void)state;
  const unsigned first = 0;
  for (int k = 0; k < 4; k++) {
    struct page page = PLAIN;
    page.sparse = true;
    page.tiled = k % 2;
    page.compression = k / 2 ? COMPRESSION_LZW : COMPRESSION_NONE;
    write_pages(k == 1 ? "wb" : "wl", &page, 1);
    holds(&first, 1, 8, NULL, page.tiled ? 16 : 6, page.tiled ? 18 : 12, "(sparse): all 0");
  }
}

/* Adds `add` to value `index` of a tag with several values, in a little-endian file. */
static void patch_tag(unsigned tag, size_t index, int add) {
  static unsigned char bytes[8000];
  FILE *whole = fopen(file, "rb");
  const size_t size = fread(bytes, 1, sizeof bytes, whole);
  fclose(whole);
  size_t at = bytes[4] + 256u * bytes[5];
  const size_t entries = bytes[at] + 256u * bytes[at + 1];
  for (at += 2; bytes[at] + 256u * bytes[at + 1] != tag; at += 12) assert_true(entries > 0);
  const size_t width = bytes[at + 2] == 3 ? 2 : 4, count = bytes[at + 4];
  unsigned char *value = bytes + at + 8;
  if (width * count > 4) value = bytes + value[0] + 256u * value[1];
  value += width * index;
  const int old = value[0] + 256 * value[1];
  value[0] = (unsigned char)((old + add) & 255);
  value[1] = (unsigned char)((old + add) >> 8);
  whole = fopen(file, "wb");
  fwrite(bytes, 1, size, whole);
  fclose(whole);
}

/* libtiff reads an uncompressed strip from its offset on, however short it is said to be. */
static void test_strip_of_a_wrong_length(void **state) {
  (void)state;
  const int first = 8; /* where libtiff puts the first strip */
  write_pages("wl", &PLAIN, 1);
  patch_tag(TIFFTAG_STRIPBYTECOUNTS, 2, -10);
  refused("block 2 is said to be 74 bytes");
  write_pages("wl", &PLAIN, 1);
  patch_tag(TIFFTAG_STRIPOFFSETS, 1, -(first + 6 * NX));
  refused("block 1 is said to be 84 bytes from byte 0");
}

static void test_pages_aside(void **state) {
  (void)state;
  struct page pages[4] = {PLAIN, PLAIN, PLAIN, PLAIN};
  for (unsigned i = 0; i < 4; i++) pages[i].number = i;
  pages[0].subfile = FILETYPE_REDUCEDIMAGE; /* the thumbnail, before the slices */
  pages[0].shrunk = 5;
  pages[2].subfile = FILETYPE_MASK;
  const unsigned slices[] = {1, 3};
  write_pages("w", pages, 4);
  holds(slices, 2, 8, NULL, 0, 0, NULL);
  pages[0].subfile = 0;
  write_pages("w", pages, 4);
  refused("page 1: 14x18, but the first page is 9x13");
  pages[0].shrunk = 0;
  pages[1].photometric = PHOTOMETRIC_MINISWHITE;
  write_pages("w", pages, 4);
  refused("page 1: photometric 0, but the first page has 1");
}

/* Lengths that are told: a decimal comma makes none. */
static void test_lengths(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double micrometres;
  } cases[] = {
      {"<OME><Pixels PhysicalSizeX=\"5.83\"></Pixels></OME>", 5.83},
      {"<OME><Pixels PhysicalSizeX = '5.83' PhysicalSizeXUnit='nm'></Pixels></OME>", 5.83e-3},
      {"<OME><Pixels PhysicalSizeX=\"0.0\"></Pixels></OME>", NAN},
      {"<OME><Pixels PhysicalSizeX=\"5,83\"></Pixels></OME>", NAN}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct page page = PLAIN;
    struct stack stack;
    const char *path = file;
    page.description = cases[i].text;
    write_pages("w", &page, 1);
    assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
    const double found = stack.voxel[0] * 1e6;
    if (isnan(cases[i].micrometres) ? !isnan(found)
                                    : !(fabs(found / cases[i].micrometres - 1.0) < 1e-6))
      fail_msg("%s: %g um", cases[i].text, found);
    stack_close(&stack);
  }
}

static void test_lost_slices(void **state) {
  (void)state;
  struct page pages[3] = {PLAIN, PLAIN, PLAIN};
  const unsigned slices[] = {0, 1, 2};
  for (unsigned i = 0; i < 3; i++) pages[i].number = i;
  pages[0].description = "ImageJ=1.53t\nimages=5\nslices=5\n";
  write_pages("w", pages, 3);
  holds(slices, 3, 8, NULL, 0, 0, "5 images, but 3 are there: slices lost, or in other files?");
  static const char *const OTHERS[][2] = {
      {"<OME><Pixels SizeX=\"14\" SizeY=\"18\" SizeZ=\"5\" SizeC=\"1\" SizeT=\"1\"/></OME>",
       "5 images, but 3"},
      {"{\"shape\": [5, 18, 14]}", "5 images, but 3"},
      {"{\"shape\": [2, 18, 14]}", "2 images, but 3 are there: those of several images?"},
      {"{\"shape\": [3, 18, 14], \"axes\": \"ZYX\"}", NULL},
      {"{\"shape\": [3, 18, 14], \"axes\": \"QYX\"}", NULL},
      {"{\"shape\": [3, 18, 14], \"axes\": \"XYZ\"}", "its axes are xyz by its text"},
      {"<OME><Pixels SizeZ = '5'></Pixels></OME>", "5 images, but 3"},
      {"{\"shape\":[5,18,14],\"axes\":\"ZYX\"}", "5 images, but 3"},
      {"<a:OME xmlns:a='o'><a:Pixels SizeZ='5'/></a:OME>", "5 images, but 3"},
      {"<OME><Pixels/><ModuloAlongZ Type=\"angle\"/></OME>", "angles or others, as its text tells"},
      {"<OME><BinaryOnly MetadataFile=\"a.companion.ome\"/></OME>", "in another file (BinaryOnly)"},
      {"{\"shape\": [5, 9, 14]}", NULL}}; /* of others than these pages */
  for (size_t i = 0; i < sizeof OTHERS / sizeof *OTHERS; i++) {
    pages[0].description = OTHERS[i][0];
    write_pages("w", pages, 3);
    holds(slices, 3, 8, NULL, 0, 0, OTHERS[i][1]);
  }
  static const char *const CHANNELS[] = {"<OME><Pixels SizeC='3' SizeZ='1'></Pixels></OME>",
                                         "<o:OME x=''><o:Pixels SizeC=\"3\"/></o:OME>",
                                         "{\"shape\":[3,18,14],\"axes\":\"CYX\"}"};
  for (size_t i = 0; i < 3; i++) {
    pages[0].description = CHANNELS[i];
    write_pages("w", pages, 3);
    refused("3 channels");
  }
  pages[0].description = NULL;
  for (uint16_t i = 0; i < 3; i++) pages[i].told = (uint16_t)(5 + i);
  write_pages("w", pages, 3);
  holds(slices, 3, 8, NULL, 0, 0, NULL);
  pages[2].told = 5;
  write_pages("w", pages, 3);
  holds(slices, 3, 8, NULL, 0, 0, "its pages are numbered in another order");
  for (size_t i = 0; i < 3; i++) pages[i].told = 0;
#define OME "<OME><Pixels SizeZ=\"3\">"
#define DATA(z, ifd) "<TiffData FirstZ=\"" z "\" IFD=\"" ifd "\"/>"
#define BESIDE(z, name)                                                                            \
  "<TiffData FirstZ=\"" z "\" IFD=\"0\"><UUID FileName=\"" name "\">u</UUID></TiffData>"
  static const struct {
    const char *text;
    bool in_order;
  } ORDERS[] = {{OME DATA("0", "0") DATA("1", "1") DATA("2", "2") "</Pixels></OME>", true},
                {OME DATA("2", "0") DATA("1", "1") DATA("0", "2") "</Pixels></OME>", false},
                {OME DATA("1", "0") DATA("0", "1") DATA("2", "2") "</Pixels></OME>", false},
                {OME "<TiffData IFD=\"0\" PlaneCount=\"3\"/></Pixels><Pixels>" DATA(
                     "0", "3") "</Pixels></OME>",
                 true},
                {OME BESIDE("0", "a") BESIDE("1", "b") BESIDE("2", "c") "</Pixels></OME>", true},
                {OME BESIDE("0", "a") BESIDE("1", "a") "</Pixels></OME>", false}};
  for (size_t i = 0; i < sizeof ORDERS / sizeof *ORDERS; i++) {
    pages[0].description = ORDERS[i].text;
    write_pages("w", pages, 3);
    if (ORDERS[i].in_order)
      holds(slices, 3, 8, NULL, 0, 0, NULL);
    else
      refused("and others in another order");
  }
  pages[0].description = "ImageJ=1.53t\nimages=3\ncf=0\nc0=-32768.0\nc1=1.0\n";
  write_pages("w", pages, 3);
  holds(slices, 3, 8, NULL, 0, 0, "ImageJ's calibration (-32768.0 + 1.0 times the grey)");
  pages[0].description = "ImageJ=1.53t\nimages=3\nslices=3\nunit=pixel\nspacing=2.0\n";
  write_pages("w", pages, 3);
  holds(slices, 3, 8, NULL, 0, 0, "voxels of 1 x 1 x 2 by its resolution or spacing, without");
  pages[0].description = "ImageJ=1.53t\nimages=3\nslices=3\n";
  write_pages("w", pages, 3);
  holds(slices, 3, 8, NULL, 0, 0, NULL);
}

/* Channels that follow one another on the pages, by the texts of ScanImage. */
static void test_channels(void **state) {
  (void)state;
  const unsigned slices[] = {0, 1};
  static const struct {
    const char *text;
    bool several;
  } TEXTS[] = {{"SI.VERSION = 5\nSI.hChannels.channelSave = [1;2]\nSI.a = 3", true},
               {"scanimage.SI4.channelsSave = [1 3]\n", true},
               {"state.acq.numberOfChannelsSave=2\r", true},
               {"state.acq.numberOfChannelsSave=1\r", false},
               {"SI.hChannels.channelSave = 2\nSI.b = [1;2]", false},
               {"SI.hChannels.channelSave = [2]\nSI.b = [1;2]", false}};
  for (size_t i = 0; i < 2 * sizeof TEXTS / sizeof *TEXTS; i++) {
    struct page pages[2] = {PLAIN, PLAIN};
    pages[1].number = 1;
    *(i % 2 ? &pages[0].program : &pages[0].description) = TEXTS[i / 2].text;
    write_pages("w", pages, 2);
    if (TEXTS[i / 2].several)
      refused("a hyperstack of 2 channels");
    else
      holds(slices, 2, 8, NULL, 0, 0, NULL);
  }
}

/* What private tags and others tell of pages that are no slices, and of their greys. */
static void test_private_tags(void **state) {
  (void)state;
  const unsigned slices[] = {0, 1};
  static unsigned char channels[64] = {[20] = 2, [24] = 1}, times[64] = {[20] = 1, [24] = 7},
                       none[64] = {[20] = 1, [24] = 1};
  static const char MANAGER[][40] = {"{\"ChannelIndex\": 1}", "{\"FrameIndex\": 3}",
                                     "{\"ChannelIndex\": 0, \"SliceIndex\": 1}"};
  static const char BAR[] = "[PrivateFei]\nDatabarHeight=4\n", NO_BAR[] = "DatabarHeight=0\n";
  const uint16_t curve[] = {1, 2};
  const struct {
    uint32_t number;
    TIFFDataType type;
    uint32_t count;
    const void *values;
    const char *told;
    bool refused;
  } cases[] = {
      {34412, TIFF_BYTE, 64, channels, "a hyperstack of 2 channels", true},
      {34412, TIFF_BYTE, 64, times, "a hyperstack of 7 frames", true},
      {34412, TIFF_BYTE, 64, none, NULL, false},
      {51123, TIFF_ASCII, sizeof MANAGER[0], MANAGER[0], "a hyperstack of 2 channels", true},
      {51123, TIFF_ASCII, sizeof MANAGER[1], MANAGER[1], "a hyperstack of 4 frames", true},
      {51123, TIFF_ASCII, sizeof MANAGER[2], MANAGER[2], NULL, false},
      {34682, TIFF_ASCII, sizeof BAR, BAR, "its last 4 rows are a bar of data", false},
      {34682, TIFF_ASCII, sizeof NO_BAR, NO_BAR, NULL, false},
      {50712, TIFF_SHORT, 2, curve, "before its LinearizationTable", false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct page pages[2] = {PLAIN, PLAIN};
    pages[1].number = 1;
    for (size_t k = 0; k < 2; k++) {
      pages[k].own.number = cases[i].number;
      pages[k].own.type = cases[i].type;
      pages[k].own.count = cases[i].count;
      pages[k].own.values = cases[i].values;
    }
    write_pages("w", pages, 2);
    if (cases[i].refused)
      refused(cases[i].told);
    else
      holds(slices, 2, 8, NULL, 0, 0, cases[i].told);
  }
  struct page pages[2] = {PLAIN, PLAIN};
  pages[1].number = 1;
  for (int k = 0; k < 2; k++) { /* parts of a picture; one part */
    pages[0].place = 1.0f;
    pages[1].place = k == 0 ? 2.0f : 1.0f;
    write_pages("w", pages, 2);
    holds(slices, 2, 8, NULL, 0, 0, k == 0 ? "its pages lie beside each other" : NULL);
  }
  pages[0] = PLAIN;
  pages[0].description = "ImageJ=1.53t\nimages=1\ncf=20\nvunit=Uncalibrated OD\n";
  write_pages("w", pages, 1);
  holds(slices, 1, 8, NULL, 0, 0, "before ImageJ's calibration by its function 20");
}

/* Renames a tag of the only directory. */
static void patch_number(const char *mode, unsigned from, unsigned to) {
  static unsigned char bytes[8000];
  const bool big = mode[1] == '8', motorola = mode[strlen(mode) - 1] == 'b';
  FILE *whole = fopen(file, "rb");
  const size_t size = fread(bytes, 1, sizeof bytes, whole);
  fclose(whole);
  size_t at = 0, length = big ? 8 : 4;
  for (size_t i = 0; i < length; i++)
    at = at << 8 | bytes[length + (motorola ? i : length - 1 - i)];
  at += big ? 8 : 2;
  while ((unsigned)(bytes[at + !motorola] << 8 | bytes[at + motorola]) != from) at += big ? 20 : 12;
  bytes[at + !motorola] = (unsigned char)(to >> 8);
  bytes[at + motorola] = (unsigned char)(to & 255);
  whole = fopen(file, "wb");
  fwrite(bytes, 1, size, whole);
  fclose(whole);
}

/* What later pages tell, and what greys have gone through. */
static void test_told_by_pages(void **state) {
  (void)state;
  const unsigned slices[] = {0, 1};
  struct page pages[2] = {PLAIN, PLAIN};
  pages[1].number = 1;
  static const float RESOLUTIONS[] = {1715.0f, 1716.0f, 0.0f, 2000.0f};
  pages[0].resolution = RESOLUTIONS[0];
  for (size_t i = 0; i < 4; i++) {
    pages[1].resolution = RESOLUTIONS[i];
    write_pages("w", pages, 2);
    holds(slices, 2, 8, NULL, 0, 0, i < 3 ? NULL : "not all of its pages have the resolution");
  }
  pages[0].resolution = pages[1].resolution = 0.0f;
  static const char *const NO_DATA[][2] = {{"77", "77"}, {"77", NULL}, {"77", "78"}, {NULL, "78"}};
  no_data = 77.0;
  for (size_t i = 0; i < 4; i++) {
    for (size_t k = 0; k < 2; k++) pages[k].gdal[1] = NO_DATA[i][k];
    write_pages("w", pages, 2);
    if (i < 2)
      holds(slices, 2, 8, NULL, 0, 0, NULL);
    else
      refused("page 1 has another GDAL_NODATA, scale or offset than the first");
  }
  no_data = NAN;
  for (size_t k = 0; k < 2; k++) pages[k].gdal[1] = NULL;
  pages[1].gdal[0] = "<Item role=\"scale\">2</Item>";
  write_pages("w", pages, 2);
  refused("page 1 has another GDAL_NODATA, scale or offset than the first");
  pages[1].gdal[0] = NULL;
  for (int k = 0; k < 4;
       k++) { /* libtiff writes no GrayResponseCurve: of another tag, its number */
    static const char *const MODES[] = {"wl", "wb", "w8l", "w8b"};
    pages[0].told = 9;
    write_pages(MODES[k], pages, 1);
    patch_number(MODES[k], TIFFTAG_PAGENUMBER, TIFFTAG_GRAYRESPONSECURVE);
    pages[0].told = 0;
    holds(slices, 1, 8, NULL, 0, 0, "greys as stored, not as its GrayResponseCurve says");
  }
  pages[0].compression = COMPRESSION_JPEG;
  write_pages("w", pages, 1);
  struct stack stack;
  static float pixels[NX * NY];
  assert_int_equal(read_all(&stack, pixels), STATUS_OK);
  assert_non_null(strstr(stack.files[0].note, "compressed with loss (JPEG, say)"));
  stack_close(&stack);
}

/* Slices behind the one page: bits that are reversed within bytes are not read as they stand. */
static void test_slices_of_reversed_bits(void **state) {
  (void)state;
  const unsigned first = 0;
  for (int reversed = 0; reversed < 2; reversed++) {
    struct page page = PLAIN;
    page.description = "ImageJ=1.53t\nimages=2\nslices=2\n";
    page.reversed = reversed;
    write_pages("wl", &page, 1);
    FILE *end = fopen(file, "ab");
    for (size_t i = 0; i < NX * NY; i++) fputc(0, end);
    fclose(end);
    struct stack stack;
    const char *path = file;
    assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
    assert_int_equal(stack.size[2], reversed ? 1 : 2);
    stack_close(&stack);
    if (reversed) holds(&first, 1, 8, NULL, 0, 0, "its text says 2 images, but 1 are there");
  }
}

/* A file that holds more than its one page, as of programs whose text got lost. */
static void test_slices_without_a_directory(void **state) {
  (void)state;
  const unsigned first = 0;
  for (size_t more = 0; more < 20000; more += 5000) {
    write_pages("w", &PLAIN, 1);
    FILE *end = fopen(file, "ab");
    for (size_t i = 0; i < more; i++) fputc((int)(i % 200), end);
    fclose(end);
    holds(&first, 1, 8, NULL, 0, 0, more > 8000 ? "bytes of it are of no page" : NULL);
  }
}

static void test_undeclared_samples(void **state) {
  (void)state;
  const unsigned first = 0;
  struct page page = PLAIN;
  page.samples = 2;
  static const uint16_t KINDS[] = {EXTRASAMPLE_UNASSALPHA, EXTRASAMPLE_ASSOCALPHA,
                                   EXTRASAMPLE_UNSPECIFIED};
  for (size_t i = 0; i < 3; i++) { /* what is transparent is no measurement, whatever its grey */
    page.extra = KINDS[i];
    page.opaque = true;
    write_pages("w", &page, 1);
    holds(&first, 1, 8, NULL, 0, 0, NULL);
    page.opaque = false;
    write_pages("w", &page, 1);
    refused("2 samples a pixel, of which those beyond the grey are not the same everywhere (pixel "
            "1,0), as of a mask or transparency");
  }
  page = PLAIN;
  page.format = SAMPLEFORMAT_COMPLEXINT;
  write_pages("w", &page, 1);
  refused("complex numbers");
  page = PLAIN;
  page.depth = 3;
  write_pages("w", &page, 1);
  refused("pages of 3 slices each");
  page = PLAIN;
  page.photometric = PHOTOMETRIC_SEPARATED;
  write_pages("w", &page, 1);
  refused("colours of the kind 5");
}

static double inverted2(unsigned sample) {
  return 3.0 - sample;
}

static void test_samples_of_less_than_a_byte(void **state) {
  (void)state;
  const unsigned first = 0;
  for (uint16_t bits = 1; bits <= 4; bits = (uint16_t)(2 * bits)) {
    struct page page = PLAIN;
    page.bits = bits;
    write_pages("w", &page, 1);
    holds(&first, 1, bits, NULL, 0, 0, NULL);
  }
  struct page page = PLAIN;
  page.bits = 2;
  page.photometric = PHOTOMETRIC_MINISWHITE;
  write_pages("w", &page, 1);
  struct stack stack;
  float pixels[NX * NY];
  assert_int_equal(read_all(&stack, pixels), STATUS_OK);
  for (size_t i = 0; i < NX * NY; i++)
    assert_true((double)pixels[i] == inverted2(grey(i % NX, i / NX, 0) & 3u));
  stack_close(&stack);
}

static uint16_t in_colour(int channel, unsigned entry) {
  return (uint16_t)(257 * ((entry * 37 + (unsigned)channel * 91) % 256));
}
static uint16_t in_other_colour(int channel, unsigned entry) {
  return in_colour(channel, entry + 1);
}
static uint16_t in_grey(int channel, unsigned entry) {
  (void)channel;
  return (uint16_t)(257 * ((entry * 50) % 256));
}
static double of_grey(unsigned sample) {
  return (sample * 50) % 256;
}

static void test_tiff_palettes(void **state) {
  (void)state;
  const unsigned first = 0, both[] = {0, 0};
  for (uint16_t bits = 4; bits <= 8; bits = (uint16_t)(bits + 4)) {
    struct page page = PLAIN;
    page.photometric = PHOTOMETRIC_PALETTE;
    page.bits = bits;
    page.colour = in_colour;
    write_pages("w", &page, 1);
    holds(&first, 1, bits, NULL, 0, 0, "the numbers of the colours are taken");
    page.colour = in_grey;
    write_pages("w", &page, 1);
    holds(&first, 1, bits, of_grey, 0, 0, "stored in colour");
    struct page pages[2] = {page, page};
    pages[0].colour = in_colour;
    pages[1].colour = in_colour;
    write_pages("w", pages, 2);
    holds(both, 2, bits, NULL, 0, 0, "the numbers of the colours are taken");
    pages[1].colour = in_other_colour;
    write_pages("w", pages, 2);
    refused("page 1 has another palette than the first");
  }
}

static int clear_grey = -1; /* the transparent one; -1: none */
static bool alpha_opaque;
static int clear_entries; /* of the palette, from its first on */

static void write_png(const char *path, int bits, int colour, unsigned turn) {
  FILE *out = fopen(path, "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png_create_info_struct(png);
  png_color palette[256];
  const unsigned count = 1u << bits;
  png_init_io(png, out);
  png_set_IHDR(png, info, NX, NY, bits, colour, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  for (unsigned i = 0; i < count; i++)
    palette[i] = (png_color){(png_byte)(in_colour(0, i + turn) / 257),
                             (png_byte)(in_colour(1, i + turn) / 257),
                             (png_byte)(in_colour(2, i + turn) / 257)};
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, (int)count);
  const png_color_16 clear = {.gray = (png_uint_16)clear_grey};
  if (clear_grey >= 0) png_set_tRNS(png, info, NULL, 0, &clear);
  png_byte transparency[256] = {0};
  if (clear_entries > 0) png_set_tRNS(png, info, transparency, clear_entries, NULL);
  png_write_info(png, info);
  for (size_t y = 0; y < NY; y++) {
    unsigned char row[256];
    struct page page = PLAIN;
    page.bits = (uint16_t)bits;
    page.samples = colour == PNG_COLOR_TYPE_GRAY_ALPHA ? 2 : 1;
    page.opaque = alpha_opaque;
    put_row(row, &page, y, NX);
    png_write_row(png, row);
  }
  png_write_end(png, NULL);
  png_destroy_write_struct(&png, &info);
  fclose(out);
}

/* Writes a grey PNG with a chunk of that name and contents. */
static void write_with_chunk(const char *name, const void *contents, size_t length) {
  static unsigned char bytes[8000], chunk[200];
  write_png(file, 8, PNG_COLOR_TYPE_GRAY, 0);
  FILE *in = fopen(file, "rb");
  const size_t size = fread(bytes, 1, sizeof bytes, in);
  fclose(in);
  chunk[3] = (unsigned char)length;
  memcpy(chunk + 4, name, 4);
  memcpy(chunk + 8, contents, length);
  const uint32_t sum = (uint32_t)crc32(0, chunk + 4, (uInt)length + 4);
  for (size_t i = 0; i < 4; i++) chunk[8 + length + i] = (unsigned char)(sum >> (24 - 8 * i) & 255);
  FILE *out = fopen(file, "wb");
  fwrite(bytes, 1, 33, out); /* signature and IHDR */
  fwrite(chunk, 1, length + 12, out);
  fwrite(bytes + 33, 1, size - 33, out);
  fclose(out);
}

/* What chunks tell of edges, greys and orientation; cut short they tell nothing. */
static void test_png_chunks(void **state) {
  (void)state;
  const unsigned first = 0;
  struct stack stack;
  const char *path = file;
  static const char SCALE[] = "\1"
                              "5e-6\0"
                              "6e-6",
                    GREYS[] = "HU\0\0\0\0\0\0\0\0\xff\0\2HU\0-1000\0"
                              "20";
  write_with_chunk("sCAL", SCALE, sizeof SCALE - 1);
  assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
  assert_true(fabs(stack.voxel[0] - 5e-6) < 1e-12 && fabs(stack.voxel[1] - 6e-6) < 1e-12);
  stack_close(&stack);
  write_with_chunk("pCAL", GREYS, sizeof GREYS - 1);
  assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
  assert_true(fabs(stack.files[0].rescale[0] - 20.0 / 255.0) < 1e-9);
  assert_true(fabs(stack.files[0].rescale[1] + 1000.0) < 1e-9);
  stack_close(&stack);
  holds(&first, 1, 8, NULL, 0, 0, "before its calibration (pCAL)");
  write_with_chunk("pHYs", "\0\0\0\3\0\0\0\6", 9);
  holds(&first, 1, 8, NULL, 0, 0, "voxels of 1 x 0.5 by its pHYs, without a unit");
  write_with_chunk("oFFs", "\0\0\0\7\0\0\0\11", 9);
  assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
  assert_true(stack.files[0].at[0] == 7.0 && stack.files[0].at[1] == 9.0);
  stack_close(&stack);
  static const char EXIF[][27] = {"II*\0\10\0\0\0\1\0\22\1\3\0\1\0\0\0\6\0\0\0\0\0\0\0",
                                  "MM\0*\0\0\0\10\0\1\1\22\0\3\0\0\0\1\0\6\0\0\0\0\0\0"};
  for (size_t k = 0; k < 2; k++) {
    write_with_chunk("eXIf", EXIF[k], 26);
    holds(&first, 1, 8, NULL, 0, 0, "its orientation 6 says to turn it");
  }
  for (size_t n = 1; n < 26; n++) {
    write_with_chunk("eXIf", EXIF[0], n);
    assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
    stack_close(&stack);
    write_with_chunk("pCAL", GREYS, n < sizeof GREYS ? n : 1);
    assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
    stack_close(&stack);
    write_with_chunk("sCAL", SCALE, n < sizeof SCALE ? n : 1);
    assert_int_equal(stack_open(&path, 1, NULL, &stack), STATUS_OK);
    stack_close(&stack);
  }
}

/* A page whose bytes are half those of the page before. */
static void test_pages_of_the_same_bytes(void **state) {
  (void)state;
  static unsigned char bytes[8000];
  struct page pages[2] = {PLAIN, PLAIN};
  write_pages("wl", pages, 2);
  FILE *whole = fopen(file, "rb");
  const size_t size = fread(bytes, 1, sizeof bytes, whole);
  fclose(whole);
  size_t at = bytes[4] + 256u * bytes[5];
  at = bytes[at + 2 + 12 * (bytes[at] + 256u * bytes[at + 1])] +
       256u * bytes[at + 3 + 12 * (bytes[at] + 256u * bytes[at + 1])]; /* the second directory */
  for (at += 2; bytes[at] + 256u * bytes[at + 1] != TIFFTAG_STRIPOFFSETS;) at += 12;
  unsigned char *offsets = bytes + bytes[at + 8] + 256u * bytes[at + 9];
  for (size_t k = 0; k < 3; k++)
    offsets[4 * k] = (unsigned char)(8 + 6 * NX * (k + 1)),
                offsets[4 * k + 1] = (unsigned char)((8 + 6 * NX * (k + 1)) >> 8);
  whole = fopen(file, "wb");
  fwrite(bytes, 1, size, whole);
  fclose(whole);
  refused("page 1 has bytes of the page before");
}

/* An animation: libpng shows its first picture. */
static void test_animated_png(void **state) {
  (void)state;
  const unsigned first = 0;
  for (unsigned pictures = 1; pictures <= 2; pictures++) {
    const unsigned char control[8] = {0, 0, 0, (unsigned char)pictures};
    write_with_chunk("acTL", control, sizeof control);
    if (pictures == 1)
      holds(&first, 1, 8, NULL, 0, 0, NULL);
    else
      refused("an animation of 2 pictures");
  }
}

static void test_png_labels(void **state) {
  (void)state;
  const unsigned first = 0;
  for (int bits = 1; bits <= 8; bits *= 2) {
    write_png(file, bits, PNG_COLOR_TYPE_GRAY, 0);
    holds(&first, 1, (unsigned)bits, NULL, 0, 0, NULL);
    write_png(file, bits, PNG_COLOR_TYPE_PALETTE, 0);
    holds(&first, 1, (unsigned)bits, NULL, 0, 0, "the numbers of the colours are taken");
  }
  /* Slices whose palettes are made for each: one number means two colours. */
  char names[2][120];
  const char *paths[] = {names[0], names[1]};
  struct stack stack;
  for (unsigned i = 0; i < 2; i++) {
    snprintf(names[i], sizeof names[i], "%s/s%u.png", folder, i);
    write_png(names[i], 8, PNG_COLOR_TYPE_PALETTE, i);
  }
  assert_int_equal(stack_open(paths, 2, NULL, &stack), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "s1.png: its palette is not that of the first slice"));
  error_clear();
  write_png(names[0], 2, PNG_COLOR_TYPE_GRAY, 0);
  write_png(names[1], 4, PNG_COLOR_TYPE_GRAY, 0);
  assert_int_equal(stack_open(paths, 2, NULL, &stack), STATUS_INPUT);
  assert_non_null(
      strstr(error_message(), "s1.png: greys of 0 to 15, but the first slice has 0 to 3"));
  error_clear();
}

/* Values that are no measurement: GDAL's no data and PNG's transparent grey. */
static void test_no_data(void **state) {
  (void)state;
  const unsigned first = 0;
  struct page page = PLAIN;
  page.gdal[1] = "77";
  write_pages("w", &page, 1);
  no_data = 77.0;
  holds(&first, 1, 8, NULL, 0, 0, NULL);
  page.gdal[1] = "-9999"; /* which no pixel can have */
  write_pages("w", &page, 1);
  no_data = NAN;
  holds(&first, 1, 8, NULL, 0, 0, NULL);
  page.gdal[1] = "nan";
  write_pages("w", &page, 1);
  holds(&first, 1, 8, NULL, 0, 0, NULL);
  page.bits = 2;
  page.gdal[1] = "2";
  page.photometric = PHOTOMETRIC_MINISWHITE; /* no data is a stored value */
  write_pages("w", &page, 1);
  no_data = 1.0;
  holds(&first, 1, 2, inverted2, 0, 0, NULL);
  page = PLAIN;
  page.gdal[0] = "<GDALMetadata>\n<Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.5</Item>\n"
                 "<Item name=\"OFFSET\" sample=\"0\" role=\"offset\">-3</Item>\n</GDALMetadata>";
  write_pages("w", &page, 1);
  no_data = NAN;
  holds(&first, 1, 8, NULL, 0, 0,
        "greys as stored, before GDAL's scale 0.5; greys as stored, before GDAL's offset -3");
  page.gdal[0] = NULL;
  page.description = "SCIFIO=0.46.0\naxes=X,Y,Channel\nimages=3\nchannels=3\nslices=1\n";
  write_pages("w", &page, 1);
  refused("3 channels");
  page.description = NULL;
  page.gdal[0] = "<Item role=\"scale\">1</Item><Item role=\"offset\">0</Item>";
  write_pages("w", &page, 1);
  holds(&first, 1, 8, NULL, 0, 0, NULL);
  clear_grey = 77;
  write_png(file, 8, PNG_COLOR_TYPE_GRAY, 0);
  no_data = 77.0;
  holds(&first, 1, 8, NULL, 0, 0, NULL);
  clear_grey = -1;
  no_data = NAN;
}

/* PNG with a second sample: transparency. */
static void test_png_alpha(void **state) {
  (void)state;
  const unsigned first = 0;
  for (int opaque = 0; opaque < 2; opaque++) {
    alpha_opaque = opaque;
    write_png(file, 8, PNG_COLOR_TYPE_GRAY_ALPHA, 0);
    if (opaque)
      holds(&first, 1, 8, NULL, 0, 0, NULL);
    else
      refused("those beyond the grey are not the same everywhere");
  }
  static const int CLEAR[] = {0, 100, 256}; /* none, some, all */
  for (size_t i = 0; i < 3; i++) {
    clear_entries = CLEAR[i];
    write_png(file, 8, PNG_COLOR_TYPE_PALETTE, 0);
    if (i == 1)
      refused(
          "its palette makes some pixels transparent and others not (pixel 12,1), as of a mask");
    else
      holds(&first, 1, 8, NULL, 0, 0, "the numbers of the colours are taken");
  }
  clear_entries = 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sparse),
      cmocka_unit_test(test_strip_of_a_wrong_length),
      cmocka_unit_test(test_pages_aside),
      cmocka_unit_test(test_lost_slices),
      cmocka_unit_test(test_lengths),
      cmocka_unit_test(test_channels),
      cmocka_unit_test(test_told_by_pages),
      cmocka_unit_test(test_private_tags),
      cmocka_unit_test(test_pages_of_the_same_bytes),
      cmocka_unit_test(test_png_chunks),
      cmocka_unit_test(test_slices_without_a_directory),
      cmocka_unit_test(test_slices_of_reversed_bits),
      cmocka_unit_test(test_undeclared_samples),
      cmocka_unit_test(test_samples_of_less_than_a_byte),
      cmocka_unit_test(test_tiff_palettes),
      cmocka_unit_test(test_png_labels),
      cmocka_unit_test(test_animated_png),
      cmocka_unit_test(test_no_data),
      cmocka_unit_test(test_png_alpha),
  };
  return cmocka_run_group_tests(tests, make_file, remove_folder);
}
