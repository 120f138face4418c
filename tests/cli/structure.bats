#!/usr/bin/env bats
# scripts/check-structure: holds for this tree, and finds what it is there to find.

setup() {
  ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
}

@test "arrows point one way, and numbers outside constants.def do not become more" {
  cd "$ROOT"
  run scripts/check-structure "${BUILD:-build}"
  [ "$status" -eq 0 ] || { echo "$output"; false; }
}

write() { # FILE TEXT: a source, compiled as the Makefile does
  mkdir -p "$(dirname "$1")" "$(dirname "build/obj/$1")"
  printf '%s\n' "$2" > "$1"
  case $1 in *.c) gcc -I. -c "$1" -o "build/obj/$1.o" ;; esac
}

@test "a circle of calls, two folders that call each other, a number and an arrow upward are found" {
  cd "$BATS_TEST_TMPDIR"
  git init -q .
  mkdir scripts
  printf '# limits\nnumbers common 1\n' > scripts/structure.txt
  write common/a.c 'void b(void); void a(void); void a(void) { b(); }'
  write common/b.c 'void b(void); const double step = 0.37; void b(void) { }'
  write sphsolve/scene/s.c 'void a(void); void s(void); void s(void) { a(); }'
  write sphsolve/plan/p.c 'void s(void); void p(void); void p(void) { s(); }'
  run "$ROOT/scripts/check-structure"
  [ "$status" -eq 0 ] || { echo "$output"; false; }
  # Tables of descriptors are data, as are names in comments and texts; and a registry makes no circle.
  write common/b.c 'extern void (*const table[])(void); void b(void); const double step = 0.37; void b(void) { table[0](); } /* 0.41 */'
  write common/t.c 'void a(void); void (*const table[])(void); void (*const table[])(void) = {a};'
  run "$ROOT/scripts/check-structure"
  [ "$status" -eq 0 ] || { echo "$output"; false; }
  write common/b.c 'void a(void); void b(void); void b(void) { a(); }'
  run "$ROOT/scripts/check-structure"
  [ "$status" -eq 1 ] && [[ "$output" == *"common: 2 files in circles of calls, 0 allowed: common/a.c calls b of common/b.c; common/b.c calls a"* ]]
  # Less than allowed is told, and held by --lower.
  [[ "$output" == *"--lower holds what has fallen: numbers common"* ]]
  write common/b.c 'void b(void); void b(void) { }'
  run "$ROOT/scripts/check-structure" --lower
  [ "$status" -eq 0 ] && [ "$(cat scripts/structure.txt)" = "# limits" ]
  write common/b.c 'void b(void); const double step = 0.37; void b(void) { }'
  run "$ROOT/scripts/check-structure"
  [ "$status" -eq 1 ] && [[ "$output" == *"common: 1 numbers in code, 0 allowed"*"common/b.c 1"* ]]
  printf 'X(step, 0.37)\n' > common/constants.def
  write common/b.c 'void b(void); void b(void) { }'
  write sphsolve/scene/t.c 'void p(void); void t(void); void t(void) { p(); }'
  run "$ROOT/scripts/check-structure"
  [ "$status" -eq 1 ] && [[ "$output" == *"sphsolve/plan and sphsolve/scene call each other"* ]]
  [[ "$output" == *"sphsolve/scene/t.c calls p of sphsolve/plan/p.c, which is above it"* ]]
  rm sphsolve/scene/t.c # its object is left over
  write common/b.c '#include <hdf5.h>'  2> /dev/null || printf '#include <hdf5.h>\n' > common/b.c
  run "$ROOT/scripts/check-structure"
  [ "$status" -eq 1 ] && [[ "$output" == *"common/b.c includes hdf5"* && "$output" != *"call each other"* ]]
}
