/* HDF5 files of other programs as images: which of their arrays is the scan, and which of its axes.
 */
#include "tests/unit/folder_rig.h"

#include <hdf5.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <zlib.h>

#include "common/error.h"
#include "ct2model/readers/stack.h"

enum { NX = 14, NY = 18, NZ = 22, N = NX * NY * NZ };
static char file[100];

static int make_file(void **state) {
  if (make_folder(state) != 0) return 1;
  snprintf(file, sizeof file, "%s/scan.h5", folder);
  return 0;
}

static unsigned char grey(size_t i) {
  return (unsigned char)((i * 2654435761u) >> 13);
}

/* Adds the greys as a dataset of that shape; with `rows` only so many of them are written, in
 * chunks of one. */
static void add(hid_t to, const char *name, int rank, const hsize_t *shape, hsize_t rows) {
  static unsigned char greys[N];
  for (size_t i = 0; i < N; i++) greys[i] = grey(i);
  hid_t groups = H5Pcreate(H5P_LINK_CREATE), layout = H5Pcreate(H5P_DATASET_CREATE);
  hid_t space = H5Screate_simple(rank, shape, NULL);
  H5Pset_create_intermediate_group(groups, 1);
  hsize_t chunk[8], start[8] = {0};
  for (int i = 0; i < rank; i++) chunk[i] = i == 0 ? 1 : shape[i];
  if (rows > 0) H5Pset_chunk(layout, rank, chunk);
  hid_t set = H5Dcreate2(to, name, H5T_NATIVE_UINT8, space, groups, layout, H5P_DEFAULT);
  hid_t part = H5S_ALL, memory = H5S_ALL;
  if (rows > 0) {
    chunk[0] = rows;
    part = H5Dget_space(set);
    memory = H5Screate_simple(rank, chunk, NULL);
    H5Sselect_hyperslab(part, H5S_SELECT_SET, start, NULL, chunk, NULL);
  }
  assert_true(H5Dwrite(set, H5T_NATIVE_UINT8, memory, part, H5P_DEFAULT, greys) >= 0);
  H5Dclose(set);
  H5Sclose(space);
  H5Pclose(layout);
  H5Pclose(groups);
}

static hid_t begin(void) {
  return H5Fcreate(file, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
}

static void holds(const char *inside, size_t written, const char *note) {
  char path[160];
  const char *paths = path;
  struct stack stack;
  float slice[NX * NY];
  snprintf(path, sizeof path, "%s%s", file, inside);
  if (stack_open(&paths, 1, NULL, &stack) != STATUS_OK) fail_msg("%s", error_message());
  if (stack.size[0] != NX || stack.size[1] != NY || stack.size[2] != NZ)
    fail_msg("%zux%zux%zu", stack.size[0], stack.size[1], stack.size[2]);
  for (size_t z = NZ; z-- > 0;) {
    if (stack_read(&stack, z, slice) != STATUS_OK) fail_msg("%s", error_message());
    for (size_t i = 0; i < NX * NY; i++)
      assert_true(slice[i] == (float)(z < written ? grey(z * NX * NY + i) : 0));
  }
  if (note == NULL ? stack.files[0].note[0] != '\0' : strstr(stack.files[0].note, note) == NULL)
    fail_msg("told '%s'", stack.files[0].note);
  stack_close(&stack);
}

static void refused(const char *inside, const char *word) {
  char path[160];
  const char *paths = path;
  struct stack stack;
  snprintf(path, sizeof path, "%s%s", file, inside);
  const enum status status = stack_open(&paths, 1, NULL, &stack);
  if (status != STATUS_INPUT || strstr(error_message(), word) == NULL)
    fail_msg("not refused with '%s': %s", word, error_message());
  error_clear();
}

static const hsize_t VOLUME[] = {NZ, NY, NX};

static void add_numbers(hid_t to, const char *name, const double *values, hsize_t n) {
  hid_t space = H5Screate_simple(1, &n, NULL);
  hid_t set = H5Dcreate2(to, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Dclose(set);
  H5Sclose(space);
}

static void add_attribute(hid_t file_id, const char *of, const char *name, hid_t type,
                          const void *value, hsize_t n) {
  hid_t object = H5Oopen(file_id, of, H5P_DEFAULT);
  hid_t space = n > 1 ? H5Screate_simple(1, &n, NULL) : H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(attribute, type, value) >= 0);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Oclose(object);
}

/* The places of the voxels: at even distances, or no image; and their edges. */
static void test_places(void **state) {
  (void)state;
  hid_t names = H5Tcopy(H5T_C_S1), unit = H5Tcopy(H5T_C_S1);
  H5Tset_size(names, 6);
  H5Tset_size(unit, 2);
  for (int k = 0; k < 4; k++) { /* even, falling, uneven, of other axes */
    double z[NZ];
    for (int i = 0; i < NZ; i++) z[i] = k == 0 ? 0.005 * i : k == 1 ? -i : i * i;
    hid_t h5 = begin();
    add(h5, "v", 3, VOLUME, 0);
    add_numbers(h5, "z", z, k == 3 ? NZ - 1 : NZ);
    add_attribute(h5, "v", "axes", names, "z:y:x", 1);
    if (k == 0) add_attribute(h5, "z", "units", unit, "mm", 1);
    H5Fclose(h5);
    if (k == 2)
      refused(":/v", "its voxels along z are at uneven distances, as /z tells (1 after 0)");
    else
      holds(":/v", NZ, k == 1 ? "/z falls: read as stored, mirrored along z" : NULL);
    if (k > 0) continue;
    char path[160];
    const char *paths = path;
    struct stack stack;
    snprintf(path, sizeof path, "%s:/v", file);
    assert_int_equal(stack_open(&paths, 1, NULL, &stack), STATUS_OK);
    assert_true(fabs(stack.voxel[2] - 5e-6) < 1e-12);
    stack_close(&stack);
  }
  const double edges[3] = {7, 6, 5}, index[2] = {0, 0};
  hid_t h5 = begin();
  add(h5, "v", 3, VOLUME, 0);
  add_attribute(h5, "v", "element_size_um", H5T_NATIVE_DOUBLE, edges, 3);
  add_attribute(h5, "v", "PALETTE", H5T_NATIVE_DOUBLE, index, 2);
  add_numbers(h5, "Spacing", edges, 3);
  H5Fclose(h5);
  holds(":/v", NZ, "not as its attribute PALETTE says; /Spacing has no unit");
  H5Tclose(names);
  H5Tclose(unit);
}

/* MINC scales slices by values beside them. */
static void test_scaled_slices(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    double most[NZ], least[NZ] = {0.0};
    for (int z = 0; z < NZ; z++) most[z] = k == 0 ? 1000.0 : 1000.0 + z;
    hid_t h5 = begin();
    add(h5, "minc-2.0/image/0/image", 3, VOLUME, 0);
    add_numbers(h5, "minc-2.0/image/0/image-min", least, NZ);
    add_numbers(h5, "minc-2.0/image/0/image-max", most, NZ);
    H5Fclose(h5);
    if (k == 0)
      holds(":/minc-2.0/image/0/image", NZ, "before image-min and image-max beside it");
    else
      refused(":/minc-2.0/image/0/image", "its slices are scaled each in its own way");
  }
}

static void test_only_array(void **state) {
  (void)state;
  const hsize_t angles[] = {N};
  hid_t h5 = begin();
  add(h5, "exchange/raw/data", 3, VOLUME, 0);
  add(h5, "exchange/theta", 1, angles, 0);
  H5Lcreate_soft("/exchange/raw/data", h5, "/entry", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_hard(h5, "/exchange/raw/data", h5, "/again", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(h5);
  holds("", NZ, "its one array, /again, is taken");
  holds(":/exchange/raw/data", NZ, NULL);
  holds(":/entry", NZ, NULL);
  h5 = H5Fopen(file, H5F_ACC_RDWR, H5P_DEFAULT);
  add(h5, "exchange/data_dark", 3, VOLUME, 0);
  H5Fclose(h5);
  refused("", "it has /again /exchange/data_dark)");
  h5 = begin();
  add(h5, "exchange/theta", 1, angles, 0);
  H5Fclose(h5);
  refused("", "name the dataset");
}

static void test_axes_of_one(void **state) {
  (void)state;
  const hsize_t shapes[][6] = {
      {1, NZ, NY, NX}, {NZ, NY, NX, 1}, {1, 1, NZ, NY, NX}, {1, NZ, 1, NY, NX}};
  const int ranks[] = {4, 4, 5, 5};
  for (size_t i = 0; i < 4; i++) {
    hid_t h5 = begin();
    add(h5, "v", ranks[i], shapes[i], 0);
    H5Fclose(h5);
    holds(":/v", NZ, NULL);
  }
  const hsize_t two[] = {2, NZ / 2, NY, NX};
  hid_t h5 = begin();
  add(h5, "v", 4, two, 0);
  H5Fclose(h5);
  refused(":/v", "/v has 4 axes");
}

static void test_part_that_was_never_written(void **state) {
  (void)state;
  hid_t h5 = begin();
  add(h5, "v", 3, VOLUME, 9);
  H5Fclose(h5);
  holds(":/v", 9, "/v was not written to its end");
  h5 = begin();
  add(h5, "v", 3, VOLUME, NZ);
  H5Fclose(h5);
  holds(":/v", NZ, NULL);
}

/* What attributes make of the greys, and which part of an array they call the scan. */
static void test_attributes(void **state) {
  (void)state;
  static const struct {
    const char *of, *name, *note;
    double value;
  } cases[] = {{"g/v", "scale_factor", "not as its attribute scale_factor says", 0.5},
               {"g/v", "scale_factor", NULL, 1.0},
               {"g/v", "add_offset", "not as its attribute add_offset says", -3.0},
               {"g/v", "add_offset", NULL, 0.0},
               {"g/v", "MATLAB_class", "rows and columns are exchanged", 1.0},
               {"g/v", "IMAGE_WHITE_IS_ZERO", "not as its attribute IMAGE_WHITE_IS_ZERO says", 1.0},
               {"g/v", "IMAGE_WHITE_IS_ZERO", NULL, 0.0},
               {"g", "ImageSizeX", "beyond ImageSizeX, Y and Z of /g it is filled up", 13.0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    hid_t h5 = begin();
    add(h5, "g/v", 3, VOLUME, 0);
    hid_t space = H5Screate(H5S_SCALAR), object = H5Oopen(h5, cases[i].of, H5P_DEFAULT);
    hid_t attribute =
        H5Acreate2(object, cases[i].name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &cases[i].value) >= 0);
    H5Aclose(attribute);
    H5Oclose(object);
    H5Sclose(space);
    H5Fclose(h5);
    holds(":/g/v", NZ, cases[i].note);
  }
}

/* Stores the bytes of the greys with or without a sign, and an attribute that is a text (NULL: two
 * numbers, `low` and `high`, of which one if they are alike). */
static void add_signed(hid_t type, const char *name, const char *text, double low, double high) {
  static unsigned char greys[N];
  const double numbers[] = {low, high};
  const hsize_t two = 2;
  for (size_t i = 0; i < N; i++) greys[i] = grey(i);
  hid_t h5 = begin(), space = H5Screate_simple(3, VOLUME, NULL);
  hid_t set = H5Dcreate2(h5, "v", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, greys) >= 0);
  hid_t kind = text != NULL ? H5Tcopy(H5T_C_S1) : H5Tcopy(H5T_NATIVE_DOUBLE);
  if (text != NULL) H5Tset_size(kind, strlen(text));
  hid_t one = text != NULL || low == high ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &two, NULL);
  hid_t attribute = H5Acreate2(set, name, kind, one, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(attribute, kind, text != NULL ? (const void *)text : numbers) >= 0);
  H5Aclose(attribute);
  H5Sclose(one);
  H5Tclose(kind);
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(h5);
}

/* The file holds the greys, those of `low` to `high` as no measurement, as of a sign if it is so.
 */
static void lacks(double low, double high, bool is_signed, const char *note) {
  char path[160];
  const char *paths = path;
  struct stack stack;
  float slice[NX * NY];
  size_t lacking = 0;
  snprintf(path, sizeof path, "%s:/v", file);
  if (stack_open(&paths, 1, NULL, &stack) != STATUS_OK) fail_msg("%s", error_message());
  for (size_t z = 0; z < NZ; z++) {
    assert_int_equal(stack_read(&stack, z, slice), STATUS_OK);
    for (size_t i = 0; i < NX * NY; i++) {
      const unsigned char stored = grey(z * NX * NY + i);
      const double wanted = is_signed ? (signed char)stored : stored;
      const bool lost = wanted >= low && wanted <= high;
      if (lost ? !isnan(slice[i]) : (double)slice[i] != wanted)
        fail_msg("%g, not %g", (double)slice[i], wanted);
      lacking += lost;
    }
  }
  assert_true(lacking > 0 || !(low <= high));
  if (note == NULL ? stack.files[0].note[0] != '\0' : strstr(stack.files[0].note, note) == NULL)
    fail_msg("told '%s'", stack.files[0].note);
  stack_close(&stack);
}

static void test_sign_and_no_data(void **state) {
  (void)state;
  const hid_t u8 = H5T_NATIVE_UINT8, i8 = H5T_NATIVE_INT8;
  add_signed(i8, "_Unsigned", "true", 0, 0);
  lacks(NAN, NAN, false, NULL);
  add_signed(u8, "_Unsigned", "false", 0, 0);
  lacks(NAN, NAN, true, NULL);
  add_signed(u8, "_Unsigned", "true", 0, 0); /* as it is */
  lacks(NAN, NAN, false, NULL);
  add_signed(i8, "_Unsigned", "false", 0, 0);
  lacks(NAN, NAN, true, NULL);
  add_signed(u8, "axes", "z:y:x", 0, 0);
  lacks(NAN, NAN, false, NULL);
  add_signed(u8, "axes", "x:y:z", 0, 0);
  lacks(NAN, NAN, false, "its axes are xyz by its attribute axes: read as stored");
  static const char *const TAGS[] = {
      "[{\"key\": \"z\"}, {\"key\": \"y\"}, {\"key\": \"x\"}, {\"key\": \"c\"}]",
      "[{\"key\": \"x\"}, {\"key\": \"y\"}, {\"key\": \"z\"}]"};
  for (int i = 0; i < 2; i++) {
    add_signed(u8, "axistags", TAGS[i], 0, 0);
    lacks(NAN, NAN, false, i == 0 ? NULL : "its axes are xyz by its attribute axistags");
  }
  add_signed(u8, "_FillValue", NULL, 77, 77);
  lacks(77, 77, false, NULL);
  add_signed(i8, "missing_value", NULL, -77, -77);
  lacks(-77, -77, true, NULL);
  add_signed(u8, "missing_value", NULL, 7, 77);
  lacks(NAN, NAN, false, "missing_value is not heeded");
  add_signed(u8, "_FillValue", NULL, -1, -1); /* which no voxel can have */
  lacks(NAN, NAN, false, NULL);
  add_signed(u8, "valid_max", NULL, 250, 250);
  lacks(251, 255, false, NULL);
  add_signed(u8, "valid_min", NULL, 3, 3);
  lacks(0, 2, false, NULL);
  add_signed(u8, "valid_range", NULL, 0, 240);
  lacks(241, 255, false, NULL);
}

/* Names of axes and scales that stand beside the array, as of NeXus and in HDF5's labels. */
static void test_named_axes(void **state) {
  (void)state;
  static const char *const ORDERS[] = {"zyx", "xyz"};
  for (int k = 0; k < 4; k++) {
    const char *order = ORDERS[k % 2];
    const char *const names[] = {(char[]){order[0], 0}, (char[]){order[1], 0},
                                 (char[]){order[2], 0}};
    const hsize_t three = 3;
    hid_t h5 = begin();
    add(h5, "entry/v", 3, VOLUME, 0);
    hid_t text = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, &three, NULL);
    H5Tset_size(text, H5T_VARIABLE);
    hid_t object = H5Oopen(h5, k < 2 ? "entry" : "entry/v", H5P_DEFAULT);
    hid_t attribute = H5Acreate2(object, k < 2 ? "axes" : "DIMENSION_LABELS", text, space,
                                 H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, text, names) >= 0);
    H5Aclose(attribute);
    H5Oclose(object);
    H5Sclose(space);
    H5Tclose(text);
    H5Fclose(h5);
    holds(":/entry/v", NZ,
          k == 0   ? NULL
          : k == 1 ? "its axes are xyz by its attribute axes: read as stored"
          : k == 2 ? NULL
                   : "its axes are xyz by its attribute DIMENSION_LABELS");
  }
  const hsize_t one[] = {1};
  hid_t h5 = begin();
  add(h5, "entry/v", 3, VOLUME, 0);
  add(h5, "entry/v_scaling_factor", 1, one, 0);
  H5Fclose(h5);
  holds(":/entry/v", NZ, "greys as stored, before /entry/v_scaling_factor");
}

static void add_text(hid_t object, const char *name, const char *value) {
  hid_t text = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(text, strlen(value));
  hid_t attribute = H5Acreate2(object, name, text, space, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(attribute, text, value) >= 0);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(text);
}

/* Dimensions of netCDF, which refer to scales, and scales of EMD, which have names; a picture that
 * is to be shown from below. */
static void test_named_scales(void **state) {
  (void)state;
  static const char *const SCALES[2][3] = {{"z", "y", "x"}, {"X", "Y", "Z"}};
  const hsize_t three = 3, one[] = {1};
  for (int k = 0; k < 4; k++) {
    const char *const *names = SCALES[k % 2];
    hobj_ref_t refers[3];
    hvl_t lists[3];
    char name[20];
    hid_t h5 = begin();
    add(h5, "g/v", 3, VOLUME, 0);
    for (int i = 0; i < 3; i++) {
      snprintf(name, sizeof name, "g/%s", names[i]);
      if (k >= 2) snprintf(name, sizeof name, "g/dim%d", i + 1);
      add(h5, name, 1, one, 0);
      assert_true(H5Rcreate(&refers[i], h5, name, H5R_OBJECT, -1) >= 0);
      lists[i] = (hvl_t){1, &refers[i]};
      hid_t scale = H5Oopen(h5, name, H5P_DEFAULT);
      if (k >= 2) add_text(scale, "name", names[i]);
      H5Oclose(scale);
    }
    hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ), space = H5Screate_simple(1, &three, NULL);
    hid_t object = H5Oopen(h5, "g/v", H5P_DEFAULT);
    hid_t attribute = H5Acreate2(object, k < 2 ? "DIMENSION_LIST" : "other", type, space,
                                 H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, lists) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(object);
    H5Fclose(h5);
    holds(":/g/v", NZ,
          k % 2 == 0 ? NULL
          : k == 1   ? "its axes are xyz by its attribute DIMENSION_LIST: read as stored"
                     : "its axes are xyz by dim1, dim2 ... beside it: read as stored");
  }
  for (int k = 0; k < 2; k++) {
    hid_t h5 = begin();
    add(h5, "v", 3, VOLUME, 0);
    hid_t object = H5Oopen(h5, "v", H5P_DEFAULT);
    add_text(object, "DISPLAY_ORIGIN", k == 0 ? "UL" : "LL");
    H5Oclose(object);
    H5Fclose(h5);
    holds(":/v", NZ, k == 0 ? NULL : "mirrored or turned by its attribute DISPLAY_ORIGIN");
  }
}

static void test_what_is_no_image(void **state) {
  (void)state;
  const hsize_t angles[] = {NZ}, others[] = {NZ + 1};
  hid_t h5 = begin();
  add(h5, "exchange/data", 3, VOLUME, 0);
  add(h5, "exchange/theta", 1, angles, 0);
  H5Fclose(h5);
  refused("", "/exchange/data holds projections, as /exchange/theta beside it tells");
  h5 = begin();
  add(h5, "exchange/data", 3, VOLUME, 0);
  add(h5, "exchange/theta", 1, others, 0);
  H5Fclose(h5);
  holds(":/exchange/data", NZ, NULL);
  h5 = begin();
  hid_t space = H5Screate_simple(3, VOLUME, NULL);
  H5Dclose(H5Dcreate2(h5, "v", H5T_STD_B8LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
  H5Fclose(h5);
  refused(":/v", "/v holds no numbers, but bits (H5T_BITFIELD); save it as integers or floats");
}

/* A chunk of 1 MB that inflates to 100: the library would allocate all of it. */
static void test_chunk_that_inflates_beyond_itself(void **state) {
  (void)state;
  enum { SIDE = 1024, TIMES = 100 };
  static unsigned char plain[SIDE * SIDE];
  const hsize_t shape[] = {8, SIDE, SIDE}, chunk[] = {1, SIDE, SIDE}, first[] = {0, 0, 0};
  for (int times = 1; times <= TIMES; times += TIMES - 1) {
    z_stream z = {0};
    unsigned char *packed = malloc(2 * sizeof plain);
    assert_int_equal(deflateInit(&z, 1), Z_OK);
    z.next_out = packed;
    z.avail_out = 2 * sizeof plain;
    for (int i = 0; i < times; i++) {
      /* It begins with noise, so that it is stored in more than 260 kB and looked at. */
      for (size_t k = 0; k < sizeof plain; k++)
        plain[k] = i == 0 && k < 300000 ? (unsigned char)(rand() >> 8) : 0;
      z.next_in = plain;
      z.avail_in = sizeof plain;
      assert_int_equal(deflate(&z, i + 1 < times ? Z_NO_FLUSH : Z_FINISH),
                       i + 1 < times ? Z_OK : Z_STREAM_END);
    }
    hid_t h5 = begin(), space = H5Screate_simple(3, shape, NULL);
    hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(layout, 3, chunk);
    H5Pset_deflate(layout, 1);
    hid_t set = H5Dcreate2(h5, "v", H5T_NATIVE_UINT8, space, H5P_DEFAULT, layout, H5P_DEFAULT);
    assert_true(z.total_out > 270000);
    assert_true(H5Dwrite_chunk(set, H5P_DEFAULT, 0, first, z.total_out, packed) >= 0);
    deflateEnd(&z);
    free(packed);
    H5Pclose(layout);
    H5Dclose(set);
    H5Sclose(space);
    H5Fclose(h5);
    char path[160];
    const char *paths = path;
    struct stack stack;
    float *slice = malloc(sizeof *slice * SIDE * SIDE);
    snprintf(path, sizeof path, "%s:/v", file);
    assert_int_equal(stack_open(&paths, 1, NULL, &stack), STATUS_OK);
    const enum status status = stack_read(&stack, 0, slice);
    stack_close(&stack);
    free(slice);
    if (times == 1) {
      assert_int_equal(status, STATUS_OK);
    } else {
      assert_int_equal(status, STATUS_INPUT);
      assert_non_null(strstr(error_message(), "a chunk of 1048576 bytes inflates to more"));
      error_clear();
    }
  }
}

/* Deflate applied twice makes ten gigabytes of ten kilobytes. */
static void test_deflated_twice(void **state) {
  (void)state;
  hid_t h5 = begin(), space = H5Screate_simple(3, VOLUME, NULL);
  hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(layout, 3, VOLUME);
  H5Pset_deflate(layout, 1);
  H5Pset_deflate(layout, 1);
  hid_t set = H5Dcreate2(h5, "v", H5T_NATIVE_UINT8, space, H5P_DEFAULT, layout, H5P_DEFAULT);
  const unsigned char zeros[N] = {0};
  assert_true(H5Dwrite(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros) >= 0);
  H5Pclose(layout);
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(h5);
  char path[160];
  const char *paths = path;
  struct stack stack;
  float slice[NX * NY];
  snprintf(path, sizeof path, "%s:/v", file);
  assert_int_equal(stack_open(&paths, 1, NULL, &stack), STATUS_OK);
  assert_int_equal(stack_read(&stack, 0, slice), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "filter"));
  error_clear();
  stack_close(&stack);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_places),
      cmocka_unit_test(test_scaled_slices),
      cmocka_unit_test(test_only_array),
      cmocka_unit_test(test_axes_of_one),
      cmocka_unit_test(test_part_that_was_never_written),
      cmocka_unit_test(test_attributes),
      cmocka_unit_test(test_sign_and_no_data),
      cmocka_unit_test(test_named_axes),
      cmocka_unit_test(test_named_scales),
      cmocka_unit_test(test_what_is_no_image),
      cmocka_unit_test(test_chunk_that_inflates_beyond_itself),
      cmocka_unit_test(test_deflated_twice),
  };
  return cmocka_run_group_tests(tests, make_file, remove_folder);
}
