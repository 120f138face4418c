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
  sed -n '/^```sh$/,/^```$/p' "$1" | grep -v '^```' > commands.sh
  [ -s commands.sh ]
  bash -e -x commands.sh > log 2>&1 || { tail -30 log; false; }
}

@test "tutorial: from a scan to a number" {
  run_blocks "$ROOT/docs/tutorial.md"
  [ -s tutorial/converge/converge.json ] && [ -s tutorial/report.html ]
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
