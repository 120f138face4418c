/* What ct2model says to wrong words, numbers and images. */
#include "refusals.h"

int ct2model_main(int argc, char **argv);
#define main ct2model_main
#include "ct2model/ct2model.c"
#undef main

enum { N = 24 };

static void write_bytes(const char *name, size_t n, unsigned char (*byte)(size_t i)) {
  FILE *file = fopen(name, "wb");
  if (file == NULL) abort();
  for (size_t i = 0; i < n; i++) fputc(byte(i), file);
  fclose(file);
}
/* Slabs across z of 4 voxels, with noise that is the same everywhere. */
static unsigned char slabs(size_t i) {
  uint32_t noise = (uint32_t)i * 2654435761U;
  noise = (noise ^ noise >> 15) * 2246822519U;
  return (unsigned char)(((i % N + i / N % N + i / (N * N)) / 4 % 2 ? 120 : 40) +
                         (noise >> 13) % 23);
}
/* Along x: 8 voxels of the label 1, 8 of 3, 8 of 2. */
static unsigned char layers(size_t i) {
  static const unsigned char label[3] = {1, 3, 2};
  return label[i % N / 8];
}
static unsigned char zero(size_t i) {
  (void)i;
  return 0;
}

static int write_images(void **state) {
  if (faults_start(state) != 0) return 1;
  write_bytes("slabs.raw", N * N * N, slabs);
  write_bytes("cut.raw", N * N * (N - 1), slabs);
  write_bytes("layers.raw", N * N * N, layers);
  write_bytes("flat.raw", N * N * N, zero);
  write_bytes("one.raw", N * N, slabs);
  FILE *file = fopen("text.tif", "w");
  if (file == NULL) return 1;
  fputs("no image\n", file);
  fclose(file);
  return mkdir("empty", 0700);
}

#define SLABS "slabs.raw --raw 24x24x24:u8 --voxel-size 10um"
#define LAYERS "layers.raw --raw 24x24x24:u8 --voxel-size 5um"

static void test_wrong_words(void **state) {
  (void)state;
  static const struct refusal cases[] = {
      {2, "ct2model", "command"},
      {2, "ct2model bild x", "bild"},
      {2, "ct2model build", ""},
      {2, "ct2model build " SLABS " -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 4", "-o"},
      {2, "ct2model build " SLABS " --void-ratio -1 -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 4 -o out.hdf --filter cubic", "--filter"},
      {2, "ct2model build " SLABS " --void-ratio 4 -o out.hdf --size 12x12", "--size"},
      {2, "ct2model build " SLABS " --void-ratio 4 -o out.hdf --crop 0,0,0,25,24,24", "--crop"},
      {2, "ct2model build " SLABS " --void-ratio 4 -o out.hdf --size 12x12x12 --filter none",
       "--filter none"},
      {2, "ct2model build slabs.raw --raw 24x24x24:u9 --void-ratio 4 -o out.hdf", "--raw"},
      {2, "ct2model build slabs.raw --raw 24x24x24:u8 --voxel-size 10 --void-ratio 4 -o out.hdf",
       "--voxel-size"},
      {2, "ct2model build slabs.raw --raw 24x24x24:u8 --voxel-size 10s --void-ratio 4 -o out.hdf",
       "--voxel-size"},
      {2, "ct2model build " SLABS " --void-ratio 4 -o -", "files are written, not standard output"},
      {2, "ct2model build " SLABS " --void-ratio 3.959+- -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 3.959+-x -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 3.959+-4 -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 3.959-+1 -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 0 -o out.hdf", "--void-ratio"},
      {2, "ct2model build " SLABS " --void-ratio 1 --levels 9 -o out.hdf", "--levels"},
      {2, "ct2model build " SLABS " --void-ratio 1 --max-memory 900kB -o out.hdf",
       "900kB: a size in MB, GB, MiB or GiB is wanted"},
      {2, "ct2model build " SLABS " --void-ratio 1 --sides open -o out.hdf", "--sides"},
      {2, "ct2model build " SLABS " --void-ratio 1 --sides closed --mirror x -o out.hdf",
       "--sides closed"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --roi cylinder:1,2", "--roi"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --roi ball:3", "--roi"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --roi mask:", "--roi"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --roi box:0,0,0,1,1", "--roi"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --roi cylinder:24,24,-1", "--roi"},
      {3, "ct2model sweep " SLABS " --void-ratio 1 --roi cylinder:-100,24,3", "--roi"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --correct ring", "--correct"},
      {2, "ct2model sweep " SLABS " --void-ratio 1 --axis 3", "--axis"},
      {2, "ct2model sweep " SLABS " --void-ratio 0.7,0.7", "--void-ratio"},
      {2, "ct2model sweep " SLABS " --void-ratio 0.7,", "--void-ratio"},
      {2, "ct2model sweep " SLABS " --void-ratio ,0.7", "--void-ratio"},
      {2, "ct2model sweep " SLABS " --void-ratio 0.7,x", "--void-ratio"},
      {2, "ct2model sweep " SLABS " --void-ratio 0.7,50", "--void-ratio"},
  };
  refusals_hold(ct2model_main, cases, sizeof cases / sizeof *cases);
}

static void test_wrong_numbers(void **state) {
  (void)state;
  static const struct refusal cases[] = {
      {2, "ct2model build empty --void-ratio 0.7 --voxel-size 5m -o out.hdf", "1 nm to 1 cm"},
      {2, "ct2model build empty --void-ratio 0.7 --voxel-size 5um,5m,5um -o out.hdf", "'5m'"},
      {2, "ct2model build empty --void-ratio 1,2 --voxel-size 5um -o out.hdf", "decimal comma"},
      {2, "ct2model build empty --void-ratio 0,725 --voxel-size 5um -o out.hdf", "decimal comma"},
      {2, "ct2model build empty --void-ratio 0,725+-0,005 --voxel-size 5um -o out.hdf",
       "decimal comma"},
      {2, "ct2model build empty --void-ratio 0.7 --voxel-size 5um,5um -o out.hdf", "three as"},
      {2, "ct2model build empty --void-ratio 0.7 --voxel-size 8,745um -o out.hdf", "decimal comma"},
      {2, "ct2model build empty --void-ratio 0.7 --voxel-size 5um --levels 2.5 -o out.hdf",
       "2.5: a whole number is wanted"},
      {2, "ct2model build empty --void-ratio 50 --voxel-size 5um -o out.hdf", "98.04 %"},
      {2, "ct2model build empty --void-ratio 0.725+-0.9 --voxel-size 5um -o out.hdf",
       "as large as the void ratio"},
      {2, "ct2model export out.hdf -o out.stl", "named .tif"},
  };
  refusals_hold(ct2model_main, cases, sizeof cases / sizeof *cases);
}

static void test_wrong_images(void **state) {
  (void)state;
  static const struct refusal cases[] = {
      {3, "ct2model build missing.tif --void-ratio 1 --voxel-size 1um -o out.hdf", "missing.tif"},
      {3, "ct2model info text.tif", "text.tif"},
      {3, "ct2model build slabs.raw --raw 24x24x23:u8 --voxel-size 1um --void-ratio 4 -o out.hdf",
       "slabs.raw"},
      {3, "ct2model build cut.raw --raw 24x24x24:u8 --voxel-size 1um --void-ratio 4 -o out.hdf",
       "cut.raw"},
      {3, "ct2model build slabs.raw --raw 24x24x24:u8 --void-ratio 4 -o out.hdf", "--voxel-size"},
      {3, "ct2model build flat.raw --raw 24x24x24:u8 --voxel-size 1um --void-ratio 4 -o out.hdf",
       "same grey"},
      {3, "ct2model info empty", "empty"},
      {3, "ct2model build one.raw --raw 24x24x1:u8 --voxel-size 1um --void-ratio 0.7 -o out.hdf",
       "one slice"},
      {3, "ct2model build slice_*.tif --void-ratio 0.7 -o out.hdf", "write them without quotes"},
  };
  refusals_hold(ct2model_main, cases, sizeof cases / sizeof *cases);
}

static void test_wrong_labels(void **state) {
  (void)state;
  static const struct refusal cases[] = {
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(0,1e-15m^2)",
       "0 is grain and 1 is pore"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(1,1e-15m^2)",
       "0 is grain and 1 is pore"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(0.35,1e-15)",
       "neither a permeability"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(0.35,0m^2)",
       "is grain"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(0.35)",
       "as soil(0.35, 1.8e-15 m^2)"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(0.35,1e-15m^2",
       "--segmented"},
      {2,
       "ct2model build " LAYERS " -o out.hdf --segmented "
       "1=pore,2=grain,3=soil(0.35,1e-15m^2),3=grain",
       "the label 3 stands there twice"},
      {3, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain,3=soil(0.35,1e-9m^2)",
       "square of a voxel"},
      {3,
       "ct2model build " LAYERS " -o out.hdf --segmented "
       "1=pore,2=grain,3=grain,4=soil(0.35,1e-15m^2)",
       "no voxel has the label 4"},
      {3,
       "ct2model build " LAYERS " -o out.hdf --segmented "
       "1=pore,2=soil(0.35,1e-15m^2),3=soil(0.35,1e-15m^2)",
       "a few voxels amid the soil grain"},
      {2, "ct2model build " SLABS " -o out.hdf --micro 160..90 --micro-permeability 2um",
       "the lower first"},
      {2, "ct2model build " SLABS " -o out.hdf --micro 90..160", "both are wanted"},
      {2,
       "ct2model build " SLABS " -o out.hdf --micro 90..160 --micro-permeability 2um --segmented 0",
       "leave --segmented out"},
      {3, "ct2model build " LAYERS " -o out.hdf --segmented", "labels 1, 2, 3"},
      {2, "ct2model build " LAYERS " -o out.hdf", "void-ratio is missing"},
      {3, "ct2model build " LAYERS " -o out.hdf --segmented 1=pore,2=grain", "label 3"},
      {3, "ct2model build " LAYERS " -o out.hdf --segmented 5", "all of the region is grain"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1 --threshold 0.5",
       "--threshold is for greys"},
      {2, "ct2model build " LAYERS " -o out.hdf --segmented 1=air", "--segmented 1=air"},
      {3, "ct2model sweep " LAYERS " --segmented 1", "no threshold to sweep"},
  };
  refusals_hold(ct2model_main, cases, sizeof cases / sizeof *cases);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_wrong_words), cmocka_unit_test(test_wrong_numbers),
      cmocka_unit_test(test_wrong_images), cmocka_unit_test(test_wrong_labels)};
  return cmocka_run_group_tests(tests, write_images, faults_end);
}
