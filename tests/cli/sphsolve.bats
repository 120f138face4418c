#!/usr/bin/env bats
# sphsolve as a user meets it: help, wrong options, bad scenes, explain, run, JSON, exit codes.

bats_require_minimum_version 1.5.0
setup_file() { export SPH="${BUILD:-build}/bin/sphsolve" ROOT="$BATS_TEST_DIRNAME/../.."; }
setup() { cd "$BATS_TEST_TMPDIR"; }

slit() { # a slit of $1 particles, body force along x
  cat > slit.cfg <<END
scene = { name = "slit"; };
domain = { size = ["0.8 mm", "${1:-8}e-4 m"]; spacing = "0.1 mm"; periodic = [true, false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.8 mm", "${1:-8}e-4 m"]; } );
force = { body_acceleration = ["1e-4 m/s^2", "0"]; };
END
}

@test "help and version" {
  run "$SPH" --help
  [ "$status" -eq 0 ]
  [[ "$output" == *"explain"* ]]
  run "$SPH" run --help
  [ "$status" -eq 0 ]
  [[ "$output" == *"Example:"* && "$output" == *"--resume"* ]]
  [ "$(echo "$output" | wc -l)" -le 24 ]
  run "$SPH" --version
  [ "$status" -eq 0 ]
  [[ "$output" == "sphsolve 0."* ]]
}

@test "wrong usage ends with exit code 2 and one line" {
  for words in "" "rum" "run" "run a b -o c" "run --out" "explain --sett x=1 a" "run a.cfg --threads zero -o b" \
               "explain a.cfg --resume" "run a.cfg -o" "explain a.cfg --max-memory 3"; do
    run --separate-stderr "$SPH" $words
    [ "$status" -eq 2 ] || { echo "$words: $status $stderr"; false; }
    [ "$(echo "$stderr" | wc -l)" -eq 1 ]
    [[ "$stderr" == "sphsolve: "* ]]
  done
  run --separate-stderr "$SPH" explain --hlep
  [[ "$stderr" == *"did you mean '--help'"* ]]
  run --separate-stderr "$SPH" explain x.cfg --tensor
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"--tensor is an option of run, not of explain"* ]]
}

@test "threads that wait for each other most of the time are told of, before the work" {
  slit
  local processors
  processors=$(env -u OMP_NUM_THREADS nproc) # which looks at it
  run --separate-stderr "$SPH" explain slit.cfg --threads $((4 * processors + 1))
  [ "$status" -eq 0 ]
  [[ "$stderr" == "sphsolve: warning: $((4 * processors + 1)) threads on $processors processor"*": --threads $processors is faster" ]] ||
    { echo "$stderr"; false; }
  run --separate-stderr "$SPH" explain slit.cfg --threads $((4 * processors))
  [ "$status" -eq 0 ] && [[ "$stderr" != *"threads on"* ]]
}

@test "overrides beyond those that are possible are refused, not dropped" {
  slit
  many=()
  for ((n = 0; n < 257; n++)); do many+=(--set "a.key$n=1"); done
  run --separate-stderr "$SPH" explain slit.cfg "${many[@]}"
  [ "$status" -eq 2 ]
  [[ "$stderr" == "sphsolve: --set: 256 overrides are possible"* ]]
}

@test "isph: walls that no list of neighbours holds are an error, and are not left out" {
  cat > dense.cfg <<END
scene = { name = "dense"; method = "isph"; end_time = "1 s"; };
domain = { size = ["5 cm", "5 cm", "30 cm"]; spacing = "1 cm"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0", "5 cm", "5 cm", "30 cm"]; },
  { type = "porous"; box = ["0", "0", "0", "5 cm", "5 cm", "28 cm"]; porosity = 0.02; grain_size = "1 mm"; } );
force = { gravity = ["0", "0", "-9.81 m/s^2"]; };
isph = { support_ratio = 6.0; };
END
  run --separate-stderr "$SPH" run dense.cfg -o dense --quiet
  [ "$status" -ne 0 ]
  [[ "$stderr" == *"more than 16384 wall particles within the support"* ]]
}

@test "missing and broken files end with exit code 3 and name the file" {
  run --separate-stderr "$SPH" explain nowhere.cfg
  [ "$status" -eq 3 ]
  [[ "$stderr" == "sphsolve: nowhere.cfg: "* ]]
  printf 'scene = { name = "x"\0 };' > zero.cfg
  run --separate-stderr "$SPH" explain zero.cfg
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"zero bytes"* ]]
  printf '\211HDF\r\n\032\n\0\0' > model.hdf
  run --separate-stderr "$SPH" run model.hdf -o x
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"is an HDF5 file; a scene is text"* ]]
  # What Windows' editors write: with a mark before the text; in UTF-16.
  printf '\357\273\277' | cat - "$BATS_TEST_DIRNAME/../../data-samples/scenes/still-tank.cfg" > mark.cfg
  "$SPH" explain mark.cfg --quiet > explained
  grep -q '^scene .*still-tank' explained
  printf '\377\376s\0' > wide.cfg
  run --separate-stderr "$SPH" explain wide.cfg
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"save it as UTF-8"* ]]
  run --separate-stderr "$SPH" explain .
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"is a folder, not a file"* ]]
  slit
  run --separate-stderr "$SPH" explain slit.cfg --set model.file=slit.cfg
  [ "$status" -eq 3 ]
  for place in fluids.viscosity 'fluids[7].viscosity'; do
    run --separate-stderr "$SPH" explain slit.cfg --set "$place=2e-3 Pa s"
    [ "$status" -eq 2 ]
    [[ "$stderr" == *"from 0, like fluids[0].viscosity" ]]
  done
  echo 'scene = { name = "m"; }; model = { file = "broken.hdf"; };
    fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } ); force = { gravity = ["0", "0", "-9.8 m/s^2"]; };' > m.cfg
  head -c 4000 /dev/urandom > broken.hdf
  run --separate-stderr "$SPH" explain m.cfg
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"broken.hdf: is no HDF5 file"* ]]
}

@test "an unknown key is named with file, line and the nearest key" {
  slit
  sed -i 's/spacing/spacin/' slit.cfg
  run --separate-stderr "$SPH" explain slit.cfg
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"slit.cfg:2: "*"did you mean 'spacing'"* ]]
}

@test "explain says what is on and why, also as JSON" {
  slit
  run "$SPH" explain slit.cfg
  [ "$status" -eq 0 ]
  [[ "$output" == *"effects"* && "$output" == *"memory"* ]]
  run --separate-stderr "$SPH" explain slit.cfg --json
  [ "$status" -eq 0 ]
  echo "$output" | python3 -c 'import json, sys; d = json.load(sys.stdin); assert d["effects"] and d["memory_bytes"] > 0'
}

@test "run leaves history, snapshot and record; JSON holds the contract's keys" {
  slit
  run --separate-stderr "$SPH" run slit.cfg -o out --json
  [ "$status" -eq 0 ] || { echo "$stderr"; false; }
  echo "$output" | python3 -c '
import json, sys
d = json.load(sys.stdin)
for key in "k intrinsic_permeability darcy_velocity reynolds steps wall_time pair_interactions_per_second status".split():
    assert key in d, key
# Plane Poiseuille flow: v = F w^2 / (12 nu) with w = 0.8 mm
v, exact = d["darcy_velocity"][0], 1e-4 * 0.8e-3 ** 2 / 12e-6
assert abs(v / exact - 1) < 0.01, (v, exact)
assert abs(d["k"] / (v / (1e-4 / 9.80665)) - 1) < 1e-9
assert abs(d["intrinsic_permeability"] / (0.8e-3 ** 2 / 12) - 1) < 0.01'
  [ -s out.hdf ]
  [ -s out-0000.hdf ]
  [ -s out.hdf.series ]
  [ -z "$(ls *.part 2>/dev/null)" ]
}

@test "k between two heads, with an error; null in a tank" {
  cd "$BATS_TEST_TMPDIR"
  local scenes=$BATS_TEST_DIRNAME/../../data-samples/scenes
  "$SPH" run "$scenes/seepage-heads.cfg" --set scene.end_time='"1 s"' --set output.history_interval='"0.05 s"' -o heads --json --quiet > heads.json
  "$SPH" run "$scenes/still-tank.cfg" --set scene.end_time='0.01 s' -o tank --json --quiet > tank.json
  python3 -c '
import json
heads, tank = json.load(open("heads.json")), json.load(open("tank.json"))
assert abs(heads["k"] / (0.018621 / 0.5) - 1) < 1e-4 and 0 < heads["k_relative_error"] < 0.1, heads
assert abs(heads["reynolds"] / (0.018621 / 0.4 * (2 / 3 * 5e-3 * 0.4 / 0.6) / 1e-6) - 1) < 0.03, heads
assert tank["k"] is None and tank["reynolds"] is None, tank'
  local analyze=${SPH%sphsolve}analyze
  "$analyze" darcy heads.hdf -o darcy > /dev/null
  python3 -c '
import json
heads, darcy = json.load(open("heads.json")), json.load(open("darcy/darcy.json"))
assert abs(darcy["k_m_per_s"] / heads["k"] - 1) < 0.02 and darcy["groups"][0]["runs"][0]["hydraulic_gradient"] == 0.5, darcy'
  run --separate-stderr "$analyze" darcy tank.hdf -o tank-darcy
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"tank.hdf: the run has no permeability"* ]]
  [ ! -e tank-darcy ]
  "$SPH" run "$scenes/seepage-heads.cfg" --set scene.method=isph --set scene.end_time='"0.1 s"' --set output.history_interval='"0.05 s"' -o heads --force --quiet
  "$analyze" history heads.hdf -o history > /dev/null
  # Columns in words; work is in the table alone.
  grep -A3 'set ylabel "Pressure (Pa)"' history/history.gp | grep -q 'title "a"'
  ! grep -qi "work" history/history.gp || false
  grep -q work_force history/history.csv
}

@test "an output folder that is not there is refused before the run" {
  slit
  run --separate-stderr "$SPH" run slit.cfg -o nowhere/out
  [ "$status" -eq 1 ]
  [[ "$stderr" == *"nowhere: "* ]]
}

@test "an independent reader, written from docs/formats.md alone, reads run and snapshot" {
  slit
  "$SPH" run slit.cfg -o out --quiet > /dev/null
  run /usr/bin/python3 "$BATS_TEST_DIRNAME/independent_reader.py" run out.hdf
  [ "$status" -eq 0 ] || { echo "$output"; false; }
  run /usr/bin/python3 "$BATS_TEST_DIRNAME/independent_reader.py" snapshot out-0000.hdf
  [ "$status" -eq 0 ] || { echo "$output"; false; }
}

@test "a run never overwrites its own model" {
  /usr/bin/python3 -c '
import h5py, numpy as np
f = h5py.File("dense.hdf", "w")
g = f.create_group("model")
solid = np.zeros((4, 4, 12), np.uint8)
solid[:, :, :4] = 1
g.create_dataset("solid", data=solid)
g.attrs["spacing"] = [1e-5] * 3'
  echo 'scene = { name = "m"; method = "stokes"; }; model = { file = "dense.hdf"; };
    fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } ); force = { gravity = ["0", "0", "-9.8 m/s^2"]; };' > m.cfg
  before=$(cksum dense.hdf)
  run --separate-stderr "$SPH" run m.cfg -o dense
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"would be overwritten"* ]]
  [ "$(cksum dense.hdf)" = "$before" ]
  # A voxel model needs no more than solid and spacing: plane Poiseuille between voxel faces, w = 8 voxels.
  "$SPH" run m.cfg -o run --json > run.json
  python3 -c '
import json
k = json.load(open("run.json"))["intrinsic_permeability"]
assert abs(k / (8e-5 ** 3 / 12 / 12e-5) - 1) < 0.01, k'
}

@test "every k comes with its error, split, in JSON and in the file that analyze reads" {
  slit
  "$SPH" run slit.cfg -o out --set scene.method=stokes --set stokes.wall=adami --json > run.json
  "$BUILD/bin/analyze" darcy out.hdf --json > darcy.json
  python3 -c '
import json
run, darcy = json.load(open("run.json")), json.load(open("darcy.json"))
k, exact = run["intrinsic_permeability"], 0.8e-3 ** 2 / 12
true, error = abs(k / exact - 1), run["error"]
# Adami walls are known to be off by 2.36 / n^2; the error bar holds that and is not idle.
assert 0.5 * true < error["resolution"] < 2 * true, (true, error)
assert abs(run["k_relative_error"] - error["total"]) < 1e-12
parts = [error[p] for p in ("resolution", "averaging", "steadiness", "void_ratio", "threshold")]
assert abs(sum(p * p for p in parts if p is not None) ** 0.5 - error["total"]) < 1e-12
assert abs(error["extrapolated_permeability"] / exact - 1) < 1e-3
budget = darcy["error_budget"]
assert abs(budget["resolution"] / error["resolution"] - 1) < 1e-9 and budget["resolution_from"] == "lattices"'
}

@test "wcsph that ends before its flow has settled: k's interval holds the steady k, and the share is named" {
  local scene="$BATS_TEST_DIRNAME/../../data-samples/scenes/poiseuille.cfg"
  for end in 0.02 0.1 0.6; do
    "$SPH" run "$scene" -o early --set "scene.end_time=\"$end s\"" --json > early.json
    python3 -c '
import json
run, exact = json.load(open("early.json")), 1e-3 ** 2 / 12  # a slit
per = run["k"] / run["intrinsic_permeability"]
assert run["k"] < 0.999 * exact * per, "it has settled"
assert run["k_low"] < exact * per < 1.0001 * run["k_high"], (run["k_low"], exact * per, run["k_high"])
assert run["error"]["steadiness"] > 100 * run["error"]["resolution"]'
  done
  "$SPH" run "$scene" -o early --set 'scene.end_time="0.1 s"' | grep -q "^verdict .* most of it is what still changes: a longer run"
  run "$BUILD/bin/analyze" darcy early.hdf
  [[ "$output" == *"left out of the fit"* && "$output" != *nan* ]]
  "$SPH" run "$scene" -o early --set 'scene.end_time="0.02 s"' --quiet
  run "$BUILD/bin/analyze" darcy early.hdf
  [[ "$output" == *"one row of history"* && "$output" != *nan* ]]
}

@test "explain --error names a spacing that reaches the error, and it does" {
  cat > duct.cfg << 'END'
scene = { name = "duct"; method = "stokes"; };
domain = { size = ["1 mm", "1 mm", "0.5 mm"]; spacing = "0.25 mm"; periodic = [false, false, true]; };
regions = ( { type = "water"; box = ["0", "0", "0", "1 mm", "1 mm", "0.5 mm"]; } );
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "1e-3 m/s^2"]; };
END
  for wanted in 0.05 0.01; do
    "$SPH" explain duct.cfg --error $wanted --json > plan.json
    eval "$(python3 -c '
import json
best = json.load(open("plan.json"))["cheapest"]["settings"][0]
print("method=%s wall=%s spacing=%.9g" % (best["method"], best["wall"], best["spacing"]))')"
    "$SPH" run duct.cfg -o out --set scene.method=$method --set $method.wall=$wall --set domain.spacing="$spacing m" --json > run.json
    python3 -c '
import json, sys
k = json.load(open("run.json"))["intrinsic_permeability"]
assert abs(k / (0.421731e-6 / 12) - 1) < float(sys.argv[1]), k' $wanted
  done
  run --separate-stderr "$SPH" explain duct.cfg --error 120%
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"--error 120%"* ]]
}

@test "explain predicts memory within a factor of two, and the error" {
  cat > duct.cfg << 'END'
scene = { name = "duct"; method = "stokes"; };
domain = { size = ["1 mm", "1 mm", "1 mm"]; spacing = "25 um"; periodic = [false, false, true]; };
regions = ( { type = "water"; box = ["0", "0", "0", "1 mm", "1 mm", "1 mm"]; } );
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "1e-3 m/s^2"]; };
END
  for setting in "stokes adami 40" "stokes frozen 40" "wcsph frozen 8" "stokes subvoxel 8"; do
    set -- $setting
    words=(--set scene.method=$1 --set $1.wall=$2 --set domain.spacing="$(awk -v n=$3 'BEGIN { print 1e-3 / n }') m")
    "$SPH" explain duct.cfg "${words[@]}" --json > plan.json
    python3 -c '
import json, os, subprocess, sys
words = sys.argv[1:]
with subprocess.Popen(words, stdout=subprocess.PIPE) as child:
    text = child.stdout.read()
    _, code, usage = os.wait4(child.pid, 0)
    child.returncode = 0
assert code == 0, words
plan, k = json.load(open("plan.json")), json.loads(text)["intrinsic_permeability"]
pairs = [("error", plan["expected_error"], abs(k / (0.421731e-6 / 12) - 1))]
if not any(s in os.environ.get("SANITIZE", "") for s in ("address", "thread")): # their shadows are not ours
    pairs.append(("memory", plan["memory_bytes"], 1024 * usage.ru_maxrss))
for what, predicted, measured in pairs:
    print(what, predicted, measured)
    assert 0.5 < predicted / measured < 2, (what, predicted, measured)' "$SPH" run duct.cfg "${words[@]}" -o out --json --threads 1
  done
}

# bats test_tags=long
@test "explain --error of a model: few spheres reach the error with as many sites as it names" {
  cat > spheres.py << 'END'
import sys
import h5py
import numpy as np
n, side, c = int(sys.argv[1]), 24e-6, 0.125
x = (np.arange(n) + 0.5) * side / n
at = [(x - place * side + side / 2) % side - side / 2 for place in (0.31, 0.47, 0.63)]
distance = np.sqrt(at[0][:, None, None] ** 2 + at[1][:, None] ** 2 + at[2] ** 2) - side * (3 * c / 4 / np.pi) ** (1 / 3)
with h5py.File("spheres.hdf", "w") as file:
    file["model/solid"] = (distance <= 0).astype("u1")
    file["model/wall_distance"] = distance.astype("f4")
    file["model"].attrs["spacing"] = [side / n] * 3
END
  cat > spheres.cfg << 'END'
scene = { name = "spheres"; };
model = { file = "spheres.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["-9.8 m/s^2", "0", "0"]; };
END
  for wanted in 0.05 0.01; do
    /usr/bin/python3 spheres.py 24
    "$SPH" explain spheres.cfg --error $wanted --json > plan.json
    eval "$(python3 -c '
import json
best = json.load(open("plan.json"))["cheapest"]["settings"][0]
print("method=%s wall=%s sites=%d" % (best["method"], best["wall"], best["size"][0]))')"
    /usr/bin/python3 spheres.py $sites
    "$SPH" run spheres.cfg -o spheres-run --set scene.method=$method --set $method.wall=$wall --json > run.json
    python3 -c '
import json, math, sys
exact = 2 * (24e-6 * (3 * 0.125 / 4 / math.pi) ** (1 / 3)) ** 2 / (9 * 0.125 * 4.29159)
k = json.load(open("run.json"))["intrinsic_permeability"]
assert abs(k / exact - 1) < float(sys.argv[1]), k / exact' $wanted
  done
}

@test "k of a closed domain that is no whole number of spacings is that of its own size" {
  cat > odd.cfg << 'END'
scene = { name = "odd"; method = "stokes"; };
domain = { size = ["3 mm", "3.3 mm"]; spacing = "0.5 mm"; periodic = [true, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "3 mm", "3.3 mm"]; } );
force = { pressure_gradient = ["-1e-3 Pa/m", "0"]; };
END
  for method in stokes wcsph; do
    "$SPH" run odd.cfg -o odd --set scene.method=$method --json > odd.json
    # 3.3^2 / 12 mm^2, and the wall's own 0.5 / N^2 of N = 6.6 spacings
    python3 -c '
import json
k = json.load(open("odd.json"))["intrinsic_permeability"]
assert abs(k / (3.3e-3 ** 2 / 12) - 1) < 0.5 / 6.6 ** 2, k'
  done
}

@test "isph: a water region that is no whole number of spacings holds its water, and stands under its weight" {
  cat > tank.cfg << 'END'
scene = { name = "tank"; method = "isph"; end_time = "0.8 s"; };
domain = { size = ["7.4 cm", "15 cm"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "7.4 cm", "9.3 cm"]; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
gauges = ( { name = "bottom"; at = ["3 cm", "0"]; } );
output = { history_interval = "20 ms"; };
END
  /usr/bin/python3 -c "import h5py" 2> /dev/null || skip "no h5py"
  "$SPH" run tank.cfg -o tank --quiet > /dev/null
  /usr/bin/python3 -c '
import h5py
h = h5py.File("tank.hdf")["history"]
mass, pressure = h["mass"][()], h["pressure_bottom"][()]
assert abs(mass[0] / (7.4 * 9.3 * 1e-4 * 0.01 * 1000) - 1) < 1e-9 and mass[-1] == mass[0], mass
assert abs(pressure[20:].mean() / (9810 * 0.093) - 1) < 0.01, pressure'
}

@test "a run that is foretold to take long says so before it begins, and what is faster" {
  cat > channel.cfg << 'END'
scene = { name = "channel"; };
domain = { size = ["60 mm", "60 mm"]; spacing = "0.25 mm"; periodic = [true, true]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "60 mm", "60 mm"]; },
            { type = "wall"; box = ["0", "0", "4 mm", "60 mm"]; } );
force = { body_acceleration = ["0", "-1e-5 m/s^2"]; };
END
  said() { timeout --preserve-status -s INT 2 "$SPH" run channel.cfg -o run "$@" 2>&1 || true; }
  [[ "$(said)" == *"by method wcsph: Re about"*"--set scene.method=stokes gives the k of slow flow"* ]]
  [[ "$(said --set scene.method=wcsph)" == *"by method wcsph"* ]]
  [[ "$(said --set scene.method=wcsph)" != *stokes* ]]
  [[ "$(said --set domain.spacing=4mm)" != *"by method"* ]]
}

@test "an error that nobody can pay for is not within reach" {
  cat > duct.cfg <<'END'
scene = { name = "duct"; };
domain = { size = ["1 mm", "1 mm", "0.5 mm"]; spacing = "0.1 mm"; periodic = [false, false, true]; };
regions = ( { type = "water"; box = ["0", "0", "0", "1 mm", "1 mm", "0.5 mm"]; } );
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "1e-3 m/s^2"]; };
END
  "$SPH" explain duct.cfg --error 0.05% --max-memory 700MB > reach.txt
  awk '/^cheapest/ { exit !($(NF - 1) > 0 && $(NF - 1) < 700) }' reach.txt
  ! grep "not within reach" reach.txt
  "$SPH" explain duct.cfg --error 0.05% --max-memory 1MB --set scene.method=wcsph --set wcsph.wall=adami > reach.txt
  grep -q "not within reach: over 30 days, or over the 1 MB of memory here" reach.txt
}
