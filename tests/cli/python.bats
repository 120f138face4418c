#!/usr/bin/env bats
# The Python module: its own tests, and the page that shows it.

bats_require_minimum_version 1.5.0
setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export TOSUI_BIN="$build/bin" PATH="$build/bin:$PATH" OMP_NUM_THREADS=1
}

@test "python: the module's own tests" {
  /usr/bin/python3 "$ROOT/tests/cli/python_test.py"
}

@test "python: the page's commands run as they stand" {
  cd "$BATS_TEST_TMPDIR"
  ln -s "$ROOT/data-samples" data-samples
  sed -n '/^```python$/,/^```$/p' "$ROOT/docs/python.md" | grep -v '^```' > page.py
  [ -s page.py ]
  PYTHONPATH="$ROOT/python" /usr/bin/python3 page.py > said
  grep -q "m^2" said
  grep -q "^(24, 24, 24) 5.5 mm/s at most" said
  ! command -v gnuplot || { [ -s surface/pictures/slice.png ] && [ -s surface/pictures/pdf.png ]; }
}

@test "python: make install puts the module where Python finds it" {
  # The instruction sets that make check built are enough here: others would be compiled under the tests beside this one.
  make -s -C "$ROOT" BUILD="$(dirname "$TOSUI_BIN")" ISAS="$(cat "$(dirname "$TOSUI_BIN")/isas")" install PREFIX=/usr DESTDIR="$BATS_TEST_TMPDIR/root" > "$BATS_TEST_TMPDIR/made"
  # Other tests run what was built: installing builds nothing anew.
  run ! grep -E "^ *(CC|LINK|MPICC) " "$BATS_TEST_TMPDIR/made"
  cd "$BATS_TEST_TMPDIR"
  PYTHONPATH="$PWD/root/usr/lib/python3/dist-packages" /usr/bin/python3 -c "import tosui; print(tosui.__file__)" | grep -q "$PWD/root"
}
