# Folders of slices with something wrong: gaps, duplicates, mixed kinds, contradicting voxel sizes.
setup_file() {
  export CT="$BUILD/bin/ct2model"
  export WORK="$BATS_FILE_TMPDIR"
}
setup() {
  mkdir -p "$BATS_TEST_TMPDIR/s"
  cd "$BATS_TEST_TMPDIR"
}
bats_require_minimum_version 1.5.0
run_ct() { run --separate-stderr "$CT" "$@"; }

# slices NUMBER...: s/slice_NUMBER.tif of 8x6 pixels; WIDTH, BITS and DPCM change them
slices() {
  python3 - "${WIDTH:-8}" "${BITS:-8}" "${DPCM:-1715}" "$@" <<'P'
import struct, sys
width, bits, dpcm = (int(v) for v in sys.argv[1:4])
for n in sys.argv[4:]:
    pixels = bytes((i * 7 + int(n)) % 251 for i in range(width * 6 * bits // 8))
    tags = [(256, 3, width), (257, 3, 6), (258, 3, bits), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1), (278, 3, 6),
            (279, 4, len(pixels)), (282, 5, 0), (283, 5, 0), (296, 3, 3)]
    at = 8 + len(pixels)
    behind = at + 2 + 12 * len(tags) + 4
    ifd = struct.pack("<H", len(tags))
    for tag, kind, value in tags:
        ifd += struct.pack("<HHII", tag, kind, 1, behind if kind == 5 else value)
    with open("s/slice_%s.tif" % n, "wb") as f:
        f.write(b"II" + struct.pack("<HI", 42, at) + pixels + ifd + bytes(4) + struct.pack("<II", dpcm, 1))
P
}

@test "a gap in the numbering is named, a stride is none" {
  slices 8 9 10 12 13
  run_ct info s
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"slice_10.tif to slice_12.tif"* ]]
  [[ "$output" == *"8x6x5 voxels in 5 files"*"slice_8.tif ... s/slice_13.tif"* ]]
  rm s/*
  slices 2 4 6 8 10 12
  run_ct info s
  [ -z "$stderr" ]
}

@test "two slices of one number are named" {
  slices 8 9 10 010 11
  run_ct info s
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"slice_010.tif and slice_10.tif carry the same number"* ]]
}

@test "one slice given twice is refused" {
  slices 1 2
  run_ct info s/slice_1.tif s
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"slice_1.tif: given twice"* ]]
}

@test "a slice of another size or type is named" {
  slices 1 2 3
  WIDTH=9 slices 4
  run_ct info s
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"slice_4.tif: 9x6, but the first slice is 8x6"* ]]
  BITS=16 slices 4
  run_ct info s
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"slice_4.tif: 16-bit unsigned, but the first slice is 8-bit unsigned"* ]]
}

@test "voxel sizes that contradict each other or the option are named" {
  slices 1 2 3
  run_ct build s --threshold 100 --mirror none -o m.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"5.83"*"TIFF resolution tags"* ]]
  for command in "build s --threshold 100 --mirror none -o m.hdf" "info s"; do
    run_ct $command --voxel-size 6um
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"TIFF resolution tags"*"5.83"*"--voxel-size 6"* ]]
  done
  DPCM=1000 slices 3
  run_ct info s
  [[ "$stderr" == *"slice_3.tif"*"10 um"*"5.83"* ]]
}

# wrong OPTION...: percent of voxels on the wrong side at full resolution, against the generator's truth; scan.json beside
wrong() {
  "$CT" build sand --void-ratio 0.725 --voxel-size 8.745um --filter none --mirror none --json --quiet "$@" -o w.hdf > scan.json
  /usr/bin/python3 -c '
import h5py, numpy as np
s = h5py.File("w.hdf")["model/solid"][()]
print(100 * (s != np.fromfile("truth.raw", np.uint8).reshape(s.shape)).mean())'
}
value() { python3 -c 'import json, sys; print(json.load(open("scan.json"))[sys.argv[1]])' "$1"; }
is() { awk "BEGIN { exit !($1) }" || { echo "$1"; false; }; }

# KIND
denoises() {
  for ratio in 10000 4; do # the first shows what partial volume and blur alone do
    "$BUILD/bin/generate_sand" --output sand --size 128x128x16 --voxel-size 8.745um --noise-ratio $ratio --truth truth.raw \
      --quiet
    [ $ratio = 4 ] || best=$(wrong > /dev/null; value specific_surface_per_m)
  done
  noisy=$(wrong)
  surface=$(value specific_surface_per_m)
  run_ct sweep sand --void-ratio 0.725 --voxel-size 8.745um
  [[ "$stderr" == *"contrast is only"*"--denoise nlm would take"* ]]
  for kind in "$@"; do
    clean=$(wrong --denoise $kind)
    is "$clean < $noisy"
    # Nearer to the surface without noise by more than half.
    is "($(value specific_surface_per_m) - $best)^2 < 0.25 * ($surface - $best)^2"
    # The forecast from walls in the slices' own planes, beside the whole scan's surface.
    is "($(value specific_surface_per_m) / $surface - $(value denoised_surface_ratio))^2 < 0.01"
    is "$(value void_ratio_error)^2 < 1e-6" # within the walls
    is "($(value denoised_void_ratio) - 0.725)^2 < 0.0025"
  done
}
@test "denoising takes voxels back to their side, and says what it does to the surface" { denoises nlm; }

# bats test_tags=long
@test "denoising by the median, and by as many threads as there are" {
  denoises median
  wrong --denoise nlm --threads 1 > /dev/null
  cp w.hdf one.hdf
  wrong --denoise nlm --threads 3 > /dev/null
  /usr/bin/python3 -c '
import h5py
a, b = (h5py.File(f)["model"] for f in ("one.hdf", "w.hdf"))
assert (a["solid"][()] == b["solid"][()]).all() and (a["wall_distance"][()] == b["wall_distance"][()]).all()'
}

@test "beam hardening and rings are told of, with what takes them out" {
  "$BUILD/bin/generate_sand" --output sand --size 128x128x16 --voxel-size 8.745um --ring 0.6 --beam 0.5 --quiet
  run_ct sweep sand --void-ratio 0.725 --voxel-size 8.745um --axis 60.66,69.62
  [[ "$stderr" == *"--correct beam"*"--correct rings"* ]] || { echo "$stderr"; false; }
}

# bats test_tags=long
@test "beam hardening and rings are measured, and taken out when asked" {
  "$BUILD/bin/generate_sand" --output sand --size 128x128x16 --voxel-size 8.745um --ring 0.6 --beam 0.5 --truth truth.raw \
    --quiet
  axis="--axis 60.66,69.62" # the generator's
  plain=$(wrong $axis)
  is "$(value beam_hardening) > 0.3 && $(value beam_hardening) < 0.65"
  is "$(value rings) > 0.03"
  run_ct sweep sand --void-ratio 0.725 --voxel-size 8.745um $axis
  [[ "$stderr" == *"--correct beam"*"--correct rings"* ]]
  beam=$(wrong $axis --correct beam)
  both=$(wrong $axis --correct beam,rings)
  is "$beam < $plain && $both < $beam"
  "$BUILD/bin/generate_sand" --output sand --size 128x128x16 --voxel-size 8.745um --ring 0 --truth truth.raw --quiet
  clean=$(wrong $axis)
  is "$(value rings) < 0.02 && $(value beam_hardening)^2 < 0.01"
  is "$both < 1.1 * $clean"
}

# bats test_tags=long
@test "the permeability tensor turns with the scan and is symmetric" {
  "$BUILD/bin/generate_sand" --output sand --size 64x64x64 --voxel-size 8.745um --ring 0 --quiet
  for flow in x y z; do
    "$CT" build sand --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,64,48,32 --flow $flow --mirror none --quiet \
      --size "$(case $flow in x) echo 12x8x16 ;; y) echo 8x16x12 ;; z) echo 16x12x8 ;; esac)" -o $flow.hdf > /dev/null
    cat > $flow.cfg <<END
scene = { name = "$flow"; method = "stokes"; };
model = { file = "$flow.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };
END
    "$BUILD/bin/sphsolve" run $flow.cfg -o run-$flow --tensor --json --quiet > $flow.json
  done
  /usr/bin/python3 - <<'P'
import h5py, json
k = {f: json.load(open(f + ".json"))["tensor"] for f in "xyz"}
# Of the lattice with the model's own sites: a coarser one closes other throats where rounding has turned a wall by .003 voxels.
for tensor in k.values():
    for i, file in enumerate(tensor["files"]):
        run = h5py.File(file)["run"].attrs
        tensor["k_m_per_s"][i][i] *= run["k_finest"] / run["k"]
z = k["z"]["k_m_per_s"]
mean = sum(z[i][i] for i in range(3)) / 3
for flow, axes in (("x", (1, 2, 0)), ("y", (2, 0, 1))):  # the scan's axes that are the model's
    t = k[flow]["k_m_per_s"]
    assert all(abs(t[i][j] - z[axes[i]][axes[j]]) < 1e-3 * mean for i in range(3) for j in range(3)), (flow, t, z)
assert all(z[i][i] > 0 for i in range(3)) and abs(z[0][0] - z[2][2]) > 1e-3 * mean
assert all(v["asymmetry"] < 0.01 for v in k.values())
P
}

# bats test_tags=long
@test "ours keeps more voxels on their side than bicubic-point, at the same void ratio" {
  BUILD="$BUILD" /usr/bin/python3 "$BATS_TEST_DIRNAME/../../scripts/studies/scan-study" --size 96x96x48 --voxel-size 8.745um \
    --noise 4 --ways bicubic,bicubic-point,nlm --output study
  for drawing in wrong surface-model surface-full; do grep -q "$drawing.svg" study/index.html; done
  python3 - <<'P'
import json
rows = {(r["noise_ratio"], r["way"]): r for r in json.load(open("study/rows.json"))}
assert [r["status"] for r in json.load(open("study/results.json"))] == ["pass"] * 4 # the ways compared; three void ratios
ours, paper = rows[4, "bicubic"], rows[4, "bicubic-point"]
assert ours["wrong"] < paper["wrong"] and abs(ours["surface_model"]) < abs(paper["surface_model"])
for row in rows.values():
    assert abs(row["void_ratio"] - 0.725) < 1e-3
assert rows[4, "nlm"]["surface"] < rows[4, "bicubic"]["surface"]
P
}

@test "what cannot be matched or is finer than the scan is said" {
  slices 1 2 3 4
  run_ct build s --void-ratio 0.9 --voxel-size 5.83um --size 16x12x8 -o m.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"finer than the scan's own 8x6x4 voxels"* ]]
  # Twelve grains and pores of nine greys each: nothing between 8/9 and 1 can be matched.
  awk 'BEGIN { for (i = 0; i < 4096; i++) printf "%c", int(i / 8) % 2 ? 120 + i % 3 : 30 + 4 * (i % 3 > 0) }' > few.raw
  run_ct build few.raw --raw 16x16x16:u8 --voxel-size 1um --void-ratio 0.75 -o m.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"too few grey levels"* ]]
}
