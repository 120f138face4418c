#!/usr/bin/env bats
# The house: every effect is registered, on file and told of (arrows: structure.bats).

setup() { cd "$BATS_TEST_DIRNAME/../.."; }

@test "every effect of the registry stands in docs/physics" {
  files=$(sed -n 's/^#include "\(.*\)".*/\1/p' sphsolve/*/effects/registry.def; ls sphsolve/*/effects/registry.def)
  for effect in $(sed -n 's/^EFFECT(\([a-z0-9_]*\),.*/\1/p' $files); do
    grep -q "^\*\*$effect\.\*\*" docs/physics/*.md || { echo "$effect is not in docs/physics"; failed=1; }
  done
  [ -z "$failed" ]
}

@test "every file of effects/ is registered, and describes one effect" {
  for file in sphsolve/*/effects/*.h; do
    grep -q "^#include \"$file\"" "$(dirname "$file")/registry.def" || { echo "$file is not registered"; failed=1; }
    [ "$(grep -c '^EFFECT(' "$file")" -eq 1 ] || { echo "$file does not describe one effect"; failed=1; }
  done
  [ -z "$failed" ]
}

@test "no name of an effect is compared as a string" {
  files=$(sed -n 's/^#include "\(.*\)".*/\1/p' sphsolve/*/effects/registry.def; ls sphsolve/*/effects/registry.def)
  for effect in $(sed -n 's/^EFFECT(\([a-z0-9_]*\),.*/\1/p' $files); do
    ! grep -rnE "str(n)?cmp\([^;]*\"$effect\"" sphsolve || { echo "$effect is compared"; failed=1; }
  done
  [ -z "$failed" ]
}

@test "per cents are printed by one rule, which has no exponents" {
  run grep -rnE '%\.[0-2]g %%' common ct2model sphsolve analyze --include='*.c'
  [ "$status" -eq 1 ] || { echo "$output"; false; }
}

@test "sources are formatted (make format)" {
  # Versions differ in what they make of the same rules; Debian 12 has this one.
  clang-format --version 2> /dev/null | grep -q 'version 14\.' || skip "clang-format 14 is not installed"
  files=$(git ls-files '*.c' '*.h' '*.cc' 2> /dev/null) && [ -n "$files" ] || skip "no checkout"
  run clang-format --dry-run -Werror $files
  [ "$status" -eq 0 ] || { echo "$output"; false; }
}

@test "files that comments name are there, and READMEs name them all" {
  run /usr/bin/python3 "$BATS_TEST_DIRNAME/named_files.py"
  [ "$status" -eq 0 ] || { echo "$output"; false; }
}
