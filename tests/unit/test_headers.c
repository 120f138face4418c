/* Pixels behind or beside a header of text, NRRD and MetaImage, and headerless ones: in every
 * spelling the voxels are those that were written, or the file is refused. */
#include "tests/unit/folder_rig.h"

#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

#include "common/error.h"
#include "ct2model/readers/stack.h"

enum { NX = 14, NY = 18, NZ = 22, N = NX * NY * NZ };

static unsigned char grey(size_t i) {
  return (unsigned char)((i * 2654435761u) >> 13);
}

/* How the greys lie in a file. */
struct body {
  const char *before, *after; /* bytes around the pixels */
  int size;                   /* bytes a grey; -8: of 8, big-endian */
  bool packed;                /* by gzip, `before` and `after` too; in two members */
};

static size_t put_greys(unsigned char *to, const struct body *body, size_t first, size_t n) {
  const size_t size = (size_t)abs(body->size);
  memset(to, 0, n * size);
  for (size_t i = 0; i < n; i++) to[i * size + (body->size < 0 ? size - 1 : 0)] = grey(first + i);
  return n * size;
}

static size_t pack(unsigned char *to, size_t room, unsigned char *from, size_t n) {
  z_stream stream = {
      .next_in = from, .avail_in = (unsigned)n, .next_out = to, .avail_out = (unsigned)room};
  assert_int_equal(deflateInit2(&stream, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
  deflateEnd(&stream);
  return stream.total_out;
}

/* Writes `head`, then n greys from `first` on. */
static void write_part(const char *name, const char *head, const struct body *body, size_t first,
                       size_t n) {
  static unsigned char plain[8 * N + 2000], packed[8 * N + 4000];
  FILE *file = fopen(in_folder(name), "wb");
  assert_non_null(file);
  fputs(head, file);
  size_t size = 0;
  if (body != NULL) {
    const char *before = body->before != NULL ? body->before : "";
    const char *after = body->after != NULL ? body->after : "";
    memcpy(plain, before, strlen(before));
    size = strlen(before);
    size += put_greys(plain + size, body, first, n);
    memcpy(plain + size, after, strlen(after));
    size += strlen(after);
    if (body->packed) {
      const size_t half = pack(packed, sizeof packed, plain, size / 2);
      const size_t rest =
          pack(packed + half, sizeof packed - half, plain + size / 2, size - size / 2);
      fwrite(packed, 1, half + rest, file);
    } else {
      fwrite(plain, 1, size, file);
    }
  }
  fclose(file);
}

/* The greys of a file, or the message of a refusal. */
static enum status compare(const char *name, const struct raw_layout *raw, size_t wrong[1],
                           char note[320]) {
  struct stack stack;
  float slice[NX * NY];
  const char *path = in_folder(name);
  enum status status = stack_open(&path, 1, raw, &stack);
  if (status != STATUS_OK) return status;
  snprintf(note, 320, "%s", stack.files[0].note);
  *wrong = stack.size[0] != NX || stack.size[1] != NY || stack.size[2] != NZ ? N : 0;
  for (size_t z = 0; z < NZ && *wrong < N && status == STATUS_OK; z++) {
    status = stack_read(&stack, z, slice);
    for (size_t i = 0; i < NX * NY; i++) *wrong += slice[i] != (float)grey(z * NX * NY + i);
  }
  stack_close(&stack);
  return status;
}

static void expect(const char *name, const struct raw_layout *raw, const char *refusal,
                   const char *told, const char *which) {
  size_t wrong = 0;
  char note[320] = "";
  const enum status status = compare(name, raw, &wrong, note);
  if (refusal == NULL && status != STATUS_OK) fail_msg("%s: %s", which, error_message());
  if (refusal == NULL && wrong > 0)
    fail_msg("%s: %zu of %d voxels are wrong", which, wrong, (int)N);
  if (refusal != NULL && (status != STATUS_INPUT || strstr(error_message(), refusal) == NULL))
    fail_msg("%s: not refused with '%s': %s, %zu voxels wrong", which, refusal, error_message(),
             wrong);
  if (refusal == NULL && (told == NULL) != (note[0] == '\0'))
    fail_msg("%s: told '%s'", which, note);
  if (told != NULL && strstr(note, told) == NULL) fail_msg("%s: told '%s'", which, note);
  error_clear();
}

#define SEVENTY_SEVEN                                                                              \
  "12345678901234567890123456789012345678901234567890123456789012345678901234567"
#define MAGIC "NRRD0005\n"
#define SHAPE "dimension: 3\nsizes: 14 18 22\n"
#define U8 MAGIC "type: uint8\n" SHAPE
#define RAW U8 "encoding: raw\n"

static void test_nrrd(void **state) {
  (void)state;
  const struct {
    const char *head;
    struct body body;
    bool beside;                /* the pixels lie in the file "beside" */
    const char *refused, *told; /* NULL: read, without a word */
  } cases[] = {
      {RAW "\n", {NULL, NULL, 1, false}, false, NULL, NULL},
      {RAW "labels: \"x\" \"y\" \"z\"\n\n", {NULL, NULL, 1, false}, false, NULL, NULL},
      {RAW "labels: \"z\" \"Y\" \"x\"\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       "its axes are zyx by its labels: read as stored"},
      {RAW "byte skip: 77\n\n", {SEVENTY_SEVEN, NULL, 1, false}, false, NULL, NULL},
      {RAW "byteskip: 77\n\n", {SEVENTY_SEVEN, NULL, 1, false}, false, NULL, NULL},
      {RAW "Byte Skip:   77 \n\n", {SEVENTY_SEVEN, NULL, 1, false}, false, NULL, NULL},
      {RAW "byteskip: 77\ndata file: beside\n", {SEVENTY_SEVEN, NULL, 1, false}, true, NULL, NULL},
      {RAW "byteskip: -1\ndatafile: beside\n", {SEVENTY_SEVEN, NULL, 1, false}, true, NULL, NULL},
      {RAW "line skip: 2\n\n", {"one\ntwo\n", NULL, 1, false}, false, NULL, NULL},
      {RAW "lineskip: 2\n\n", {"one\ntwo\n", NULL, 1, false}, false, NULL, NULL},
      {RAW "lineskip: 2\nbyteskip: 3\n\n", {"one\ntwo\n123", NULL, 1, false}, false, NULL, NULL},
      {RAW "lineskip: 1\ndata file: beside\n", {"one\n", NULL, 1, false}, true, NULL, NULL},
      {RAW "lineskip: 9999\n\n", {NULL, NULL, 1, false}, false, "not so many lines", NULL},
      {RAW "line skip: -1\n\n", {NULL, NULL, 1, false}, false, "line skip -1", NULL},
      {RAW "byte skip: -2\n\n", {NULL, NULL, 1, false}, false, "byte skip -2", NULL},
      {RAW "byte skip: seven\n\n", {NULL, NULL, 1, false}, false, "byte skip seven", NULL},
      {RAW "bite skip: 77\n\n",
       {SEVENTY_SEVEN, NULL, 1, false},
       false,
       "'bite skip' is no field",
       NULL},
      {RAW "byteskip: 3\nbyte skip: 4\n\n",
       {"1234", NULL, 1, false},
       false,
       "a second byte skip",
       NULL},
      {RAW "my byteskip:=77\n# byteskip: 77\nContent: x\nspace origin: (0,0,0)\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       NULL},
      {RAW "space directions: (0,0,1) (0,1,0) (1,0,0)\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       "its axes are turned (space directions): read as stored"},
      {RAW "space directions: (2,0,0) (0,-2,0) (0,0,2)\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       "its axes are turned"},
      {RAW "space directions: (2,1e-12,0) (0, 2, 0) (0,0,2)\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       NULL},
      {RAW "old min: -1000\noldmax: 3000.5\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       "before its old min -1000; greys as stored, before its old max 3000.5"},
      {RAW "old min: nan\n\n", {NULL, NULL, 1, false}, false, NULL, NULL},
      {RAW "\n", {NULL, "\n", 1, false}, false, NULL, "1 bytes after its pixels"},
      {RAW "data file: beside\n",
       {SEVENTY_SEVEN, NULL, 1, false},
       true,
       "77 bytes more than the 14x18x22 pixels",
       NULL},
      {RAW "data file: beside\nbyte skip: 5\n",
       {"12345", "end", 1, false},
       true,
       NULL,
       "3 bytes after its pixels"},
      {U8 "encoding: gzip\n\n", {NULL, NULL, 1, true}, false, NULL, NULL},
      {U8 "encoding: GZ\nbyteskip: 77\n\n", {SEVENTY_SEVEN, NULL, 1, true}, false, NULL, NULL},
      {U8 "encoding: gzip\n\n", {NULL, "more", 1, true}, false, "more than the 5544 bytes", NULL},
      {U8 "encoding: hex\n\n", {NULL, NULL, 1, false}, false, "encoding hex", NULL},
      {U8 "\n", {NULL, NULL, 1, false}, false, "encoding is missing", NULL},
      {MAGIC "type: Unsigned Short Int\n" SHAPE "encoding: raw\nendian: little\n\n",
       {NULL, NULL, 2, false},
       false,
       NULL,
       NULL},
      {MAGIC "type: unsigned short\n" SHAPE "encoding: raw\n\n",
       {NULL, NULL, 2, false},
       false,
       "endian is missing",
       NULL},
      {MAGIC "type: unsigned long long int\n" SHAPE "encoding: raw\nendian: big\n\n",
       {NULL, NULL, -8, false},
       false,
       NULL,
       NULL},
      {MAGIC "type: int64\n" SHAPE "encoding: raw\nendian: little\n\n",
       {NULL, NULL, 8, false},
       false,
       NULL,
       NULL},
      {MAGIC "type: block\nblock size: 1\n" SHAPE "encoding: raw\n\n",
       {NULL, NULL, 1, false},
       false,
       "type block",
       NULL},
      {MAGIC "type: uint8\ndimension: 5\nsizes: 1 14 18 22 1\nkinds: scalar domain domain domain "
             "time\nencoding: raw\n\n",
       {NULL, NULL, 1, false},
       false,
       NULL,
       NULL},
      {MAGIC "type: uint8\ndimension: 4\nsizes: 2 7 18 22\nencoding: raw\n\n",
       {NULL, NULL, 1, false},
       false,
       "save one volume",
       NULL},
      {MAGIC "type: uint8\ndimension: 3\nsizes: 14 18\nencoding: raw\n\n",
       {NULL, NULL, 1, false},
       false,
       "are not 3 whole numbers",
       NULL},
      {RAW "spacings: 1 1 2\n\n", {NULL, NULL, 1, false}, false, NULL, "voxels of 1 x 1 x 2 by"},
      {RAW "kinds: domain domain list\n\n", {NULL, NULL, 1, false}, false, NULL, NULL},
      {RAW "kinds: list domain domain\n\n",
       {NULL, NULL, 1, false},
       false,
       "axis 0 holds 14 values of kind list",
       NULL},
      {RAW "kinds: RGB-color domain domain\n\n",
       {NULL, NULL, 1, false},
       false,
       "of kind RGB-color",
       NULL},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    if (cases[i].beside) write_part("beside", "", &cases[i].body, 0, N);
    write_part("case.nrrd", cases[i].head, cases[i].beside ? NULL : &cases[i].body, 0, N);
    expect("case.nrrd", NULL, cases[i].refused, cases[i].told, cases[i].head);
  }
}

#define META "ObjectType = Image\nNDims = 3\nDimSize = 14 18 22\n"
#define BYTES META "ElementType = MET_UCHAR\n"

static void test_meta(void **state) {
  (void)state;
  const struct {
    const char *head;
    struct body body;
    const char *refused, *told;
  } cases[] = {
      {BYTES "ElementDataFile = beside\n", {NULL, NULL, 1, false}, NULL, NULL},
      {BYTES "ElementDataFile = beside\n",
       {SEVENTY_SEVEN, NULL, 1, false},
       "77 bytes more than",
       NULL},
      {BYTES "TransformMatrix = 0 0 1 0 1 0 1 0 0\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       NULL,
       "its axes are turned (TransformMatrix): read as stored"},
      {BYTES "elementbyteordermsb = False\nELEMENTBYTEORDERMSB = T\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "but another line has the other order",
       NULL},
      {BYTES "ElementByteOrderMSB = Yes\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "ElementByteOrderMSB = Yes is neither True nor False",
       NULL},
      {BYTES "DimSize = 22 18 14\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "a second DimSize",
       NULL},
      {BYTES "Orientation = 1 0 0 0 -1 0 0 0 1\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       NULL,
       "its axes are turned (Orientation)"},
      {BYTES "TransformMatrix = 1 0 0 0 1 1e-12 0 0 1\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       NULL,
       NULL},
      {BYTES "HeaderSize = 77\nElementDataFile = beside\n",
       {SEVENTY_SEVEN, NULL, 1, false},
       NULL,
       NULL},
      {BYTES "HeaderSize = -1\nElementDataFile = beside \n",
       {SEVENTY_SEVEN, NULL, 1, false},
       NULL,
       NULL},
      {BYTES "HeaderSize: 77\nElementDataFile: beside\n",
       {SEVENTY_SEVEN, NULL, 1, false},
       NULL,
       NULL},
      {BYTES "CompressedData = True\nElementDataFile = beside\n",
       {NULL, NULL, 1, true},
       NULL,
       NULL},
      {BYTES "BinaryData = False\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "pixels as text",
       NULL},
      {BYTES "HeaderSizePerSlice = 9\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "before every slice",
       NULL},
      /* MetaIO reads the first letter; two lines of order may differ. */
      {META "ElementType = MET_USHORT\nBinaryDataByteOrderMSB = T\nElementDataFile = beside\n",
       {NULL, NULL, -2, false},
       NULL,
       NULL},
      {META "ElementType = MET_USHORT\nBinaryDataByteOrderMSB = false\nElementByteOrderMSB = "
            "F\nElementDataFile = beside\n",
       {NULL, NULL, 2, false},
       NULL,
       NULL},
      {META "ElementType = MET_USHORT\nBinaryDataByteOrderMSB = True\nElementByteOrderMSB = "
            "False\nElementDataFile = beside\n",
       {NULL, NULL, -2, false},
       "another line has the other order",
       NULL},
      {BYTES "CompressedData = t\nElementDataFile = beside\n", {NULL, NULL, 1, true}, NULL, NULL},
      {BYTES "ElementToIntensityFunctionSlope = 1\nElementToIntensityFunctionOffset = 0\n"
             "ElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       NULL,
       NULL},
      {BYTES "ElementToIntensityFunctionSlope = -2\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       NULL,
       "greys as stored, before its slope -2"},
      {META "ElementType = MET_ULONG_LONG\nElementByteOrderMSB = 1\nElementDataFile = beside\n",
       {NULL, NULL, -8, false},
       NULL,
       NULL},
      {"NDims = 4\nDimSize = 14 18 22 1\nElementType = MET_UCHAR\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       NULL,
       NULL},
      {"NDims = 4\nDimSize = 14 18 11 2\nElementType = MET_UCHAR\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "save one volume",
       NULL},
      {"NDims = 3\nDimSize = 14 18\nElementType = MET_UCHAR\nElementDataFile = beside\n",
       {NULL, NULL, 1, false},
       "is not 3 numbers",
       NULL},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    write_part("beside", "", &cases[i].body, 0, N);
    write_part("case.mhd", cases[i].head, NULL, 0, 0);
    expect("case.mhd", NULL, cases[i].refused, cases[i].told, cases[i].head);
  }
}

/* A volume in several files, by a list and by a pattern of names. */
static void test_several_files(void **state) {
  (void)state;
  const struct body plain = {"head", NULL, 1, false};
  char list[2000] = BYTES "HeaderSize = 4\nElementDataFile = LIST 2\n",
       nrrd[2000] = RAW "byte skip: 4\ndata file: LIST\n";
  for (int z = 0; z < NZ; z++) {
    char name[40];
    snprintf(name, sizeof name, "slice%03d.bin", 2 * z + 3);
    write_part(name, "", &plain, (size_t)z * NX * NY, NX * NY);
    sprintf(list + strlen(list), "%s\n", name);
    sprintf(nrrd + strlen(nrrd), "%s\n", name);
  }
  write_part("list.mhd", list, NULL, 0, 0);
  expect("list.mhd", NULL, NULL, NULL, list);
  write_part("list.nhdr", nrrd, NULL, 0, 0);
  expect("list.nhdr", NULL, NULL, NULL, nrrd);
  const char *pattern = BYTES "HeaderSize = 4\nElementDataFile = slice%03d.bin 3 45 2\n";
  write_part("pattern.mhd", pattern, NULL, 0, 0);
  expect("pattern.mhd", NULL, NULL, NULL, pattern);
  pattern = RAW "byte skip: 4\ndata file: slice%03d.bin 3 45 2 2\n";
  write_part("pattern.nhdr", pattern, NULL, 0, 0);
  expect("pattern.nhdr", NULL, NULL, NULL, pattern);
  /* Two slabs of eleven slices. */
  write_part("slab1", "", &(struct body){NULL, NULL, 1, false}, 0, N / 2);
  write_part("slab2", "", &(struct body){NULL, NULL, 1, false}, N / 2, N / 2);
  pattern = RAW "data file: slab%d 1 2 1 3\n";
  write_part("slabs.nhdr", pattern, NULL, 0, 0);
  expect("slabs.nhdr", NULL, NULL, NULL, pattern);
  const char *const wrong[][2] = {
      {"ElementDataFile = slice%03d.bin 3 43 2\n", "names 21 files for 22 slices"},
      {"ElementDataFile = slice%03d.bin 3 47 2\n", "names 23 files for 22 slices"},
      {"ElementDataFile = slice%03d.bin 5 47 2\n", "slice047.bin: No such file"},
      {"ElementDataFile = slice%s.bin 3 45 2\n", "no pattern of file names"},
      {"ElementDataFile = slice%03d%n.bin 3 45 2\n", "no pattern of file names"},
      {"ElementDataFile = slice%03d.bin 3 45 0\n", "no pattern of file names"},
      {"ElementDataFile = slice%03d.bin\n", "no pattern of file names"},
      {"ElementDataFile = ../slice%03d.bin 3 45 2\n", "outside the header's folder"},
      {"ElementDataFile = LIST\n", "names none"},
      {"ElementDataFile = LIST\n/etc/passwd\n", "outside the header's folder"}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    char head[300];
    snprintf(head, sizeof head, BYTES "HeaderSize = 4\n%s", wrong[i][0]);
    write_part("wrong.mhd", head, NULL, 0, 0);
    expect("wrong.mhd", NULL, wrong[i][1], NULL, head);
  }
  snprintf(nrrd, sizeof nrrd, "%s", BYTES "ElementDataFile = slice%03d.bin 3 45 2\n");
  write_part("wrong.mhd", nrrd, NULL, 0, 0);
  expect("wrong.mhd", NULL, "4 bytes more than the 14x18x1 pixels", NULL, nrrd);
}

static void test_raw_with_a_header(void **state) {
  (void)state;
  struct raw_layout raw;
  write_part("scan.raw", SEVENTY_SEVEN, &(struct body){NULL, NULL, 1, false}, 0, N);
  assert_int_equal(raw_layout_parse("14x18x22:u8:77", &raw), STATUS_OK);
  expect("scan.raw", &raw, NULL, NULL, "--raw with 77 bytes before");
  assert_int_equal(raw_layout_parse("14x18x22:u8", &raw), STATUS_OK);
  expect("scan.raw", &raw, "not whole slices", NULL, "--raw without");
  assert_int_equal(raw_layout_parse("14x18x22:u8:76", &raw), STATUS_OK);
  expect("scan.raw", &raw, "not whole slices", NULL, "--raw with 76");
  assert_int_equal(raw_layout_parse("14x18x22:u8:5700", &raw), STATUS_OK);
  expect("scan.raw", &raw, "not whole slices", NULL, "--raw beyond the end");
  const char *const wrong[] = {"14x18x22:u8:",
                               "14x18x22:u8:x",
                               "14x18x22:u8:-1",
                               "14x18x22:u8:1:1",
                               "14x18x22:u8:9999999999999999999",
                               "14x18x22::5"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    assert_int_equal(raw_layout_parse(wrong[i], &raw), STATUS_USAGE);
    error_clear();
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_nrrd),
      cmocka_unit_test(test_meta),
      cmocka_unit_test(test_several_files),
      cmocka_unit_test(test_raw_with_a_header),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
