#!/usr/bin/env bats
# The house: arrows point one way, and every effect is registered, on file and told of.

setup() { cd "$BATS_TEST_DIRNAME/../.."; }

@test "includes point from programs to their modules to common" {
  run scripts/check-includes
  [ "$status" -eq 0 ] || { echo "$output"; false; }
}

@test "every effect of the registry stands in docs/physics" {
  for effect in $(sed -n 's/^EFFECT(\([a-z0-9_]*\)).*/\1/p' sphsolve/plan/registry.def); do
    grep -q "^\*\*$effect\.\*\*" docs/physics/*.md || { echo "$effect is not in docs/physics"; failed=1; }
  done
  [ -z "$failed" ]
}

@test "no file of ours is over 600 lines" {
  run awk 'FNR == 601 { print FILENAME }' $(git ls-files '*.c' '*.h' '*.cc' 2>/dev/null || find common ct2model sphsolve analyze -name '*.[ch]')
  [ -z "$output" ] || { echo "$output"; false; }
}
