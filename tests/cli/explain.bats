#!/usr/bin/env bats
# The plan of every sample scene, held against tests/cli/golden/NAME.txt. After a wanted change:
#   UPDATE_GOLDEN=1 BUILD=$PWD/build bats tests/cli/explain.bats

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_path
  sample_model 32x32x14 dense.hdf
}

@test "explain of every sample scene is as recorded" {
  cd "$BATS_FILE_TMPDIR"
  failed=0
  for scene in "$ROOT"/data-samples/scenes/*.cfg; do
    name=$(basename "$scene" .cfg)
    golden=$ROOT/tests/cli/golden/$name.txt
    set_model=()
    grep -q '^model' "$scene" && set_model=(--set model.file=dense.hdf)
    sphsolve explain "$scene" "${set_model[@]}" --threads 2 > "$name.txt" || { echo "$name: explain failed"; failed=1; }
    if [ -n "$UPDATE_GOLDEN" ]; then cp "$name.txt" "$golden"; fi
    diff -u "$golden" "$name.txt" || failed=1
  done
  [ $failed -eq 0 ]
}

@test "isph: the least dt that a refusal names is one that passes" {
  cd "$BATS_TEST_TMPDIR"
  cat > tank.cfg <<'SCENE'
scene = { name = "tank"; method = "isph"; end_time = "1 s"; };
domain = { size = ["1 m", "0.5 m"]; spacing = "2 cm"; periodic = [false, false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "1 m", "0.4 m"]; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
SCENE
  for end in "1 s" "70 s"; do
    run sphsolve explain tank.cfg --set isph.dt='1e-9 s' --set scene.end_time="$end"
    [ "$status" -ne 0 ]
    least=$(sed -n 's/.*a dt of at least \(.*\) s$/\1/p' <<< "$output")
    sphsolve explain tank.cfg --set isph.dt="$least s" --set scene.end_time="$end"
  done
}

@test "no golden file without its scene" {
  for golden in "$ROOT"/tests/cli/golden/*.txt; do
    [ -e "$ROOT/data-samples/scenes/$(basename "$golden" .txt).cfg" ]
  done
}

@test "method isph: steps as predicted, within a factor 2 of those a run takes" {
  cd "$BATS_FILE_TMPDIR"
  scenes=$ROOT/data-samples/scenes
  while read -r scene sets; do
    set -- $sets
    sphsolve explain "$scenes/$scene" "$@" --threads 1 --json > predicted.json
    sphsolve run "$scenes/$scene" "$@" --threads 1 -o pace --json > took.json
    /usr/bin/python3 - "$scene" <<'END'
import json, sys
predicted, took = json.load(open("predicted.json")), json.load(open("took.json"))
assert 0.5 < predicted["steps"] / took["steps"] < 2, (sys.argv[1], predicted["steps"], took["steps"])
END
  done <<'END'
still-tank.cfg --set isph.dt=auto --set scene.end_time=1s
dam-break.cfg --set domain.spacing=1.46cm
seepage-dam.cfg --set scene.end_time=1.5s
seepage-heads.cfg --set scene.method=isph --set isph.dt=auto --set scene.end_time=1s
seepage-heads.cfg
seepage-column.cfg
gate.cfg
END
}

@test "wcsph with Wendland's kernel: explain and the run file say so, and k of a slit is exact" {
  cd "$BATS_FILE_TMPDIR"
  scene=$ROOT/data-samples/scenes/poiseuille.cfg
  sphsolve explain "$scene" --set wcsph.kernel=wendland | grep -q "^spacing .*, kernel wendland$"
  sphsolve run "$scene" --set wcsph.kernel=wendland -o wendland --json > wendland.json
  /usr/bin/python3 - <<'END'
import h5py, json
run = h5py.File("wendland.hdf", "r")["run"]
assert run.attrs["kernel"] in (b"wendland", "wendland")
exact = 1e-4 * 1e-3**2 / 12 / 1e-6  # force w^2 / (12 nu), over the slit
assert abs(json.load(open("wendland.json"))["darcy_velocity"][0] / exact - 1) < 2e-3
END
  run sphsolve explain "$scene" --set wcsph.kernel=cubic
  [ "$status" -eq 3 ]
}

@test "a run to an error records the time that explain foretells for it" {
  cd "$BATS_FILE_TMPDIR"
  sphsolve explain "$ROOT/data-samples/scenes/demo.cfg" --set model.file=dense.hdf --error 30% --threads 2 --json > told.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=dense.hdf --error 30% --threads 2 -o told --quiet > /dev/null
  /usr/bin/python3 - << 'END'
import json
import h5py
told = json.load(open("told.json"))["levels"][-1]["seconds"]
with h5py.File("told.hdf") as run:
    kept = run["run/timing"].attrs["predicted_seconds"]
assert abs(kept - told - 0.02) < 1e-6 * told, (kept, told)  # the program's own start beside it
END
}

@test "explain of a model that nothing leads through: k is 0, with the reason that the run gives, and no time or error" {
  cd "$BATS_FILE_TMPDIR"
  /usr/bin/python3 - <<'END'
import h5py, numpy as np
solid = np.zeros((12, 12, 12), "u1")
solid[3:6] = 1  # a layer across z; along x all is open
corners = np.ones((12, 12, 12), "u1")
corners[:6, :, :6] = corners[6:, :, 6:] = 0  # two channels that meet at edges alone
for name, voxels in ("layer", solid), ("corners", corners):
    with h5py.File(f"{name}.hdf", "w") as f:
        f["model/solid"] = voxels
        f["model"].attrs["spacing"] = [1e-5] * 3
END
  cat > layer.cfg <<'END'
scene = { name = "layer"; end_time = "1 ms"; };
model = { file = "layer.hdf"; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-1 m/s^2"]; };
END
  for method in stokes wcsph; do
    for more in "" "--error 20%"; do
      sphsolve explain layer.cfg --set scene.method=$method $more > said.txt
      grep -q "^blocked    no pore leads through the model along the force: k is 0" said.txt
      run ! grep -E "^(time  |error|iterations|steps|run with|wanted)" said.txt
    done
    sphsolve run layer.cfg --set scene.method=$method -o layer-run > ran.txt 2>&1
    grep -qF "$(sed -n 's/^blocked *//p' said.txt)" ran.txt
    sphsolve explain layer.cfg --set scene.method=$method --json --error 20% > said.json
    /usr/bin/python3 - <<'END'
import json
said = json.load(open("said.json"))
assert said["blocked"] and said["levels"] == [] and "cheapest" not in said
assert all(said[key] is None for key in ("seconds", "expected_error", "expected_error_scan")), said
END
    sphsolve explain layer.cfg --set scene.method=$method --set 'force.body_acceleration=["1 m/s^2","0","0"]' > open.txt
    run ! grep blocked open.txt
    grep -q "^time  " open.txt
  done
  # Particles that move pass where sites touch by edges, those of stokes do not: as in their runs.
  for words in "stokes 1" "wcsph 0"; do
    set -- $words
    [ "$(sphsolve explain layer.cfg --set model.file=corners.hdf --set scene.method=$1 --set wcsph.wall=frozen | grep -c ^blocked)" -eq "$2" ]
  done
}

# bats test_tags=long
@test "what finer lattices for a large effect of the sides take is said: more than that a run does not take" {
  cd "$BATS_FILE_TMPDIR"
  # Slits along z that meet nothing of themselves when mirrored: the effect is as large as can be.
  /usr/bin/python3 - <<'END'
import numpy as np
z, y, x = np.mgrid[:40, :40, :40]
np.save("leaning.npy", np.where((x + z) % 40 < 8, 0, 255).astype("u1"))
END
  ct2model build leaning.npy --segmented 0 --voxel-size 5um --mirror none --quiet -o leaning.hdf
  ct2model build leaning.npy --segmented 0 --voxel-size 5um --sides mirrored --quiet -o mirrored.hdf
  demo="$ROOT/data-samples/scenes/demo.cfg --threads 1 --set model.file"
  sphsolve explain $demo=leaning.hdf --json > told.json
  /usr/bin/python3 - "$(command -v sphsolve)" $demo=leaning.hdf <<'END'
import json, os, subprocess, sys
child = subprocess.Popen([sys.argv[1], "run", *sys.argv[2:], "--quiet", "-o", "leaning-run"])
_, code, usage = os.wait4(child.pid, 0)
child.returncode = code
told, peak = json.load(open("told.json")), 1024 * usage.ru_maxrss
print(f"{peak / 1e6:.1f} of {told['memory_bytes'] / 1e6:.1f}, {told['memory_sides_bytes'] / 1e6:.1f} MB")
assert code == 0 and told["seconds_sides"] > 0 and told["memory_bytes"] < peak <= told["memory_sides_bytes"]
END
  sphsolve explain $demo=mirrored.hdf > told.txt
  run ! grep "sides turn out" told.txt
}

@test "a run of more than 30 days is warned of before it begins" {
  scene=$ROOT/data-samples/scenes/still-tank.cfg
  run --separate-stderr sphsolve explain "$scene" --set isph.dt=auto --set scene.end_time=1e8s
  [ $status -eq 0 ]
  [[ $stderr == *"this run will take about"*"an earlier end makes it shorter" ]]
  run --separate-stderr sphsolve explain "$scene" --set isph.dt=auto --set scene.end_time=1e6s
  [ -z "$stderr" ]
}
