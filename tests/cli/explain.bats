#!/usr/bin/env bats
# The plan of every sample scene, held against tests/cli/golden/NAME.txt. After a wanted change:
#   UPDATE_GOLDEN=1 BUILD=$PWD/build bats tests/cli/explain.bats

load programs
setup_file() {
  programs_path
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --size 32x32x14 -o dense.hdf --quiet > /dev/null
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

@test "no golden file without its scene" {
  for golden in "$ROOT"/tests/cli/golden/*.txt; do
    [ -e "$ROOT/data-samples/scenes/$(basename "$golden" .txt).cfg" ]
  done
}

@test "explain --ranks: one rank is the plan itself; many have less memory each, and no less than their share of the time" {
  cd "$BATS_FILE_TMPDIR"
  for scene in "s06.cfg --set model.file=dense.hdf" "s06.cfg --set model.file=dense.hdf --set scene.method=stokes" dam-break.cfg; do
    for ranks in 1 3 1000; do
      sphsolve explain "$ROOT/data-samples/scenes/"$scene --threads 1 --json --ranks $ranks > "ranks$ranks.json"
    done
    /usr/bin/python3 - <<'END'
import json
one, three, many = (json.load(open(f"ranks{n}.json")) for n in (1, 3, 1000))
close = lambda a, b: abs(a - b) <= 1e-9 * abs(b)
assert close(one["ranks"]["memory_bytes"], one["memory_bytes"]) and close(one["ranks"]["seconds"], one["seconds"])
assert many["ranks"]["memory_bytes"] < three["ranks"]["memory_bytes"] < one["memory_bytes"]
assert one["seconds"] / 3 <= three["ranks"]["seconds"] and three["ranks"]["efficiency"] <= 1
assert many["ranks"]["used"] <= 1000 and many["ranks"]["efficiency"] < three["ranks"]["efficiency"]
END
  done
  run sphsolve explain "$ROOT/data-samples/scenes/dam-break.cfg" --ranks 0
  [ "$status" -eq 2 ]
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
seepage-heads.cfg --set isph.dt=auto --set scene.end_time=1s
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
  /usr/bin/python3 -c 'import h5py' 2> /dev/null || skip "python3-h5py is not installed"
  /usr/bin/python3 - << 'END'
import json
import h5py
told = json.load(open("told.json"))["levels"][-1]["seconds"]
with h5py.File("told.hdf") as run:
    kept = run["run/timing"].attrs["predicted_seconds"]
assert abs(kept - told - 0.02) < 1e-6 * told, (kept, told)  # the program's own start beside it
END
}
