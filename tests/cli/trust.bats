#!/usr/bin/env bats
# Nothing lost, nothing believed: budgets, equal bytes, hostile files, bounds on memory.
bats_require_minimum_version 1.5.0

load programs
setup_file() {
  programs_path
  sample_model 16x16x7 m.hdf
  cat > flow.cfg << 'END'
scene = { method = "isph"; end_time = "0.3 s"; };
domain = { size = ["0.4 m", "0.1 m"]; spacing = "1 cm"; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.4 m", "0.1 m"]; },
  { type = "porous"; box = ["0.1 m", "0", "0.3 m", "0.1 m"]; porosity = 0.4; grain_size = "5 mm"; },
  { type = "inflow"; box = ["0", "0", "1 cm", "0.1 m"]; head = "0.3 m"; },
  { type = "inflow"; box = ["0.39 m", "0", "0.4 m", "0.1 m"]; head = "0.2 m"; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
}
setup() {
  cd "$BATS_FILE_TMPDIR"
}

# refused CODE TEXT COMMAND...: the exit code, one line on stderr, and TEXT in it
refused() {
  local code=$1 text=$2; shift 2
  run --separate-stderr timeout 60 "$@"
  [ "$status" -eq "$code" ] && [ "${#stderr_lines[@]}" -eq 1 ] && [[ "$stderr" == *"$text"* ]] ||
    { echo "$*: exit code $status, wanted $code and '$text': $stderr"; false; }
}
python() { /usr/bin/python3 "$@"; }

@test "every run ends with a budget that closes" {
  run --separate-stderr sphsolve run flow.cfg -o flow -v
  [ "$status" -eq 0 ]
  # 20 x 10 of free water, and the soil's .08 kg in rows of 6 x 13.
  [[ "$output" == *"budget     particles: 278 + "* ]]
  [[ "$output" != *unaccounted* ]]
  [[ "$output" == *"momentum (kg m/s): "*"not accounted for"*"energy (J): "*"not accounted for"* ]]
  analyze report flow.hdf -o flow.html --quiet > /dev/null
  page flow.html '"drag of soil, Forchheimer" in page["runs"][0]["ledger"]["words"]'
  sphsolve run "$ROOT/data-samples/scenes/s06.cfg" --set model.file=m.hdf --set scene.end_time='1 ms' -o pore --quiet > /dev/null
  cat > slit.cfg << 'END'
scene = { method = "stokes"; };
domain = { size = ["6 cm", "6 cm"]; spacing = "1 cm"; periodic = [true, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "6 cm", "6 cm"]; } );
force = { body_acceleration = ["1 mm/s^2", "0"]; };
END
  run --separate-stderr sphsolve run slit.cfg -o slit
  [ "$status" -eq 0 ]
  [[ "$output" == *"budget     mass: the flux is the same through all planes"*"energy: friction takes"* ]]
  # Water that only a wall drives has its balance too.
  cat > couette.cfg << 'END'
scene = { method = "stokes"; };
domain = { size = ["6 cm", "6 cm"]; spacing = "1 cm"; periodic = [true, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "6 cm", "6 cm"]; },
  { type = "wall"; box = ["0", "5 cm", "6 cm", "6 cm"]; velocity = ["1 mm/s", "0"]; } );
END
  run --separate-stderr sphsolve run couette.cfg -o couette
  [ "$status" -eq 0 ]
  [[ "$output" == *"momentum: walls and pressure balance what drives the flow to "[1-9]*e-* ]]
  sphsolve run "$ROOT/data-samples/scenes/s06.cfg" --set model.file=m.hdf --set scene.method=stokes --set stokes.tolerance=1e-6 -o creep --quiet > /dev/null
  python "$ROOT/tests/cli/budget_closes.py"
}

@test "the same inputs give the same bytes in every output" {
  for d in one two; do
    mkdir -p $d/slices
    cp "$ROOT"/data-samples/small/slice_00{0?,1?}.png $d/slices
    cp "$ROOT/data-samples/scenes/s06.cfg" $d
    (
      cd $d
      # Neither threads nor where and how one works are in what comes out.
      [ $d = one ] || { umask 077 && export OMP_NUM_THREADS=2 TZ=Asia/Tokyo LC_ALL=C.UTF-8; }
      ct2model sweep slices --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,64,64,12 --size 16x16x3 -o sweep.csv --json --quiet > sweep.json
      ct2model build slices --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,64,64,12 --size 16x16x3 -o dense.hdf --quiet > build.txt
      cp ../one/dense.hdf model.hdf # a model's time is part of its hash
      sphsolve run s06.cfg --set model.file=model.hdf --set scene.end_time='5 ms' --set output.interval='2 ms' -o out --quiet > /dev/null
      sphsolve run s06.cfg --set model.file=model.hdf --set scene.method=stokes --set stokes.tolerance=1e-4 -o creep --quiet > /dev/null
      cp ../flow.cfg .
      sphsolve run flow.cfg --set scene.end_time='20 ms' -o flow --quiet > /dev/null
    )
    [ $d = one ] && sleep 1.1
  done
  for f in sweep.csv sweep.json build.txt out-0000.hdf out-0001.hdf out-0002.hdf creep-0000.hdf flow-0000.hdf out.hdf.series; do cmp one/$f two/$f; done
  # Models and runs differ in the time of their provenance and in what a clock measured, and in nothing else (but checksums of HDF5 over them).
  /usr/bin/python3 "$ROOT/tests/cli/blank_clock.py" {one,two}/{dense,out,creep,flow}.hdf
  for f in dense out creep flow; do cmp one/$f.hdf two/$f.hdf; done
  # What is drawn of one run is drawn again, bit for bit.
  for d in one two; do
    (cd one && for c in darcy pdf history; do analyze $c out.hdf -o ../drawn-$d --quiet > /dev/null; done
      analyze report out.hdf -o report.html --quiet > /dev/null && mv report.html ../drawn-$d)
  done
  diff -r drawn-one drawn-two
}

@test "compressed pixels cannot promise more than they can hold; sizes that overflow are refused" {
  head -c 1000 /dev/zero | gzip > zeros.gz
  printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 100000 100000 100\nencoding: gzip\n\n' | cat - zeros.gz > bomb.nrrd
  refused 3 "can hold at most" ct2model sweep bomb.nrrd --void-ratio 0.7 --voxel-size 1um --quiet
  python - << 'END'
import zlib, struct
def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
head = struct.pack(">IIBBBBB", 900000, 900000, 16, 0, 0, 0, 0)
open("bomb.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b""))
def tiff(width, height, rows):
    tags = [(256, 4, width), (257, 4, height), (258, 3, 16), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1), (278, 4, rows), (279, 4, 2**32 - 1)]
    return b"II*\0" + struct.pack("<I", 8) + struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", t, k, 1, v) for t, k, v in tags) + bytes(4)
open("wide.tif", "wb").write(tiff(2**32 - 1, 2**32 - 1, 2**32 - 1))
open("tall.tif", "wb").write(tiff(60000, 60000, 60000))
END
  refused 3 "not a readable TIFF" ct2model sweep wide.tif --void-ratio 0.7 --voxel-size 1um --quiet
  for f in bomb.png tall.tif; do
    run --separate-stderr timeout 60 ct2model sweep $f --void-ratio 0.7 --voxel-size 1um --quiet --max-memory 1GB
    [ "$status" -eq 1 ] || [ "$status" -eq 3 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
  done
  truncate -s 1000000 s.raw
  refused 3 "header promises" ct2model sweep --void-ratio 0.7 --voxel-size 1um --quiet \
    "$(printf 'NDims = 3\nDimSize = 18446744073709551615 4 4\nElementType = MET_UCHAR\nElementDataFile = s.raw\n' > huge.mhd; echo huge.mhd)"
  run --separate-stderr ct2model sweep s.raw --raw 4294967296x4294967296x4:u16le --void-ratio 0.7 --voxel-size 1um --quiet
  [ "$status" -eq 2 ] || [ "$status" -eq 3 ]
}

@test "2^32 slices are counted, and refused before any is read" {
  truncate -s 4294967296 many.raw # a hole: no bytes on the disk
  refused 3 "4294967296 voxels along z" timeout 60 ct2model sweep many.raw --raw 1x1x4294967296:u8 --void-ratio 0.7 --voxel-size 1um --quiet --max-memory 100MB
  rm many.raw
}

@test "a header names only files beside it" {
  mkdir -p inner
  head -c 64 /dev/urandom > beside.raw
  for name in ../beside.raw "$PWD/beside.raw" x/../../beside.raw; do
    printf 'NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = %s\n' "$name" > inner/out.mhd
    refused 3 "lie outside the header's folder" ct2model info inner/out.mhd
    printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: %s\n\n' "$name" > inner/out.nrrd
    refused 3 "lie outside the header's folder" ct2model info inner/out.nrrd
  done
  ln -s ../beside.raw inner/link.raw
  printf 'NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = link.raw\n' > inner/out.mhd
  refused 3 "lie outside the header's folder" ct2model info inner/out.mhd
}

@test "a message is one line whatever it quotes; files of a newer version are refused" {
  refused 3 "no?such?[31m.cfg" sphsolve explain $'no\nsuch\e[31m.cfg'
  refused 2 "--size 1x?1" ct2model build m.hdf --void-ratio 0.7 --size $'1x\n1'
  refused 3 "unknown unit '2'" sphsolve explain flow.cfg --set $'scene.end_time=1\n2'
  refused 2 "'two words' cannot be set in flow.cfg" sphsolve explain flow.cfg --set 'scene.two words=1'
  # JSON is UTF-8: of a name that is not, what is readable.
  cp m.hdf $'m\xff.hdf'
  ct2model info $'m\xff.hdf' --json | python -c 'import json, sys; assert json.load(sys.stdin)["files"][0]["path"] == "m?.hdf"'
  cp m.hdf newer.hdf
  python -c "import h5py; h5py.File('newer.hdf', 'r+')['provenance'].attrs['schema_version'] = 99"
  refused 3 "is of schema version 99" sphsolve explain "$ROOT/data-samples/scenes/s06.cfg" --set model.file=newer.hdf
  refused 3 "is of schema version 99" analyze darcy newer.hdf
}

@test "pipes, chains in a circle, and texts and settings without end are refused" {
  mkfifo pipe.tif
  refused 3 "a pipe or device, not an image file" ct2model info pipe.tif
  refused 3 "is no file" analyze darcy pipe.tif
  python "$ROOT/tests/cli/write_hostile_images.py"
  refused 3 "its directories lead in a circle" ct2model info circle.tif
  refused 3 "slices of 2147483648x1073741824 are too large" ct2model sweep huge.tif --void-ratio 0.5 --voxel-size 1um
  # The shadows of sanitizers are no memory of ours.
  [[ "$SANITIZE" == *address* || "$SANITIZE" == *thread* ]] || ulimit -S -v 1000000
  refused 3 "not a readable PNG: Read Error" ct2model info text.png
  ulimit -S -v unlimited
  refused 3 "20001 settings: no scene file" sphsolve explain many.cfg
  ct2model sweep pages.tif --void-ratio 0.5 --voxel-size 1um --quiet -o pages.csv > /dev/null
  ct2model sweep pages.raw --raw 4x4x300:u8 --void-ratio 0.5 --voxel-size 1um --quiet -o raw.csv > /dev/null
  cmp pages.csv raw.csv
}

@test "NaN and infinities in float stacks are named with their slice" {
  for bad in nan inf -inf; do
    python -c "
import array
a = array.array('f', [i % 7 for i in range(8 * 8 * 8)])
a[300] = float('$bad')
open('f.raw', 'wb').write(a.tobytes())"
    refused 3 "f.raw" ct2model sweep f.raw --raw 8x8x8:f32le --void-ratio 0.7 --voxel-size 1um --filter none --quiet
  done
}

@test "HDF5 of wrong types, ranks, groups, links and filters is refused" {
  python - << 'END'
import h5py, numpy as np
def make(name, solid=np.zeros((4, 4, 4), "u1"), spacing=[1e-5] * 3, **options):
    with h5py.File(name, "w") as f:
        if solid is not None: f.create_dataset("/model/solid", data=solid, **options)
        else: f.create_group("model")
        if spacing is not None: f["model"].attrs["spacing"] = spacing
make("float.hdf", np.zeros((4, 4, 4)))
make("text.hdf", np.full((4, 4, 4), b"x"))
make("flat.hdf", np.zeros((4, 4), "u1"))
make("deep.hdf", np.zeros((4, 4, 4, 4), "u1"))
make("seven.hdf", np.full((4, 4, 4), 7, "u1"))
make("none.hdf", None)
make("nospace.hdf", spacing=None)
make("two.hdf", spacing=[1e-5] * 2)
make("nan.hdf", spacing=[float("nan")] * 3)
make("minus.hdf", spacing=[-1e-5] * 3)
make("words.hdf", spacing="1 mm")
make("empty.hdf", np.zeros((0, 4, 4), "u1"))
make("lzf.hdf", compression="lzf")
make("other.hdf", external=[("elsewhere.bin", 0, 64)], solid=np.zeros((4, 4, 4), "u1"))
with h5py.File("link.hdf", "w") as f: f["model"] = h5py.ExternalLink("none.hdf", "/model")
with h5py.File("loop.hdf", "w") as f: f["model"] = h5py.SoftLink("/model")
with h5py.File("chase.hdf", "w") as f: f["a"], f["model"] = h5py.SoftLink("/model"), h5py.SoftLink("/a")
with h5py.File("self.hdf", "w") as f:
    g = f.create_group("model"); g["model"] = g; g["solid"] = g
with h5py.File("vast.hdf", "w") as f:
    f.create_dataset("/model/solid", shape=(1 << 20, 1 << 20, 1 << 20), dtype="u1", chunks=(64, 64, 64), compression="gzip")
    f["model"].attrs["spacing"] = [1e-5] * 3
with h5py.File("bomb.hdf", "w") as f:
    f.create_dataset("/model/solid", shape=(500, 500, 500), dtype="u1", chunks=(64, 64, 64), compression="gzip")
    f["model"].attrs["spacing"] = [1e-5] * 3
make("round.hdf")
with h5py.File("round.hdf", "r+") as f: f["model"].attrs["periodic"] = np.array([7, -3, 1], "i4")
make("depth.hdf")
with h5py.File("depth.hdf", "r+") as f:
    for i in range(300): f = f.create_group("g")
make("walls.hdf")
with h5py.File("walls.hdf", "a") as f:
    f["/model/wall_distance"] = np.full((4, 4, 4), np.nan, "f4")
END
  printf 'scene = { };\nmodel = { file = "model-file"; };\nfluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-9.8 m/s^2"]; };\n' > s.cfg
  for case in "float:holds floats" "text:holds no numbers" "flat:has 2 dimensions" "deep:has 4 dimensions" "seven:only 0 (pore)" \
    "none:has no /model/solid" "nospace:no attribute 'spacing'" "two:3 are wanted" "nan:greater than 0" "minus:greater than 0" "words:wrong type" \
    "empty:impossible" "lzf:filter or storage" "other:filter or storage" "link:has no /model/solid" "loop:has no /model/solid" \
    "chase:has no /model/solid" "self:has no dataset" "walls:holds nan" \
    "bomb:claims 125000000 bytes, but the 0 stored" "round:periodic holds 7; 0 and 1" "depth:lie too deep"; do
    sed "s/model-file/${case%%:*}.hdf/" s.cfg > case.cfg
    refused 3 "${case#*:}" sphsolve explain case.cfg
  done
  sed "s/model-file/vast.hdf/" s.cfg > case.cfg
  refused 1 "would exceed the limit" sphsolve explain case.cfg
}

@test "a damaged size in HDF5's own tables takes no memory" {
  refused 3 "asks for more memory than any needs" ct2model info "$ROOT/tests/fuzz/corpus/hdf5/run-hungry.hdf"
}

@test "--max-memory is held before memory is taken, with the number in the message" {
  sphsolve explain "$ROOT/data-samples/scenes/s06.cfg" --set model.file=m.hdf --max-memory 50MB > /dev/null
  refused 1 "limit of 0.0 MB; --max-memory sets it" sphsolve explain "$ROOT/data-samples/scenes/s06.cfg" --set model.file=m.hdf --max-memory 0.01MB
  refused 1 "MB in use would exceed the limit of 0.2 MB" sphsolve run "$ROOT/data-samples/scenes/s06.cfg" --set model.file=m.hdf \
    --max-memory 0.2MB -o little --quiet
  [ ! -e little.hdf ]
}

@test "a folder that cannot be written is found before the work" {
  local as="" open
  open=$(mktemp -d /tmp/tosui-trust-XXXXXX) # the test's own folder is closed to others
  # (a build for coverage writes counts, which are not what is tested here)
  [ "$(id -u)" -ne 0 ] || as="setpriv --reuid 65534 --clear-groups env GCOV_PREFIX=$open/counts"
  mkdir -m 777 "$open/counts" && mkdir "$open/locked" && chmod 755 "$open" && chmod 555 "$open/locked"
  cp -r m.hdf "$ROOT/data-samples/scenes/s06.cfg" "$ROOT/data-samples/small" "$open"
  cd "$open"
  $as sphsolve --version > /dev/null || skip "the programs are closed to others"
  refused 1 "cannot be written" $as sphsolve run s06.cfg --set model.file=m.hdf -o locked/out --quiet
  refused 1 "cannot be written" $as ct2model build small --void-ratio 0.725 --voxel-size 8.745um --size 16x16x7 -o locked/m.hdf --quiet
  refused 1 "cannot be written" $as ct2model sweep small --void-ratio 0.725 --voxel-size 8.745um --size 16x16x7 -o locked/s.csv --quiet
  cd "$BATS_FILE_TMPDIR"
  rm -rf "$open"
}
