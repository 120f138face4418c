/* BMP, VTI and DICOM, byte by byte: what they hold is read voxel for voxel, what the short readers
 * do not read is refused. */
#include "tests/unit/folder_rig.h"

#include <math.h>
#include <string.h>
#include <zlib.h>

#include "common/error.h"
#include "ct2model/readers/stack.h"

enum { NX = 13, NY = 18, NZ = 5, N = NX * NY * NZ };
static char names[NZ][120];

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

static double no_data[2] = {NAN, NAN}; /* values from one to the other are no measurement */

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
    const bool lost = wanted >= no_data[0] && wanted <= no_data[1];
    if (lost ? !isnan(pixels[i]) : (double)pixels[i] != wanted)
      fail_msg("%g at %zu, not %g", (double)pixels[i], i, wanted);
  }
  for (int a = 0; a < 2; a++) {
    const double found = stack.voxel[2 * a] * 1e6;
    if (isnan(voxel[a]) ? !isnan(found) : !(fabs(found / voxel[a] - 1.0) < 1e-6))
      fail_msg("voxel %g um, not %g", found, voxel[a]);
  }
  assert_true(stack.voxel_source != NULL || (isnan(stack.voxel[0]) && isnan(stack.voxel[2])));
  if (note == NULL ? stack.files[0].note[0] != '\0' : strstr(stack.files[0].note, note) == NULL)
    fail_msg("told '%s', not '%s'", stack.files[0].note, note != NULL ? note : "");
  stack_close(&stack);
}

struct bmp {
  unsigned bits, header, compression, lost; /* lost: bytes missing at the end */
  bool top_down;
  enum { GREYS, INVERTED, COLOURS } palette;
};

static unsigned bmp_resolution = 171527; /* pixels per metre */

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
    put(file, bmp_resolution, 4);
    put(file, bmp_resolution, 4);
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
  bmp_resolution = 39; /* 1 dpi, as ImageMagick writes it where nobody told */
  write_bmp(0, &skyscan);
  holds(1, 1, 255, 1, 0, untold, NULL);
  bmp_resolution = 171527;
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

/* Puts four zeros into a file, `behind` bytes after the start of a text. */
static void insert_zeros(const char *path, const char *text, size_t behind) {
  static char bytes[1 << 20];
  FILE *file = fopen(path, "rb");
  const size_t n = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  size_t at = 0;
  while (memcmp(bytes + at, text, strlen(text)) != 0) at++;
  at += behind;
  file = fopen(path, "wb");
  fwrite(bytes, 1, at, file);
  fwrite("\0\0\0", 1, 4, file);
  fwrite(bytes + at, 1, n - at, file);
  fclose(file);
}

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
       "does not begin with its compressed blocks"},
      {{"ImageData", " compressor=\"vtkLZ4DataCompressor\"",
        "<PointData>" ARRAY("UInt8", "") "</PointData>", 1, false, 0},
       false,
       "vtkLZ4DataCompressor, which is not read; save it with zlib"},
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
  /* The head is of 64 bits, but is said to be of 32: all would be read four bytes early. */
  write_vti(&(struct vti){"ImageData", " header_type=\"UInt32\"",
                          "<PointData>" ARRAY("UInt8", "") "</PointData>", 1, false, 0},
            false);
  char path[160];
  snprintf(path, sizeof path, "%s/scan.vti", folder);
  insert_zeros(path, "_1234567", 12);
  refused(1, "bytes are left behind its array: is header_type=\"UInt32\" right?");
}

/* The greys as text, in base64 or in compressed blocks. */
struct vti_form {
  enum { APPENDED, ENCODED, INLINE, TEXT } form;
  size_t block;                   /* bytes of a compressed block; 0: plain */
  bool apart, wide;               /* the head is encoded apart from the numbers, as VTK does it */
  int size;                       /* bytes a number; < 0: big-endian */
  const char *type, *more, *text; /* of VTKFile; instead of the numbers */
  size_t lost;                    /* bytes missing at the end of what is encoded */
};

static unsigned char body[20 * N];
static size_t body_length;

static void add_number(uint64_t value, int bytes, bool big) {
  for (int i = 0; i < bytes; i++)
    body[body_length++] = (unsigned char)(value >> 8 * (big ? bytes - 1 - i : i) & 255);
}

static void put_base64(FILE *file, const unsigned char *bytes, size_t n) {
  static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < n; i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; k++) bits = bits << 8 | (i + k < n ? bytes[i + k] : 0);
    for (size_t k = 0; k < 4; k++)
      fputc(i + k <= n ? DIGITS[bits >> (18 - 6 * k) & 63] : '=', file);
    if (i % 60 == 57) fputs("\n  ", file);
  }
}

/* Fills `body` with the array; returns the length of its head. */
static size_t make_body(const struct vti_form *f) {
  static unsigned char packed[20 * N];
  const bool big = f->size < 0;
  const int size = abs(f->size), width = f->wide ? 8 : 4;
  body_length = 0;
  for (size_t i = 0; i < N; i++) add_number(grey(i % NX, i / NX % NY, i / NX / NY), size, big);
  const size_t whole = body_length;
  const size_t count = f->block > 0 ? (whole + f->block - 1) / f->block : 0;
  size_t lengths[64], used = 0;
  assert_true(count <= 64);
  for (size_t i = 0; i < count; i++) {
    uLongf room = sizeof packed - used;
    const size_t n = i + 1 < count ? f->block : whole - i * f->block;
    assert_int_equal(compress(packed + used, &room, body + i * f->block, n), Z_OK);
    lengths[i] = room;
    used += room;
  }
  memmove(body + 1024, body, whole);
  body_length = 0;
  add_number(f->block > 0 ? count : whole, width, big);
  if (f->block > 0) add_number(f->block, width, big), add_number(whole % f->block, width, big);
  for (size_t i = 0; i < count; i++) add_number(lengths[i], width, big);
  const size_t head = body_length;
  if (f->block > 0)
    memcpy(body + head, packed, used);
  else
    memmove(body + head, body + 1024, whole);
  body_length += (f->block > 0 ? used : whole) - f->lost;
  return head;
}

static void write_vti_form(const struct vti_form *f) {
  FILE *file = begin(0, "scan.vti");
  const bool appended = f->form == APPENDED || f->form == ENCODED;
  const size_t head = make_body(f);
  fprintf(file,
          "<VTKFile type='ImageData' byte_order='%s' header_type='%s'%s%s><ImageData "
          "WholeExtent='0 %d 0 %d 0 %d'>\n<FieldData><DataArray type='Float64' format='ascii'> 1.5 "
          "</DataArray></FieldData><Piece>\n<PointData><DataArray type='%s' format='%s' "
          "offset='0'>\n ",
          f->size < 0 ? "BigEndian" : "LittleEndian", f->wide ? "UInt64" : "UInt32",
          f->block > 0 ? " compressor='vtkZLibDataCompressor'" : "", f->more, NX - 1, NY - 1,
          NZ - 1, f->type,
          appended            ? "appended"
          : f->form == INLINE ? "binary"
                              : "ascii");
  if (appended)
    fprintf(file, "</DataArray></PointData></Piece></ImageData><AppendedData encoding='%s'>_",
            f->form == APPENDED ? "raw" : "base64");
  if (f->form == TEXT && f->text == NULL) {
    const bool floats = f->type[0] == 'F';
    for (size_t i = 0; i < N; i++)
      fprintf(file, floats ? "%u.0e0 " : "%u\n", grey(i % NX, i / NX % NY, i / NX / NY));
  } else if (f->text != NULL) {
    fputs(f->text, file);
  } else if (f->form == APPENDED) {
    fwrite(body, 1, body_length, file);
  } else {
    put_base64(file, body, f->apart ? head : 0);
    put_base64(file, body + (f->apart ? head : 0), body_length - (f->apart ? head : 0));
  }
  fputs(appended ? "\n</AppendedData></VTKFile>" : "\n</DataArray></PointData>", file);
  if (!appended) fputs(f->lost == 1 ? "<CellData><DataArray/>" : "<CellData/>", file);
  fclose(file);
}

static void test_vti_forms(void **state) {
  (void)state;
  const double untold[] = {NAN, NAN};
  static const struct {
    const char *type;
    int size;
  } TYPES[] = {{"UInt8", 1}, {"UInt16", -2}, {"Int32", 4}, {"UInt64", -8}};
  for (int form = ENCODED; form <= INLINE; form++)
    for (size_t t = 0; t < 4; t++)
      for (int k = 0; k < 4; k++) {
        write_vti_form(
            &(struct vti_form){form, 0, k % 2, k / 2, TYPES[t].size, TYPES[t].type, "", NULL, 0});
        holds(1, NZ, 255, 1, 0, untold, NULL);
      }
  /* Blocks of which the last is shorter, whole (NX NY NZ = 1170 = 2 x 585), or the only one. */
  static const size_t BLOCKS[] = {400, 585, 32768};
  for (int form = APPENDED; form <= INLINE; form++)
    for (size_t b = 0; b < 3; b++)
      for (int k = 0; k < 4; k++) {
        write_vti_form(&(struct vti_form){form, BLOCKS[b], k % 2, k / 2, TYPES[k].size,
                                          TYPES[k].type, "", NULL, 0});
        holds(1, NZ, 255, 1, 0, untold, NULL);
      }
  static const char *const TEXTS[] = {"UInt8",   "Int16", "UInt32", "Float32",
                                      "Float64", "Int64", "UInt64"};
  for (size_t t = 0; t < sizeof TEXTS / sizeof *TEXTS; t++) {
    write_vti_form(&(struct vti_form){TEXT, 0, false, false, -1, TEXTS[t],
                                      " compressor='vtkLZ4DataCompressor'", NULL, 0});
    holds(1, NZ, 255, 1, 0, untold, NULL);
  }
  const struct {
    struct vti_form form;
    const char *refused;
  } wrong[] = {
      {{INLINE, 0, true, false, 1, "UInt8", "", NULL, 7}, "ends within its array"},
      {{INLINE, 0, true, false, 2, "UInt8", "", NULL, 0},
       "has 2340 bytes, but its extent promises"},
      {{INLINE, 0, true, false, 1, "UInt8", "", NULL, 2}, "ends within its array"},
      {{APPENDED, 400, true, false, 1, "UInt8", "", NULL, 7}, "block 2 of its array"},
      {{INLINE, 400, true, false, 1, "UInt16", "", NULL, 0}, "has 1170 bytes, but its extent"},
      {{INLINE, 0, true, true, 1, "UInt8", " compressor='vtkLZMADataCompressor'", NULL, 0},
       "vtkLZMADataCompressor, which is not read"},
      {{TEXT, 0, true, false, 1, "UInt8", "", "1 2 3", 0}, "can hold at most"},
      {{TEXT, 0, true, false, 1, "Bit", "", "1 2 3", 0}, "type Bit"},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    write_vti_form(&wrong[i].form);
    refused(1, wrong[i].refused);
  }
  static char text[8 * N];
  static const char *const NONE[] = {"AA*A", "=AAA", "AA=A", "A==="};
  for (size_t i = 0; i < 4; i++) {
    memset(text, 'A', 3 * N); /* a head of zeros would be another length */
    memcpy(text, NONE[i], 4);
    write_vti_form(&(struct vti_form){INLINE, 0, false, false, 1, "UInt8", "", text, 0});
    refused(1, "no base64");
  }
  /* Text whose numbers are too few, too many, or none of the type. */
  static const char *const ENDS[][2] = {
      {"", "1169 numbers, but"},      {" 7 7", "more than the 1170 numbers"},
      {" 256", "'256' is no number"}, {" -1", "'-1' is no number"},
      {" 1.5", "'1.5' is no number"}, {" x", "'x' is no number"}};
  for (size_t e = 0; e < sizeof ENDS / sizeof *ENDS; e++) {
    text[0] = '\0';
    for (size_t i = 0, used = 0; i + 1 < N; i++)
      used += (size_t)sprintf(text + used, " %zu", i % 9);
    strcat(text, ENDS[e][0]);
    write_vti_form(&(struct vti_form){TEXT, 0, false, false, 1, "UInt8", "", text, 0});
    refused(1, ENDS[e][1]);
  }
  /* A second array behind the first. */
  write_vti_form(&(struct vti_form){TEXT, 0, false, false, 1, "UInt8", "", NULL, 1});
  refused(1, "several arrays");
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
  if (strcmp(kind, "OW") == 0 || strcmp(kind, "SQ") == 0 || strcmp(kind, "UN") == 0) {
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

/* What else a file may have or lack. */
static struct {
  bool no_preamble, no_group, unturned; /* unturned: no orientation with the position */
  int number;                           /* of the slice; 0: none */
  const char *series, *distance, *thickness;
  const int *places;    /* of frames, in tenths of a mm */
  const size_t *rank;   /* of frames in the body; NULL: one behind the other */
  const double *mapped; /* slope and intercept of real world values, and the slope of the last */
  const char *scaled;   /* slope of the last frame */
  bool table, floats;   /* a table for the greys; pixels that are floats */
  int padding, limit;   /* values of padding, from one to the other; 0: none */
  const char *location; /* of the slice, mm */
  const char *tilt, *aspect, *axes;
  double aside;     /* of a slice from the one before, mm along y */
  unsigned pointer; /* what the next frame follows by: an element of group 0x18 */
  bool several;     /* by that, and by an element of group 0x54 */
  bool unspaced;
  const char *told[2];          /* one more text: tag as "GGGGEEEE" with its kind, and value */
  const unsigned char *numbers; /* of frames in the stack; NULL: none */
  unsigned numbered;            /* 0x9057 or 0x9157: as what */
  unsigned part;                /* of a concatenation */
} extra;

static void put_item(FILE *file, bool begin, bool implicit, unsigned group, unsigned element) {
  if (begin) {
    put_head(file, group, element, "SQ", 0xffffffff, implicit);
    put(file, 0xe000fffe, 4), put(file, 0xffffffff, 4);
  } else {
    put(file, 0xe00dfffe, 4), put(file, 0, 4);
    put(file, 0xe0ddfffe, 4), put(file, 0, 4);
  }
}

static void put_mapping(FILE *file, double slope, bool implicit) {
  const double values[2] = {extra.mapped[1], slope};
  put_item(file, true, implicit, 0x40, 0x9096);
  put_item(file, true, implicit, 0x40, 0x08ea); /* its unit */
  put_text(file, 0x08, 0x100, "SH", "{counts}", implicit);
  put_item(file, false, implicit, 0, 0);
  for (unsigned i = 0; i < 2; i++) {
    uint64_t bits;
    memcpy(&bits, &values[i], sizeof bits);
    put_head(file, 0x40, 0x9224 + i, "FD", 8, implicit);
    put(file, bits, 8);
  }
  put_item(file, false, implicit, 0, 0);
}

/* The functional groups of frames: what all share, and the position of each. */
static void put_frames(FILE *file, const struct dicom *d) {
  const bool implicit = d->implicit;
  char text[80];
  put_item(file, true, implicit, 0x5200, 0x9229);
  put_item(file, true, implicit, 0x20, 0x9116);
  put_text(file, 0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0", implicit);
  put_item(file, false, implicit, 0, 0);
  put_item(file, true, implicit, 0x28, 0x9110);
  put_text(file, 0x28, 0x30, "DS", "0.02\\0.01", implicit);
  put_item(file, false, implicit, 0, 0);
  put_item(file, false, implicit, 0, 0);
  put_head(file, 0x5200, 0x9230, "SQ", 0xffffffff, implicit);
  for (unsigned f = 0; f < d->frames; f++) {
    put(file, 0xe000fffe, 4), put(file, 0xffffffff, 4);
    put_item(file, true, implicit, 0x20, 0x9113);
    if (extra.numbers == NULL)
      snprintf(text, sizeof text, "-10.5\\%g\\%g", 20.0 + f * extra.aside, 0.1 * extra.places[f]);
    if (extra.numbers == NULL) put_text(file, 0x20, 0x32, "DS", text, implicit);
    put_item(file, false, implicit, 0, 0);
    if (extra.numbers != NULL) {
      put_item(file, true, implicit, 0x20, 0x9111);
      put_head(file, 0x20, extra.numbered, "UL", extra.numbered == 0x9057 ? 4 : 8, implicit);
      if (extra.numbered != 0x9057) put(file, 1, 4);
      put(file, extra.numbers[f], 4);
      put_item(file, false, implicit, 0, 0);
    }
    put_item(file, true, implicit, 0x28, 0x9145);
    put_text(file, 0x28, 0x1053, "DS",
             extra.scaled != NULL && f + 1 == d->frames ? extra.scaled : "1", implicit);
    put_item(file, false, implicit, 0, 0);
    if (extra.mapped != NULL) put_mapping(file, extra.mapped[f + 1 == d->frames ? 2 : 0], implicit);
    put(file, 0xe00dfffe, 4), put(file, 0, 4);
  }
  put(file, 0xe0ddfffe, 4), put(file, 0, 4);
}

/* Slices from z on into one file. */
static void write_dicom(size_t i, size_t z, const struct dicom *d) {
  char text[80];
  snprintf(text, sizeof text, "IM%zu.dcm", i);
  FILE *file = begin(i, text);
  const bool implicit = d->implicit;
  for (int k = 0; k < 128 && !extra.no_preamble; k++) fputc(0, file);
  if (!extra.no_preamble) fputs("DICM", file);
  if (!extra.no_group) put_text(file, 2, 0x10, "UI", d->syntax, false);
  put_text(file, 8, 5, "CS", "ISO_IR 100", implicit);
  if (d->nested) { /* a sequence of undefined length with an item of one, which has pixels of its
                      own */
    put_head(file, 0x08, 0x1140, "SQ", 0xffffffff, implicit);
    put(file, 0xe000fffe, 4), put(file, 0xffffffff, 4);
    put_head(file, 0x7fe0, 0x10, "OW", 4, implicit);
    put(file, 0x01020304, 4);
    put(file, 0xe00dfffe, 4), put(file, 0, 4);
    put(file, 0xe0ddfffe, 4), put(file, 0, 4);
    /* One of unknown kind, whose items are implicit (PS3.5, 6.2.2). */
    put_head(file, 0x09, 0x1001, "UN", 0xffffffff, implicit);
    put(file, 0xe000fffe, 4), put(file, 0xffffffff, 4);
    put_head(file, 0x09, 0x1002, "", 4, true);
    put(file, 0x61626364, 4);
    put(file, 0xe00dfffe, 4), put(file, 0, 4);
    put(file, 0xe0ddfffe, 4), put(file, 0, 4);
  }
  if (extra.told[0] != NULL) {
    const unsigned long tag = strtoul(extra.told[0], NULL, 16);
    put_text(file, (unsigned)(tag >> 16), (unsigned)(tag & 0xffff), extra.told[0] + 9,
             extra.told[1], implicit);
  }
  if (extra.part > 0) {
    put_head(file, 0x20, 0x9162, "US", 2, implicit);
    put(file, extra.part, 2);
  }
  if (extra.thickness != NULL) put_text(file, 0x18, 0x50, "DS", extra.thickness, implicit);
  if (extra.distance != NULL) put_text(file, 0x18, 0x88, "DS", extra.distance, implicit);
  if (extra.tilt != NULL) put_text(file, 0x18, 0x1120, "DS", extra.tilt, implicit);
  if (extra.series != NULL) put_text(file, 0x20, 0x0e, "UI", extra.series, implicit);
  if (extra.number != 0) {
    snprintf(text, sizeof text, "%d", extra.number);
    put_text(file, 0x20, 0x13, "IS", text, implicit);
  }
  if (extra.location != NULL) put_text(file, 0x20, 0x1041, "DS", extra.location, implicit);
  if (d->place != 0) {
    snprintf(text, sizeof text, "-10.5\\%g\\%g", 20.0 + (double)z * extra.aside, 0.1 * d->place);
    put_text(file, 0x20, 0x32, "DS", text, implicit);
    if (!extra.unturned)
      put_text(file, 0x20, 0x37, "DS", extra.axes != NULL ? extra.axes : "1\\0\\0\\0\\1\\0",
               implicit);
  }
  put_whole(file, 2, 1, implicit);
  put_text(file, 0x28, 4, "CS", d->photometric, implicit);
  if (d->frames > 1) {
    snprintf(text, sizeof text, "%u", d->frames);
    put_text(file, 0x28, 8, "IS", text, implicit);
  }
  put_whole(file, 0x10, NY, implicit);
  put_whole(file, 0x11, NX, implicit);
  if (extra.pointer > 0) {
    put_head(file, 0x28, 9, "AT", extra.several ? 8 : 4, implicit);
    put(file, 0x18, 2), put(file, extra.pointer, 2);
    if (extra.several) put(file, 0x54, 2), put(file, 0x80, 2);
  }
  if (extra.places == NULL && !extra.unspaced)
    put_text(file, 0x28, 0x30, "DS", "0.02\\0.01", implicit);
  if (extra.aspect != NULL) put_text(file, 0x28, 0x34, "IS", extra.aspect, implicit);
  put_whole(file, 0x100, 16, implicit);
  put_whole(file, 0x101, d->stored, implicit);
  put_whole(file, 0x102, d->stored - 1, implicit);
  put_whole(file, 0x103, d->is_signed, implicit);
  if (extra.padding != 0) put_whole(file, 0x120, (unsigned)extra.padding & 0xffff, implicit);
  if (extra.limit != 0) put_whole(file, 0x121, (unsigned)extra.limit & 0xffff, implicit);
  if (d->slope != NULL) put_text(file, 0x28, 0x1053, "DS", d->slope, implicit);
  if (extra.mapped != NULL && extra.places == NULL) put_mapping(file, extra.mapped[0], implicit);
  if (extra.places != NULL) put_frames(file, d);
  if (extra.table) put_item(file, true, implicit, 0x28, 0x3000);
  if (extra.table) put_item(file, false, implicit, 0, 0);
  put_head(file, 0x7fe0, extra.floats ? 0x08 : 0x10, extra.floats ? "OF" : "OW",
           2 * NX * NY * d->frames, implicit);
  for (size_t k = 0; k < NX * NY * d->frames; k++) {
    const size_t frame = k / NX / NY, at = z + (extra.rank != NULL ? extra.rank[frame] : frame);
    const int value = (int)grey(k % NX, k / NX % NY, at) - (d->is_signed ? 100 : 0);
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

/* Files without preamble, without the group that names their syntax, or that name the other one. */
static void test_dicom_without_its_beginning(void **state) {
  (void)state;
  const double flat[] = {10, NAN};
  for (int k = 0; k < 8; k++) {
    const bool implicit = k % 2;
    extra.no_preamble = k / 2 % 2;
    extra.no_group = k / 4;
    const struct dicom d = {implicit ? "1.2.840.10008.1.2" : EXPLICIT,
                            "MONOCHROME2",
                            NULL,
                            implicit,
                            false,
                            true,
                            16,
                            NZ,
                            0,
                            0};
    write_dicom(0, 0, &d);
    holds(1, NZ, 255, 1, 0, flat, NULL);
    snprintf(names[1], sizeof names[1], "%s/IM0001", folder); /* a name without an ending */
    assert_int_equal(rename(names[0], names[1]), 0);
    memcpy(names[0], names[1], sizeof names[0]);
    holds(1, NZ, 255, 1, 0, flat, NULL);
  }
  memset(&extra, 0, sizeof extra);
  for (int implicit = 0; implicit < 2; implicit++) {
    write_dicom(0, 0,
                &(struct dicom){implicit ? EXPLICIT : "1.2.840.10008.1.2", "MONOCHROME2", NULL,
                                implicit, false, true, 16, NZ, 0, 0});
    holds(1, NZ, 255, 1, 0, flat, NULL);
  }
  /* A list of slices (DICOMDIR) has no pixels. */
  FILE *file = begin(0, "DICOMDIR");
  for (int k = 0; k < 128; k++) fputc(0, file);
  fputs("DICM", file);
  put_text(file, 2, 0x10, "UI", EXPLICIT, false);
  put_text(file, 8, 5, "CS", "ISO_IR 100", false);
  fclose(file);
  refused(1, "a list of slices (DICOMDIR)");
}

/* Slices whose names are in another order than their numbers. */
static void test_dicom_numbers(void **state) {
  (void)state;
  const double flat[] = {10, NAN}, thick[] = {10, 70};
  const size_t order[NZ] = {3, 0, 4, 1, 2};
  struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, 1, 0, 0};
  for (int k = 0; k < 3; k++) { /* without a place, with one that no orientation explains, twice */
    extra.unturned = k > 0;
    extra.thickness = k > 1 ? "0.07" : NULL;
    for (size_t i = 0; i < NZ; i++) {
      d.place = k > 0 ? 5 * (int)order[i] - 7 : 0;
      extra.number = 2 * (int)order[i] + 1;
      write_dicom(i, order[i], &d);
    }
    holds(NZ, NZ, 255, 1, 0, k > 1 ? thick : flat, NULL);
  }
  extra.number = 5;
  write_dicom(0, 3, &d);
  refused(NZ, "are both slice 5");
  /* Without numbers: a position that no orientation explains, and a location alone. */
  const double deep[] = {10, 500};
  memset(&extra, 0, sizeof extra);
  for (int k = 0; k < 2; k++) {
    extra.unturned = k == 0;
    for (size_t i = 0; i < NZ; i++) {
      char location[20];
      snprintf(location, sizeof location, "%g", 0.5 * (double)order[i] - 0.7);
      d.place = k == 0 ? 5 * (int)order[i] - 7 : 0;
      extra.location = k == 0 ? NULL : location;
      write_dicom(i, order[i], &d);
    }
    holds(NZ, NZ, 255, 1, 0, deep, NULL);
  }
  memset(&extra, 0, sizeof extra);
}

/* Frames that tell their places are taken in their order, at even distances. */
static void test_dicom_frames(void **state) {
  (void)state;
  const double deep[] = {10, 500}, apart[] = {10, 60}, thick[] = {10, 70};
  static const int places[][NZ] = {{-7, -2, 3, 8, 13}, {13, 8, 3, -2, -7}, {-7, 3, -2, 8, 13},
                                   {0, 5, 0, 5, 0},    {1, 1, 1, 1, 1},    {-7, -2, 3, 8, 16}};
  static const size_t ranks[][NZ] = {{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}, {0, 2, 1, 3, 4}};
  struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, NZ, 0, 0};
  for (int k = 0; k < 12; k++) {
    extra.places = places[k / 2];
    d.implicit = k % 2;
    d.syntax = d.implicit ? "1.2.840.10008.1.2" : EXPLICIT;
    write_dicom(0, 0, &d);
    if (k >= 6) refused(1, "not slices one behind the other");
    if (k >= 6) continue;
    extra.rank = ranks[k / 2];
    write_dicom(0, 0, &d);
    holds(1, NZ, 255, 1, 0, deep,
          k < 2 ? NULL : "in the order of their positions or numbers, not as stored");
    extra.rank = NULL;
  }
  extra.places = places[0];
  extra.scaled = "2";
  write_dicom(0, 0, &d);
  refused(1, "turned or scaled each in its own way");
  extra.scaled = NULL;
  extra.mapped = (const double[]){2, -5, 2};
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, deep, "before the slope 2 and intercept -5 of its Real World Value");
  extra.mapped = (const double[]){2, -5, 3};
  write_dicom(0, 0, &d);
  refused(1, "turned or scaled each in its own way");
  memset(&extra, 0, sizeof extra);
  extra.thickness = "0.07";
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, thick, NULL);
  extra.distance = "0.06"; /* of slices that overlap */
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, apart, NULL);
  memset(&extra, 0, sizeof extra);
}

static void test_dicom_values(void **state) {
  (void)state;
  const double flat[] = {10, NAN};
  const struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, NZ, 0, 0};
  extra.table = true;
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, flat, "greys as stored, before its table");
  extra.table = false;
  extra.mapped = (const double[]){1, 0};
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, flat, NULL);
  struct dicom slice = d;
  slice.frames = 1;
  for (size_t i = 0; i < 2; i++) {
    extra.mapped = i == 0 ? (const double[]){2, 0} : (const double[]){3, 0};
    write_dicom(i, i, &slice);
  }
  refused(2, "the same number means other densities");
  extra.mapped = NULL;
  extra.floats = true;
  write_dicom(0, 0, &d);
  refused(1, "pixels that are floats");
  memset(&extra, 0, sizeof extra);
}

/* Frames that tell their numbers in the stack alone. */
static void test_dicom_numbered_frames(void **state) {
  (void)state;
  const double flat[] = {10, NAN};
  static const unsigned char numbers[][NZ] = {
      {1, 2, 3, 4, 5}, {5, 4, 3, 2, 1}, {1, 3, 2, 4, 5}, {1, 2, 3, 1, 2}, {1, 1, 1, 1, 1}};
  static const size_t ranks[][NZ] = {{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}, {0, 2, 1, 3, 4}};
  static const int none[NZ] = {0};
  const struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, NZ, 0, 0};
  for (int k = 0; k < 10; k++) {
    extra.places = none;
    extra.numbers = numbers[k / 2];
    extra.numbered = k % 2 ? 0x9157 : 0x9057;
    extra.rank = k < 6 ? ranks[k / 2] : NULL;
    write_dicom(0, 0, &d);
    if (k < 6 || k == 9) /* indices that are all the same are of another axis */
      holds(1, NZ, 255, 1, 0, flat, k < 2 || k == 9 ? NULL : "in the order of their positions or");
    else
      refused(1, "not slices one behind the other");
  }
  memset(&extra, 0, sizeof extra);
}

/* What a file says of its pixels, and of what its frames are. */
static void test_dicom_told(void **state) {
  (void)state;
  const double flat[] = {10, NAN};
  const struct {
    const char *tag, *value, *told;
    double factor, offset;
    bool refused;
  } cases[] = {{"20500020 CS", "INVERSE", NULL, -1, 65535, false},
               {"20500020 CS", "IDENTITY", NULL, 1, 0, false},
               {"00282110 CS", "01", "compressed with loss", 1, 0, false},
               {"00282110 CS", "00", NULL, 1, 0, false},
               {"00280301 CS", "YES", "text is written into its pixels", 1, 0, false},
               {"00280301 CS", "NO", NULL, 1, 0, false},
               {"00080008 CS", "DERIVED\\SECONDARY\\MIP", "projections, as it says", 1, 0, false},
               {"00281040 CS", "LOG", "its greys are logarithms", 1, 0, false},
               {"00181063 DS", "33.3", "follow one another in time", 1, 0, false},
               {"00181520 DS", "1\\2\\3", "its frames are projections", 1, 0, true}};
  struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, NZ, 0, 0};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    extra.told[0] = cases[i].tag;
    extra.told[1] = cases[i].value;
    write_dicom(0, 0, &d);
    if (cases[i].refused)
      refused(1, cases[i].told);
    else
      holds(1, NZ, 255, cases[i].factor, cases[i].offset, flat, cases[i].told);
  }
  extra.told[0] = NULL;
  extra.part = 2;
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, flat, "part 2 of a scan that was cut into several files");
  memset(&extra, 0, sizeof extra);
  /* Slices of one series that are of two echoes or times, or with a localizer, are not one scan. */
  static const char *const OF[][3] = {
      {"00180086 IS", "1", "2"},
      {"00200100 IS", "1", "2"},
      {"00180060 DS", "80", "140"},
      {"00181210 SH", "B30s", "B80s"},
      {"00080008 CS", "ORIGINAL\\PRIMARY\\AXIAL", "ORIGINAL\\PRIMARY\\LOCALIZER"}};
  d.frames = 1;
  for (size_t i = 0; i < sizeof OF / sizeof *OF; i++) {
    struct stack stack;
    static float pixels[N];
    extra.series = "1.2.3";
    for (size_t z = 0; z < 2; z++) {
      extra.told[0] = OF[i][0];
      extra.told[1] = OF[i][1 + z];
      extra.number = (int)z + 1;
      write_dicom(z, z, &d);
    }
    assert_int_equal(read_all(2, &stack, pixels), STATUS_OK);
    assert_string_not_equal(stack.files[0].series, stack.files[1].series);
    stack_close(&stack);
  }
  memset(&extra, 0, sizeof extra);
}

/* Values that fill up slices beyond what was measured. */
static void test_dicom_padding(void **state) {
  (void)state;
  const double flat[] = {10, NAN};
  const struct {
    bool is_signed;
    unsigned stored;
    int padding, limit;
    double from, to;
  } cases[] = {{false, 16, 77, 0, 77, 77},
               {false, 16, 77, 90, 77, 90},
               {true, 16, -77, 0, -77, -77},
               {true, 16, 20, -77, -77, 20},
               {true, 12, -77, 0, -77, -77},
               {false, 12, 0xf000 | 77, 0, 77, 77}}; /* bits that are not stored */
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const struct dicom d = {EXPLICIT, "MONOCHROME2",   NULL, false, cases[i].is_signed,
                            false,    cases[i].stored, NZ,   0,     0};
    extra.padding = cases[i].padding;
    extra.limit = cases[i].limit;
    no_data[0] = cases[i].from;
    no_data[1] = cases[i].to;
    write_dicom(0, 0, &d);
    holds(1, NZ, 255, 1, d.is_signed ? -100 : 0, flat, NULL);
  }
  no_data[0] = no_data[1] = NAN;
  memset(&extra, 0, sizeof extra);
}

/* Where slices lie: upright, of one direction, of square pixels; else a body comes out sheared. */
static void test_dicom_geometry(void **state) {
  (void)state;
  const double deep[] = {10, 500}, untold[] = {NAN, NAN}, flat[] = {10, NAN};
  const double asides[] = {0.001,
                           0.13}; /* within a fraction of a pixel, and more: a tilt of 15 degrees */
  struct dicom d = {EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, 1, 0, 0};
  for (int k = 0; k < 2; k++) {
    extra.aside = asides[k];
    extra.tilt = "15"; /* what counts is where the slices lie */
    for (size_t z = 0; z < NZ; z++) {
      d.place = 5 * (int)z - 7;
      write_dicom(z, z, &d);
    }
    if (k == 0)
      holds(NZ, NZ, 255, 1, 0, deep, NULL);
    else
      refused(NZ, "does not lie behind that of IM0.dcm, but 0.13 mm aside (a tilted gantry?)");
  }
  extra.aside = 0.0;
  for (size_t z = 0; z < NZ; z++) {
    d.place = 5 * (int)z - 7;
    extra.axes = z == 3 ? "1\\0\\0\\0\\0\\-1" : NULL;
    write_dicom(z, z, &d);
  }
  refused(NZ, "IM3.dcm: a slice in another direction than");
  memset(&extra, 0, sizeof extra);
  static const int places[] = {-7, -2, 3, 8, 13};
  d = (struct dicom){EXPLICIT, "MONOCHROME2", NULL, false, false, false, 16, NZ, 0, 0};
  extra.places = places;
  extra.aside = 0.13;
  write_dicom(0, 0, &d);
  refused(1, "its frames are shifted sideways, one by 0.13 mm");
  memset(&extra, 0, sizeof extra);
  extra.tilt = "-15";
  write_dicom(0, 0, &d);
  refused(1, "its gantry is tilted by -15 degrees");
  extra.tilt = "0";
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, flat, NULL);
  extra.pointer = 0x1063;
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, flat, "its frames follow one another in time");
  extra.several = true;
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, flat, "its frames follow one another along several axes");
  memset(&extra, 0, sizeof extra);
  extra.unspaced = true;
  const double behind[] = {NAN, 500};
  struct dicom slice = d;
  slice.frames = 1;
  for (size_t z = 0; z < NZ; z++) { /* positions alone */
    slice.place = 5 * (int)z - 7;
    write_dicom(z, z, &slice);
  }
  holds(NZ, NZ, 255, 1, 0, behind, NULL);
  extra.aspect = "2\\1";
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, untold,
        "its pixels are not square (aspect 2:1): give --voxel-size as X,Y,Z");
  extra.aspect = "1\\1";
  write_dicom(0, 0, &d);
  holds(1, NZ, 255, 1, 0, untold, NULL);
  memset(&extra, 0, sizeof extra);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bmp),
      cmocka_unit_test(test_vti),
      cmocka_unit_test(test_vti_forms),
      cmocka_unit_test(test_dicom),
      cmocka_unit_test(test_dicom_without_its_beginning),
      cmocka_unit_test(test_dicom_numbers),
      cmocka_unit_test(test_dicom_frames),
      cmocka_unit_test(test_dicom_values),
      cmocka_unit_test(test_dicom_numbered_frames),
      cmocka_unit_test(test_dicom_told),
      cmocka_unit_test(test_dicom_padding),
      cmocka_unit_test(test_dicom_geometry),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
