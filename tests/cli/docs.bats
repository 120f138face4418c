#!/usr/bin/env bats
# Each command in the documentation works as it stands.

setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH"
}

run_blocks() { # runs all ```sh blocks of a page, in order, beside a copy of the samples
  cd "$BATS_TEST_TMPDIR"
  ln -s "$ROOT/data-samples" data-samples
  cp -r "$ROOT/examples" examples
  sed -n '/^```sh$/,/^```$/p' "$1" | grep -v '^```' > commands.sh
  [ -s commands.sh ]
  bash -e -x commands.sh > log 2>&1 || { tail -30 log; false; }
}

@test "readme: a scan, a scene of four lines, a report" {
  run_blocks "$ROOT/README.md"
  [ -s out.html ]
}

@test "tutorial: from a scan to a number" {
  run_blocks "$ROOT/docs/tutorial.md"
  [ -s tutorial/converge/converge.json ] && [ -s tutorial/report.html ]
}

@test "calibration: from a measured void ratio to its share in the error of k" {
  run_blocks "$ROOT/docs/calibration.md"
  k() { sed -n 's/.*"k": \([0-9.e-]*\),/\1/p' "calibration/run-$1.json"; }
  awk -v a="$(k 0.705)" -v b="$(k 0.725)" -v c="$(k 0.745)" 'BEGIN { exit !(0 < a && a < b && b < c) }'
  [ "$(wc -l < calibration/study/calibration.csv)" -eq 7 ]
}

@test "seepage: a column, two heads, a dam on soil" {
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/seepage.md"
  python3 - <<'END'
import json, re
k = json.load(open("seepage/darcy/darcy.json"))
a = 1000 * 1e-6 * 0.6**2 / (0.4**3 * 5e-3**2)
assert abs(k["k_m_per_s"] / (9.80665 / a) - 1) < 0.001, k["k_m_per_s"]
v, head = map(float, re.findall(r"(?:v|head) ([0-9.e-]+)", open("seepage/heads.txt").read()))
assert abs(v / 0.01862 - 1) < 0.05 and abs(head / 0.1 - 1) < 0.03, (v, head)
dam, paper = [list(map(float, re.findall(r" ([0-9.]+)", line))) for line in open("seepage/dam.txt") if "bottom after" in line]
for time, share, pressure in (dam, paper):
    assert abs(share - 0.5) < 0.02 and abs(pressure / 2940 - 1) < 0.04, (share, pressure)
assert abs(dam[0] / 0.449 - 1) < 0.1 and abs(paper[0] / 0.324 - 1) < 0.1, (dam, paper)
END
}

@test "examples: each study runs, and runs again only what changed" {
  local bin=${PATH%%:*}/
  cp -r "$ROOT/examples" "$BATS_TEST_TMPDIR" && cd "$BATS_TEST_TMPDIR/examples"
  unset MAKEFLAGS MFLAGS # those of a make that runs this test are not meant for these
  local settings=("BIN=$bin" "SLICES=$ROOT/data-samples/small" "ROOT=$ROOT")
  make -C specimen "${settings[@]}" SIZES="16x16x7 32x32x14" > log 2>&1 || { cat log; false; }
  make -C calibration "${settings[@]}" SIZE=16x16x7 THRESHOLDS="58 66" > log 2>&1 || { cat log; false; }
  make -C gradients "${settings[@]}" SIZE=16x16x7 VOID_RATIOS=0.942 GRADIENTS="5 10" > log 2>&1 || { cat log; false; }
  make -C seepage "${settings[@]}" GRAIN_SIZES="5" > log 2>&1 || { cat log; false; }
  [ -s specimen/out/report.html ] && [ -s specimen/out/converge/converge.json ] && [ -s gradients/out/darcy/darcy.json ]
  awk -F, 'NR > 1 { if ($2 <= e || $3 <= k) exit 1; e = $2; k = $3; n++ } END { exit n != 3 }' calibration/out/calibration.csv
  awk -F, 'NR == 2 { exit ($2 / $4 - 1) ^ 2 > 1e-6 }' seepage/out/seepage.csv
  run make -C specimen "${settings[@]}" SIZES="16x16x7 32x32x14"
  [[ "$output" == *"Nothing to be done"* ]]
  touch specimen/out/model-32x32x14.hdf
  run make -C specimen "${settings[@]}" SIZES="16x16x7 32x32x14"
  [ "$status" -eq 0 ] && [[ "$output" == *"run-32x32x14"* && "$output" != *"model-16x16x7.hdf -o"* ]]
}

@test "the examples of --help use options that exist" {
  for program in ct2model sphsolve analyze; do
    for command in $("$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p'); do
      help=$("$program" "$command" --help)
      known=$(echo "$help" | sed -n '/^Options:/,/^Example:/p' | grep -oE -- '--[a-z][a-z-]*' | sort -u)
      for option in $(echo "$help" | sed -n '/^Example:/,$p' | grep -oE -- ' --[a-z][a-z-]*' | sort -u); do
        grep -qx -- "$option" <<< "$known" || { echo "$program $command: $option"; false; }
      done
      [ "$(echo "$help" | wc -l)" -le 45 ]
    done
  done
}
