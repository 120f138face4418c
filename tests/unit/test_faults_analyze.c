/* Every allocation and every write of analyze fails once, on a small run. */
#include "common/provenance.h"
#include "faults.h"
#include "long_tests.h"
#include "made_run.h"

int analyze_main(int argc, char **argv);
#define main analyze_main
#include "analyze/analyze.c"
#undef main

static int write_runs(void **state) {
  if (faults_start(state) != 0) return 1;
  write_run("a", 1, N);
  write_run("b", 5, N);
  write_run("c", 1, N / 2);
  return 0;
}

#define CASE(name, command)                                                                        \
  static void name(void **state) {                                                                 \
    (void)state;                                                                                   \
    faults_both(analyze_main, NULL, command);                                                      \
  }
CASE(test_darcy, "analyze darcy a.hdf b.hdf -o out-darcy --quiet")
CASE(long_test_pdf, "analyze pdf a.hdf b.hdf -o out-pdf --quiet")
CASE(long_test_history, "analyze history a.hdf -o out-history --json --quiet")
CASE(long_test_slice, "analyze slice a.hdf --plane y=30um --thickness 10um -o out-slice --quiet")
CASE(long_test_converge, "analyze converge a.hdf c.hdf -o out-converge --quiet")
CASE(long_test_mix, "analyze pdf a.hdf c.hdf --mix -o out-mix")
CASE(test_report, "analyze report a.hdf b.hdf -o out.html --quiet")

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_darcy),         cmocka_unit_test(long_test_pdf),
      cmocka_unit_test(long_test_history),  cmocka_unit_test(long_test_slice),
      cmocka_unit_test(long_test_converge), cmocka_unit_test(long_test_mix),
      cmocka_unit_test(test_report)};
  long_tests_choose();
  return cmocka_run_group_tests(tests, write_runs, faults_end);
}
