#!/usr/bin/env bats
# An effect that is off costs nothing: no instruction per pair, no byte. Counted, not timed.

setup() {
  cd "$BATS_TEST_DIRNAME/../.."
  command -v valgrind > /dev/null || skip "valgrind is not installed (make deps)"
  ! nm "$BUILD/tests/bench_engine" | grep -q '__asan_init\|__tsan_init\|__ubsan' || skip "built with a sanitizer"
  grep -q avx2 /proc/cpuinfo || skip "this machine has no AVX2"
}

# bats test_tags=long
@test "effects of wcsph that are off cost no instruction and no byte: walls and their water" {
  scripts/count-effects /dev/null moving subvoxel
}

# bats test_tags=long
@test "effects of wcsph that are off cost no instruction and no byte: shifting and viscosity" {
  scripts/count-effects /dev/null shifting viscous
}
