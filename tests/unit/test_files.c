/* HDF5 layer and model file: what is written is read back, what is wrong is refused, nothing half
 * is left behind. */
#include "files_rig.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <hdf5.h>

#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/model_file.h"
#include "common/provenance.h"
#include "common/snapshot_file.h"
#include "sphsolve/geometry/model_facts.h"
#include "sphsolve/output/checkpoint_file.h"

static void test_round_trip(void **state) {
  (void)state;
  struct h5_file *file;
  size_t dims[3] = {2, 3, 1}, found[3];
  double values[6] = {1, 2, 3, 4, 5, 6.5}, *read, number = 0;
  char *text;
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_write(file, "/a/b/values", H5_F64, 2, dims, values, true), STATUS_OK);
  assert_int_equal(h5_write_attribute(file, "/a", "number", H5_F64, 1, values + 2), STATUS_OK);
  assert_int_equal(h5_write_text(file, "/t", "hello"), STATUS_OK);
  /* Not there under its own name until whole. */
  assert_int_equal(access(path, F_OK), -1);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(h5_read(file, "/a/b/values", H5_F64, 2, found, &read), STATUS_OK);
  assert_int_equal(found[0], 2);
  assert_memory_equal(read, values, sizeof values);
  memory_free(&read);
  assert_int_equal(h5_read_attribute(file, "/a", "number", H5_F64, 1, &number), STATUS_OK);
  assert_true(number == 3);
  assert_int_equal(h5_read_text(file, "/t", &text), STATUS_OK);
  assert_string_equal(text, "hello");
  memory_free(&text);
  refused(h5_read(file, "/a/b/none", H5_F64, 2, found, &read), "no dataset");
  refused(h5_read(file, "/a/b/values", H5_F64, 3, found, &read), "2 dimensions");
  refused(h5_read(file, "/a/b/values", H5_I32, 2, found, &read), "floats");
  refused(h5_read(file, "/t", H5_F64, 0, found, &read), "no numbers");
  refused(h5_read_attribute(file, "/a", "number", H5_F64, 3, values), "1 values, 3 are wanted");
  h5_close(file);
  /* Abandoned: neither the file nor its part is left. */
  char other[64], part[80];
  snprintf(other, sizeof other, "%s/b.hdf", folder);
  snprintf(part, sizeof part, "%s.part", other);
  assert_int_equal(h5_create(other, &file), STATUS_OK);
  assert_int_equal(access(part, F_OK), 0);
  h5_close(file);
  assert_int_equal(access(part, F_OK), -1);
  assert_int_equal(access(other, F_OK), -1);
}

/* What others write into HDF5 files and we do not: texts of any length, odd types and filters. */
static void write_foreign(const char *name) {
  const char *words[2] = {"some", "words"};
  const hsize_t two = 2;
  const double numbers[2] = {1, 2};
  hid_t file = H5Fcreate(name, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  hid_t text = H5Tcopy(H5T_C_S1), pair = H5Screate_simple(1, &two, NULL);
  hid_t scalar = H5Screate(H5S_SCALAR), checked = H5Pcreate(H5P_DATASET_CREATE);
  H5Tset_size(text, H5T_VARIABLE);
  hid_t set = H5Dcreate2(file, "words", text, pair, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, text, H5S_ALL, H5S_ALL, H5P_DEFAULT, words);
  hid_t one = H5Acreate2(set, "one", text, scalar, H5P_DEFAULT, H5P_DEFAULT);
  hid_t many = H5Acreate2(set, "many", text, pair, H5P_DEFAULT, H5P_DEFAULT);
  hid_t number = H5Acreate2(set, "number", H5T_NATIVE_DOUBLE, scalar, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(one, text, words);
  H5Awrite(many, text, words);
  H5Awrite(number, H5T_NATIVE_DOUBLE, numbers);
  H5Aclose(one);
  H5Aclose(many);
  H5Aclose(number);
  H5Dclose(set);
  H5Pset_chunk(checked, 1, &two);
  H5Pset_fletcher32(checked);
  set = H5Dcreate2(file, "checked", H5T_NATIVE_DOUBLE, pair, H5P_DEFAULT, checked, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers);
  H5Dclose(set);
  H5Pclose(checked);
  H5Sclose(scalar);
  H5Sclose(pair);
  H5Tclose(text);
  H5Fclose(file);
}

static void test_foreign(void **state) {
  (void)state;
  struct h5_file *file;
  char *text, **names;
  double *values, number;
  size_t count, dims[2] = {1};
  int rank;
  write_foreign(path);
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(h5_read_texts(file, "/words", &count, &names), STATUS_OK);
  assert_string_equal(names[1], "words");
  h5_free_texts(count, &names);
  refused(h5_read_text(file, "/words", &text), "2 texts, one is wanted");
  refused(h5_read_text(file, "/checked", &text), "no text");
  assert_int_equal(h5_read_attribute_text(file, "/words", "one", &text), STATUS_OK);
  assert_string_equal(text, "some");
  memory_free(&text);
  refused(h5_read_attribute_text(file, "/words", "many", &text), "is no text");
  refused(h5_read_attribute_text(file, "/words", "number", &text), "is no text");
  refused(h5_read_attribute(file, "/words", "one", H5_F64, 1, &number), "wrong type");
  assert_true(isnan(h5_attribute_or_nan(file, "/words", "one")));
  refused(h5_list(file, "/none", &count, &names), "no group");
  refused(h5_list_attributes(file, "/none", &count, &names), "no object");
  refused(h5_shape(file, "/words", 0, &rank, dims), "at most 0 are wanted");
  /* Rows of a dataset, as each rank takes its own. */
  assert_int_equal(h5_read_rows(file, "/checked", H5_F64, 1, 2, 1, dims, &values), STATUS_OK);
  assert_true(values[0] == 2 && dims[0] == 1);
  memory_free(&values);
  refused(h5_read_rows(file, "/checked", H5_F64, 1, 2, 2, dims, &values), "has 2 rows, 3 are");
  refused(h5_read_rows(file, "/checked", H5_F64, 1, 3, 0, dims, &values), "has 2 rows, not 3");
  h5_close(file);
}

static void test_not_hdf5(void **state) {
  (void)state;
  struct h5_file *file;
  char name[64];
  snprintf(name, sizeof name, "%s/text.hdf", folder);
  FILE *text = fopen(name, "w");
  fputs("no HDF5", text);
  fclose(text);
  refused(h5_open(name, &file), "no HDF5 file");
  refused(h5_open("/nowhere/at/all.hdf", &file), "No such file");
}

static void test_hash_of_a_start(void **state) {
  (void)state;
  char name[64], text[70000];
  uint64_t hash;
  memset(text, 'x', sizeof text);
  snprintf(name, sizeof name, "%s/text", folder);
  FILE *file = fopen(name, "wb");
  fwrite(text, sizeof text, 1, file);
  fclose(file);
  const size_t sizes[] = {0, 1, 65536, 65537, sizeof text};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    assert_int_equal(hash_file_start(name, sizes[i], &hash), STATUS_OK);
    assert_true(hash == hash_bytes(text, sizes[i]));
  }
  assert_int_equal(hash_file(name, &hash), STATUS_OK);
  assert_true(hash == hash_bytes(text, sizeof text));
  unlink(name);
}

static void write_model(const struct voxel_model *model) {
  struct h5_file *file;
  const char *inputs[] = {"in.tif"};
  uint64_t hash = hash_bytes("x", 1);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(model_write(file, model), STATUS_OK);
  assert_int_equal(provenance_write(file, "test", "test --me", 1, inputs, &hash), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
}

static void test_model(void **state) {
  (void)state;
  uint8_t solid[24] = {1, 0, 0, 0, 0, 1};
  float distance[24] = {-1e-6f, 2e-6f};
  struct voxel_model model = {.size = {4, 3, 2},
                              .spacing = {1e-6, 2e-6, 3e-6},
                              .periodic = {true, true, false},
                              .mirror_plane = 1,
                              .void_ratio = 11,
                              .void_ratio_measured = NAN,
                              .threshold = 60,
                              .solid = solid,
                              .wall_distance = distance},
                     read;
  write_model(&model);
  assert_int_equal(model_read(path, &read), STATUS_OK);
  assert_int_equal(read.size[0], 4);
  assert_int_equal(read.size[2], 2);
  assert_true(read.spacing[0] == 1e-6 && read.spacing[2] == 3e-6);
  assert_true(read.periodic[0] && !read.periodic[2]);
  assert_true(read.void_ratio == 11 && isnan(read.void_ratio_measured) && read.threshold == 60);
  assert_memory_equal(read.solid, solid, sizeof solid);
  assert_memory_equal(read.wall_distance, distance, sizeof distance);
  assert_null(read.grain_fraction);
  model_free(&read);
  solid[7] = 3;
  write_model(&model);
  refused(model_read(path, &read), "only 0 (pore) and 1 (grain)");
  solid[7] = 0;
  distance[5] = NAN;
  write_model(&model);
  refused(model_read(path, &read), "/model/wall_distance holds nan at x=1 y=1 z=0");
  for (int i = 0; i < 24; i++) distance[i] = solid[i] ? 1e-6f : -1e-6f;
  write_model(&model);
  refused(model_read(path, &read), "wrong sign in 22 of 22 voxels of the pores");
  for (int i = 0; i < 24; i++) distance[i] = 1e-6f; /* fewer than half of the voxels are wrong */
  write_model(&model);
  refused(model_read(path, &read), "wrong sign in 2 of 2 voxels of the grains");
  for (int i = 0; i < 24; i++) distance[i] = solid[i] ? -1e-6f : 1e-6f;
  distance[3] = -4e-6f; /* deep in a grain, says a pore */
  write_model(&model);
  refused(model_read(path, &read), "wrong sign in 1 of 22 voxels of the pores");
  for (int i = 0; i < 24; i++) distance[i] = 0.0f;
  write_model(&model);
  refused(model_read(path, &read), "nowhere beyond 0 m in the pores");
  for (int i = 0; i < 24; i++) distance[i] = solid[i] ? 0.0f : 1e-6f;
  write_model(&model);
  refused(model_read(path, &read), "nowhere beyond 0 m in the grains");
  for (int i = 0; i < 24; i++) distance[i] = solid[i] ? -1e-6f : 1e-6f;
  model.void_ratio_measured = -1e300;
  write_model(&model);
  refused(model_read(path, &read), "void_ratio_measured is -1e+300");
  model.void_ratio_measured = NAN;
  for (int i = 0; i < 24; i++) distance[i] = solid[i] ? -0.5f : 0.5f; /* in voxels */
  write_model(&model);
  refused(model_read(path, &read), "metres from the middle of a voxel");
  /* solid and spacing alone make a model. */
  struct h5_file *file;
  size_t dims[3] = {2, 3, 4};
  double spacing[3] = {1e-6, 1e-6, 1e-6};
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_write(file, "/model/solid", H5_U8, 3, dims, solid, false), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  refused(model_read(path, &read), "spacing");
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_write(file, "/model/solid", H5_U8, 3, dims, solid, false), STATUS_OK);
  assert_int_equal(h5_write_attribute(file, "/model", "spacing", H5_F64, 3, spacing), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(model_read(path, &read), STATUS_OK);
  assert_true(read.periodic[0] && read.periodic[1] && read.periodic[2] && read.void_ratio == 11);
  model_free(&read);
}

/* Two programs with one output, and a file of which nothing can be written. */
static void test_outputs_that_cannot_begin(void **state) {
  (void)state;
  struct h5_file *file = NULL;
  char part[80];
  snprintf(part, sizeof part, "%s.part", path);
  const int held = open(part, O_RDWR | O_CREAT, 0600); /* as the library of another program does */
  assert_int_equal(flock(held, LOCK_EX), 0);
  assert_int_equal(h5_create(path, &file), STATUS_RUN);
  assert_non_null(strstr(error_message(), "another program is writing it"));
  error_clear();
  assert_int_equal(access(part, F_OK), 0);
  close(held);
  const struct rlimit none = {0, RLIM_INFINITY};
  struct rlimit before;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
  if (h5_create(path, &file) == STATUS_OK) h5_close(file);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  error_clear();
  assert_int_not_equal(access(part, F_OK), 0);
}

/* A number that no scan can have is refused, whatever it is the error of. */
static void test_facts(void **state) {
  (void)state;
  static const char *const NAMES[][2] = {{"/model", "voxel_scanned"},
                                         {"/model", "void_ratio_error"},
                                         {"/calibration", "smoothing"},
                                         {"/calibration", "threshold_uncertainty"},
                                         {"/calibration", "dthreshold_dvoid_ratio"},
                                         {"/calibration", "contrast_to_noise"},
                                         {"/scanner", "blur"},
                                         {"/scanner", "blur_uncertainty"},
                                         {"/scanner", "noise_correlation"},
                                         {"/scanner", "resolution"},
                                         {"/scanner", "smooth_walls"}};
  const double wrong[] = {-1e300, 1e300}, voxel = 2e-6;
  uint8_t solid[24] = {1};
  const struct voxel_model model = {
      .size = {4, 3, 2}, .spacing = {1e-6, 1e-6, 1e-6}, .solid = solid};
  for (size_t i = 0; i <= 2 * sizeof NAMES / sizeof *NAMES; i++) {
    struct h5_file *file;
    struct model_facts facts;
    assert_int_equal(h5_create(path, &file), STATUS_OK);
    assert_int_equal(model_write(file, &model), STATUS_OK);
    assert_int_equal(h5_make_group(file, "/calibration"), STATUS_OK);
    assert_int_equal(h5_make_group(file, "/scanner"), STATUS_OK);
    const char *const *name = NAMES[i / 2];
    const bool good = i == 2 * sizeof NAMES / sizeof *NAMES;
    if (!good && strcmp(name[1], "contrast_to_noise") == 0 && i % 2 == 1) { /* no noise */
      h5_close(file);
      continue;
    }
    if (good || i > 1)
      assert_int_equal(h5_write_attribute(file, "/model", "voxel_scanned", H5_F64, 1, &voxel),
                       STATUS_OK);
    if (!good)
      assert_int_equal(h5_write_attribute(file, name[0], name[1], H5_F64, 1, &wrong[i % 2]),
                       STATUS_OK);
    assert_int_equal(h5_commit(file), STATUS_OK);
    if (good)
      assert_int_equal(model_facts_read(path, &facts), STATUS_OK);
    else
      refused(model_facts_read(path, &facts), name[1]);
  }
}

static void test_snapshot(void **state) {
  (void)state;
  double points[6] = {0, 1, 2, 3, 4, 5}, velocity[6] = {1, 0, 0, 0, 0, 2}, *read;
  struct snapshot_field field = {"velocity", "m/s", "velocity of the fluid", H5_F64, 3, velocity,
                                 NULL,       NULL},
                        at = {.type = H5_F64, .components = 3, .data = points};
  struct snapshot snapshot;
  assert_int_equal(snapshot_write(path, 0.5, 7, 0, 2, &at, 1, &field), STATUS_OK);
  assert_int_equal(snapshot_open(path, &snapshot), STATUS_OK);
  assert_true(snapshot.time == 0.5 && snapshot.count == 2);
  assert_memory_equal(snapshot.points, points, sizeof points);
  assert_int_equal(snapshot_read(&snapshot, "velocity", 3, &read), STATUS_OK);
  assert_memory_equal(read, velocity, sizeof velocity);
  memory_free(&read);
  refused(snapshot_read(&snapshot, "pressure", 1, &read), "no dataset");
  snapshot_close(&snapshot);
}

static size_t read_bytes(const char *name, char **bytes) {
  FILE *file = fopen(name, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  size_t size = (size_t)ftell(file);
  rewind(file);
  *bytes = malloc(size);
  assert_int_equal(fread(*bytes, 1, size, file), size);
  fclose(file);
  return size;
}
static void test_series(void **state) {
  (void)state;
  char *names[] = {"a \"b\"\\\n-0000.hdf", "c-0001.hdf"}, *text;
  const double times[] = {0, 0.5};
  assert_int_equal(series_write(path, 2, names, times), STATUS_OK);
  const size_t size = read_bytes(path, &text);
  static const char wanted[] =
      "{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [\n"
      "    { \"name\" : \"a \\\"b\\\"\\\\\\u000a-0000.hdf\", \"time\" : 0 },\n"
      "    { \"name\" : \"c-0001.hdf\", \"time\" : 0.5 }\n  ]\n}\n";
  assert_int_equal(size, sizeof wanted - 1);
  assert_memory_equal(text, wanted, size);
  free(text);
}

static void write_bytes(const char *name, const char *bytes, size_t size) {
  FILE *file = fopen(name, "wb");
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  fclose(file);
}

/* Which of the checkpoints written is opened; -1: none, as both are damaged. */
static double opened_checkpoint(const char *prefix) {
  struct h5_file *file;
  double number = 0;
  enum status status = checkpoint_open(prefix, &file);
  if (status != STATUS_OK) {
    refused(status, "remove both to start anew");
    return -1;
  }
  assert_int_equal(h5_read_attribute(file, "/state", "number", H5_F64, 1, &number), STATUS_OK);
  h5_close(file);
  return number;
}

static void write_checkpoint(const char *prefix, double number) {
  struct h5_file *file;
  assert_int_equal(checkpoint_create(prefix, &file), STATUS_OK);
  assert_int_equal(h5_make_group(file, "/state"), STATUS_OK);
  assert_int_equal(h5_write_attribute(file, "/state", "number", H5_F64, 1, &number), STATUS_OK);
  assert_int_equal(checkpoint_commit(prefix, file), STATUS_OK);
}

/* A thousand times a bit is flipped or the end cut off, anywhere: always known, and the checkpoint
 * before is taken; with that damaged too, none is. */
static void test_damaged_checkpoints(void **state) {
  (void)state;
  char prefix[64], newest[80], older[80], *bytes, *before;
  uint64_t random = 10;
  log_start("test", LOG_QUIET);
  snprintf(prefix, sizeof prefix, "%s/run", folder);
  snprintf(newest, sizeof newest, "%s.ckpt.hdf", prefix);
  snprintf(older, sizeof older, "%s.ckpt.1.hdf", prefix);
  write_checkpoint(prefix, 1);
  write_checkpoint(prefix, 2);
  assert_true(opened_checkpoint(prefix) == 2);
  const size_t size = read_bytes(newest, &bytes), size_before = read_bytes(older, &before);
  for (int i = 0; i < 1000; i++) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    const size_t place = (size_t)((random >> 16) % size);
    const char flip = (char)(1 << (random >> 61));
    bytes[place] ^= flip;
    write_bytes(newest, bytes, i % 4 ? size : place);
    bytes[place] ^= flip;
    if (opened_checkpoint(prefix) != 1) fail_msg("damage at byte %zu of %zu passed", place, size);
    if (i % 10) continue;
    write_bytes(older, before, place % size_before);
    assert_true(opened_checkpoint(prefix) == -1);
    write_bytes(older, before, size_before);
  }
  free(before);
  free(bytes);
}

/* Killed at any moment of its writing, a checkpoint leaves nothing behind but checkpoints. */
static void test_torn_checkpoints(void **state) {
  (void)state;
  char prefix[64], newest[80], fresh[80], part[96], *bytes;
  snprintf(prefix, sizeof prefix, "%s/torn", folder);
  snprintf(newest, sizeof newest, "%s.ckpt.hdf", prefix);
  snprintf(fresh, sizeof fresh, "%s.ckpt.new.hdf", prefix);
  snprintf(part, sizeof part, "%s.part", fresh);
  write_checkpoint(prefix, 1);
  write_checkpoint(prefix, 2);
  const size_t size = read_bytes(newest, &bytes);
  /* While it is written, and before it is sealed. */
  write_bytes(part, bytes, size / 2);
  write_bytes(fresh, bytes, size - 16);
  assert_true(opened_checkpoint(prefix) == 2);
  assert_true(access(part, F_OK) != 0 && access(fresh, F_OK) != 0);
  /* Between the two renames: the newest is the one not yet in place. */
  assert_int_equal(unlink(newest), 0);
  write_bytes(fresh, bytes, size);
  assert_true(opened_checkpoint(prefix) == 2);
  assert_true(access(newest, F_OK) == 0 && access(fresh, F_OK) != 0);
  free(bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_hash_of_a_start),
                                     cmocka_unit_test(test_round_trip),
                                     cmocka_unit_test(test_foreign),
                                     cmocka_unit_test(test_not_hdf5),
                                     cmocka_unit_test(test_model),
                                     cmocka_unit_test(test_facts),
                                     cmocka_unit_test(test_outputs_that_cannot_begin),
                                     cmocka_unit_test(test_snapshot),
                                     cmocka_unit_test(test_series),
                                     cmocka_unit_test(test_damaged_checkpoints),
                                     cmocka_unit_test(test_torn_checkpoints)};
  return cmocka_run_group_tests(tests, make_file, remove_folder);
}
