/* libFuzzer: edits of a run file, or of a snapshot (by the first byte), as analyze reads them. */
#include "fuzz_edits.h"
#include "fuzz_reads.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static struct edit_base run, snapshot;
  if (run.size == 0) {
    edit_base_read("tests/fuzz/corpus/hdf5/run-run.hdf", 0, &run);
    edit_base_read("tests/fuzz/corpus/hdf5/run-snapshot.hdf", 0, &snapshot);
  }
  bool of_run = size == 0 || data[0] % 4 != 0;
  const char *path =
      edit_file(of_run ? &run : &snapshot, ".hdf", data + (size > 0), size - (size > 0));
  if (of_run)
    fuzz_read_run(path);
  else
    fuzz_read_snapshot(path);
  return fuzz_end(path, 0);
}
