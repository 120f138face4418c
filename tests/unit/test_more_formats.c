/* BMP, VTI and DICOM, byte by byte: what they hold is read voxel for voxel, what the short readers
 * do not read is refused. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/error.h"
#include "common/log.h"
#include "ct2model/readers/stack.h"

enum { NX = 13, NY = 18, NZ = 5, N = NX * NY * NZ };
static char folder[] = "/tmp/tosui-more-XXXXXX";
static char names[NZ][120];

static int make_folder(void **state) {
  (void)state;
  log_start("test_more_formats", LOG_QUIET);
  return mkdtemp(folder) == NULL;
}
static int remove_folder(void **state) {
  (void)state;
  char command[100];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return system(command);
}

static unsigned grey(size_t x, size_t y, size_t z) {
  return (unsigned)(7 * x + 11 * y + 3 * z + x * y) & 255u;
}

static FILE *begin(size_t i, const char *name) {
  snprintf(names[i], sizeof names[i], "%s/%s", folder, name);
  FILE *file = fopen(names[i], "wb");
  assert_non_null(file);
  return file;
}

static void put(FILE *file, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; i++) fputc((int)(value >> (8 * i) & 255), file);
}

static enum status read_all(size_t count, struct stack *stack, float *pixels) {
  const char *paths[NZ];
  for (size_t i = 0; i < count; i++) paths[i] = names[i];
  enum status status = stack_open(paths, count, NULL, stack);
  for (size_t z = 0; status == STATUS_OK && z < stack->size[2]; z++)
    status = stack_read(stack, z, pixels + z * NX * NY);
  return status;
}

static void refused(size_t count, const char *word) {
  struct stack stack;
  static float pixels[4 * N];
  const enum status status = read_all(count, &stack, pixels);
  if (status != STATUS_INPUT || strstr(error_message(), word) == NULL)
    fail_msg("not refused with '%s': %s", word, error_message());
  error_clear();
  stack_close(&stack);
}

/* The files hold `slices` slices of factor * (grey & mask) + offset; voxels in um, NAN: not told.
 */
static void holds(size_t count, size_t slices, unsigned mask, double factor, double offset,
                  const double voxel[2], const char *note) {
  struct stack stack;
  static float pixels[N];
  if (read_all(count, &stack, pixels) != STATUS_OK) fail_msg("%s", error_message());
  if (stack.size[0] != NX || stack.size[1] != NY || stack.size[2] != slices)
    fail_msg("%zux%zux%zu", stack.size[0], stack.size[1], stack.size[2]);
  for (size_t i = 0; i < slices * NX * NY; i++) {
    const double wanted = factor * (grey(i % NX, i / NX % NY, i / NX / NY) & mask) + offset;
    if ((double)pixels[i] != wanted) fail_msg("%g at %zu, not %g", (double)pixels[i], i, wanted);
  }
  for (int a = 0; a < 2; a++) {
    const double found = stack.voxel[2 * a] * 1e6;
    if (isnan(voxel[a]) ? !isnan(found) : !(fabs(found / voxel[a] - 1.0) < 1e-6))
      fail_msg("voxel %g um, not %g", found, voxel[a]);
  }
  if (note == NULL ? stack.files[0].note[0] != '\0' : strstr(stack.files[0].note, note) == NULL)
    fail_msg("told '%s', not '%s'", stack.files[0].note, note != NULL ? note : "");
  stack_close(&stack);
}

struct bmp {
  unsigned bits, header, compression, lost; /* lost: bytes missing at the end */
  bool top_down;
  enum { GREYS, INVERTED, COLOURS } palette;
};

static void write_bmp(size_t z, const struct bmp *bmp) {
  char name[40];
  snprintf(name, sizeof name, "rec%04zu.bmp", z);
  FILE *file = begin(z, name);
  const unsigned core = bmp->header == 12, entry = core ? 3 : 4;
  const unsigned colours = bmp->bits <= 8 ? 1u << bmp->bits : 0,
                 start = 14 + bmp->header + entry * colours + 6;
  const size_t stride = (NX * bmp->bits + 31) / 32 * 4;
  fputs("BM", file);
  put(file, start + stride * NY, 4);
  put(file, 0, 4);
  put(file, start, 4);
  put(file, bmp->header, 4);
  put(file, NX, core ? 2 : 4);
  put(file, bmp->top_down ? (uint64_t)(int64_t)-NY : NY, core ? 2 : 4);
  put(file, 1, 2);
  put(file, bmp->bits, 2);
  if (!core) {
    put(file, bmp->compression, 4);
    put(file, 0, 4);
    put(file, 171527, 4);
    put(file, 171527, 4);
    put(file, 0, 8);
    for (unsigned i = 40; i < bmp->header; i++) fputc(0, file);
  }
  for (unsigned i = 0; i < colours; i++) {
    const unsigned value = bmp->palette == INVERTED ? colours - 1 - i : i;
    for (unsigned c = 0; c < 3; c++)
      put(file, bmp->palette == COLOURS ? (i * 37 + c * 91) % 256 : value, 1);
    if (!core) fputc(0, file);
  }
  fputs("filler", file);
  for (size_t row = 0; row < NY; row++) {
    unsigned char line[4 * NX + 4] = {0};
    const size_t y = bmp->top_down ? row : NY - 1 - row;
    for (size_t x = 0; x < NX; x++) {
      const unsigned value = grey(x, y, z);
      if (bmp->bits > 8) {
        memset(line + x * bmp->bits / 8, (int)value, 3);
        line[x * bmp->bits / 8 + 3] = bmp->bits == 32 ? 200 : 0;
        continue;
      }
      const size_t bit = x * bmp->bits;
      line[bit / 8] |=
          (unsigned char)((value & ((1u << bmp->bits) - 1u)) << (8 - bmp->bits - bit % 8));
    }
    fwrite(line, 1, row + 1 == NY ? stride - bmp->lost : stride, file);
  }
  fclose(file);
}

static void test_bmp(void **state) {
  (void)state;
  const double told[] = {1e6 / 171527, NAN}, untold[] = {NAN, NAN};
  const struct bmp skyscan = {8, 40, 0, 0, false, GREYS};
  for (size_t z = 0; z < NZ; z++) write_bmp(z, &skyscan);
  holds(NZ, NZ, 255, 1, 0, told, NULL);
  const struct bmp others[] = {{8, 40, 0, 0, true, GREYS},
                               {8, 12, 0, 0, false, GREYS},
                               {8, 124, 0, 0, false, GREYS},
                               {24, 40, 0, 0, false, GREYS},
                               {32, 108, 0, 0, true, GREYS}};
  for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
    write_bmp(0, &others[i]);
    holds(1, 1, 255, 1, 0, others[i].header == 12 ? untold : told,
          others[i].bits > 8 ? "stored in colour" : NULL);
  }
  write_bmp(0, &(struct bmp){8, 40, 0, 0, false, INVERTED});
  holds(1, 1, 255, -1, 255, told, NULL);
  for (unsigned bits = 1; bits <= 8; bits *= bits == 1 ? 4 : 2) {
    write_bmp(0, &(struct bmp){bits, 40, 0, 0, false, COLOURS});
    holds(1, 1, (1u << bits) - 1u, 1, 0, told, "the numbers of the colours are taken");
  }
  write_bmp(0, &(struct bmp){8, 40, 1, 0, false, GREYS});
  refused(1, "compression 1");
  write_bmp(0, &(struct bmp){8, 40, 0, 1, false, GREYS});
  refused(1, "its header promises");
  write_bmp(0, &(struct bmp){16, 40, 0, 0, false, GREYS});
  refused(1, "bitmaps of 16 bits");
}

struct vti {
  const char *type, *more, *arrays; /* attributes of VTKFile, text of the piece's data */
  int size;                         /* bytes a number; < 0: big-endian */
  bool wide;                        /* header of 64 bits */
  size_t lost;
};

static void put_ordered(FILE *file, uint64_t value, int bytes, bool big) {
  for (int i = 0; i < bytes; i++) fputc((int)(value >> 8 * (big ? bytes - 1 - i : i) & 255), file);
}

static void write_vti(const struct vti *vti, bool cells) {
  FILE *file = begin(0, "scan.vti");
  const bool big = vti->size < 0;
  const int size = abs(vti->size), more = cells ? 1 : 0;
  fprintf(file,
          "<?xml version=\"1.0\"?>\n<!-- <AppendedData> and a <DataArray> in a comment -->\n"
          "<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"%s\"%s%s>\n"
          "  <ImageData WholeExtent=\"0 %d 0 %d 2 %d\" Origin=\"0 0 0\" Spacing=\"1 1 2\">\n"
          "  <Piece Extent=\"0 %d 0 %d 2 %d\">%s</Piece></ImageData>\n"
          "  <AppendedData encoding=\"raw\">\n   _1234567",
          vti->type, big ? "BigEndian" : "LittleEndian", vti->wide ? " header_type=\"UInt64\"" : "",
          vti->more, NX - 1 + more, NY - 1 + more, NZ + 1 + more, NX - 1 + more, NY - 1 + more,
          NZ + 1 + more, vti->arrays);
  put_ordered(file, (uint64_t)(N * size), vti->wide ? 8 : 4, big);
  for (size_t i = 0; i + vti->lost < N; i++)
    put_ordered(file, grey(i % NX, i / NX % NY, i / NX / NY), size, big);
  if (vti->lost == 0) fputs("\n  </AppendedData>\n</VTKFile>\n", file);
  fclose(file);
}

#define ARRAY(type, more)                                                                          \
  "<DataArray type=\"" type "\" Name=\"grey\" format=\"appended\" " more " offset=\"7\"/>"

static void test_vti(void **state) {
  (void)state;
  const double untold[] = {NAN, NAN};
  const struct {
    struct vti vti;
    bool cells;
    const char *refused;
  } cases[] = {
      {{"ImageData", "",
        "<PointData Scalars=\"grey\">" ARRAY("UInt8", "") "</PointData><CellData/>", 1, false, 0},
       false,
       NULL},
      {{"ImageData", "", "<PointData></PointData><CellData>" ARRAY("UInt16", "") "</CellData>", 2,
        true, 0},
       true,
       NULL},
      {{"ImageData", "", "<CellData>" ARRAY("Int32", "NumberOfComponents=\"1\"") "</CellData>", -4,
        true, 0},
       true,
       NULL},
      {{"ImageData", "", "<PointData>" ARRAY("UInt64", "") "</PointData>", -8, false, 0},
       false,
       NULL},
      {{"StructuredGrid", "", "<PointData>" ARRAY("UInt8", "") "</PointData>", 1, false, 0},
       false,
       "no ImageData of VTK"},
      {{"ImageData", " compressor=\"vtkZLibDataCompressor\"",
        "<PointData>" ARRAY("UInt8", "") "</PointData>", 1, false, 0},
       false,
       "compressed or encoded"},
      {{"ImageData", "", "<PointData>" ARRAY("UInt8", "") ARRAY("UInt8", "") "</PointData>", 1,
        false, 0},
       false,
       "several arrays"},
      {{"ImageData", "", "<PointData></PointData>", 1, false, 0}, false, "has no array"},
      {{"ImageData", "", "<PointData>" ARRAY("UInt8", "NumberOfComponents=\"3\"") "</PointData>", 1,
        false, 0},
       false,
       "3 numbers a voxel"},
      {{"ImageData", "", "<PointData>" ARRAY("Bit", "") "</PointData>", 1, false, 0},
       false,
       "type Bit"},
      {{"ImageData", "", "<CellData>" ARRAY("UInt8", "") "</CellData>", 1, false, 0},
       false,
       "but its extent promises"},
      {{"ImageData", "", "<PointData>" ARRAY("UInt16", "") "</PointData>", 1, false, 0},
       false,
       "but its extent promises"},
      {{"ImageData", "", "<PointData>" ARRAY("UInt8", "") "</PointData>", 1, false, 3},
       false,
       "ends within its array"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    write_vti(&cases[i].vti, cases[i].cells);
    if (cases[i].refused != NULL)
      refused(1, cases[i].refused);
    else
      holds(1, NZ, 255, 1, 0, untold, "Spacing = 1 1 2 has no unit");
  }
}

struct dicom {
  const char *syntax, *photometric, *slope;
  bool implicit, is_signed, nested;
  unsigned stored, frames, dirt; /* dirt: set in the bits above */
  int place;                     /* of the slice, in tenths of a mm */
};

static void put_head(FILE *file, unsigned group, unsigned element, const char *kind, size_t length,
                     bool implicit) {
  put(file, group, 2);
  put(file, element, 2);
  if (implicit) {
    put(file, length, 4);
    return;
  }
  fputs(kind, file);
  if (strcmp(kind, "OW") == 0 || strcmp(kind, "SQ") == 0) {
    put(file, 0, 2);
    put(file, length, 4);
  } else {
    put(file, length, 2);
  }
}

static void put_text(FILE *file, unsigned group, unsigned element, const char *kind,
                     const char *text, bool implicit) {
  const size_t length = strlen(text);
  put_head(file, group, element, kind, length + length % 2, implicit);
  fputs(text, file);
  if (length % 2) fputc(strcmp(kind, "UI") == 0 ? 0 : ' ', file);
}

static void put_whole(FILE *file, unsigned element, unsigned value, bool implicit) {
  put_head(file, 0x28, element, "US", 2, implicit);
  put(file, value, 2);
}

/* Slices from z on into one file. */
static void write_dicom(size_t i, size_t z, const struct dicom *d) {
  char text[80];
  snprintf(text, sizeof text, "IM%zu.dcm", i);
  FILE *file = begin(i, text);
  const bool implicit = d->implicit;
  for (int k = 0; k < 128; k++) fputc(0, file);
  fputs("DICM", file);
  put_text(file, 2, 0x10, "UI", d->syntax, false);
  if (d->nested) { /* a sequence of undefined length with an item of one, which has pixels of its
                      own */
    put_head(file, 0x08, 0x1140, "SQ", 0xffffffff, implicit);
    put(file, 0xe000fffe, 4), put(file, 0xffffffff, 4);
    put_head(file, 0x7fe0, 0x10, "OW", 4, implicit);
    put(file, 0x01020304, 4);
    put(file, 0xe00dfffe, 4), put(file, 0, 4);
    put(file, 0xe0ddfffe, 4), put(file, 0, 4);
  }
  if (d->place != 0) {
    snprintf(text, sizeof text, "-10.5\\20\\%g", 0.1 * d->place);
    put_text(file, 0x20, 0x32, "DS", text, implicit);
    put_text(file, 0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0", implicit);
  }
  put_whole(file, 2, 1, implicit);
  put_text(file, 0x28, 4, "CS", d->photometric, implicit);
  if (d->frames > 1) {
    snprintf(text, sizeof text, "%u", d->frames);
    put_text(file, 0x28, 8, "IS", text, implicit);
  }
  put_whole(file, 0x10, NY, implicit);
  put_whole(file, 0x11, NX, implicit);
  put_text(file, 0x28, 0x30, "DS", "0.02\\0.01", implicit);
  put_whole(file, 0x100, 16, implicit);
  put_whole(file, 0x101, d->stored, implicit);
  put_whole(file, 0x102, d->stored - 1, implicit);
  put_whole(file, 0x103, d->is_signed, implicit);
  if (d->slope != NULL) put_text(file, 0x28, 0x1053, "DS", d->slope, implicit);
  put_head(file, 0x7fe0, 0x10, "OW", 2 * NX * NY * d->frames, implicit);
  for (size_t k = 0; k < NX * NY * d->frames; k++) {
    const int value = (int)grey(k % NX, k / NX % NY, z + k / NX / NY) - (d->is_signed ? 100 : 0);
    put(file, ((unsigned)value & ((1u << d->stored) - 1u)) | d->dirt, 2);
  }
  fclose(file);
}

#define EXPLICIT "1.2.840.10008.1.2.1"
static void test_dicom(void **state) {
  (void)state;
  const double flat[] = {10, NAN}, deep[] = {10, 500};
  /* Names are in another order than places; the voxel is the slices' distance. */
  const size_t order[NZ] = {3, 0, 4, 1, 2};
  struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, true, 16, 1, 0, 0};
  for (size_t i = 0; i < NZ; i++) {
    d.place = 5 * (int)order[i] - 7;
    write_dicom(i, order[i], &d);
  }
  holds(NZ, NZ, 255, 1, 0, deep, NULL);
  d.place = 5 * 4 - 7;
  write_dicom(0, 4, &d); /* twice the same place */
  refused(NZ, "at the same place");
  d.place = 31;
  write_dicom(0, 4, &d); /* 1.8 mm after the one before */
  refused(NZ, "are some missing?");
  const struct {
    struct dicom dicom;
    double factor, offset;
    const char *note, *refused;
  } cases[] = {
      {{"1.2.840.10008.1.2", "MONOCHROME2", NULL, true, false, true, 16, NZ, 0, 0},
       1,
       0,
       NULL,
       NULL},
      {{EXPLICIT, "MONOCHROME2", NULL, false, true, false, 16, NZ, 0, 0}, 1, -100, NULL, NULL},
      {{EXPLICIT, "MONOCHROME2", NULL, false, true, false, 12, NZ, 0xf000, 0}, 1, -100, NULL, NULL},
      {{EXPLICIT, "MONOCHROME2", NULL, false, true, false, 12, NZ, 0, 0}, 1, -100, NULL, NULL},
      {{EXPLICIT, "MONOCHROME2", NULL, false, false, false, 12, NZ, 0xa000, 0}, 1, 0, NULL, NULL},
      {{EXPLICIT, "MONOCHROME1", NULL, false, false, false, 16, NZ, 0, 0}, -1, 65535, NULL, NULL},
      {{EXPLICIT, "MONOCHROME2", "2.5", false, false, false, 16, NZ, 0, 0},
       1,
       0,
       "slope 2.5",
       NULL},
      {{"1.2.840.10008.1.2.4.70", "MONOCHROME2", NULL, false, false, false, 16, NZ, 0, 0},
       1,
       0,
       NULL,
       "transfer syntax"},
      {{EXPLICIT, "RGB", NULL, false, false, false, 16, NZ, 0, 0}, 1, 0, NULL, "kind RGB"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    write_dicom(0, 0, &cases[i].dicom);
    if (cases[i].refused != NULL)
      refused(1, cases[i].refused);
    else
      holds(1, NZ, 255, cases[i].factor, cases[i].offset, flat, cases[i].note);
  }
  d = (struct dicom){EXPLICIT, "MONOCHROME2", "1", false, false, false, 16, 1, 0, 0};
  write_dicom(0, 0, &d);
  d.slope = "1.5";
  write_dicom(1, 1, &d);
  refused(2, "the same number means other densities");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bmp),
      cmocka_unit_test(test_vti),
      cmocka_unit_test(test_dicom),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
