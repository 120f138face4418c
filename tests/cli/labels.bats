#!/usr/bin/env bats
# Segmented images, NumPy arrays and HDF5 datasets as they come from other programs.

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_setup
  # A sphere of share 0.216 in a cube of 320 um, 12 voxels a side, off the middle; 1 is grain, 0 pore; and with three labels.
  /usr/bin/python3 - <<'END'
n, r = 12, (0.216 * 3 / (4 * 3.141592653589793)) ** (1 / 3) * 12
at = [i + .5 - n / 2 for i in range(n)]
inside = [(x - .137) ** 2 + (y + .21) ** 2 + (z - .3) ** 2 < r * r for z in at for y in at for x in at]
open("sphere.raw", "wb").write(bytes(inside))
open("turned.raw", "wb").write(bytes(not i for i in inside))
open("three.raw", "wb").write(bytes(7 + (j % 2) if i else 3 for j, i in enumerate(inside)))
END
  cat > s.cfg <<'END'
scene = { name = "sphere"; method = "stokes"; };
model = { file = "s.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };
END
  export CUBE="--raw 12x12x12:u8 --voxel-size 26.666667um --mirror none"
}

@test "k of smoothed labels is that of the sphere: Zick and Homsy within 2 %" {
  ct2model build sphere.raw $CUBE --segmented 0 --json -o s.hdf > s.json
  sphsolve run s.cfg -o s-run --json > run.json
  /usr/bin/python3 - <<'END'
import json
s, run = json.load(open("s.json")), json.load(open("run.json"))
radius = (0.216 * 3 / (4 * 3.141592653589793)) ** (1 / 3) * 320e-6
exact = 2 * radius**2 / (9 * 0.216 * 7.4419)  # Zick, Homsy 1982
# Of the lattice with the labels' own sites: the walls are looked at, not the limit of the lattices.
finest = run["intrinsic_permeability"] * run["k_finest"] / run["k"]
assert abs(finest / exact - 1) < 0.02, finest / exact
assert s["segmented"]["pore"] == [0] and s["segmented"]["grain"] == [1]
assert -0.1 < s["segmented"]["k_change_by_smoothing"] < -0.01
assert abs(s["void_ratio_original"] - s["void_ratio"]) < 1e-9
for key in ("threshold", "threshold_otsu", "threshold_uncertainty", "dthreshold_dvoid_ratio", "contrast_to_noise"):
    assert s[key] is None, key
assert run["error"]["threshold"] is None
END
}

@test "the steps of labels are a part of the error of k, and k holds the sphere's with it" {
  ct2model build sphere.raw $CUBE --segmented 0 --json -o s.hdf > s.json
  sphsolve run s.cfg -o held --error 20% --json > held.json
  sphsolve explain s.cfg --json > foretold.json
  /usr/bin/python3 - <<'END'
import json, math
run, foretold = json.load(open("held.json")), json.load(open("foretold.json"))
radius = (0.216 * 3 / (4 * 3.141592653589793)) ** (1 / 3) * 320e-6
exact = 2 * radius**2 / (9 * 0.216 * 7.4419)  # Zick, Homsy 1982
error = run["error"]
change = abs(error["dlnk_blurred_again"])
# Beside the blurred steps: a fortieth of a voxel that walls may be off, and the spheres that have as many voxels.
steps, placed = 2 * (1 + 3 * change) * change, 0.301 / foretold["pores"]["width"]
counted = error["dlnk_dvoid_ratio"] * json.load(open("s.json"))["segmented"]["void_ratio_uncertainty"]
assert abs(error["scan"] / math.hypot(steps, placed, counted) - 1) < 1e-6, (error, foretold["pores"])
assert counted > 0.02
assert 0.0005 < change < 0.1, error
assert abs(run["intrinsic_permeability"] / exact - 1) < error["total"], (run["intrinsic_permeability"] / exact, error)
assert 0.0005 < foretold["expected_error_scan"] < 0.1
END
}

@test "an ellipse whose voxels have a smaller area: k holds; a measured void ratio says how far off they are" {
  # Half axes of 11.4 and 6.24 voxels in the middle: 3.2 % of the area is not in the labels.
  /usr/bin/python3 -c 'open("ellipse.raw", "wb").write(bytes(((x - 13.5) / 11.4) ** 2 + ((y - 13.5) / 6.24) ** 2 < 1
                                    for z in range(8) for y in range(28) for x in range(28)))'
  local ellipse="ellipse.raw --raw 28x28x8:u8 --voxel-size 10um --mirror none --segmented 1"
  ct2model build $ellipse -o s.hdf > told.txt
  grep -q "a body of this void ratio +- 0.0[1-9]* has as many voxels" told.txt
  sphsolve run s.cfg -o unsure --json > unsure.json
  ct2model build $ellipse --void-ratio 0.3987 --json -o s.hdf > met.json # pi 11.4 6.24 / (784 - pi 11.4 6.24)
  sphsolve run s.cfg -o sure --json > sure.json
  /usr/bin/python3 - <<'END'
import json, math
unsure, sure = json.load(open("unsure.json")), json.load(open("sure.json"))
a, b = 11.4e-5, 6.24e-5
exact = math.pi * a * b / (28e-5) ** 2 * a * a * b * b / (4 * (a * a + b * b))
off = abs(unsure["intrinsic_permeability"] / exact - 1)
assert 0.04 < off < unsure["error"]["total"] < 0.12, (off, unsure["error"])
assert unsure["error"]["void_ratio"] is None and json.load(open("met.json"))["segmented"]["void_ratio_uncertainty"] is None
assert sure["error"]["scan"] < 0.5 * unsure["error"]["scan"] and sure["error"]["void_ratio"] > 0.02, sure["error"]
END
}

@test "the walls enclose the volume of the labels" {
  ct2model build sphere.raw $CUBE --segmented 0 -o volume.hdf --quiet
  /usr/bin/python3 - <<'END'
import h5py
grain = h5py.File("volume.hdf")["model/grain_fraction"][:].mean()
share = open("sphere.raw", "rb").read().count(1) / 12**3
assert abs(grain / share - 1) < 0.015, grain / share
END
}

@test "which label is pore: by its number, by a list, found out" {
  e() { ct2model build "$@" --json -o e.hdf 2> said | sed -n 's/^  "void_ratio": \(.*\),/\1/p'; }
  same() { awk -v a="$1" -v b="$2" 'BEGIN { exit !((a / b - 1)^2 < 1e-12) }'; }
  first=$(e sphere.raw $CUBE --segmented 0)
  same "$first" "$(e turned.raw $CUBE --segmented 1)"
  same "$first" "$(e turned.raw $CUBE --segmented=1)"
  same "$first" "$(e --segmented 1 turned.raw $CUBE)"
  same "$first" "$(e sphere.raw $CUBE --segmented)"
  same "$first" "$(e three.raw $CUBE --segmented 3)"
  same "$first" "$(e three.raw $CUBE --segmented 3=pore,7=grain,8=grain)"
  same "$first" "$(e sphere.raw $CUBE)"
  grep -q "0 is taken as pore, 1 as grain.*--segmented 1" said
  same "$first" "$(e sphere.raw $CUBE --void-ratio 3.66)"
  run ! grep -q "taken as pore" said
}

@test "labels beside a measured void ratio: one error everywhere, of what the walls enclose; advice that holds" {
  # Rough grains: their walls cut corners that the voxels' centres count.
  /usr/bin/python3 - <<'END'
import random
random.seed(3)
n, balls = 24, [(random.uniform(0, 24), random.uniform(0, 24), random.uniform(0, 24), random.uniform(2, 5)) for _ in range(60)]
def near(a, b): return min(abs(a - b), n - abs(a - b))
open("balls.raw", "wb").write(bytes(int(any(near(x, a) ** 2 + near(y, b) ** 2 + near(z, c) ** 2 < r * r for a, b, c, r in balls))
                                    for z in range(n) for y in range(n) for x in range(n)))
END
  local balls="balls.raw --raw 24x24x24:u8 --voxel-size 10um --mirror none"
  e=$(ct2model build $balls --segmented 0 --json -o balls.hdf | sed -n 's/^  "void_ratio_original": \(.*\),/\1/p')
  measured=$(awk -v e="$e" 'BEGIN { printf "%.4f", 1.02 * e }')
  ct2model build $balls --segmented 0 -e "$measured" -o balls.hdf > told.txt 2> said.txt
  sphsolve run s.cfg --set model.file=balls.hdf -o balls-run --json > run.json
  grep -q "^full resolution .* by the labels$" told.txt
  grep -q "^void ratio .* by voxels of the smoothed labels; .* within the walls (measured" told.txt
  analyze report balls-run.hdf -o balls.html -q
  page balls.html 'page["model"]["rule"] == "labels" and page["model"]["void_ratio_walls"] != page["models"][0]["model"]["attributes"]["void_ratio"]'
  E=$e M=$measured /usr/bin/python3 - <<'END'
import json, os, re
import h5py
e, measured = float(os.environ["E"]), float(os.environ["M"])
model, run = h5py.File("balls.hdf")["model"].attrs, json.load(open("run.json"))["error"]
assert abs(model["void_ratio"] - e) > 0.003, "the voxels' centres do not tell the two apart"
assert abs(model["void_ratio_error"] - (e - measured)) < 1e-9
assert abs(float(re.search(r"error ([-+.0-9]+)\)", open("told.txt").read()).group(1)) - (e - measured)) < 1e-4
assert abs(run["void_ratio"] - abs(run["dlnk_dvoid_ratio"] * (e - measured))) < 1e-9
END
  # Another label is advised only where it would be taken.
  far=$(awk -v e="$e" 'BEGIN { printf "%.4f", 1.3 / e }')
  near=$(awk -v e="$e" 'BEGIN { printf "%.4f", 1.05 / e }')
  run -3 --separate-stderr ct2model build $balls --segmented 0 -e "$far" -o wrong.hdf
  [[ "$stderr" != *"--segmented 1"* ]]
  run -3 --separate-stderr ct2model build $balls --segmented 0 -e "$near" -o wrong.hdf
  [[ "$stderr" == *"say --segmented 1"* ]]
  ct2model build $balls --segmented 1 -e "$near" -o right.hdf --quiet
}

@test "what cannot be labels is refused, and what to do is said" {
  wrong() { # CODE WORD ARGUMENTS
    local code=$1 word=$2
    shift 2
    run --separate-stderr ct2model build "$@" -o wrong.hdf
    [ "$status" -eq "$code" ] && [[ "$stderr" == *"$word"* ]] || { echo "$*: $status $stderr"; false; }
  }
  wrong 3 "more than 32 greys: leave --segmented out" "$ROOT/data-samples/small" --voxel-size 8.745um --segmented 0
  wrong 3 "--segmented 1" sphere.raw $CUBE --void-ratio 0.273
}

@test "a threshold on two labels: told, and so is that no share of the scan is known" {
  for threshold in otsu 0.5; do
    ct2model build sphere.raw $CUBE --threshold $threshold -o two.hdf --quiet
    ct2model build sphere.raw $CUBE --threshold $threshold -o two.hdf > /dev/null 2> said.txt
    grep -q "holds two greys alone.*--segmented" said.txt
  done
  sphsolve run s.cfg --set model.file=two.hdf -o both > two.txt
  grep -q "^error .*scan not counted (unknown)" two.txt
  analyze darcy both.hdf | grep -q "scan unknown, not counted"
  analyze report both.hdf -o two.html --quiet
  said two.html -q "What the scan left in k.* not counted"
  ct2model build sphere.raw $CUBE --segmented 0 -o s.hdf --quiet
  sphsolve run s.cfg -o known > known.txt
  run ! grep -q "scan not counted" known.txt
}

@test "a NumPy array and an HDF5 dataset are the volume that a raw file is" {
  /usr/bin/python3 - <<'END'
import h5py, numpy as np
z, y, x = np.mgrid[:20, :24, :28]
v = (20000 + 9000 * np.sin(x / 4) * np.sin(y / 3) * np.cos(z / 5) + 300 * np.sin(x * y * z)).astype("u2")
v.tofile("v.raw")
np.save("v.npy", v), np.save("big.npy", v.astype(">u2")), np.save("columns.npy", np.asfortranarray(v))
np.save("wide.npy", v.astype("i8")), np.save("wider.npy", v.astype(">u8")), np.save("complex.npy", v.astype("c8"))
np.save("tens.npy", (v // 16).astype("f4")), np.save("half.npy", np.asfortranarray((v // 16).astype("f2"))), np.save("half-big.npy", (v // 16).astype(">f2"))
np.save("labels.npy", np.where(v > 20000, 1, 0))
np.save("constant.npy", np.full((20, 20, 20), 3, "u1")), np.save("small.npy", v[:2, :3, :3])
open("far.npy", "wb").write(open("v.npy", "rb").read().replace(b"(20, 24, 28), }        ", b"(99999999999, 9, 9), } "))
np.save("ones.npy", v[None, :, None]), np.save("last.npy", np.asfortranarray(v[None, ..., None])), np.save("times.npy", v.reshape(2, 10, 24, 28))
np.save("float.npy", v.astype("f4")), np.save("one.npy", v[0, 0]), np.save("truth.npy", v > 20000)
with h5py.File("v.h5", "w") as file:
    file["group/v"] = v
    file.create_dataset("packed", data=v, chunks=(7, 9, 11), compression="gzip")
    file["double"] = v.astype("f8")
    file["toward"] = h5py.ExternalLink("elsewhere.h5", "/v")
with h5py.File("v.mat", "w", userblock_size=512) as file:
    file["v"] = v
with open("v.mat", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file")
END
  threshold() { ct2model sweep "$@" --void-ratio 0.8 --voxel-size 5um --json --quiet | grep '"threshold_original"'; }
  raw=$(threshold v.raw --raw 28x24x20:u16le)
  for image in v.npy big.npy columns.npy ones.npy last.npy v.h5:/group/v v.h5:group/v v.h5:/packed v.mat:/v "v.h5:/packed --threads 4"; do
    [ "$raw" = "$(threshold $image)" ] || { echo "$image"; false; }
  done
  for image in float.npy wide.npy wider.npy v.h5:/double; do
    awk -v a="${raw//[^0-9.]/}" -v b="$(threshold $image | tr -cd 0-9.)" 'BEGIN { exit !((a - b)^2 < 1) }'
  done
  raw=$(threshold tens.npy)
  for image in half.npy half-big.npy; do [ "$raw" = "$(threshold $image)" ] || { echo "$image"; false; }; done
  ct2model build truth.npy --segmented 1 --voxel-size 5um -o truth.hdf --quiet
  ct2model build labels.npy --segmented 1 --voxel-size 5um -o labels.hdf --quiet
  /usr/bin/python3 -c 'import h5py; truth, labels = (h5py.File(f)["model/solid"][()] for f in ("truth.hdf", "labels.hdf")); assert (truth == labels).all()'
  [[ "$(ct2model info v.h5:/packed)" == *"28x24x20"*"16-bit unsigned"* ]]
  for words in "constant.npy one.value,.3:" "small.npy 3.x.3.x.2.voxels.are.too.few" "one.npy axes" "times.npy axes" "far.npy over.2.32.long" "complex.npy type..<c8.*float32" "v.h5 /packed" "v.h5:/nothing no.dataset./nothing..it.has./double" "v.h5:/toward link.into.another" "v.h5:/group /group/v" "truth.hdf a.model.already" "v.h5: /packed" "v.npy:/x no.HDF5"; do
    given="--void-ratio 0.8"
    [[ $words != constant* && $words != small* ]] || given="" # nothing to ask a void ratio for
    run --separate-stderr ct2model build ${words% *} $given --voxel-size 5um -o wrong.hdf
    [ "$status" -eq 3 ] && [[ "$stderr" =~ ${words#* } ]] || { echo "$words: $status $stderr"; false; }
  done
  # Headerless pixels read the wrong way round or in pairs are told, and noise as noise; those read the right way are not.
  /usr/bin/python3 -c 'import numpy as np
np.fromfile("v.raw", "<u2").astype(">f4").tofile("f.raw"), np.random.default_rng(1).integers(0, 65536, 13440).astype("u2").tofile("noise.raw")
v = np.fromfile("v.raw", "<u2").astype(float)
v = np.round(40 + 170 * (v - v.min()) / np.ptp(v)).astype("u2")
g = np.random.default_rng(2).normal(0, 9000, v.shape) + 1.2 * np.fromfile("v.raw", "<u2")
np.clip((g - np.percentile(g, 25)) * 65535 / np.ptp(np.percentile(g, [25, 65])), 0, 65535).astype("<u2").tofile("cut.raw")
(500 * np.floor(v / 30) - 1000).astype("<f4").tofile("labels.raw")
np.clip(6 * (v.astype(int) - 125) + 128, 0, 255).astype("u1").tofile("ends.raw")
v.astype("u1").tofile("pairs.raw"), (257 * v).astype("<u2").tofile("made.raw")'
  for words in "v.raw:u16be is.u16le.meant" "f.raw:f32le is.f32be.meant" "v.raw:i16le ^$" "f.raw:f32be ^$" "noise.raw:u16be no.more.alike.than.those.far" "made.raw:u16le ^$" "cut.raw:u16le ^$" "labels.raw:f32le ^$" "v.raw:u16le ^$"; do
    file=${words%%:*} type=${words%% *}
    run --separate-stderr ct2model info "$file" --raw "28x24x20:${type#*:}"
    [ "$status" -eq 0 ]
    [[ "$stderr" =~ ${words#* } ]] || { echo "$words: $stderr"; false; }
  done
  for pairs in pairs.raw:u16le ends.raw:u16be; do
    run --separate-stderr ct2model info "${pairs%:*}" --raw "28x24x10:${pairs#*:}"
    [[ "$stderr" == *"is u8 meant in --raw"* ]] || { echo "$pairs: $stderr"; false; }
  done
  cp v.h5 before.h5
  run ct2model build v.h5:/packed --void-ratio 0.8 --voxel-size 5um -o v.h5 --force
  [ "$status" -eq 2 ]
  cmp v.h5 before.h5
}

@test "labels dressed as greys are told by their edges; a scan's are not" {
  /usr/bin/python3 - <<'END'
import numpy as np
noise = np.random.default_rng(5)
z, y, x = np.indices((40, 36, 32))
phase = lambda a, b, c: np.sin((x + a) / 3) + np.cos((y + b) / 2.5) + np.sin((z + c) / 4 + 1) > 0.2
thirds = (-1 / 3, 0, 1 / 3)
averaged = sum(phase(a, b, c) for a in thirds for b in thirds for c in thirds) / 27
np.save("dressed.npy", 200 - 100 * phase(0, 0, 0) + noise.normal(0, 5, x.shape))
np.save("averaged.npy", 200 - 100 * averaged + noise.normal(0, 5, x.shape))
END
  run --separate-stderr ct2model build dressed.npy --void-ratio 1.177 --voxel-size 4um -o dressed.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"edges are sharper (0.1 voxels)"* ]]
  run --separate-stderr ct2model build averaged.npy --void-ratio 1.177 --voxel-size 4um -o averaged.hdf
  [ "$status" -eq 0 ]
  [ -z "$stderr" ]
}

@test "voxels that are no cubes become cubes" {
  ct2model build sphere.raw --raw 12x12x12:u8 --voxel-size 5um,5um,10um --segmented 0 --mirror none --json -o a.hdf > a.json
  /usr/bin/python3 - <<'END'
import json
a = json.load(open("a.json"))
assert a["size"] == [12, 12, 24] and all(abs(s / 5e-6 - 1) < 1e-9 for s in a["spacing_m"]), a
assert all(abs(v / w - 1) < 1e-9 for v, w in zip(a["voxel_size_m"], (5e-6, 5e-6, 1e-5))), a["voxel_size_m"]
END
}

# bats test_tags=long
@test "slices far apart: told, in the error of k, and refused where nothing is known between them" {
  mkdir -p apart
  for i in $(seq 0 4 55); do cp "$(printf '%s/slice_%04d.png' "$ROOT/data-samples/small" "$i")" apart; done
  far() { ct2model build apart --void-ratio 0.725 --voxel-size "8.745um,8.745um,$1" --crop 0,0,0,64,64,14 -o far.hdf; }
  run --separate-stderr far 34.98um
  [ "$status" -eq 0 ] && [[ "$stderr" == *"4 times as long as wide: what lies between is drawn"*"too low, by as much as the part scan"* ]]
  scene stokes far.hdf > far.cfg
  share() { sphsolve run far.cfg -o far-run --set lattice.spacing='"25 um"' --json 2> /dev/null | sed -n 's/.*"scan": \([0-9.e-]*\),*/\1/p'; }
  drawn=$(share)
  /usr/bin/python3 -c 'import h5py; del h5py.File("far.hdf", "r+")["model"].attrs["voxel_scanned_longest"]'
  awk -v drawn="$drawn" -v other="$(share)" 'BEGIN { print drawn, other; exit !(drawn > 1.05 * other && other > 0) }'
  run --separate-stderr far 17.49um
  [ "$status" -eq 0 ] && [[ "$stderr" != *"times as long as wide"* ]]
  run --separate-stderr far 446um
  [ "$status" -eq 3 ] && [[ "$stderr" == *"51 times as long as wide"*"not known; --size 1x1x11 "*"--size 64x64x714 "* ]] || { echo "$stderr"; false; }
}

@test "--sides: an octant mirrored on all sides is the whole; closed sides are walls" {
  # The eighth of a sphere of share 0.216 in a cube of 17 voxels, cut through its middle voxel.
  /usr/bin/python3 - <<'END'
n, r = 9, (0.216 * 3 / (4 * 3.141592653589793)) ** (1 / 3) * 17
at = [(i - (n - 1)) ** 2 for i in range(n)]
open("eighth.raw", "wb").write(bytes(x + y + z < r * r for z in at for y in at for x in at))
END
  local eighth="eighth.raw --raw 9x9x9:u8 --voxel-size 10um --segmented 0"
  for sides in mirrored periodic closed; do
    # By default: given, periodic sides state that the body repeats itself, which an octant does not.
    ct2model build $eighth $([ $sides = periodic ] || echo --sides $sides) -o $sides.hdf --quiet
    sphsolve run s.cfg --set model.file=$sides.hdf -o run-$sides --json > run-$sides.json
  done
  /usr/bin/python3 - <<'END'
import h5py, json
k = {s: json.load(open(f"run-{s}.json"))["intrinsic_permeability"] for s in ("mirrored", "periodic", "closed")}
radius = (0.216 * 3 / (4 * 3.141592653589793)) ** (1 / 3) * 170e-6
exact = 2 * radius**2 / (9 * 0.216 * 7.4419)  # Zick, Homsy 1982
assert abs(k["mirrored"] / exact - 1) < 0.03, k["mirrored"] / exact
assert k["closed"] < 0.8 * k["periodic"], k
for sides, shape, periodic in (("mirrored", (17, 17, 17), [1, 1, 1]), ("periodic", (17, 9, 9), [1, 1, 1]), ("closed", (17, 9, 9), [1, 0, 0])):
    model = h5py.File(sides + ".hdf")["model"]
    assert model["solid"].shape == shape and list(model.attrs["periodic"]) == periodic, sides
    assert model.attrs["sides"].decode() == sides
for name in ("solid", "wall_distance", "grain_fraction"):
    field = h5py.File("mirrored.hdf")["model/" + name][:]
    assert all((field == field[s]).all() for s in ((slice(None, None, -1),), (slice(None), slice(None, None, -1)), (..., slice(None, None, -1)))), name
END
  # What the run of the wrapped octant says of its sides, on a coarse lattice, is what mirroring them did.
  /usr/bin/python3 - <<'END'
import json
k = {s: json.load(open(f"run-{s}.json")) for s in ("mirrored", "periodic", "closed")}
import math
said = k["periodic"]["error"]["sides"]
true = abs(k["mirrored"]["k_finest"] / k["periodic"]["k_finest"] - 1)
assert true > 0.02 and 0.5 * true < said < 2 * true, (said, true)
# And what a tube would do.
tube = k["periodic"]["error"]["dlnk_sides_closed"]
closed = math.log(k["closed"]["k_finest"] / k["periodic"]["k_finest"])
assert closed < -0.3 and 0.7 * closed > tube > 1.4 * closed, (tube, closed)
assert k["mirrored"]["error"]["dlnk_sides_closed"] is None
assert k["mirrored"]["error"]["sides"] is None and k["closed"]["error"]["sides"] is None
assert k["periodic"]["error"]["total"] >= said
END
}

# round.raw, balls that wrap round, part.raw, the same less a quarter of its layers, and models of them; said.txt
balls() {
  python3 -c 'n = 24
d = lambda a, b: min(abs(a - b), n - abs(a - b)) ** 2
balls = [(3, 20, 1), (15, 4, 22), (9, 12, 11), (20, 14, 4), (1, 8, 17)]
open("round.raw", "wb").write(bytes(any(d(x, p) + d(y, q) + d(z, r) < 40 for p, q, r in balls)
                                    for z in range(n) for y in range(n) for x in range(n)))'
  head -c $((24 * 24 * 18)) round.raw > part.raw
  ct2model build round.raw --raw 24x24x24:u8 --voxel-size 5um --segmented 0 --mirror none -o round.hdf 2> said.txt
  run ! grep "meet grain" said.txt
  ct2model build part.raw --raw 24x24x18:u8 --voxel-size 5um --segmented 0 --mirror none -o part.hdf 2> said.txt
  grep -q "meet grain" said.txt
}
@test "pores that are cut where the model repeats itself along the flow are told; of periodic images and mirrored ones none are" {
  balls
}

# bats test_tags=long
@test "pores that are cut: of the sample, with what mends it; and their part in the error of k" {
  small="$ROOT/data-samples/small --voxel-size 8.745um --blur keep -o cut.hdf --force" part="--crop 0,0,0,64,64,28"
  ct2model build $small $part --void-ratio 0.725 --mirror none 2> said.txt
  grep -qE "[1-9][0-9] % of the pores in the first and last layers .*; leave out --mirror none, unless" said.txt
  ct2model build $small --void-ratio 0.6 --crop 0,0,0,40,40,20 2> said.txt | grep -q "(measured 0.6, error +0.0000)" # no -0.0000
  ct2model build $small $part --void-ratio 0.725 --mirror x 2> said.txt
  grep -q "; give --mirror z, unless" said.txt
  for words in "--mirror z" "--mirror x --sides mirrored"; do
    ct2model build $small $part --void-ratio 0.725 $words 2> said.txt
    run ! grep "meet grain" said.txt
  done
  balls
  # The error of its k holds what mirroring it in all axes makes of it, and says what would mend it.
  ct2model build part.raw --raw 24x24x18:u8 --voxel-size 5um --segmented 0 --sides mirrored -o whole.hdf -q
  for name in part whole round; do
    sphsolve run s.cfg --set model.file=$name.hdf -o $name-run --error 5% --json > $name.json 2> $name.txt
  done
  grep -q "part.hdf: pores do not meet .*: build it with --mirror z" part.txt
  run ! grep "do not meet" whole.txt round.txt
  # With the sides mirrored the ends alone are what is wrong.
  ct2model build part.raw --raw 24x24x18:u8 --voxel-size 5um --segmented 0 --mirror none --sides mirrored -o ends.hdf -q
  sphsolve run s.cfg --set model.file=ends.hdf -o ends-run --error 5% --time 60s --json > ends.json 2> ends.txt
  /usr/bin/python3 - <<'END'
import json
k = {n: json.load(open(n + ".json")) for n in ("part", "whole", "round", "ends")}
change = k["whole"]["k"] / k["part"]["k"] - 1
assert change > 0.15, change
assert change < k["part"]["error"]["sides"] < 3 * change, (change, k["part"]["error"])
change = k["whole"]["k"] / k["ends"]["k"] - 1
assert abs(change) < k["ends"]["error"]["sides"] < 3 * abs(change), (change, k["ends"]["error"])
assert k["ends"]["error"]["dlnk_sides_closed"] is None
END
}

# bats test_tags=long
@test "the share of the scan is that of fine lattices, where slits of few voxels are wider than a site" {
  # Balls whose parts meet in slits where the image is wrapped round.
  /usr/bin/python3 - <<'END'
import numpy as np
z, y, x = np.mgrid[:90, :90, :90] / 6
d = lambda a, b: np.minimum(abs(a - b), 24 - abs(a - b))**2
balls = [(3, 20, 1), (15, 4, 22), (9, 12, 11), (20, 14, 4), (1, 8, 17)]
sum(d(x, p) + d(y, q) + d(z, r) < 46 for p, q, r in balls).clip(0, 1).astype(np.uint8).tofile("fine.raw")
END
  ct2model build fine.raw --raw 90x90x90:u8 --voxel-size 1um --segmented 0 --mirror none -q -o fine.hdf 2> said.txt
  sphsolve run s.cfg --set model.file=fine.hdf -o fine-run --error 3% --json > fine.json
  # The fourth lattice, whose sites are several voxels wide, has .016, the finest .042.
  /usr/bin/python3 -c 'import json; e = json.load(open("fine.json"))["error"]["dlnk_blurred_again"]; assert 0.03 < e < 0.06, e'
}

@test "throats of one or two voxels: no small error, and the share of the sides is said to be unknown" {
  # A bubble between throats of 1 x 2 and of 2 x 2 voxels: the first is closed on any coarser lattice, both by a blur.
  python3 - <<'END'
for wide in 1, 2:
    pore = lambda x, y, z: (x - 11.5) ** 2 + (y - 11.5) ** 2 + (z - 11.5) ** 2 < 49 or 12 - wide < x < 13 and y in (11, 12)
    open(f"throat{wide}.raw", "wb").write(bytes(not pore(i % 24, i // 24 % 24, i // 576) for i in range(24**3)))
END
  for wide in 1 2; do
    ct2model build throat$wide.raw --raw 24x24x24:u8 --voxel-size 5um --segmented 0 --mirror none -q -o throat$wide.hdf
    sphsolve run s.cfg --set model.file=throat$wide.hdf -o throat$wide-run > throat$wide.txt
    sphsolve run s.cfg --set model.file=throat$wide.hdf -o throat$wide-run --force --json > throat$wide.json
  done
  grep -q "^error .*resolution 100 %, scan 100 %, sides not counted (unknown)" throat1.txt || { cat throat1.txt; false; }
  analyze darcy throat1-run.hdf | grep -q "sides unknown, not counted"
  analyze report throat1-run.hdf -o throat.html && said throat.html -q "sides do to k is not known"
  python3 -c 'import json; e = json.load(open("throat2.json"))["error"]; assert e["scan"] >= 1 and e["resolution"] < 0.75, e'
}

@test "a stack of 192 kB is enough for a run, its parts of the error and a tensor" {
  [ -z "$SANITIZE" ] || skip "sanitizers take more of it"
  ct2model build sphere.raw $CUBE --segmented 0 -q -o small.hdf
  ulimit -S -s 192
  sphsolve run s.cfg --set model.file=small.hdf -o small-run --error 20% -q
  sphsolve run s.cfg --set model.file=small.hdf -o small-tensor --tensor -q
  analyze report small-run.hdf -o small.html -q
}

@test "two labels are found where the first, middle and last slices show one" {
  /usr/bin/python3 -c "open('layers.raw', 'wb').write(bytes(6 <= z < 9 for z in range(24) for _ in range(144)))"
  ct2model build layers.raw --raw 12x12x24:u8 --voxel-size 26.666667um --mirror none --json -o layers.hdf > layers.json
  jq -e '.segmented.pore == [0] and .segmented.grain == [1]' layers.json
}

@test "a body whose pores lead along another axis is told which --flow that is" {
  cd "$BATS_TEST_TMPDIR"
  /usr/bin/python3 -c 'import numpy as np
image = np.ones((12, 14, 16), "u1")
image[4:8, 5:9, :] = 0
np.save("duct.npy", image)'
  local build="ct2model build duct.npy --segmented 0 --voxel-size 5um --mirror none --quiet -o duct.hdf"
  [[ "$(${build/--quiet/} 2>&1)" == *"nothing can flow; one leads along x: --flow x makes that axis z"* ]]
  [[ "$(${build/--quiet/} --flow y 2>&1)" == *"nothing can flow; one leads along y: --flow x makes that axis z"* ]]
  [[ "$(${build/--quiet/} --flow x 2>&1)" != *"nothing can flow"* ]]
}

@test "what the steps of labels leave in k counts however few lattices there are: a tube of six voxels" {
  # Poiseuille 1840, for a circle of its 32 voxels.
  python3 -c 'open("tube.raw", "wb").write(bytes((i - 6.5) ** 2 + (j - 6.5) ** 2 > 9 for _ in range(24) for j in range(14) for i in range(14)))'
  ct2model build tube.raw --raw 14x14x24:u8 --segmented 0 --voxel-size 5um --mirror none -o tube.hdf --quiet --force
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=tube.hdf -o tube-run --error 5% --json --quiet --force > tube.json
  python3 -c 'import json, math
run = json.load(open("tube.json"))
exact = 32**2 / (8 * math.pi) / 14**2 * 5e-6**2
assert run["error"]["scan"] > 0 and len(run["levels"]) < 3, run["error"]
assert abs(run["intrinsic_permeability"] / exact - 1) < run["error"]["total"], (run["intrinsic_permeability"], exact, run["error"])'
}
