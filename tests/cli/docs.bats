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
