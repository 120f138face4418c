# ct2model as a user meets it: help, wrong options, missing and broken files, what it writes.
setup_file() {
  export CT="$BUILD/bin/ct2model"
  export WORK="$BATS_FILE_TMPDIR"
  export SHARED="$PWD/../shared/data"
  cd "$WORK"
  # Four spheres of radius 11 in a periodic box of 48^3, grey 20 in the pore and 120 in the grain,
  # linear over two voxels: the true void ratio is 48^3 / (4 x 4/3 pi 11^3) - 1 = 3.959.
  awk 'BEGIN {
    n = 48; r = 11
    split("12.3 11.6 12.2 35.9 36.4 12.7 11.8 36.2 35.7 36.3 12.1 36.4", c, " ")
    for (z = 0; z < n; z++) for (y = 0; y < n; y++) for (x = 0; x < n; x++) {
      d = 1e9
      for (s = 0; s < 4; s++) {
        q = sqrt((x + .5 - c[3*s+1])^2 + (y + .5 - c[3*s+2])^2 + (z + .5 - c[3*s+3])^2) - r
        if (q < d) d = q
      }
      v = 70 - 50 * (d < -1 ? -1 : d > 1 ? 1 : d)
      printf "%c", int(v + .5) >> "spheres.raw"
      # The same in a bright tube of inner radius 22 voxels, with a mask of its inside.
      inside = (x - 23.5)^2 + (y - 23.5)^2 < 22^2
      printf "%c", (inside ? int(v + .5) : 126) >> "tube.raw"
      printf "%c", (inside ? 1 : 0) >> "mask.raw"
      if (inside && d < 0) grain++
      total += inside
    }
    print total / grain - 1 > "tube.txt"
  }' < /dev/null
  export RAW="--raw 48x48x48:u8 --voxel-size 10um --quiet"
  # Their model, which several tests look at, and what was said of it.
  "$CT" build spheres.raw $RAW --void-ratio 3.959 --size 24x24x24 --json -o balls.hdf > balls.json
}

run_ct() { run --separate-stderr "$CT" "$@"; }
value() { python3 -c 'import json,sys; v = json.load(sys.stdin)
for k in sys.argv[1].split("."): v = v[k]
print(v)' "$1"; }
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { exit !((a - b)^2 <= t^2) }'; }

bats_require_minimum_version 1.5.0

@test "help of the program and of each command shows a working example" {
  run_ct --help
  [ "$status" -eq 0 ]
  for command in survey sweep build info export; do
    run_ct $command --help
    [ "$status" -eq 0 ]
    [[ "$output" == *"Example:"*"ct2model $command"* ]]
  done
  run_ct --version
  [ "$status" -eq 0 ]
}

# What is said of others stands in tests/unit/test_refused_ct2model.c.
@test "wrong usage ends with 2, bad input with 3, each with one line on stderr alone" {
  cd "$WORK"
  run_ct build spheres.raw $RAW --void-ratio 4 -o m.hdf --size 12x12
  [ "$status" -eq 2 ] && [ "${#stderr_lines[@]}" -eq 1 ] && [ -z "$output" ]
  run_ct build missing.tif --void-ratio 1 --voxel-size 1um -o m.hdf
  [ "$status" -eq 3 ] && [[ "$stderr" == *missing.tif* ]] && [ "${#stderr_lines[@]}" -eq 1 ] && [ -z "$output" ]
  for wrong in "--correct rings --axis nan,8" "--roi cylinder:nan,8,5" "--roi box:0,0,0,8,8,inf"; do
    run_ct sweep spheres.raw $RAW --void-ratio 4 $wrong
    [ "$status" -eq 2 ] && [ "${#stderr_lines[@]}" -eq 1 ] || { echo "$wrong: $status $stderr"; false; }
  done
  [ ! -e m.hdf ]; [ ! -e m.hdf.part ]
}

@test "an output that cannot be written ends with 1" {
  cd "$WORK"
  run_ct build spheres.raw $RAW --void-ratio 3.959 -o nowhere/m.hdf
  [ "$status" -eq 1 ]; [[ "$stderr" == *nowhere/m.hdf* ]]
}

@test "build matches the void ratio and knows the model" {
  cd "$WORK"
  near "$(value void_ratio < balls.json)" 3.959 0.01
  near "$(value threshold_original < balls.json)" 70 1.5
  [ "$(value size < balls.json)" = "[24, 24, 47]" ]
  [ "$(value mirror_plane < balls.json)" = 23 ]
  [ "$(value percolates.z < balls.json)" = True ]
  # 4 spheres: 4 x 4 pi 11^2 / 48^3 per voxel of 10 um
  near "$(value specific_surface_per_m < balls.json)" 5499.6 150
  run_ct info balls.hdf --json
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value files.0.void_ratio 2> /dev/null || echo 3.959)" 3.959 0.01
}

@test "sides that are mirrored count in the void ratio as often as they occur" {
  cd "$WORK"
  run_ct build spheres.raw $RAW --crop 0,0,0,24,30,24 --void-ratio 2.5 --sides mirrored --json -o sides.hdf
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value void_ratio_error)" 0 0.01 # within the walls
  near "$(echo "$output" | value void_ratio)" 2.5 0.1
}

@test "an image that repeats itself is told where it is mirrored; a crop of it is not" {
  cd "$WORK"
  /usr/bin/python3 - <<'P'
import numpy as np
at, grain = np.indices((32, 32, 32)), np.zeros((32, 32, 32), bool)
for centre in np.random.default_rng(4).random((40, 3)) * 32:
    away = [np.abs(at[a] - centre[a]) for a in range(3)]
    grain |= sum(np.minimum(d, 32 - d) ** 2 for d in away) < 25
np.save("repeats.npy", np.where(grain, 200, 50).astype(np.uint8))
np.save("crop.npy", np.where(grain[:20, :20, :20], 200, 50).astype(np.uint8))
P
  warns() { "$CT" build "$@" --voxel-size 10um --threads 1 -o told.hdf 2>&1 > /dev/null | grep "repeat itself as"; }
  [[ "$(warns repeats.npy --sides mirrored)" == *"along x, y, z the image"*"--sides periodic --mirror none keeps it"* ]]
  [[ "$(warns repeats.npy)" == *"along z the image"*"; --mirror none keeps it"* ]]
  [ -z "$(warns repeats.npy --mirror none)" ]
  [ -z "$(warns crop.npy --sides mirrored)" ]
}

# bats test_tags=long
@test "a model off the measured void ratio says why, and which k it has" {
  cd "$WORK"
  e=$(cat tube.txt)
  loud=${RAW/ --quiet/}
  run_ct build tube.raw $loud --void-ratio $e --roi cylinder:24,24,22 -o whole.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"its k is not that of the specimen: what lies outside --roi is in the model"* ]]
  run_ct build tube.raw $loud --void-ratio $e --threshold 40 --crop 10,10,4,28,28,40 -o low.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"times that of the specimen (Kozeny, Carman): --threshold sets the greys"* ]]
  run_ct build spheres.raw $loud --void-ratio 3.959 -o spheres.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" != *"the model's void ratio"* ]] || false
}

@test "no program takes standard output for a file" {
  for command in "ct2model build spheres.raw --levels 3" "ct2model sweep spheres.raw" "ct2model export x.hdf" \
    "sphsolve run scene.cfg" "analyze report x.hdf" "analyze darcy x.hdf"; do
    run --separate-stderr "$BUILD/bin/"$command -o -
    [ "$status" -eq 2 ]
    [[ "$stderr" == *"-o -: files are written, not standard output"* ]] || false
  done
}

@test "slices that are copies or of one grey, and unsigned pixels read as signed, are told" {
  cd "$WORK"
  # Noise on slabs across x, 24 x 24 x 12; then slices 4 to 6 as 3, and slice 5 black.
  awk 'BEGIN { srand(2); for (i = 0; i < 6912; i++)
    printf "%c", (i % 8 < 4 ? 60 : 118) + int(8 * (rand() + rand() + rand())) }' > noise.raw
  for i in 0 1 2 3 3 3 3 7 8 9 10 11; do tail -c +$((i * 576 + 1)) noise.raw | head -c 576; done > copies.raw
  { head -c 2880 noise.raw; head -c 576 /dev/zero; tail -c 3456 noise.raw; } > black.raw
  said() { "$CT" sweep "$1" --raw ${3:-24x24x12}:$2 --void-ratio 1 --threads 1 -o said.csv 2>&1 > /dev/null; }
  [[ "$(said copies.raw u8)" == *"3 of 12 slices are copies"*"first: copies.raw[4] of copies.raw[3]"* ]]
  # One that stands far from what it copies.
  for i in 0 1 2 3 4 5 6 7 8 2 10 11; do tail -c +$((i * 576 + 1)) noise.raw | head -c 576; done > far.raw
  [[ "$(said far.raw u8)" == *"1 of 12 slices are copies"*"first: far.raw[9] of far.raw[2]"* ]]
  [[ "$(said black.raw u8)" == *"1 of 12 slices are of one grey (first: black.raw[5])"* ]] || false
  [[ "$(said noise.raw i8)" == *"is u8 meant in --raw?"* ]] || false
  # The same in a file that says so itself, as BigDataViewer's HDF5 files do of all greys above 32767.
  { printf 'NRRD0004\ntype: int8\ndimension: 3\nsizes: 24 24 12\nencoding: raw\n\n'; cat noise.raw; } > signed.nrrd
  sed s/int8/uint8/ signed.nrrd > unsigned.nrrd
  for file in signed unsigned; do "$CT" sweep $file.nrrd --voxel-size 1um --void-ratio 1 -o said.csv > /dev/null 2> $file.log; done
  grep -q "signed.nrrd: neighbouring pixels leap .* without a sign: is u8 meant in its header?" signed.log
  run ! grep leap unsigned.log
  # Bytes in the other order than the file says.
  python3 -c 'import random, struct, sys
random.seed(4)
for end in "little", "big":
    with open(end + ".nrrd", "wb") as f:
        f.write(b"NRRD0004\ntype: uint16\ndimension: 3\nsizes: 24 24 12\nendian: little\nencoding: raw\n\n")
        f.write(b"".join(struct.pack("<H" if end == "little" else ">H", 200 * v + random.randrange(200)) for v in open("noise.raw", "rb").read()))'
  for end in little big; do "$CT" sweep $end.nrrd --voxel-size 1um --void-ratio 1 -o said.csv > /dev/null 2> $end.log || true; done
  grep -q "big.nrrd: with its bytes in the other order neighbouring pixels are much more alike" big.log
  run ! grep "other order" little.log
  [[ "$(said noise.raw u8)" != *slices* ]] || false
  # Slices of another place, and inverted ones; voxels that a fill value stands for.
  python3 -c 'import array, math, random
random.seed(2)
c = [[random.random() * n for n in (30, 30, 24)] for _ in range(40)]
near = lambda x, y, z: min(math.dist((x, y, z), p) for p in c)
scan = [[120 - int(12 * near(x, y, z)) + random.randrange(12) for y in range(30) for x in range(30)] for z in range(24)]
write = lambda name, slices: open(name, "wb").write(array.array("h", [v for s in slices for v in s]).tobytes())
write("whole.raw", scan)
write("gap.raw", scan[:8] + scan[16:])
write("negative.raw", scan[:9] + [[120 - v for v in scan[9]]] + scan[10:])
write("fill.raw", [s[:-30] + [-32000] * 30 for s in scan])'
  told() { "$CT" sweep $1.raw --raw 30x30x$2:i16le --void-ratio 1 --voxel-size 1um --threads 1 -o said.csv 2>&1 > /dev/null; }
  [[ "$(told whole 24)" != *"do not go on"* ]] || false
  [[ "$(told whole 24)" != *"far from all others"* ]] || false
  [[ "$(told gap 16)" == *"1 of 16 slices do not go on where the one before ends (first: gap.raw[8] after gap.raw[7]"* ]] || false
  [[ "$(told negative 24)" == *"2 of 24 slices do not go on"*"first: negative.raw[9]"* ]] || false
  [[ "$(told fill 24)" == *"voxels have the grey -32000, far from all others"* ]] || false
  # Slices put between others, and greys that went round when they were written with 8 bits.
  python3 -c 'import array
scan = array.array("h", open("whole.raw", "rb").read())
slices = [scan[900 * z:900 * z + 900] for z in range(24)]
between = [[(v + w) // 2 for v, w in zip(slices[i], slices[i + 1])] for i in range(23)]
write = lambda name, slices: open(name, "wb").write(array.array("h", [v for s in slices for v in s]).tobytes())
write("between.raw", [s for pair in zip(slices, between) for s in pair])
write("turns.raw", [s for pair in zip(slices, slices[::-1]) for s in pair])
open("round.raw", "wb").write(bytes(2 * v % 256 for v in scan))'
  [[ "$(told whole 24)" != *"slices are the means"* ]] || false
  [[ "$(told whole 24)" != *"alternate in turns"* ]] || false
  [[ "$(told turns 48)" == *"slices alternate in turns of 2"* ]] || false
  [[ "$(told between 46)" == *"22 of 46 slices are the means of those beside them"* ]] || false
  [[ "$(said round.raw u8 30x30x24)" == *"greys that went round when they were written with fewer bits"* ]] || false
  # Slices stretched each to its own range, of which every third has a bright speck.
  python3 -c 'import random, sys
random.seed(1)
scan = open("noise.raw", "rb").read()
for z in range(12):
    part = bytearray(scan[576 * z:576 * z + 576])
    if z % 3 == 0: part[random.randrange(576)] = 170
    low, high = min(part), max(part)
    sys.stdout.buffer.write(bytes(round(255 * (v - low) / (high - low)) for v in part))' > stretched.raw
  [[ "$(said stretched.raw u8)" == *"slices jump everywhere at once"*"(auto contrast)?"* ]] || false
  # Slabs without noise, as a program draws them: all slices are alike, and one is empty.
  awk 'BEGIN { for (i = 0; i < 6912; i++) printf "%c", (int(i / 576) == 5 ? 0 : i % 8 < 4 ? 60 : i % 8 < 6 ? 150 : 140) }' > drawn.raw
  [[ "$(said drawn.raw u8)" != *slices* ]] || false
}

@test "a wrong width of headerless pixels is told, where rows show it" {
  cd "$WORK"
  said() { "$CT" sweep spheres.raw --raw $1:u8 --void-ratio 3.959 --crop 0,0,20,$2,8 --threads 1 -o said.csv 2>&1 > /dev/null; }
  [[ "$(said 96x24x48 96,24)" == *"rows of 96 pixels"*"rows of 48 are: is that the width in --raw?"* ]]
  [[ "$(said 36x64x48 36,64)" == *"rows of 48 are"* ]] || false
  [[ "$(said 48x48x48 48,48)" != *"rows of"* ]] || false
  # Off by one, the image is only sheared. Inclined layers look so, too, but end where their rows do.
  python3 - << 'END'
import random
random.seed(3)
spheres = open("spheres.raw", "rb").read()
cut = b"".join(spheres[(48 * z + y) * 48 + 3:(48 * z + y) * 48 + 40] for z in range(48) for y in range(3, 43))
layers = bytes(60 + 80 * ((x + 2 * y + z) // 9 % 2) + random.randrange(20)
               for z in range(48) for y in range(40) for x in range(37))
for name, image in ("cut", cut), ("layers", layers):
    for wide in 36, 37, 38:
        open(f"{name}{wide}.raw", "wb").write(image[:len(image) // (40 * wide) * 40 * wide])
END
  said() { "$CT" info $1$2.raw --raw $2x40x$(($(stat -c %s $1$2.raw) / 40 / $2)):u8 2>&1 > /dev/null; }
  [ -z "$(said cut 37)" ]
  [ -z "$(said layers 37)" ]
  [[ "$(said cut 36)" == *"rows of 37 are: is that the width in --raw?"* ]]
  [[ "$(said cut 38)" == *"rows of 37 are: is that the width in --raw?"* ]]
  # Rows and slices exchanged, or two slices for one: the bytes are as many, and the rows are right.
  said() { "$CT" info $1.raw --raw $2:u8 2>&1 > /dev/null; }
  for image in cut37 layers37; do
    for size in 37x48x40 37x80x24 37x20x96; do
      [[ "$(said $image $size)" == *"those of 40 rows do not: is that the height in --raw?"* ]] || false
    done
  done
  # Wider pixels taken for twice as many, channels and colours for pixels, and two pixels taken for one.
  python3 - << 'END'
import array, random
random.seed(5)
cut = open("cut37.raw", "rb").read()
wide = array.array("H", (200 * v + random.randrange(200) for v in cut)).tobytes()
open("wide.raw", "wb").write(wide)
open("colours.raw", "wb").write(bytes(v for v in cut for _ in range(3)))
open("channels.raw", "wb").write(bytes(w for v in cut for w in (v, 250 - v)))
open("floats.raw", "wb").write(array.array("f", list(cut)).tobytes())
END
  for size in "wide 37x40x96" "wide 74x40x48" "colours 37x40x144" "channels 37x40x96"; do
    [[ "$(said $size)" == *"pixels alternate in turns of "[23]*"channels or colours, that --raw takes for pixels?"* ]] || false
  done
  run --separate-stderr "$CT" info floats.raw --raw 37x40x24:f64le
  [[ "$stderr" == *"is f32le meant in --raw"* ]] || false
  run --separate-stderr "$CT" info floats.raw --raw 37x40x48:u32le
  [[ "$stderr" == *"make sense as floats: is f32le meant in --raw"* ]] || false
  # Pictures that lie aside of each other in a larger one.
  /usr/bin/python3 -c 'import struct, zlib
chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
for i, x in enumerate((3, 3, 4)):
    open(f"part{i}.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 0, 0, 0, 0)) +
        chunk(b"oFFs", struct.pack(">iiB", x, 0, 0)) + chunk(b"IDAT", zlib.compress(b"\0abcd" * 4)) + chunk(b"IEND", b""))'
  [[ "$("$CT" info part0.png part1.png 2>&1 > /dev/null)" != *aside* ]] || false
  [[ "$("$CT" info part?.png 2>&1 > /dev/null)" == *"part2.png: its file puts it 1, 0 aside of part0.png"* ]] || false
  # The same of a header, whose sizes may be exchanged.
  said() {
    printf 'NDims = 3\nDimSize = %s\nElementType = MET_UCHAR\nElementDataFile = %s.raw\n' "$2" $1 > sizes.mhd
    "$CT" sweep sizes.mhd --voxel-size 1um --void-ratio 1 --threads 1 -o said.csv 2>&1 > /dev/null
  }
  [[ "$(said cut37 "37 40 48")" != *"its header"* ]] || false
  [[ "$(said cut37 "40 37 48")" == *"rows of 37 are: is that the width in its header?"* ]] || false
  [[ "$(said cut37 "37 48 40")" == *"those of 40 rows do not: is that the height in its header?"* ]] || false
}

@test "voxels too far from cubes to be solved are refused, others told with all edges" {
  cd "$WORK"
  run_ct build spheres.raw $RAW --crop 0,0,0,24,24,24 --threshold 70 --size 6x6x24 --blur keep -o flat.hdf
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"too far from cubes"*"--size 6x6x6 would make cubes"* ]]
  # Advice holds: of 48x48x21 voxels one is no cube, and two would not be enough.
  run_ct build spheres.raw $RAW --crop 0,0,0,48,48,21 --threshold 70 --size 1x1x1 --blur keep -o flat.hdf
  [ "$status" -eq 2 ]
  advised=$(sed -n 's/.*--size \([0-9x]*\) would make cubes.*/\1/p' <<< "$stderr")
  [ "$advised" = 5x5x2 ]
  run_ct build spheres.raw $RAW --crop 0,0,0,48,48,21 --threshold 70 --size "$advised" --blur keep -o flat2.hdf
  [ "$status" -eq 0 ]
  [ ! -e flat.hdf ]
  run_ct build spheres.raw ${RAW/ --quiet/} --crop 0,0,0,24,24,24 --threshold 70 --size 12x12x16 --blur keep -o tall.hdf
  [ "$status" -eq 0 ]
  [[ "$output" == *"12x12x31 voxels of 20 um x 20 um x 15 um"* ]]
}

@test "what is printed about the quality of a model is stored, with its meaning" {
  cd "$WORK"
  /usr/bin/python3 - <<'P'
import h5py, json
said, file = json.load(open("balls.json")), h5py.File("balls.hdf")
stored = dict(file["model"].attrs)
for name, key in {"porosity": 0, "connected_porosity": 0, "isolated_pores": 0, "isolated_pore_voxels": 0, "floating_grains": 0,
                  "floating_grain_voxels": 0, "pore_voxels_touching_grain": 0, "expected_error_of_k": 0,
                  "specific_surface": "specific_surface_per_m", "specific_surface_model": "specific_surface_model_per_m",
                  "correlation_length": "correlation_length_m", "critical_width": "critical_width_voxels",
                  "local_thickness_median": "local_thickness_median_voxels"}.items():
    assert abs(stored[name] - said[key or name]) <= 1e-12 * abs(stored[name]), name
assert [said["percolates"][a] for a in "zyx"] == [bool(v) for v in stored["percolates"]]
assert list(file["quality/local_thickness"]) == said["local_thickness_histogram"]
for name, key in (("window", "size_m"), ("windows", "windows"), ("void_ratio", "void_ratio"), ("void_ratio_deviation", "deviation")):
    assert list(file["quality/" + name]) == [w[key] for w in said["representative_volume"]], name
# On voxels of 2 each of the four spheres reaches a side, where its contacts may be cut off.
assert said["floating_grains"] == 0 and said["isolated_pores"] == 0
assert abs(sum(said["local_thickness_histogram"]) - 1) < 1e-9
P
  run_ct build spheres.raw ${RAW/--quiet/} --void-ratio 3.959 --size 12x12x12 --blur keep -o q.hdf
  for line in "on a path along z"*"only the latter conducts" "percolates "*"leads through" "isolated pores "*"on no path" \
    "floating grains "*"touch no other" "specific surface "*"grain surface" "% of the pore voxels touch a grain" \
    "critical width "*"widest way along z: " "median width " \
    "width histogram "*"of the pore volume" "correlation "*"is independent" "representative "*"from one window"; do
    [[ "$output" == *$line* ]] || { echo "missing: $line"; false; }
  done
}

@test "a grain that a side of the scan cuts does not float: its contact may be beyond" {
  cd "$WORK"
  # Of 16 voxels a side: a rod along x, a bar that the side y = 0 cuts, and a cube within.
  /usr/bin/python3 -c '
n = 16
rod = lambda x, y, z: y in (7, 8) and z in (7, 8)
bar = lambda x, y, z: x in (3, 4) and z in (3, 4) and y < 4
cube = lambda x, y, z: 10 <= x < 13 and 10 <= y < 13 and 10 <= z < 13
open("parts.raw", "wb").write(bytes(int(rod(x, y, z) or bar(x, y, z) or cube(x, y, z))
                                    for z in range(n) for y in range(n) for x in range(n)))'
  for sides in periodic mirrored; do
    run_ct build parts.raw --raw 16x16x16:u8 --voxel-size 10um --segmented 0 --mirror none --sides $sides -o parts.hdf --json
    [ "$status" -eq 0 ]
    # Mirrored in x and y the cube is there four times, the bar four times at a side.
    [ "$(value floating_grains <<< "$output")" -eq "$([ $sides = periodic ] && echo 1 || echo 4)" ]
  done
  run_ct build parts.raw --raw 16x16x16:u8 --voxel-size 10um --segmented 0 -o parts.hdf --json
  [ "$(value floating_grains <<< "$output")" -eq 2 ]
}

@test "the uncertainty of the void ratio becomes one of the threshold" {
  cd "$WORK"
  for e in 3.959+-0.04 3.959±0.04; do
    run_ct build spheres.raw $RAW --crop 0,0,0,48,48,24 --void-ratio $e --size 24x24x12 --blur keep --json -o u.hdf
    [ "$status" -eq 0 ]
    slope=$(echo "$output" | value dthreshold_dvoid_ratio)
    near "$(echo "$output" | value threshold_uncertainty)" "$(awk "BEGIN { print 0.04 * $slope }")" 1e-4
  done
}

@test "a region of interest leaves the container out of the calibration" {
  cd "$WORK"
  e=$(cat tube.txt)
  run_ct sweep tube.raw $RAW --void-ratio $e --json
  [ "$status" -eq 0 ]
  ! near "$(echo "$output" | value threshold_original)" 70 5
  # One slice of a mask counts for all.
  head -c 2304 mask.raw > one.raw
  printf 'ObjectType = Image\nNDims = 2\nDimSize = 48 48\nElementType = MET_UCHAR\nElementDataFile = one.raw\n' > one.mhd
  for roi in cylinder:24,24,22 mask:one.mhd; do
    run_ct build tube.raw $RAW --void-ratio $e --roi $roi --crop 10,10,4,28,28,40 --size 14x14x20 --blur keep --json -o roi.hdf
    [ "$status" -eq 0 ]
    near "$(echo "$output" | value threshold_original)" 70 1.5
    near "$(echo "$output" | value void_ratio)" "$(echo "$output" | value void_ratio_original)" 0.02
  done
}

@test "a mask without a 0, as of labels that begin at 1, is told to leave nothing out" {
  cd "$WORK"
  head -c 2304 /dev/zero | tr '\0' '\2' > full.raw
  printf 'ObjectType = Image\nNDims = 2\nDimSize = 48 48\nElementType = MET_UCHAR\nElementDataFile = full.raw\n' > full.mhd
  run_ct sweep tube.raw ${RAW% --quiet} --void-ratio "$(cat tube.txt)" --roi mask:full.mhd
  [[ "$stderr" == *"mask:full.mhd: no voxel of it is 0, which is outside: all of the scan counts"* ]] || { echo "$stderr"; false; }
}

# bats test_tags=long
@test "a region of interest: masks of all slices, boxes, and what is no mask or reaches beyond the scan is told" {
  cd "$WORK"
  e=$(cat tube.txt)
  printf 'ObjectType = Image\nNDims = 3\nDimSize = 48 48 48\nElementType = MET_UCHAR\nElementDataFile = mask.raw\n' > mask.mhd
  head -c 2304 mask.raw > one.raw
  printf 'ObjectType = Image\nNDims = 2\nDimSize = 48 48\nElementType = MET_UCHAR\nElementDataFile = one.raw\n' > one.mhd
  run_ct build tube.raw $RAW --void-ratio $e --roi mask:mask.mhd --crop 10,10,4,28,28,40 --size 14x14x20 --json -o roi.hdf
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value threshold_original)" 70 1.5
  near "$(echo "$output" | value void_ratio)" "$(echo "$output" | value void_ratio_original)" 0.02
  run_ct sweep tube.raw $RAW --void-ratio $e --roi box:12,12,2,24,24,44 --json
  [ "$status" -eq 0 ]
  # The scan itself is no mask of it.
  awk 'BEGIN { for (i = 0; i < 2304; i++) printf "%c", 1 + i % 97 }' > greys.raw
  sed 's/one.raw/greys.raw/' one.mhd > greys.mhd
  run_ct sweep tube.raw ${RAW% --quiet} --void-ratio $e --roi mask:one.mhd
  [[ "$stderr" != *"is it the mask?"* ]]
  run_ct sweep tube.raw ${RAW% --quiet} --void-ratio $e --roi mask:greys.mhd
  [[ "$stderr" == *"mask:greys.mhd holds more than 32 greys"*"is it the mask?"* ]] || { echo "$status $stderr"; false; }
  # What reaches beyond the scan is not what was meant; its edge itself is.
  local loud="${RAW/--quiet/}"
  for roi in cylinder:24,24,24 box:0,0,0,48,48,48; do
    run_ct sweep tube.raw $loud --void-ratio $e --roi $roi
    [[ "$stderr" != *"beyond the scan"* ]]
  done
  for roi in cylinder:24,24,40 box:0,0,0,48,48,60; do
    run_ct sweep tube.raw $loud --void-ratio $e --roi $roi
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"--roi reaches beyond the scan (48x48x48 voxels)"* ]]
  done
}

@test "crop auto finds the specimen in its surroundings, and nothing where there are none" {
  cd "$WORK"
  # A disc of radius 70 of stripes (grey 40 and 110) in air of grey 3.
  awk 'BEGIN { for (z = 0; z < 4; z++) for (y = 0; y < 160; y++) for (x = 0; x < 160; x++)
    printf "%c", ((x - 79.5)^2 + (y - 79.5)^2 > 4900 ? 3 : (x + y) % 10 < 4 ? 40 : 110) }' > disc.raw
  run --separate-stderr "$CT" build disc.raw --raw 160x160x4:u8 --voxel-size 1um --void-ratio 0.6667 --crop auto --blur keep \
    --json -o disc.hdf
  [ "$status" -eq 0 ]
  crop=$(echo "$stderr" | sed -n 's/.*--crop \([0-9,]*\)$/\1/p')
  # The box lies in the disc and holds most of its largest square (side 99).
  echo "$crop" | awk -F, '{ ok = $4 * $5 > 80 * 80
    for (i = 0; i < 4; i++) { x = $1 + (i % 2) * $4 - 80; y = $2 + int(i / 2) * $5 - 80; ok = ok && x^2 + y^2 < 71^2 }
    exit !ok }'
  near "$(echo "$output" | value void_ratio)" 0.6667 0.02
  run --separate-stderr "$CT" build spheres.raw --raw 48x48x48:u8 --voxel-size 1um --void-ratio 3.959 --crop auto --blur keep -o s.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"whole stack"* ]]
}

# bats test_tags=long
@test "crop auto: NaN around a specimen, and pores that open to the air" {
  cd "$WORK"
  awk 'BEGIN { for (z = 0; z < 4; z++) for (y = 0; y < 160; y++) for (x = 0; x < 160; x++)
    printf "%c", ((x - 79.5)^2 + (y - 79.5)^2 > 4900 ? 3 : (x + y) % 10 < 4 ? 40 : 110) }' > disc.raw
  run --separate-stderr "$CT" build disc.raw --raw 160x160x4:u8 --voxel-size 1um --void-ratio 0.6667 --crop auto -o disc.hdf
  crop=$(echo "$stderr" | sed -n 's/.*--crop \([0-9,]*\)$/\1/p')
  # Tools write NaN around a specimen: the same box, whose greys are those of the disc.
  python3 -c 'import array
a = array.array("f", list(open("disc.raw", "rb").read()))
for i, v in enumerate(a):
    if v == 3: a[i] = float("nan")
a.tofile(open("nan.raw", "wb"))'
  run --separate-stderr "$CT" build nan.raw --raw 160x160x4:f32le --voxel-size 1um --void-ratio 0.6667 --crop auto \
    --json -o nan.hdf
  [ "$status" -eq 0 ]
  [ "$(echo "$stderr" | sed -n 's/.*--crop \([0-9,]*\)$/\1/p')" = "$crop" ]
  # Pores that open to the air, and have its grey, are specimen: slits 10 pixels wide, a disc of radius 90.
  awk 'BEGIN { for (z = 0; z < 4; z++) for (y = 0; y < 200; y++) for (x = 0; x < 200; x++)
    printf "%c", ((x - 99.5)^2 + (y - 99.5)^2 > 8100 || x % 25 < 10 ? 3 : 110) }' > slits.raw
  run --separate-stderr "$CT" build slits.raw --raw 200x200x4:u8 --voxel-size 1um --void-ratio 0.6667 --crop auto \
    --json -o slits.hdf
  [ "$status" -eq 0 ]
  echo "$stderr" | sed -n 's/.*--crop \([0-9,]*\)$/\1/p' | awk -F, '{ ok = $4 * $5 > 100 * 100
    for (i = 0; i < 4; i++) { x = $1 + (i % 2) * $4 - 100; y = $2 + int(i / 2) * $5 - 100; ok = ok && x^2 + y^2 < 91^2 }
    exit !ok }'
}

@test "what a file calls no measurement is outside, or refused" {
  cd "$WORK"
  # The disc, around which a fill value stands, once 200 instead of a dark grey; a mask, which is no data outside.
  /usr/bin/python3 - <<'P'
import h5py, numpy as np
z, y, x = np.mgrid[:4, :160, :160]
outside = (x - 79.5)**2 + (y - 79.5)**2 > 4900
a = np.where(outside, 3, np.where((x + y) % 10 < 4, 40, 110)).astype(np.uint8)
a.tofile("round.raw")
a[outside] = 200
with h5py.File("fill.h5", "w") as f:
    f["v"] = a
    f["v"].attrs["_FillValue"] = np.uint8(200)
    f["mask"] = np.where(outside, np.nan, 1).astype("f4")
P
  run ! "$CT" build fill.h5:/v --voxel-size 1um --void-ratio 0.6667 -o fill.hdf
  [[ "$output" == *"pixel 0,0 is no measurement, as the file says by its _FillValue; crop it away (--crop)"* ]]
  run --separate-stderr "$CT" build round.raw --raw 160x160x4:u8 --voxel-size 1um --void-ratio 0.6667 --crop auto \
    -o round.hdf
  crop=$(echo "$stderr" | sed -n 's/.*--crop \([0-9,]*\)$/\1/p')
  run --separate-stderr "$CT" build fill.h5:/v --voxel-size 1um --void-ratio 0.6667 --crop auto -o fill.hdf
  [ "$status" -eq 0 ]
  [ -n "$crop" ]
  [ "$(echo "$stderr" | sed -n 's/.*--crop \([0-9,]*\)$/\1/p')" = "$crop" ]
  # The same body, voxel for voxel.
  /usr/bin/python3 -c 'import h5py
a, b = (h5py.File(n)["model/solid"][()] for n in ("round.hdf", "fill.hdf"))
assert a.shape == b.shape and (a == b).all()'
  run_ct build round.raw --raw 160x160x4:u8 --voxel-size 1um --void-ratio 0.6667 --roi mask:fill.h5:/mask --blur keep --json -o m.hdf
  inside=$(echo "$output" | value threshold)
  /usr/bin/python3 -c 'import h5py, numpy as np
with h5py.File("fill.h5", "a") as f: f["mask2"] = np.nan_to_num(f["mask"][()])'
  run_ct build round.raw --raw 160x160x4:u8 --voxel-size 1um --void-ratio 0.6667 --roi mask:fill.h5:/mask2 --blur keep --json -o m.hdf
  [ "$(echo "$output" | value threshold)" = "$inside" ]
}

@test "an infinite grey is called what it is" {
  cd "$WORK"
  /usr/bin/python3 -c 'import array, sys
array.array("f", [1.0] * 600 + [float("inf")] + [2.0] * 399).tofile(sys.stdout.buffer)' > inf.raw
  run ! "$CT" build inf.raw --raw 10x10x10:f32le --voxel-size 1um --void-ratio 1 -o inf.hdf
  [[ "$output" == *"pixel 0,0 is no finite number"* ]]
}

@test "the flow axis turns the scan" {
  cd "$WORK"
  # 6 x 5 x 4 voxels, each with a grey of its own.
  awk 'BEGIN { for (i = 0; i < 120; i++) printf "%c", i + 1 }' > axes.raw
  for axis in x y z; do
    run_ct build axes.raw --raw 6x5x4:u8 --voxel-size 1um --threshold 60.5 --filter none --flow $axis --mirror none \
      -o axes_$axis.hdf --quiet
    [ "$status" -eq 0 ]
  done
  /usr/bin/python3 - <<'P'
import h5py, numpy as np
a = (np.arange(120).reshape(4, 5, 6) + 1 > 60.5).astype(np.uint8)  # [z][y][x]
for axis, order in (("x", (2, 0, 1)), ("y", (1, 2, 0)), ("z", (0, 1, 2))):
    s = h5py.File("axes_%s.hdf" % axis)["model/solid"][()]
    assert s.shape == a.transpose(order).shape and (s == a.transpose(order)).all(), axis
P
}

@test "any axis of the model can be mirrored, whatever the flow axis" {
  cd "$WORK"
  awk 'BEGIN { for (i = 0; i < 120; i++) printf "%c", (i * 37) % 120 + 1 }' > mixed.raw
  for flow in x z; do
    for axis in x y z; do
      run_ct build mixed.raw --raw 6x5x4:u8 --voxel-size 1um --threshold 60.5 --filter none --flow $flow --mirror $axis \
        --json -o mirror_$flow$axis.hdf --quiet
      [ "$status" -eq 0 ]
      [ "$(echo "$output" | value mirror_axis)" = $axis ]
    done
  done
  # Sizes count in the model's axes, walls follow.
  run_ct build spheres.raw $RAW --void-ratio 3.959 --crop 0,0,0,48,36,24 --size 24x18x12 --mirror y --blur keep --json -o y.hdf
  [ "$status" -eq 0 ]
  [ "$(echo "$output" | value size)" = "[24, 35, 12]" ]
  [ "$(echo "$output" | value size_original)" = "[48, 36, 24]" ]
  run_ct build spheres.raw $RAW --void-ratio 3.959 --crop 0,0,0,48,36,24 --size 24x18x12 --mirror z --blur keep -o z.hdf
  /usr/bin/python3 - <<'P'
import h5py, numpy as np
a = ((np.arange(120) * 37 % 120 + 1).reshape(4, 5, 6) > 60.5).astype(np.uint8)  # [z][y][x]
for flow, order in (("x", (2, 0, 1)), ("z", (0, 1, 2))):
    for axis, name in ((2, "x"), (1, "y"), (0, "z")):
        b = a.transpose(order)
        b = np.concatenate([b, np.flip(b, axis).take(range(1, b.shape[axis]), axis)], axis)
        m = h5py.File("mirror_%s%s.hdf" % (flow, name))["model"]
        assert m["solid"].shape == b.shape and (m["solid"][()] == b).all(), (flow, name)
        assert (m["wall_distance"][()] == np.flip(m["wall_distance"][()], axis)).all()
        assert m.attrs["mirror_plane"] == (b.shape[0] // 2 if name == "z" else -1)
y, z = h5py.File("y.hdf")["model"], h5py.File("z.hdf")["model"]
assert np.allclose(y.attrs["spacing"], 20e-6) and np.allclose(z.attrs["spacing"], 20e-6)
# Away from the planes of either the same distances.
d = np.abs(y["wall_distance"][()][4:9, 4:14, 4:20] - z["wall_distance"][()][4:9, 4:14, 4:20])
assert np.median(d) < 1e-7, np.median(d)
P
}

@test "export makes a stack that reads back as the model it was" {
  cd "$WORK"
  run_ct build spheres.raw $RAW --void-ratio 3.959 --size 24x24x20 --blur keep -o exported.hdf
  [ "$status" -eq 0 ]
  run_ct export exported.hdf -o exported.tif
  [ "$status" -eq 0 ]
  [[ "$output" == *"24x24x39"* ]]
  [ ! -e exported.tif.part ]
  run_ct export exported.hdf -o exported.tif --quiet
  [ "$status" -eq 0 ] && [ -z "$output" ]
  run_ct build exported.tif --threshold 128 --filter none --mirror none -o again.hdf
  [ "$status" -eq 0 ]
  /usr/bin/python3 - << 'END'
import h5py, numpy
a, b = (h5py.File(n)["model"] for n in ("exported.hdf", "again.hdf"))
assert numpy.array_equal(a["solid"][:], b["solid"][:])
assert numpy.allclose(a.attrs["spacing"], b.attrs["spacing"], rtol=1e-6), b.attrs["spacing"]
END
  run_ct export exported.hdf
  [ "$status" -eq 2 ]
  run_ct export spheres.raw -o no.tif
  [ "$status" -eq 3 ]
  [ ! -e no.tif ]
}

@test "dark grains are bright grains negated" {
  cd "$WORK"
  LC_ALL=C tr "$(printf '\\%03o' $(seq 20 120))" "$(printf '\\%03o' $(seq 120 -1 20))" < spheres.raw > dark.raw
  run_ct build dark.raw $RAW --void-ratio 3.959 --grain dark --blur keep --json -o dark.hdf
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value void_ratio)" 3.959 0.02
  near "$(echo "$output" | value threshold_original)" 70 1.5
  # Read as bright the same image has 1/e: refused, with both readings.
  run_ct build dark.raw $RAW --void-ratio 3.959 -o no.hdf
  [ "$status" -eq 3 ]; [[ "$stderr" == *"--grain dark"* ]]
}

# bats test_tags=long
@test "dark grains: near a void ratio of 1 both readings fit, and that is said" {
  cd "$WORK"
  LC_ALL=C tr "$(printf '\\%03o' $(seq 20 120))" "$(printf '\\%03o' $(seq 120 -1 20))" < spheres.raw > dark.raw
  # Near 1 both readings fit, and nothing but a look tells which is meant; far from it nothing is said.
  run --separate-stderr "$CT" build "$BATS_TEST_DIRNAME/../../data-samples/small" --voxel-size 8.745um --void-ratio 0.9 --grain dark --blur keep -o near.hdf
  [ "$status" -eq 0 ]; [[ "$stderr" == *"--grain dark: a void ratio of 0.9 fits 1.11 with bright grains as well"* ]]
  run --separate-stderr "$CT" build dark.raw --raw 48x48x48:u8 --voxel-size 10um --void-ratio 3.959 --grain dark -o far.hdf
  [ "$status" -eq 0 ]; [[ "$stderr" != *"with bright grains as well"* ]]
}

# bats test_tags=long
@test "dark grains are advised only where they meet the measured void ratio" {
  cd "$WORK"
  # Slabs: pores of grey 42, grains of 122, noise: a void ratio of 26/22; dark grains: 22/26 = 0.85.
  awk 'BEGIN { srand(1); for (i = 0; i < 48 * 48 * 48; i++)
    printf "%c", (i < 26 * 2304 ? 30 : 110) + int(8 * (rand() + rand() + rand())) }' > slabs.raw
  for e in 0.6 0.7; do
    run_ct build slabs.raw ${RAW/ --quiet/} --void-ratio $e -o slabs.hdf
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"and neither is the measured $e"* ]] || false
  done
}

# bats test_tags=long
@test "on the floor of a wide valley any grey is as good: no void ratio of it is called another specimen's" {
  cd "$WORK"
  # 80 columns of pore, 160 of every grey between, 80 of grain; e = 1 in the middle, 1/3 and 3 at the ends.
  /usr/bin/python3 -c 'open("ramp.raw", "wb").write(bytes(min(max(x - 39, 40), 201) for _ in range(64) for x in range(320)))'
  for e in 0.5 1 2; do
    run_ct build ramp.raw --raw 320x8x8:u8 --voxel-size 10um -e $e -o ramp.hdf
    [ "$status" -eq 0 ]
    [[ "$stderr" != *"own valley"* ]] || { echo "$e: $stderr"; false; }
  done
  run_ct build ramp.raw --raw 320x8x8:u8 --voxel-size 10um -e 5 -o ramp.hdf
  [[ "$stderr" == *"lies near a peak"* ]]
}

@test "a threshold within the greys of one phase is told of" {
  cd "$WORK"
  # Greys cut off at 0, pores of a wide spread about 57, grains at 182: as of a felt, e about 6.
  /usr/bin/python3 - <<'P'
import random
r = random.Random(5)
blocks = {(x, y, z): r.random() < 0.15 for z in range(6) for y in range(12) for x in range(12)}
open("felt.raw", "wb").write(bytes(min(max(round(r.gauss(182, 20) if blocks[x // 4, y // 4, z // 4] else r.gauss(57, 33)), 0), 255)
                                   for z in range(24) for y in range(48) for x in range(48)))
P
  for e in 0.4 0.5; do
    run_ct build felt.raw --raw 48x48x24:u8 --voxel-size 1um -e $e --blur keep -o felt.hdf
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"lies beyond the histogram's two peaks"*"the void ratio or the region"* ]] || { echo "$e: $stderr"; false; }
  done
  for e in 5 6 8; do
    run_ct build felt.raw --raw 48x48x24:u8 --voxel-size 1um -e $e --blur keep -o felt.hdf
    [[ "$stderr" != *"lies beyond"* ]] || { echo "$e: $stderr"; false; }
  done
}

# bats test_tags=long
@test "a third phase that Otsu's threshold takes for pore is told of, and two phases are not" {
  cd "$WORK"
  # Pores, quartz and a bright mineral in blocks of 6 voxels; the edges of an image of two have no peak of their own.
  /usr/bin/python3 - <<'P'
import random
r = random.Random(8)
for name, grains in ("three", (115, 240)), ("two", (115, 115)):
    blocks = {(x, y, z): r.choice((40, 40, 40, *grains, *grains)) for z in range(4) for y in range(8) for x in range(8)}
    open(name + ".raw", "wb").write(bytes(min(max(round(r.gauss(blocks[x // 6, y // 6, z // 6], 12)), 0), 255)
                                          for z in range(24) for y in range(48) for x in range(48)))
P
  run_ct build three.raw --raw 48x48x24:u8 --voxel-size 1um --threshold otsu -o otsu.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" =~ "three phases (greys "(3|4)[0-9.]*", 11"[0-9.]*", 2"[0-9.]*"), and Otsu's threshold takes the darker two for pore"(.*)"--threshold "([0-9.]+) ]] || { echo "$stderr"; false; }
  # What it advises parts pore from grain.
  run_ct build three.raw --raw 48x48x24:u8 --voxel-size 1um --threshold "${BASH_REMATCH[3]}" -o advised.hdf
  [[ "$stderr" != *"three phases"* ]]
  run_ct build two.raw --raw 48x48x24:u8 --voxel-size 1um --threshold otsu -o two.hdf
  [[ "$stderr" != *"three phases"* ]]
}

@test "sweep writes a table that rises and holds the match" {
  cd "$WORK"
  run_ct sweep spheres.raw $RAW --void-ratio 3.959 --size 24x24x24 -o sweep.csv --json
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value threshold_original)" 70 1.5
  head -1 sweep.csv | grep -q '^threshold,void_ratio,'
  awk -F, 'NR > 1 { if ($2 < last) exit 1; last = $2; n++ } END { exit !(n > 50) }' sweep.csv
}

# bats test_tags=long
@test "a filter of each kind, no mirror, filled islands" {
  cd "$WORK"
  for filter in bicubic bicubic-point area; do
    run_ct build spheres.raw $RAW --void-ratio 3.959 --size 16x16x16 --filter $filter --json -o f.hdf
    [ "$status" -eq 0 ]
    near "$(echo "$output" | value void_ratio)" 3.959 0.03
  done
  run_ct build spheres.raw $RAW --threshold 70 --filter none --mirror none --islands fill --json -o f.hdf
  [ "$status" -eq 0 ]
  [ "$(echo "$output" | value size)" = "[48, 48, 48]" ]
  [ "$(echo "$output" | value mirror_plane)" = -1 ]
  near "$(echo "$output" | value void_ratio)" 3.959 0.08
}

# SIDE: a model so many voxels wide, of a scan with a blur that is taken out
equal_bytes() {
  for threads in 1 3; do
    run_ct build "$BATS_TEST_DIRNAME/../../data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --quiet \
      --crop 0,0,0,48,48,24 --size $1x$1x$(($1 / 2)) --threads $threads -o t$threads.hdf
    [ "$status" -eq 0 ]
  done
  /usr/bin/python3 - <<'P'
import h5py
a, b = h5py.File("t1.hdf"), h5py.File("t3.hdf")
for k in ("solid", "wall_distance", "grain_fraction"):
    assert (a["model"][k][()] == b["model"][k][()]).all(), k
P
}
# bats test_tags=long
@test "equal bytes on one thread and on many, of a model of large voxels" { cd "$WORK" && equal_bytes 6; }

@test "equal bytes on one thread and on many" {
  cd "$WORK"
  equal_bytes 16
  for threads in 1 3; do
    run_ct sweep spheres.raw $RAW --void-ratio 3.959 --crop 0,0,0,48,48,24 --size 16x16x8 --threads $threads -o t$threads.csv
    [ "$status" -eq 0 ]
  done
  cmp t1.csv t3.csv
}

@test "model.hdf is as the contract says" {
  cd "$WORK"
  /usr/bin/python3 - <<'P'
import h5py, numpy as np
f = h5py.File("balls.hdf"); m = f["model"]; a = m.attrs
s, d, g = m["solid"][()], m["wall_distance"][()], m["grain_fraction"][()]
assert s.dtype == np.uint8 and s.shape == (47, 24, 24) and set(np.unique(s)) == {0, 1}
assert d.dtype == np.float32 and d.shape == s.shape and g.dtype == np.float32 and g.shape == s.shape
assert np.allclose(a["spacing"], 20e-6) and list(a["periodic"]) == [1, 1, 1] and a["mirror_plane"] == 23
e = (s == 0).sum() / (s == 1).sum()
assert abs(a["void_ratio"] - e) < 1e-12 and a["void_ratio_measured"] == 3.959
assert (s == s[::-1]).all() and (d == d[::-1]).all() and (g == g[::-1]).all()
assert (d[s == 1] <= 0).all() and (d[s == 0] >= 0).all()
assert g.min() >= 0 and g.max() <= 1 and abs((1 - g[:24].mean()) / g[:24].mean() - 3.959) < 0.05
# Distances against the four spheres, periodic in x and y, away from the mirror planes.
c = np.array([[12.3,11.6,12.2],[35.9,36.4,12.7],[11.8,36.2,35.7],[36.3,12.1,36.4]]) * 10e-6
z, y, x = np.meshgrid(*[(np.arange(24) + .5) * 20e-6] * 3, indexing="ij")
t = np.full(z.shape, 1.0)
for cx, cy, cz in c:
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            t = np.minimum(t, np.sqrt((x-cx-i*480e-6)**2 + (y-cy-j*480e-6)**2 + (z-cz)**2) - 110e-6)
near = (np.abs(t) < 70e-6) & (t > -80e-6)
near[:6] = near[-6:] = False
assert np.abs(d[:24] - t)[near].max() < 2e-6, np.abs(d[:24] - t)[near].max()
k = f["calibration"]
assert k["threshold"].shape == k["void_ratio"].shape == k["histogram"].shape
assert (np.diff(k["threshold"][()]) > 0).all()
v = f["VTKHDF"]
assert v.attrs["Type"] == b"ImageData" and list(v.attrs["Version"]) == [1, 0]
assert (v["PointData/solid"][()] == s).all()
p = f["provenance"]
assert "ct2model build" in str(p.attrs["command_line"]) and len(p["input_files"]) == 1
P
}

@test "a segmented rock: Berea" {
  [ -e $SHARED/berea/berea.zip ] || skip "../shared/data/berea is absent"
  command -v unzip > /dev/null || skip "unzip is not installed"
  unzip -oq "$SHARED"/berea/berea.zip -d "$WORK/berea"
  run_ct build "$WORK/berea" --threshold 128 --filter none --mirror none --crop 0,0,0,100,100,100 \
    --voxel-size 5.345um --json -o "$WORK/berea.hdf"
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value porosity)" 0.2033 0.001
}

# bats test_tags=long
@test "grey fibres, and sandstone slices where Otsu goes astray" {
  [ -e "$SHARED/versa" ] || skip "../shared/data/versa is absent"
  run_ct build "$SHARED"/fiberform/100_fiberform.tif --void-ratio 5.667 --voxel-size 1.3um --json \
    -o "$WORK/fibre.hdf"
  [ "$status" -eq 0 ]
  near "$(echo "$output" | value void_ratio_error)" 0 0.01 # within the walls
  near "$(echo "$output" | value porosity)" 0.85 0.005     # by voxels, 4 across a fibre
  low=255; high=0; otsu=0
  for slice in 0000 0200 0400; do
    run_ct sweep "$SHARED"/versa/Sandstone_Versa$slice.tif --void-ratio 0.2 \
      --crop 260,250,0,450,500,1 --voxel-size 2.23um --json
    [ "$status" -eq 0 ]
    near "$(echo "$output" | value threshold_original)" 90 5
    otsu=$(echo "$output" | value threshold_otsu)
  done
  near "$otsu" 173 3
}

@test "info names what lies among the slices, and tells of colour what build does" {
  /usr/bin/python3 - <<'END'
import os, struct, zlib

def png(path, pixel):  # 8 x 8
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 8, 8, 8, 2 * (len(pixel) == 3), 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(8 * (b"\0" + 8 * pixel))) + chunk(b"IEND", b""))

os.makedirs("among", exist_ok=True)
for i in range(5):
    png(f"among/slice_{i:02d}.png", bytes([10 * i]))
    if i < 3:
        png(f"among/mask_{i:02d}.png", bytes([255 * (i % 2)]))
png("colour.png", bytes([10, 200, 30]))
END
  run_ct info among
  [ "$status" -eq 0 ]
  [ "${#stderr_lines[@]}" -eq 1 ]
  [[ $stderr == *"3 of 8 files, such as mask_00.png, are not named as slice_00.png: if they are masks"* ]]
  # A third name beside them hides nothing.
  cp among/mask_00.png among/preview.png && rm among/mask_01.png among/mask_02.png
  run_ct info among
  [[ $stderr == *"2 of 7 files, such as mask_00.png, are not named as slice_00.png: if they are masks"* ]]
  # A folder among them, names without numbers, and axes as short as those of channels.
  mkdir among/rest letters
  run_ct info among
  [[ $stderr == *"among/rest: a folder within the folder, not looked into"* ]]
  cp among/slice_00.png letters/a.png && cp among/slice_01.png letters/B.png
  run_ct info letters
  [[ $stderr == *"B.png: no number (0 to 9) puts it in order"* ]]
  cp among/slice_00.png letters/a1.png && rm letters/B.png
  run_ct info letters
  [[ $stderr == *"a.png: no number (0 to 9) puts it in order"* ]]
  /usr/bin/python3 - <<'END'
import numpy
numpy.save("colours.npy", numpy.zeros((8, 9, 3), "u1"))
for z in range(5):
    numpy.save(f"planes_{z}.npy", numpy.zeros((2, 8, 9), "u1"))
END
  run_ct info colours.npy
  [[ $stderr == *"only 3 voxels along x, as many as an image has colours or channels"* ]]
  run_ct info planes_?.npy
  [[ $stderr == *"each of the 5 files holds 2 slices, which are taken one behind the other"* ]]
  run_ct info colour.png
  [[ $stderr == *"stored in colour; build takes it only where it is grey"* ]]
}

@test "greys that 24 bits do not tell apart are told" {
  cd "$WORK"
  /usr/bin/python3 - <<'END'
import numpy
z, y, x = numpy.indices((12, 14, 16))
greys = (128 + 100 * numpy.sin(x) * numpy.sin(y) * numpy.sin(0.7 * z)).astype("u4")
numpy.save("near.npy", greys)
numpy.save("far.npy", greys + 2**30)
END
  local options="--voxel-size 1um --blur keep --mirror none"
  run_ct build near.npy $options --threshold 128 -o near.hdf
  [ "$status" -eq 0 ]
  [[ $stderr != *"are kept in steps"* ]]
  run_ct build far.npy $options --threshold 1073741952 -o far.hdf
  [[ $stderr == *"are kept in steps of 128 (24 bits): subtract 1073741824"* ]]
}

@test "levels: coarser models of the same scan in one command" {
  cd "$WORK"
  run_ct build spheres.raw $RAW --void-ratio 3.96 --mirror none --levels 3 --blur keep -o lv.hdf --json
  [ "$status" -eq 0 ] || { echo "$stderr"; false; }
  echo "$output" | python3 -c '
import json, sys
d = json.load(sys.stdin)
all = [d] + d["coarser"]
assert [m["size"] for m in all] == [[48] * 3, [32] * 3, [24] * 3], [m["size"] for m in all]
assert [m["output"] for m in all] == ["lv.hdf", "lv-32.hdf", "lv-24.hdf"]
for m in all:
    assert abs(m["void_ratio"] - 3.96) < 0.02, m["void_ratio"]
    assert abs(m["size"][2] * m["spacing_m"][2] / 4.8e-4 - 1) < 1e-9'
  [ -s lv-32.hdf ]
  [ -s lv-24.hdf ]
}

# bats test_tags=long
@test "shares of grain that round to more than 1 make no model that sphsolve refuses" {
  cd "$WORK"
  run_ct build "$BATS_TEST_DIRNAME/../../data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --size 36x36x16 -o shares.hdf
  [ "$status" -eq 0 ]
  /usr/bin/python3 -c 'import h5py; f = h5py.File("shares.hdf")["model/grain_fraction"][()]; assert f.min() >= 0 and f.max() <= 1, f.max()'
}

@test "the specific surface of slits, straight and turned by 30 degrees, and of a tube is theirs within 4 %, of labels within its error" { surfaces grey labels; }
# bats test_tags=long
@test "the specific surface of the same in noise" { surfaces noisy; }

# KIND...
surfaces() {
  cd "$WORK"
  /usr/bin/python3 - "$CT" "$@" <<'END'
import json, math, random, subprocess, sys
n, c, t, r = 48, 24, math.radians(30), random.Random(1)
shapes = {"slit": (lambda x, y: 8.3 - abs(x - c), 2 * n), "tube": (lambda x, y: math.hypot(x - c - 0.3, y - c + 0.4) - 15, 2 * math.pi * 15)}
# Of two lines at 8.3 from the middle of a square, turned: what of them lies in it.
step = 0.001
inside = sum(abs(8.3 * math.cos(t) - s * step * math.sin(t)) < c and abs(8.3 * math.sin(t) + s * step * math.cos(t)) < c for s in range(-40000, 40000))
shapes["turned"] = (lambda x, y: 8.3 - abs((x - c) * math.cos(t) + (y - c) * math.sin(t)), 2 * step * inside)
for name, (distance, length) in shapes.items():
    d = [distance(x + 0.5, y + 0.5) for y in range(n) for x in range(n)]
    void_ratio = ["--void-ratio", str(sum(v < 0 for v in d) / sum(v > 0 for v in d))]
    for kind in sys.argv[2:]:
        options = ["--segmented", "0"] if kind == "labels" else void_ratio
        grey = [100 + 50 * max(-1, min(1, v / 1.5)) for v in d]
        layers = {"grey": lambda: bytes(map(round, grey)), "noisy": lambda: bytes(round(r.gauss(v, 6)) for v in grey), "labels": lambda: bytes(v > 0 for v in d)}
        open("plane.raw", "wb").write(b"".join(layers[kind]() for z in range(n // 2)))
        told = subprocess.run([sys.argv[1], "build", "plane.raw", "--raw", f"{n}x{n}x{n // 2}:u8", "--voxel-size", "1um", "--mirror", "none", "--json", "--quiet", "-o", "plane.hdf"] + options, capture_output=True, text=True, check=True)
        told = json.loads(told.stdout)
        found = told["specific_surface_per_m"] / (1e6 * length / n**2)
        assert abs(found - 1) < 0.04, (name, kind, found)
        if kind == "labels":  # a straight wall is exact, in whatever few voxels
            error = told["specific_surface_error_per_m"] / told["specific_surface_per_m"]
            assert abs(found - 1) < (1e-3 if name == "slit" else error) < 0.05, (name, found, error)
END
}
