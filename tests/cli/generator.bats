#!/usr/bin/env bats
# The generator of the sample scan: same bytes for the same options, exact void ratio, sand that holds
# together and lets water through.

setup_file() {
  case ${BUILD:=build} in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
  export GENERATE="$BUILD/bin/generate_sand" FOLDER
  FOLDER=$(mktemp -d)
  SMALL="$BATS_TEST_DIRNAME/../../data-samples/small"
  export SMALL
  "$GENERATE" --quiet --output "$FOLDER/dense" --size 64x60x40 --voxel-size 11.66um \
    --truth "$FOLDER/dense.raw" --threads 1
  "$GENERATE" --quiet --output "$FOLDER/loose" --size 64x60x40 --voxel-size 11.66um \
    --void-ratio 0.942 --truth "$FOLDER/loose.raw"
}

teardown_file() { rm -rf "$FOLDER"; }

# value KEY FILE: a number of a flat JSON file
value() { sed -nE "s/.*\"$1\": \"?([-+.0-9e]+).*/\1/p" "$2"; }

# true_in EXPRESSION: awk's verdict
true_in() { awk "BEGIN { exit !($1) }"; }

solid_voxels() { tr -d '\000' < "$1" | wc -c; }

@test "the committed small stack is made again, byte for byte" {
  "$GENERATE" --quiet --output "$FOLDER/small" --format png8 --size 128x128x56 \
    --voxel-size 8.745um --void-ratio 0.725 --seed 2006
  [ "$(ls "$SMALL" | grep -c png)" -eq 56 ]
  diff -r --exclude README.md "$SMALL" "$FOLDER/small"
}

@test "one thread and two give the same bytes; another seed does not" {
  "$GENERATE" --quiet --output "$FOLDER/two" --size 64x60x40 --voxel-size 11.66um --threads 2
  diff -r "$FOLDER/dense" "$FOLDER/two"
  "$GENERATE" --quiet --output "$FOLDER/other" --size 64x60x40 --voxel-size 11.66um --seed 2
  ! cmp -s "$FOLDER/dense/slice_0020.tif" "$FOLDER/other/slice_0020.tif"
}

@test "the void ratio of the true voxels is exact to 1e-4, and the one in sand.json is theirs" {
  for case in dense:0.725 loose:0.942; do
    solid=$(solid_voxels "$FOLDER/${case%:*}.raw")
    total=$(stat -c %s "$FOLDER/${case%:*}.raw")
    [ "$total" -eq $((64 * 60 * 40)) ]
    # e(s) moves by N / s^2 = 2e-5 a voxel at this size
    true_in "($total - $solid) / $solid - ${case#*:} < 1e-4 && ${case#*:} - ($total - $solid) / $solid < 1e-4"
    [ "$(value solid_voxels "$FOLDER/${case%:*}/sand.json")" -eq "$solid" ]
    e=$(value void_ratio "$FOLDER/${case%:*}/sand.json")
    true_in "$e - ($total - $solid) / $solid < 1e-8 && ($total - $solid) / $solid - $e < 1e-8"
  done
}

# bats test_tags=long
@test "grains are 105 to 215 um, touch, hardly had to be cut, and form one skeleton" {
  for case in dense loose; do
    json="$FOLDER/$case/sand.json"
    min=$(sed -nE 's/.*"min": ([^,]+),.*/\1/p' "$json")
    max=$(sed -nE 's/.*"max": ([^}]+)}.*/\1/p' "$json")
    true_in "$min >= 105e-6 && $max <= 215e-6 && $max - $min > 30e-6"
    true_in "$(value coordination "$json") > 4 && $(value coordination "$json") < 9"
    true_in "$(value overlap_cut "$json") < 0.01"
    true_in "$(value largest_cluster "$json") > 0.95"
  done
}

# crosses FILE PHASE: number of axes along which the phase connects the two ends (faces of voxels)
crosses() {
  od -An -v -tu1 -w1 "$1" | awk -v nx=64 -v ny=60 -v nz=40 -v phase="$2" '
    { voxel[NR - 1] = $1 + 0 }
    function visit(i) { if (voxel[i] == phase && seen[i] != axis) { seen[i] = axis; queue[++last] = i } }
    END {
      for (axis = 1; axis <= 3; axis++) {
        last = 0; reached = 0
        for (i = 0; i < NR; i++) {
          x = i % nx; y = int(i / nx) % ny; z = int(i / (nx * ny))
          if ((axis == 1 && x == 0) || (axis == 2 && y == 0) || (axis == 3 && z == 0)) visit(i)
        }
        for (head = 1; head <= last; head++) {
          i = queue[head]
          x = i % nx; y = int(i / nx) % ny; z = int(i / (nx * ny))
          if ((axis == 1 && x == nx - 1) || (axis == 2 && y == ny - 1) || (axis == 3 && z == nz - 1))
            { reached = 1; break }
          if (x > 0) visit(i - 1)
          if (x < nx - 1) visit(i + 1)
          if (y > 0) visit(i - nx)
          if (y < ny - 1) visit(i + nx)
          if (z > 0) visit(i - nx * ny)
          if (z < nz - 1) visit(i + nx * ny)
        }
        axes += reached
      }
      print axes
    }'
}

# bats test_tags=long
@test "pores and grains both reach from end to end in x, y and z" {
  [ "$(crosses "$FOLDER/dense.raw" 0)" -eq 3 ]
  [ "$(crosses "$FOLDER/dense.raw" 1)" -eq 3 ]
  [ "$(crosses "$FOLDER/loose.raw" 0)" -eq 3 ]
}

# bats test_tags=long
@test "quartz peaks at grey 100, pores near 22, in 16-bit TIFF as grey * 256" {
  # one uncompressed strip behind the 8-byte header
  for slice in "$FOLDER"/dense/slice_00[0-3]?.tif; do
    od -An -v -tu2 -w2 -j8 -N$((64 * 60 * 2)) "$slice"
  done | awk '
    { count[int($1 / 256 / 4)]++ }
    END {
      for (bin = 1; bin < 64; bin++) {
        smooth = (count[bin - 1] + count[bin] + count[bin + 1])
        if (bin < 14) { if (smooth > low) { low = smooth; pore = 4 * bin + 2 } }
        else if (smooth > high) { high = smooth; quartz = 4 * bin + 2 }
      }
      print pore, quartz
      exit !(pore >= 14 && pore <= 28 && quartz >= 96 && quartz <= 104)
    }'
}

@test "help works; wrong usage ends with 2 and says what is wrong" {
  run "$GENERATE" --help
  [ "$status" -eq 0 ]
  [[ $output == *"--void-ratio"* ]]
  run "$GENERATE"
  [ "$status" -eq 2 ]
  [[ $output == *"--output"* ]]
  for wrong in "--size 64x64" "--void-ratio 7" "--voxel-size 5.83" "--format gif" "--seed x" "--nonsense" "stray"; do
    # shellcheck disable=SC2086
    run "$GENERATE" --output "$FOLDER/none" $wrong
    [ "$status" -eq 2 ]
    [ -n "$output" ]
    [ ! -e "$FOLDER/none" ]
  done
}

@test "a folder that cannot be made ends with 1" {
  run "$GENERATE" --output /proc/nowhere/sand
  [ "$status" -eq 1 ]
  [[ $output == */proc/nowhere/sand* ]]
}

@test "a new run leaves no slice or description of an older one" {
  mkdir -p "$FOLDER/again"
  touch "$FOLDER/again/slice_0999.tif" "$FOLDER/again/slice_0000.png" "$FOLDER/again/notes.txt"
  "$GENERATE" --quiet --output "$FOLDER/again" --size 16x16x8 --voxel-size 11.66um
  [ "$(ls "$FOLDER/again" | grep -c slice_)" -eq 8 ]
  [ -e "$FOLDER/again/notes.txt" ]
  [ -e "$FOLDER/again/sand.json" ]
}

# bats test_tags=long
@test "a finer truth is the same sand in the same place; other grains and sizes are other sands" {
  "$GENERATE" --quiet --output "$FOLDER/fine" --size 64x60x40 --voxel-size 11.66um --truth "$FOLDER/fine.raw" \
    --truth-refine 2
  cmp "$FOLDER/dense/slice_0020.tif" "$FOLDER/fine/slice_0020.tif"
  python3 - "$FOLDER/dense.raw" "$FOLDER/fine.raw" << 'P'
import sys
coarse, fine = (open(name, "rb").read() for name in sys.argv[1:])
nx, ny, nz = 64, 60, 40
assert len(fine) == 8 * len(coarse)
wrong = 0
for z in range(nz):
    for y in range(ny):
        rows = [fine[((2 * z + k) * 2 * ny + 2 * y + j) * 2 * nx:][:2 * nx] for k in (0, 1) for j in (0, 1)]
        for x in range(nx):
            solid = sum(row[2 * x] + row[2 * x + 1] for row in rows)
            here = coarse[(z * ny + y) * nx + x]
            wrong += solid > 4 and not here or solid < 4 and here
assert wrong < 0.01 * len(coarse), wrong   # another place would have half of them wrong
P
  for grains in "--grains round" "--grains long" "--fines 0.1" "--grain-size 300um"; do
    "$GENERATE" --quiet --output "$FOLDER/kind" --size 64x60x40 --voxel-size 11.66um $grains
    ! cmp -s "$FOLDER/dense/slice_0020.tif" "$FOLDER/kind/slice_0020.tif"
    true_in "$(value void_ratio "$FOLDER/kind/sand.json") > 0.7248"
  done
}
