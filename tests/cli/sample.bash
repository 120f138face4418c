# Models of the small sample, each built once for all tests of a program; ROOT is the repository, ct2model on PATH.

# SIZE OUT.hdf: at a void ratio of 0.725, with the scan's blur left in it, which takes a third of the time. Kept beside the
# tests' programs, under a name that changes with ct2model and with the scan; tests that run side by side wait for the one
# that builds it. Half of a size is made with it, as a level.
sample_model() {
  local scan=$ROOT/data-samples/small finest=$1 levels=1 program key kept model
  case $1 in
    32x32x14 | 16x16x7) finest=32x32x14 levels=3 ;;
  esac
  program=$(command -v ct2model)
  key=$(cat "$program" "$scan"/*.png | sha256sum | cut -c1-16)
  kept=$(dirname "$(dirname "$program")")/tests/models/$key-$finest
  model=$kept.hdf
  [ "$1" = $finest ] || model=$kept-${1%%x*}.hdf
  mkdir -p "$(dirname "$kept")"
  (
    flock 9
    [ -s "$model" ] || ct2model build "$scan" --void-ratio 0.725 --voxel-size 8.745um --size $finest --levels $levels \
      --blur keep -o "$kept.hdf" --quiet > /dev/null
  ) 9> "$kept.lock" && cp "$model" "$2"
}
