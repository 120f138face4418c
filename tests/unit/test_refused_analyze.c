/* What analyze says to wrong words and files. */
#include "made_run.h"
#include "refusals.h"

int analyze_main(int argc, char **argv);
#define main analyze_main
#include "analyze/analyze.c"
#undef main

static int write_files(void **state) {
  if (faults_start(state) != 0) return 1;
  write_run("a", 1, N);
  write_run("c", 1, N / 2);
  FILE *file = fopen("text.hdf", "w");
  if (file == NULL) return 1;
  fputs("no HDF5\n", file);
  fclose(file);
  return mkdir("folder", 0700);
}

static void test_wrong_words(void **state) {
  (void)state;
  static const struct refusal cases[] = {
      {2, "analyze", "command"},
      {2, "analyze darcy", ""},
      {2, "analyze slice a.hdf --plane w=1mm", "--plane"},
      {2, "analyze slice a.hdf --plane x=1s", "--plane"},
      {2, "analyze slice a.hdf --plane x=5m", "spans"},
      {2, "analyze slice a.hdf --zoom 1mm,2mm", "--zoom"},
      {2, "analyze darcy a.hdf --plane x=1mm",
       "--plane is an option of slice, not of darcy (see analyze darcy --help)"},
      {2, "analyze report a.hdf -o -", "files are written, not standard output"},
      {2, "analyze report a.hdf -o out.pdf", "a page is HTML"},
  };
  refusals_hold(analyze_main, cases, sizeof cases / sizeof *cases);
}

static void test_wrong_files(void **state) {
  (void)state;
  static const struct refusal cases[] = {
      {3, "analyze darcy missing.hdf", "missing.hdf"},
      {3, "analyze darcy text.hdf", "text.hdf"},
      {3, "analyze darcy a-0000.hdf", "OUT.hdf"},
      {3, "analyze darcy a", "a: No such file or directory; a.hdf is there"},
      {3, "analyze darcy folder", "folder"},
      {3, "analyze darcy a.hdf c.hdf", "--mix"},
      {2, "analyze converge a.hdf", "too few arguments"},
  };
  refusals_hold(analyze_main, cases, sizeof cases / sizeof *cases);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_wrong_words),
                                     cmocka_unit_test(test_wrong_files)};
  return cmocka_run_group_tests(tests, write_files, faults_end);
}
