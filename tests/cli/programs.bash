# Called by setup_file of the tests of the programs: ROOT, the programs in PATH, one thread, a folder of the file's own.
programs_setup() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH" OMP_NUM_THREADS=1
  cd "$BATS_FILE_TMPDIR"
}
setup() { cd "$BATS_FILE_TMPDIR"; }
