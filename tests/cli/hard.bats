#!/usr/bin/env bats
# The fast third of the hard cases (make hard runs all of them).

# bats test_tags=long
@test "the fast hard cases hold" {
  root=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  run "$root/scripts/hard" --fast
  echo "$output"
  [ "$status" -eq 0 ]
}
