# Models of the small sample, each built once for all tests of a program; ROOT is the repository, ct2model on PATH.

# SIZE OUT.hdf: at a void ratio of 0.725. Kept beside the tests' programs, under a name that changes with ct2model and with
# the scan; tests that run side by side wait for the one that builds it.
sample_model() {
  local scan=$ROOT/data-samples/small program key kept
  program=$(command -v ct2model)
  key=$(cat "$program" "$scan"/*.png | sha256sum | cut -c1-16)
  kept=$(dirname "$(dirname "$program")")/tests/models/$key-$1
  mkdir -p "$(dirname "$kept")"
  (
    flock 9
    [ -s "$kept.hdf" ] || ct2model build "$scan" --void-ratio 0.725 --voxel-size 8.745um --size "$1" -o "$kept.hdf" --quiet > /dev/null
  ) 9> "$kept.lock" && cp "$kept.hdf" "$2"
}
