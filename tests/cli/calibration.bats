#!/usr/bin/env bats
# Calibration with more or less than one void ratio and voxel size; profiles of a model; what the shell completes.

bats_require_minimum_version 1.5.0
setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH" OMP_NUM_THREADS=1
  # A quarter of it: a build in a fifth of the time.
  export SCAN="$ROOT/data-samples/small --crop 0,0,0,96,96,24 --size 12x12x3 --quiet"
}
setup() { cd "$BATS_FILE_TMPDIR"; }

@test "a list of void ratios: each as if it were alone" {
  ct2model build $SCAN --voxel-size 8.745um --void-ratio 0.65,0.725+-0.01,0.8 --levels 2 -o list.hdf --json > list.json
  ct2model sweep $SCAN --voxel-size 8.745um --void-ratio 0.65,0.725+-0.01,0.8 -o list.csv --json > sweep.json
  for e in 0.65 0.725+-0.01 0.8; do
    ct2model build $SCAN --voxel-size 8.745um --void-ratio $e -o one-${e%+*}.hdf --json > one-${e%+*}.json
  done
  [ -e list-e0.65-8.hdf ]
  [ -e list-e0.8-8.hdf ]
  [ ! -e list.hdf ]
  /usr/bin/python3 - <<'END'
import json
every, sweep = json.load(open("list.json")), json.load(open("sweep.json"))
assert len(every["void_ratios"]) == len(sweep["void_ratios"]) == 2
for e, model, swept in zip((0.65, 0.725, 0.8), [every] + every["void_ratios"], [sweep] + sweep["void_ratios"]):
    alone = json.load(open(f"one-{e}.json"))
    assert model["output"] == f"list-e{e}.hdf" and len(model["coarser"]) == 1
    for key in ("void_ratio_measured", "threshold", "threshold_uncertainty", "void_ratio", "dthreshold_dvoid_ratio", "porosity"):
        assert model[key] == alone[key], (e, key)
    assert abs(swept["threshold_original"] - alone["threshold_original"]) < 1e-9
assert sweep["threshold"] < sweep["void_ratios"][1]["threshold"]  # more pore: a higher threshold
END
  # A coarser level, whose scanner was measured with the finest's, too.
  ct2model build ${SCAN/12x12x3/8x8x2} --voxel-size 8.745um --void-ratio 0.65 -o one-8.hdf
  /usr/bin/python3 - <<'END'
import h5py
level, alone = h5py.File("list-e0.65-8.hdf"), h5py.File("one-8.hdf")
for name in ("solid", "wall_distance", "grain_fraction"):
    assert (level["model"][name][()] == alone["model"][name][()]).all(), name
assert len(level["scanner"].attrs) > 5 and str(dict(level["scanner"].attrs)) == str(dict(alone["scanner"].attrs))
END
  [ "$(head -1 list.csv | cut -d, -f1,2)" = threshold,void_ratio ]
  ct2model sweep ${SCAN% --quiet} --voxel-size 8.745um --void-ratio 0.65,0.8 -o two.csv > two.txt
  [ "$(grep -n written two.txt)" = "$(grep -n . two.txt | tail -1)" ]
}

# bats test_tags=long
@test "a sweep of the scan's own voxels, and the threshold's error, are the scan's whatever the model's size" {
  local scan="$ROOT/data-samples/small --voxel-size 8.745um --void-ratio 0.725+-0.02 --crop 0,0,0,64,64,28"
  for size in 64x64x28 32x32x14 16x16x7; do ct2model sweep $scan --size $size > $size.txt 2> $size.log; done
  run ! grep -qE "within the walls|too few grey levels" 64x64x28.txt 64x64x28.log # no walls were looked for
  [ "$(sed -n 's/^threshold *\(.*\) (.*/\1/p' *x*x*.txt | sort -u | wc -l)" -eq 1 ]
}

@test "a sweep needs no voxel size, and tells no length without; a model needs one" {
  /usr/bin/python3 - <<'END'
import random
random.seed(3)
grey = lambda x, y, z: int(random.gauss(60 if (x // 5 + y // 4 + z // 6) % 3 == 0 else 180, 12))
open("plain.raw", "wb").write(bytes(max(0, min(255, grey(x, y, z))) for z in range(20) for y in range(24) for x in range(24)))
END
  local image="plain.raw --raw 24x24x20:u8 --size 12x12x10 --void-ratio 0.5"
  ct2model sweep $image --json > unsized.json
  ct2model sweep $image --voxel-size 5um --json > sized.json
  ct2model sweep $image > unsized.txt 2> said.txt
  grep -q "no voxel size" said.txt
  grep -q "^threshold" unsized.txt
  run ! grep -qE "specific surface|[0-9] [um]?m\b" unsized.txt
  /usr/bin/python3 - <<'END'
import json
a, b = json.load(open("unsized.json")), json.load(open("sized.json"))
for key in a:
    lengths = key.endswith(("_m", "_per_m")) or key == "scanner"
    assert lengths or a[key] == b[key], key
assert a["voxel_size_m"] is None and a["specific_surface_per_m"] is None and b["specific_surface_per_m"] > 0
END
  run --separate-stderr ct2model build $image -o m.hdf
  [ "$status" -eq 3 ]
  [[ "$stderr" == *--voxel-size* ]]
}

@test "profiles: porosity and pore width by layer are those of the model's arrays" {
  # Slits across x: pores of 6 voxels between plates of 4 and of 2, so that layers and widths are known.
  /usr/bin/python3 - <<'END'
import h5py, numpy as np
h, solid = 2e-6, np.ones((5, 6, 24), "u1")
solid[:, :, 0:6] = solid[:, :, 10:20] = 0
x = np.arange(24)
distance = np.where(x < 6, 3 - abs(x + 0.5 - 3), np.where((x >= 10) & (x < 20), 5 - abs(x + 0.5 - 15), -np.minimum(abs(x + 0.5 - 8) - 2, 0) * -1))
distance = np.where(solid[0, 0] == 1, -np.minimum.reduce([abs(x + 0.5 - e) for e in (6, 10, 20, 24)]), distance)
with h5py.File("slits.hdf", "w") as file:
    file["model/solid"] = solid
    file["model"].attrs["spacing"] = [h, h, h]
    file["model/wall_distance"] = np.broadcast_to(distance * h, solid.shape).astype("f4")
END
  ct2model export slits.hdf -o slits.csv
  ct2model export slits.hdf -o slits.csv --quiet # its own product is replaced
  /usr/bin/python3 - <<'END'
import csv
rows = list(csv.DictReader(open("slits.csv")))
of = {a: [r for r in rows if r["axis"] == a] for a in ("x", "y", "z", "width")}
assert [len(of[a]) for a in "xyz"] == [24, 6, 5]
h = 2e-6
for i, row in enumerate(of["x"]):
    pore = i < 6 or 10 <= i < 20
    assert abs(float(row["position_m"]) - (i + 0.5) * h) < 1e-12 and float(row["porosity"]) == pore
    if pore:
        wide = 6 if i < 6 else 10
        assert abs(float(row["pore_width_m"]) / (wide * h) - 1) < 0.2, (i, row)
    else:
        assert row["pore_width_m"] == ""
assert all(abs(float(r["porosity"]) - 16 / 24) < 1e-6 for r in of["y"] + of["z"])
assert abs(sum(float(r["porosity"]) for r in of["width"]) - 1) < 1e-6
END
  cp "$ROOT/README.md" notes.csv
  run --separate-stderr ct2model export slits.hdf -o notes.csv
  [ "$status" -eq 2 ]
  cmp "$ROOT/README.md" notes.csv
}

# What bash would offer for a line that ends where the cursor is.
offered() {
  bash -c 'source "$1"; compopt() { :; }
    COMP_LINE=$2 COMP_POINT=${#2}
    read -ra COMP_WORDS <<< "${2//=/ = }"
    [[ $2 == *" " ]] && COMP_WORDS+=("")
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    _tosui
    printf "%s\n" "${COMPREPLY[@]}" | sort | tr "\n" " "' _ "$ROOT/scripts/tosui-completion.bash" "$1"
}

@test "bash completes commands, options, values, keys of a scene and their values" {
  cp "$ROOT/data-samples/scenes/poiseuille.cfg" s.cfg
  [ "$(offered "ct2model bu")" = "build " ]
  [[ "$(offered "ct2model build x --si")" == *"--sides --size "* ]]
  [ "$(offered "ct2model build x --sides ")" = "closed mirrored periodic " ]
  [ "$(offered "ct2model build x --grain d")" = "dark " ]
  [ "$(offered "ct2model sweep x --filter bi")" = "bicubic bicubic-point " ]
  [ "$(offered "ct2model build x --threshold ")" = "auto otsu " ]
  [[ "$(offered "sphsolve run s.cfg --set sc")" == "scene. " ]]
  [ "$(offered "sphsolve run s.cfg --set scene.")" = "scene.end_time= scene.method= scene.name= scene.steady_tolerance= " ]
  [ "$(offered "sphsolve explain s.cfg --set scene.method=")" = "auto darcy isph richards solute stokes wcsph " ]
  [ "$(offered "sphsolve run s.cfg --set output.image=")" = "false true " ]
  [ "$(offered "sphsolve run s.c")" = "s.cfg " ]
  mkdir -p "my scan"
  [ "$(offered "ct2model info my")" = "my scan " ]
}

@test "bash at a terminal: a name with a space is quoted, and a value follows the key that was completed" {
  command -v python3 || skip "no python3"
  mkdir -p "my scan" && cp "$ROOT/data-samples/scenes/poiseuille.cfg" s.cfg
  cat > typed.py << 'END'
import os, pty, select, sys
child, terminal = pty.fork()
if child == 0:
    os.execvp("bash", ["bash", "--norc", "-i"])
def told(seconds):
    text = b""
    while select.select([terminal], [], [], seconds)[0]:
        text += os.read(terminal, 9999)
        if until in text: break
    return text.decode()
def typed(keys, wanted):
    global until
    until = wanted
    os.write(terminal, keys)
    text = told(20)
    assert wanted.decode() in text, text
typed(b". " + sys.argv[1].encode() + b"; echo rea''dy\n", b"ready")
typed(b"ct2model info my\t", b"my\\ scan")
typed(b"\x15sphsolve run s.cfg --set scene.me\t", b"scene.method=")
typed(b"stok\t", b"es")
END
  python3 typed.py "$ROOT/scripts/tosui-completion.bash"
}
