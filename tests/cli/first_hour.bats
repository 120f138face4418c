#!/usr/bin/env bats
# What goes wrong in the first hour with one's own scan: nothing is destroyed, no wrong input passes, nothing found is lost.

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_setup
  mkdir scan && cp "$ROOT"/data-samples/small/slice_00{0,1}?.png "$ROOT"/data-samples/small/slice_002{0,1,2,3}.png scan
  export SCAN="scan --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,64,64,12 --size 16x16x3 --quiet"
  # What the models are like is not looked at: their blur stays, a third of the time.
  ct2model build $SCAN --blur keep -o m.hdf
  export KEPT="scan --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,32,32,16 --size 16x16x8 --quiet --blur keep"
  scene stokes m.hdf > a.cfg
  sphsolve run a.cfg -o run --quiet
}

refused() { # FILE COMMAND...: ends with 2 and one line, and the file is what it was
  local file=$1 before
  before=$(md5sum < "$file")
  shift
  run --separate-stderr "$@"
  [ "$status" -eq 2 ] && [ "$(wc -l <<< "$stderr")" -eq 1 ] || { echo "$*: $status $stderr"; false; }
  [ "$before" = "$(md5sum < "$file")" ] || { echo "$*: $file was changed"; false; }
}

@test "no output replaces an input, by whatever name, even with --force" {
  ln -s scan/slice_0001.png soft.png
  ln scan/slice_0002.png hard.png
  ln -s m.hdf soft.hdf
  for force in "" --force; do
    refused scan/slice_0000.png ct2model build $SCAN -o scan/slice_0000.png $force
    refused scan/slice_0001.png ct2model build $SCAN -o soft.png $force
    refused scan/slice_0002.png ct2model sweep $SCAN -o hard.png $force
    refused m.hdf ct2model export m.hdf -o m.hdf $force
    refused m.hdf ct2model export m.hdf -o ./../"$(basename "$PWD")"/m.hdf $force
    refused m.hdf sphsolve run a.cfg -o m $force
    refused m.hdf sphsolve run a.cfg -o soft $force
    refused run.hdf analyze report run.hdf -o run.hdf $force
    refused m.hdf analyze report run.hdf -o m.hdf $force
    refused run-0000.hdf analyze report run.hdf -o run-0000.hdf $force
    mkdir -p dir && ln -sf ../run.hdf dir/darcy.svg
    refused run.hdf analyze darcy run.hdf -o dir $force
  done
}

@test "an output that is a symbolic link is written where it leads, as cp does; the link stays" {
  mkdir -p far
  ln -s far/model.hdf linked.hdf # to nothing yet
  ln -s "$PWD/far/run.hdf" linkedrun.hdf
  ln -s ../linked.hdf far/back.hdf
  ct2model build $KEPT -o linked.hdf
  [ -L linked.hdf ]
  cmp m.hdf far/model.hdf || ct2model info far/model.hdf
  [ ! -L far/model.hdf ]
  ct2model build $KEPT -o far/back.hdf # over two links
  [ -L far/back.hdf ]
  [ -L linked.hdf ]
  sphsolve run a.cfg --set model.file=linked.hdf -o linkedrun --quiet
  [ -L linkedrun.hdf ]
  analyze darcy far/run.hdf --json > /dev/null
  ln -s far/run.html page.html
  analyze report run.hdf -o page.html --quiet
  [ -L page.html ]
  grep -q "<html" far/run.html
  ln -s far/m.tif stack.tif
  ct2model export m.hdf -o stack.tif --quiet
  [ -L stack.tif ]
  ct2model info far/m.tif --voxel-size 10um > /dev/null
  [ "$(find . -name '*.part' | wc -l)" -eq 0 ]
  # A link to what is not ours, to a folder that is not there, and to itself.
  echo "my notes" > far/notes.txt
  ln -s far/notes.txt notes.hdf
  refused far/notes.txt ct2model build $SCAN -o notes.hdf
  ln -s absent/x.hdf nowhere.hdf
  run --separate-stderr ct2model build $SCAN -o nowhere.hdf
  [ "$status" -eq 1 ]
  [[ "$stderr" == *"folder absent"* ]]
  ln -s round.hdf circle.hdf
  ln -s circle.hdf round.hdf
  run --separate-stderr ct2model build $SCAN -o round.hdf
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"leads back to itself"* ]]
}

@test "of an option given twice with other values the last counts, and that is told in a line" {
  said() { "$@" 2>&1 > /dev/null | grep -c "given more than once" || true; }
  local build="ct2model build scan --voxel-size 8.745um --crop 0,0,0,32,32,12 --size 16x16x6 --blur keep -o twice.hdf"
  $build --void-ratio .7 -e .8 > told.txt 2> said.txt
  grep -q "^ct2model: warning: --void-ratio is given more than once: .8 counts, the last, not .7$" said.txt
  grep -q "measured 0.8," told.txt
  [ "$(said $build -e .7 -e .7)" -eq 0 ]
  [ "$(said $build -e .7 -v -v)" -eq 0 ]
  [ "$(said $build -e .6 -e .65 -e .7)" -eq 1 ]
  [ "$(said sphsolve explain a.cfg --set scene.name=a --set model.file=m.hdf)" -eq 0 ]
  [ "$(said sphsolve explain a.cfg --set scene.name=a --set scene.name=b)" -eq 1 ]
}

@test "a file that is no product of ours is replaced with --force only" {
  echo "my notes" > notes.txt
  refused notes.txt ct2model build $SCAN -o notes.txt
  refused notes.txt ct2model sweep $SCAN -o notes.txt
  refused notes.txt ct2model export m.hdf -o notes.txt
  refused notes.txt analyze report run.hdf -o notes.txt
  cp notes.txt mine.hdf
  refused mine.hdf sphsolve run a.cfg -o mine
  cp notes.txt mine2-0000.hdf
  refused mine2-0000.hdf sphsolve run a.cfg -o mine2
  mkdir -p own && cp notes.txt own/darcy.csv
  refused own/darcy.csv analyze darcy run.hdf -o own
  run ct2model build $SCAN -o /dev/null
  [ "$status" -eq 2 ]
  [ -c /dev/null ]
  ct2model sweep $SCAN -o notes.txt --force
  grep -q "^threshold,void_ratio" notes.txt
  # What one of the programs made is replaced without a word.
  cp m.hdf product.hdf
  cp run.hdf product2.hdf
  cp run-0000.hdf product2-0000.hdf
  cp notes.txt product.csv # a sweep
  for again in 1 2; do
    ct2model export m.hdf -o product.tif
    analyze report run.hdf -o product.html
    analyze darcy run.hdf -o products --quiet
  done
  ct2model sweep $SCAN -o product.csv
  ct2model build $KEPT -o product.hdf
  sphsolve run a.cfg -o product2 --quiet
}

@test "slices numbered in steps are told of: others between them may have been left out" {
  mkdir -p second all
  for i in 0 3 6 9; do
    cp "scan/slice_000$i.png" second
    cp "scan/slice_000$i.png" "all/s$((i / 3)).png"
  done
  said() { ct2model info "$1" --voxel-size "${2-8.745um}" 2>&1 > /dev/null; }
  [[ "$(said second)" == *"numbered in steps of 3 (slice_0000.png, slice_0003.png, ...)"*"their distance"* ]]
  [ -z "$(said all)" ]
  # Who gave a distance, were it that of the pixels, is not asked for it.
  [ -z "$(said second 8.745um,8.745um,26.235um)" ]
  [ -z "$(said second 8.745um,8.745um,8.745um)" ]
}

@test "a folder that is absent or may not be written is named, before the work" {
  run --separate-stderr ct2model build $SCAN -o nowhere/m.hdf
  [ "$status" -eq 1 ]
  [[ "$stderr" == *"folder nowhere"* ]]
  run --separate-stderr sphsolve run a.cfg -o nowhere/run
  [ "$status" -eq 1 ]
  [[ "$stderr" == *"folder nowhere"* ]]
  run --separate-stderr analyze report run.hdf -o nowhere/run.html
  [ "$status" -eq 1 ]
  [[ "$stderr" == *"folder nowhere"* ]]
}

@test "a folder that takes no file, whoever asks, and a name too long for one are told before the work" {
  local long place
  long=$(printf 'n%.0s' {1..250})
  for place in /proc/none "$long"; do
    for words in "ct2model build $SCAN -o $place.hdf" "sphsolve run a.cfg -o $place" "analyze report run.hdf -o $place.html"; do
      run --separate-stderr $words
      [ "$status" -eq 1 ] && [[ "$stderr" == *"$place"*"cannot be written: "*"; "* ]] && [ "$(wc -l <<< "$stderr")" -eq 1 ] \
        || { echo "$words: $status $stderr"; false; }
      [ -z "$output" ]
    done
  done
}

@test "a void ratio that labels cannot meet is an error; a near one is said" {
  /usr/bin/python3 - <<'END'
import random
random.seed(1)
open("labels.raw", "wb").write(bytes(255 if (x // 4 + y // 4 + z // 4) % 4 else 0 for z in range(16) for y in range(16) for x in range(16)))
END
  local image="labels.raw --raw 16x16x16:u8 --voxel-size 5um"
  run --separate-stderr ct2model build $image --void-ratio 0.7 -o labels.hdf
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"0.3333"*"0.7"* ]]
  [ ! -e labels.hdf ]
  run --separate-stderr ct2model build $image --void-ratio 0.32 -o labels.hdf
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"0.3333"*"0.32"* ]]
}

@test "a lattice wider than its model is named, not the model's threshold" {
  run --separate-stderr sphsolve run a.cfg --set lattice.spacing='"1 km"' -o wide
  [ "$status" -eq 3 ] && [[ "$stderr" == *"lattice.spacing: 1000 m is no lattice for a model that is "* ]] \
    || { echo "$status $stderr"; false; }
}

@test "names and numbers that mean something else are refused before the work" {
  said() { # CODE WORD COMMAND...
    local code=$1 word=$2
    shift 2
    run --separate-stderr "$@"
    [ "$status" -eq "$code" ] && [[ "$stderr" == *"$word"* ]] || { echo "$*: $status $stderr"; false; }
  }
  mkdir -p folder
  said 2 "is a folder" sphsolve run a.cfg -o folder/
  said 2 "is a folder" sphsolve run a.cfg -o .
  [ ! -e folder/.hdf ]
  said 2 "named .tif" ct2model export m.hdf -o m.stl
  said 2 "numbers take a point" sphsolve run a.cfg -o comma --error 5,5%
  said 3 "decimal comma" sphsolve run a.cfg -o comma --set 'fluids.[0].density="1,0 kg/m^3"'
  said 3 "the name of a file" analyze darcy ""
  said 2 "first comes one of run" sphsolve --resume run a.cfg -o comma
  [ ! -e m.stl ] && [ ! -e comma.hdf ] || { ls; false; }
}

@test "Ctrl-C during isph: no step is begun any more, and --resume goes on from the last" {
  sed 's/end_time = "[^"]*"/end_time = "100 s"/' "$ROOT/data-samples/scenes/dam-break.cfg" > dam.cfg
  /usr/bin/python3 - <<'END'
import os, signal, subprocess, time
signal.signal(signal.SIGINT, signal.default_int_handler)
rows = lambda: open("dam.history.csv").read().count("\n") if os.path.exists("dam.history.csv") else 0
run = subprocess.Popen(["sphsolve", "run", "dam.cfg", "-o", "dam", "--set", "output.history_interval=\"1e-6 s\""],
                       stderr=subprocess.PIPE, text=True)
until = time.time() + 60
while rows() < 5 and time.time() < until:
    time.sleep(0.01)
run.send_signal(signal.SIGINT)
before = rows()
said = run.communicate(timeout=60)[1]
assert run.returncode == 130 and said.index("stopping") < said.index("interrupted"), said
assert before >= 5 and rows() <= before + 2, (before, rows())  # the step that ran, and what was read late
END
  [ -e dam.ckpt.hdf ]
  sphsolve run dam.cfg -o dam --resume --set scene.end_time='"0.05 s"' --json --quiet > dam.json
  /usr/bin/python3 -c "import json; assert json.load(open('dam.json'))['status'] == 'end_time'"
}

@test "what does not get out is an error" {
  for words in "ct2model info m.hdf" "ct2model info m.hdf --json" "ct2model --help" "sphsolve explain a.cfg --json" \
               "sphsolve run a.cfg -o full --json" "analyze darcy run.hdf --json" "ct2model sweep $SCAN --json"; do
    code=0
    $words > /dev/full 2> said || code=$?
    [ $code -eq 1 ] && grep -q "stdout" said || { echo "$words: $code"; cat said; false; }
  done
}

@test "-q prints nothing but errors, --json and files aside" {
  for words in "ct2model build $KEPT -o quiet-model.hdf" "ct2model sweep $SCAN" "sphsolve run a.cfg -o quiet --quiet" \
               "analyze darcy run.hdf -q" "analyze report run.hdf -o quiet.html -q"; do
    run $words
    [ "$status" -eq 0 ] && [ -z "$output" ] || { echo "$words: $output"; false; }
  done
  run analyze darcy run.hdf -q --json
  [[ "$output" == *k_m_per_s* ]]
}

@test "a name without an ending gets one; an ending of another kind is refused" {
  ct2model build $KEPT -o plain
  ct2model build $KEPT -o sand-0.725
  ct2model build $KEPT --levels 2 -o coarse
  ct2model sweep $SCAN -o curve
  analyze report run.hdf -o page
  [ -e plain.hdf ]
  [ -e sand-0.725.hdf ]
  [ -e coarse-11.hdf ]
  [ -e curve.csv ]
  [ -e page.html ]
  [ ! -e plain ]
  for wrong in "build scan.tif" "build m.vtk" "sweep curve.png"; do
    run --separate-stderr ct2model ${wrong% *} $SCAN -o "${wrong#* }"
    [ "$status" -eq 2 ]
    [[ "$stderr" == *"name it ."* ]]
    [ ! -e "${wrong#* }" ]
  done
}

@test "analyze of all files of a folder takes the runs among models, snapshots and images" {
  mkdir -p mixed && cp m.hdf run*.hdf mixed
  for command in darcy pdf history "report -o mixed.html"; do
    run --separate-stderr analyze $command mixed/*.hdf
    [ "$status" -eq 0 ]
    [ "$(wc -l <<< "$stderr")" -eq 1 ]
    [[ "$stderr" == *"$(($(ls mixed | wc -l) - 1)) of $(ls mixed | wc -l) files are no runs"* ]]
  done
  run --separate-stderr analyze darcy mixed/m.hdf
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"looks like a model"* ]]
}

@test "the same run given twice counts once" {
  ln -sf run.hdf other.hdf
  run --separate-stderr analyze darcy run.hdf ./run.hdf other.hdf --json
  [ "$status" -eq 0 ]
  [[ "$output" == *'"runs_in_fit": 1'* ]]
  [[ "$stderr" == *"given twice"* ]]
}

@test "a copy of a run counts once too; the same scene run again is another run" {
  mkdir -p copies
  cp run.hdf run-0000.hdf copies
  sphsolve run a.cfg -o again --quiet
  run --separate-stderr analyze darcy run.hdf copies/run.hdf --json
  [ "$status" -eq 0 ]
  [[ "$output" == *'"runs_in_fit": 1'* ]]
  [[ "$stderr" == *"copies/run.hdf: a copy of run.hdf"* ]]
  run --separate-stderr analyze darcy run.hdf again.hdf --json
  [[ "$output" == *'"runs_in_fit": 2'* ]]
}

@test "a disk that is full at the end does not take k with it" {
  code=0
  (ulimit -f 30; trap '' XFSZ; sphsolve run a.cfg -o limit --json --quiet > limit.json 2> said) || code=$?
  [ $code -eq 1 ] && grep -q "k = .* cm/s" said && grep -q '"k": 0\.00' limit.json || { cat said; false; }
}

@test "a run whose own file does not fit leaves no snapshot and no image that look like a run" {
  for method in stokes wcsph; do
    mkdir -p lone.hdf.part # nothing can be written there
    scene $method m.hdf > lone.cfg
    run --separate-stderr sphsolve run lone.cfg -o lone --quiet --set scene.end_time='"1e-5 s"'
    [ "$status" -eq 1 ] && [[ "$stderr" == *"k = "*"lone.hdf"* ]] || { echo "$stderr"; false; }
    [ ! -e lone-0000.hdf ] && [ ! -e lone-image.hdf ] && [ ! -e lone.hdf.series ] || { ls lone*; false; }
    [ $method = wcsph ] || [ ! -e lone.history.csv ]
    [[ $method = stokes || "$stderr" == *"history of the run is kept in lone.history.csv: lone.hdf"* ]]
  done
  [ -e lone.history.csv ] # the way to the steady state is more than its end
  # What a run showed while it went on stays, as does all that --resume goes on from.
  run -1 sphsolve run lone.cfg -o lone --quiet --set scene.end_time='"1e-5 s"' --set checkpoint.interval='"1e-4 s"'
  [ -e lone-0000.hdf ] && [ -e lone.ckpt.hdf ] || { ls lone*; false; }
  rmdir lone.hdf.part
  sphsolve run lone.cfg -o lone --quiet --set scene.end_time='"1e-5 s"' --set checkpoint.interval='"1e-4 s"' --resume
  [ -e lone.hdf ]
  mkdir dam.hdf.part
  run -1 sphsolve run "$ROOT/data-samples/scenes/dam-break.cfg" -o dam --quiet --set domain.spacing='"3 cm"' \
    --set scene.end_time='"0.01 s"' --set output.interval='"0.005 s"'
  [ -e dam-0000.hdf ] && [ -e dam-0001.hdf ] && [ -e dam.hdf.series ] || { echo "$stderr"; ls dam*; false; }
}

# bats test_tags=long
@test "a flow of another run beside an older record is told by the page and by a solute" {
  sphsolve run a.cfg -o unlike --quiet
  cp unlike.hdf older.hdf
  sphsolve run a.cfg -o unlike --quiet --force --set lattice.spacing='"20 um"'
  cp older.hdf unlike.hdf # what a disk that fills at the end may leave
  run --separate-stderr analyze report unlike.hdf -o unlike.html
  [ "$status" -eq 3 ] && [[ "$stderr" == "analyze: "*"unlike-0000.hdf: is of another run than unlike.hdf"* ]] || { echo "$stderr"; false; }
  [ ! -e unlike.html ]
  printf 'scene = { name = "s"; };\nflow = { file = "unlike.hdf"; };\nsolute = { peclet = [1.0]; };\n' > solute.cfg
  run --separate-stderr sphsolve run solute.cfg -o solute --quiet
  [ "$status" -eq 3 ] && [[ "$stderr" == "sphsolve: "*"unlike-image.hdf: is of another run than "*"unlike.hdf"* ]] || { echo "$stderr"; false; }
  sphsolve run a.cfg -o unlike --quiet --force # and whole again
  sphsolve run solute.cfg -o solute --quiet
}

@test "a region beside the stack is told with the stack's size" {
  run --separate-stderr ct2model build scan --void-ratio 0.725 --voxel-size 8.745um --roi cylinder:500,500,20 --quiet -o beside.hdf
  [ "$status" -eq 3 ] && [[ "$stderr" == *"no voxel of the stack is inside; it has 128x128x24, and --roi is in pixels" ]] || { echo "$stderr"; false; }
}

@test "--resume after another method says what has changed" {
  scene wcsph m.hdf > b.cfg
  sphsolve run b.cfg --set checkpoint.interval='"0.0001 s"' --set scene.end_time='"2e-5 s"' -o cut --quiet
  [ -e cut.ckpt.hdf ]
  run --separate-stderr sphsolve run a.cfg -o cut --resume
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"another method"*"--resume"* && "$stderr" != *column* ]]
}

@test "--resume after a changed scene names what changed: refused, or said" {
  scene wcsph m.hdf > c.cfg
  sphsolve run c.cfg --set checkpoint.interval='"0.0001 s"' --set scene.end_time='"2e-5 s"' -o changed --quiet
  [ -e changed.ckpt.hdf ]
  changed() { # WORDS IN THE MESSAGE, then --set ...
    local words=$1
    shift
    run --separate-stderr sphsolve run c.cfg -o changed --resume --set scene.end_time='"2e-5 s"' "$@"
    [ "$status" -eq 3 ] || { echo "$*: $status $stderr"; false; }
    [[ "$stderr" == *"$words"*"--resume"* ]] || { echo "$*: $stderr"; false; }
  }
  changed "fluids.viscosity (Pa s) was 0.001 and is 0.002" --set fluids.[0].viscosity='"2e-3 Pa s"'
  changed "force.body_acceleration (m/s^2) was 0 0 -9.80665 and is 0 0 -1" --set 'force.body_acceleration=["0","0","-1 m/s^2"]'
  changed "wcsph.wall was subvoxel and is frozen" --set wcsph.wall=frozen
  run --separate-stderr sphsolve run c.cfg -o changed --resume --set scene.end_time='"4e-5 s"'
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"scene.end_time = 4e-05 (2e-05 before)"* ]]
}

@test "Ctrl-C says so at once, ends with 130, and --resume goes on" {
  scene wcsph m.hdf > long.cfg
  sed -i 's/method = "wcsph";/method = "wcsph"; end_time = "100 s"; steady_tolerance = 0.0;/' long.cfg
  /usr/bin/python3 - <<'END'
import signal, subprocess, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
run = subprocess.Popen(["sphsolve", "run", "long.cfg", "-o", "long"], stderr=subprocess.PIPE, text=True)
while int(open(f"/proc/{run.pid}/stat").read().split()[13]) < 100:  # a second of a processor, whatever else runs
    time.sleep(0.02)
run.send_signal(signal.SIGINT)
said = run.communicate(timeout=60)[1]
assert run.returncode == 130 and "stopping" in said and said.index("stopping") < said.index("interrupted"), said
END
  [ -e long.ckpt.hdf ]
  sphsolve run long.cfg -o long --resume --set scene.end_time='"0.001 s"' --json > long.json
  /usr/bin/python3 -c "import json; assert json.load(open('long.json'))['steps'] > 100"
}

@test "make package names what it needs, and make deps finds it" {
  mkdir -p fake && printf '#!/bin/sh\nexit 1\n' > fake/dpkg-query && chmod +x fake/dpkg-query
  PATH="$PWD/fake:$PATH" run "$ROOT/scripts/install-deps" --package --check
  [ "$status" -eq 1 ]
  [[ "$output" == *debhelper* && "$output" == *"--package"* ]]
  grep -q "install-deps.* --package" "$ROOT/scripts/package"
}

@test "make package in a folder of one's own: what is made there is not that of the make that asked" {
  mkdir -p made-of && printf '#!/bin/sh\necho ok installed\n' > made-of/dpkg-query
  printf '#!/bin/sh\nmkdir build && touch "$KEPT" && make clean\nls "$KEPT"\nexit 1\n' > made-of/dpkg-buildpackage
  chmod +x made-of/*
  PATH="$PWD/made-of:$PATH" KEPT=$PWD/own/kept run make -C "$ROOT" package BUILD="$PWD/own"
  [ -e own/kept ] || { echo "$output"; false; }
}

@test "heads are heights: gravity that points up is refused" {
  run --separate-stderr sphsolve explain "$ROOT/data-samples/scenes/seepage-heads.cfg" --set 'force.gravity=["0","9.81 m/s^2"]'
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"force: heads are heights above z = 0, and this gravity points up"* ]]
}

@test "between two heads: no k while inertia counts, else the exact one" {
  heads=$ROOT/data-samples/scenes/seepage-heads.cfg
  for end in 1e-4 0.05 0.2; do
    sphsolve run "$heads" --set scene.end_time="$end s" -o "heads-$end" --json > "$end.json" 2> "$end.log"
  done
  # 9.81 x 0.5 = a v + b v^2
  python3 -c '
import json
for end in ("1e-4", "0.05"):
    assert json.load(open(end + ".json"))["k"] is None
a, b, drive = 225.0, 2062.5, 9.81 * 0.5
exact = 2 * drive / (a + (a * a + 4 * b * drive) ** 0.5) / 0.5
run = json.load(open("0.2.json"))
assert run["k_low"] < exact < run["k_high"] < 1.0001 * exact, (run, exact)'
}

@test "k of soil so fine that less goes through it than the water before it moves by" { fine_soil 1; }
# bats test_tags=long
@test "k of soil so fine: of grains of 20 um" { fine_soil 20; }

# GRAIN_SIZE, in um
fine_soil() {
  for grain in "$1"; do
    sphsolve run "$ROOT/data-samples/scenes/seepage-heads.cfg" --set scene.end_time="1 s" --set output.history_interval="0.05 s" \
      --set 'regions.[0].porosity=0.3' --set "regions.[0].grain_size=\"$grain um\"" -o fine --json > fine.json 2> fine.log
    python3 -c '
import json
run, exact = json.load(open("fine.json")), 9.81 * 0.3**3 / (1e-3 * 0.7**2) * ('$grain' * 1e-6) ** 2
assert run["k_low"] < exact < run["k_high"] < 1.0001 * exact, (exact, run)'
  done
}

@test "what comes next is printed so that a shell takes it, a name with spaces too" {
  mkdir "my runs"
  sphsolve run "$BATS_TEST_DIRNAME/slit.cfg" -o "my runs/the first" > told.txt
  bash -c "$(sed -n 's/^next  *//p' told.txt)"
  [ -s "my runs/the first.html" ]
  sphsolve run "$BATS_TEST_DIRNAME/slit.cfg" -o unquoted | grep -q '^next       analyze report unquoted.hdf -o unquoted.html$'
}
