#!/usr/bin/env bats
# sphsolve-mpi (make MPI=1): the same answers and the same files on any number of ranks.
bats_require_minimum_version 1.5.0
load sample

setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$build/tests:$PATH" AGREE="/usr/bin/python3 $ROOT/tests/cli/ranks.py"
  # More ranks than cores, and as root, are fine here.
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
  export OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1 OMP_NUM_THREADS=1
  # Ranks of one machine need none of Open MPI's networks; those that wait sleep (tests/ranks/preload).
  export OMPI_MCA_plm=isolated OMPI_MCA_pml=ob1 OMPI_MCA_btl=vader,self PMIX_MCA_gds=hash HWLOC_COMPONENTS=-gl,-opencl,-pci
  export IDLE=$build/tests/idle.so
  [ -e "$IDLE" ] || IDLE=
  [ -x "$build/bin/sphsolve-mpi" ] || return 0
  cd "$BATS_FILE_TMPDIR"
  sample_model 16x16x7 dense.hdf
  cp "$ROOT/data-samples/scenes/s06.cfg" s06.cfg
}
setup() {
  command -v sphsolve-mpi > /dev/null || skip "sphsolve-mpi is not built (make check MPI=1)"
  command -v mpirun > /dev/null || skip "mpirun is not installed"
  cd "$BATS_FILE_TMPDIR"
}
ranks_of() { # NAME: the processes of its ranks, of this folder alone
  local p
  for p in $(pgrep -f -- "sphsolve-mpi.* -o $1 --quiet"); do
    [ "$(readlink "/proc/$p/cwd")" != "$PWD" ] || [ "$(basename "$(readlink "/proc/$p/exe")")" != sphsolve-mpi ] || echo "$p"
  done
}
# NAME RANKS COMMAND...: a rank of a run with -o NAME is killed once the second checkpoint is there; anew where the run was
# over before that. The job ends, and leaves the checkpoint.
killed() {
  local name=$1 ranks=$2 job again code; shift 2
  for again in $(seq 20); do
    rm -f "$name".* "$name"-*
    on "$ranks" "$@" > log 2>&1 &
    job=$!
    until [ -e "$name.ckpt.1.hdf" ] || ! kill -0 $job 2> /dev/null; do sleep 0.01; done
    ranks_of "$name" | tail -1 | xargs -r kill -9 2> /dev/null || true
    code=0; wait $job || code=$?
    while [ -n "$(ranks_of "$name")" ]; do sleep 0.02; done # the others, after mpirun
    [ -e "$name.hdf" ] || break
  done
  [ $code -ne 0 ]
  [ -e "$name.ckpt.hdf" ]
  [ ! -e "$name.hdf" ]
}
on() { local n=$1; shift; timeout 120 mpirun ${IDLE:+-x LD_PRELOAD="$IDLE"} -np "$n" "$@"; }
stokes() { # NAME [options]
  local name=$1; shift
  echo run s06.cfg --set model.file=dense.hdf --set scene.method=stokes --set stokes.tolerance=1e-6 -o "$name" --quiet "$@"
}

@test "rows of 1 to 200 items are cut evenly on 1, 2, 3, 4 ranks" {
  for n in 1 2 3 4; do on $n ranks_balance-mpi; done
}

@test "stokes: one application of the operator on 1, 2, 3, 4 ranks" {
  local vectors="" c
  for c in 0 1 2 3; do vectors="$vectors operator$c residual$c"; done
  local ranks="1 2 3 4"
  for walls in "" adami; do
    ranks_stokes one.hdf $walls
    for n in $ranks; do
      on $n ranks_stokes-mpi "on$n.hdf" $walls
      $AGREE one.hdf "on$n.hdf" 1e-12 $vectors flux
      # A factor in single precision, found by iteration, stands in the preconditioner.
      $AGREE one.hdf "on$n.hdf" 1e-5 preconditioner0 preconditioner1 preconditioner2 preconditioner3
    done
    ranks=3
  done
}

# RANKS...
same_stokes() {
  [ -e serial.hdf ] || sphsolve $(stokes serial) > /dev/null
  for n in "$@"; do
    on $n sphsolve-mpi $(stokes "run$n" | sed 's/ --quiet//') > "out$n"
    [ "$(grep -c '^k ' "out$n")" -eq 1 ]
    $AGREE serial.hdf "run$n.hdf" 1e-6 run@k history/darcy_velocity history/kinetic_energy
    $AGREE serial-0000.hdf "run$n-0000.hdf" 1e-5 VTKHDF/PointData/velocity VTKHDF/PointData/pressure
    $AGREE serial-0000.hdf "run$n-0000.hdf" 0 VTKHDF/Points VTKHDF/PointData/id VTKHDF/Connectivity VTKHDF/Offsets
  done
  # What a clock measured stands under /run/timing alone.
  /usr/bin/python3 -c 'import h5py, sys; run = h5py.File(sys.argv[1])["run"]
assert {"waiting_seconds", "busy_seconds"} <= set(run["timing"].attrs) and "waiting_seconds" not in run.attrs' run$n.hdf
}
@test "stokes: k, history and snapshot of a run on 3 ranks" { same_stokes 3; }
# bats test_tags=long
@test "stokes: k, history and snapshot of a run on 1, 2, 4 ranks" { same_stokes 1 2 4; }

@test "stokes: a rank killed on 3, finished on 4 and without MPI" {
  killed cut 3 sphsolve-mpi $(stokes cut --set checkpoint.interval=1us)
  for f in cut.ckpt*.hdf; do cp "$f" "two${f#cut}"; done
  [ -e serial.hdf ] || sphsolve $(stokes serial) > /dev/null
  on 4 sphsolve-mpi $(stokes cut --resume) > /dev/null
  sphsolve $(stokes two --resume) > /dev/null
  $AGREE serial.hdf cut.hdf 1e-6 run@k
  $AGREE serial.hdf two.hdf 1e-6 run@k
}

# What runs `carried` takes; the run on one.
carried_alone() {
  cat > carried.cfg <<'END'
scene  = { name = "carried"; };
flow   = { file = "slit.hdf"; };
solute = { peclet = [30.0]; length = "1 mm"; way = "both"; };
checkpoint = { interval = "1 us"; };
END
  given="run carried.cfg --error 30%"
  [ ! -e alone.hdf ] || return 0
  sphsolve run "$ROOT/tests/cli/slit.cfg" -o slit --quiet
  sphsolve $given -o alone --quiet --set checkpoint.interval='"1 h"'
}
@test "solute: closure problem and walk on 3 ranks, bit for bit" {
  carried_alone
  on 3 sphsolve-mpi $given -o carried --quiet --set checkpoint.interval='"1 h"'
  /usr/bin/python3 "$ROOT/tests/cli/same_run.py" alone.hdf carried.hdf @
}
# bats test_tags=long
@test "solute: ended on 2 ranks and resumed on one, bit for bit" {
  carried_alone
  killed ended 2 sphsolve-mpi $given -o ended --quiet
  sphsolve $given -o ended --quiet --resume --set checkpoint.interval='"1 h"'
  /usr/bin/python3 "$ROOT/tests/cli/same_run.py" alone.hdf ended.hdf @
}

@test "a dataset of more dimensions than are wanted is refused on 2 ranks" {
  /usr/bin/python3 -c 'import h5py, numpy as np
with h5py.File("deep.hdf", "w") as f:
    f.create_dataset("/model/solid", data=np.zeros((2,) * 16, "u1"))
    f["model"].attrs["spacing"] = [1e-5] * 3'
  run on 2 sphsolve-mpi run s06.cfg --set model.file=deep.hdf --set scene.method=stokes -o deep
  [ "$status" -eq 3 ]
  [ "$(grep -c 'has 16 dimensions' <<< "$output")" -eq 1 ]
}

@test "an error is said once, and ends all ranks" {
  run on 3 sphsolve-mpi run nowhere.cfg -o none
  [ "$status" -eq 3 ]
  [ "$(grep -c 'nowhere.cfg' <<< "$output")" -eq 1 ]
  run sphsolve run "$ROOT/data-samples/scenes/still-tank.cfg" -o none --set isph.solver=petsc
  [ "$status" -eq 3 ]
  [[ "$output" == *"sphsolve-mpi"* ]]
}

small() { # METHOD: a run of it
  case $1 in
    stokes) stokes small --set checkpoint.interval=1us ;;
    wcsph) wcsph small --set scene.end_time=1e-3s ;;
    isph) isph dam-break 2ms small --set checkpoint.interval=1us ;;
  esac
}
# FILE CODE: what a run that failed said on stderr holds one line of ours.
one_line() {
  [ "$2" -gt 0 ] && [ "$2" -le 4 ] && [ "$(grep -c '^sphsolve: ' "$1")" -eq 1 ] || { echo "$1: exit code $2"; cat "$1"; false; }
}

@test "an allocation or a write that fails on one of 2 ranks ends both with one line" {
  local fault folder
  # method:fault:rank:which of them
  for fault in {stokes,isph}:{allocation:1:9,allocation:0:60,allocation:1:130,write:1:4,write:0:9} wcsph:{allocation:1:130,write:1:9}; do
    folder=faults/$fault && mkdir -p "$folder" && cp s06.cfg dense.hdf "$folder"
    (cd "$folder" && IFS=: read -r method kind rank n <<< "$fault" && code=0 &&
      { on 2 -q ranks_faults-mpi "$kind" "$rank" "$n" $(small "$method") > out 2> said || code=$?; } && echo $code > code) &
    while [ "$(jobs -r | wc -l)" -ge 6 ]; do sleep 0.1; done
  done
  wait
  for folder in faults/*; do one_line "$folder/said" "$(cat "$folder/code")"; done
}

@test "memory too short for a part of the error leaves k on 2 ranks, and says so" {
  sample_model 32x32x14 mid.hdf
  for n in 1 2; do
    on $n sphsolve-mpi run s06.cfg --set model.file=mid.hdf --set scene.method=stokes --max-memory $(awk "BEGIN { print 8 / $n }")MB --json \
      -o short$n > short$n.json 2> said
    [ "$(grep -c 'part of the error of k is not known' said)" -eq 1 ]
  done
  /usr/bin/python3 -c 'import json
one, two = (json.load(open(f"short{n}.json")) for n in (1, 2))
assert abs(two["k"] / one["k"] - 1) < 1e-6 and one["error"]["sides"] is None and two["error"]["sides"] is None'
}

@test "a full disk ends all ranks with one line" {
  local method code
  for method in stokes wcsph isph; do
    rm -f small* && code=0
    # blocks of 1 KB: no snapshot fits; what Open MPI would write, and would not fit either, is done without
    OMPI_MCA_btl=tcp,self PMIX_MCA_gds=hash on 2 -q bash -c 'ulimit -f 8; trap "" XFSZ; exec sphsolve-mpi "$@"' - $(small $method) > /dev/null 2> said || code=$?
    one_line said $code
    grep -q "full\|large" said
    [ ! -e small.hdf ]
    [ -z "$(ls small*.part small*.new.hdf 2> /dev/null)" ]
  done
}

wcsph() { # NAME [options]
  local name=$1; shift
  echo run s06.cfg --set model.file=dense.hdf --set scene.steady_tolerance=0.0 --set scene.end_time=0.01s \
    --set force.body_acceleration="[\"0\",\"0\",\"-${pull:-9.8}m/s^2\"]" --set output.interval=0.005s -o "$name" --quiet "$@"
}
same() { # SERIAL OTHER [NAME...]: bit for bit but for these (same_run.py), snapshots too
  local file pairs=()
  for file in "$1".hdf "$1"-0*.hdf; do pairs+=("$file" "$2${file#"$1"}"); done
  # The error's lattices are solved by method stokes, whose sums are cut at the ranks.
  /usr/bin/python3 "$ROOT/tests/cli/same_run.py" "${pairs[@]}" run/levels @ "${@:3}"
}

# WALLS:RANKS...
same_wcsph() {
  local walls n
  for walls in "$@"; do
    n=${walls#*:} walls=${walls%:*}
    local pull=9.8 # as much as the walls bear; the more, the more often particles are ordered anew
    [ $walls != adami ] || pull=3
    [ $walls != frozen ] || pull=98
    [ -e "w$walls.hdf" ] || sphsolve $(wcsph "w$walls" --set wcsph.wall=$walls) > /dev/null
    on $n sphsolve-mpi $(wcsph "w$walls$n" --set wcsph.wall=$walls) > /dev/null
    same "w$walls" "w$walls$n"
  done
}
@test "wcsph: every bit of histories and snapshots on 3 and 4 ranks, whatever the walls" { same_wcsph subvoxel:3 frozen:4; }
# bats test_tags=long
@test "wcsph: every bit of histories and snapshots on 1, 2, 3, 4 ranks, whatever the walls" {
  same_wcsph subvoxel:2 subvoxel:4 adami:3 frozen:1
}

@test "wcsph: a step too long is halved on all ranks at once" {
  local pull=98
  sphsolve $(wcsph long --set wcsph.force_dt=true --set wcsph.dt=1.6e-4s) > /dev/null
  on 3 sphsolve-mpi $(wcsph long3 --set wcsph.force_dt=true --set wcsph.dt=1.6e-4s) > /dev/null
  /usr/bin/python3 -c 'import h5py; assert len(h5py.File("long.hdf")["run/watchdog/time"]) > 0'
  same long long3
}

@test "wcsph: a rank killed on 2, taken up by 3 and by one, bit for bit" {
  local pull=98
  [ -e wfrozen.hdf ] || sphsolve $(wcsph wfrozen --set wcsph.wall=frozen) > /dev/null
  killed stop 2 sphsolve-mpi $(wcsph stop --set wcsph.wall=frozen --set checkpoint.interval=1us)
  mkdir -p alone && cp stop* s06.cfg dense.hdf alone
  on 3 sphsolve-mpi $(wcsph stop --set wcsph.wall=frozen --resume) > /dev/null
  same wfrozen stop
  (cd alone && sphsolve $(wcsph stop --set wcsph.wall=frozen --resume) > /dev/null)
  same wfrozen alone/stop
}

@test "the same inputs on 2 ranks give the same bytes but for what a clock measured" {
  for d in one two; do
    mkdir -p $d && cp s06.cfg dense.hdf $d
    (cd $d && on 2 sphsolve-mpi $(stokes creep) > /dev/null && on 2 sphsolve-mpi $(wcsph flow --set scene.end_time=2ms --set output.interval=1ms) > /dev/null)
  done
  /usr/bin/python3 "$ROOT/tests/cli/blank_clock.py" {one,two}/{creep,flow}.hdf
  for f in creep creep-0000 flow flow-0000 flow-0001 flow-0002; do cmp one/$f.hdf two/$f.hdf; done
}

isph() { # SCENE END NAME [options]
  local scene=$1 end=$2 name=$3; shift 3
  echo run "$ROOT/data-samples/scenes/$scene.cfg" --set scene.method=isph --set scene.end_time="$end" -o "$name" --quiet "$@"
}

# SCENE:END:RANKS...
same_isph() {
  local scene n
  for scene in "$@"; do
    n=${scene##*:} end=${scene#*:} scene=${scene%%:*}
    sphsolve $(isph "$scene" "${end%:*}" "serial-$scene") > /dev/null
    on "$n" sphsolve-mpi $(isph "$scene" "${end%:*}" "$scene") > /dev/null
    same "serial-$scene" "$scene"
  done
}
@test "isph: every bit of histories and snapshots of three sample scenes on 3 and 4 ranks" { same_isph dam-break:0.05s:3 seepage-heads:0.05s:4 seepage-column:0.1s:3; }
# bats test_tags=long
@test "isph: every bit of histories and snapshots of the other sample scenes on 1, 2, 3, 4 ranks" {
  same_isph gate:0.05s:2 seepage-column:0.1s:4 seepage-dam:0.05s:2 seepage-embankment:0.02s:3 still-tank:0.02s:1
}

same_on_ranks() { # SCENE.cfg of isph; RANKS...
  sphsolve run "$1.cfg" -o "serial-$1" --quiet > /dev/null
  for n in "${@:2}"; do
    on "$n" sphsolve-mpi run "$1.cfg" -o "$1" --quiet > /dev/null
    same "serial-$1" "$1"
  done
}

beds_on() { # RANKS...
  cat > beds.cfg << 'END'
scene = { method = "isph"; end_time = "0.03 s"; };
domain = { size = ["0.3 m", "0.2 m"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.3 m", "0.2 m"]; },
  { type = "porous"; box = ["5 cm", "0", "25 cm", "0.2 m"]; porosity = 0.4; permeability = "1e-4 m/s"; },
  { type = "porous"; box = ["5 cm", "0", "15 cm", "0.2 m"]; porosity = 0.4; permeability = "1e-3 m/s"; },
  { type = "inflow"; box = ["0", "0", "1 cm", "0.2 m"]; head = "0.4 m"; },
  { type = "inflow"; box = ["0.29 m", "0", "0.3 m", "0.2 m"]; head = "0.3 m"; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
  same_on_ranks beds "$@"
}
@test "isph: coarse soil beside finer soil and water, the same bits on 1 and 3 ranks" { beds_on 3; }

rain_on() { # RANKS...
  cat > rain.cfg << 'END'
scene = { method = "isph"; end_time = "0.3 s"; };
domain = { size = ["0.3 m", "0.2 m"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.1 m", "0.1 m"]; },
  { type = "porous"; box = ["0.1 m", "0", "0.2 m", "0.12 m"]; porosity = 0.4; grain_size = "5 mm"; },
  { type = "wall"; box = ["0.22 m", "0.1 m", "0.26 m", "0.12 m"]; },
  { type = "rain"; box = ["0", "0.15 m", "0.3 m", "0.2 m"]; rate = "3 cm/s"; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
  same_on_ranks rain "$@"
}
@test "isph: rain on water, a roof and soil, the same bits on 1 and 3 ranks" { rain_on 3; }

radiating_on() { # RANKS...
  cat > radiating.cfg << 'END'
scene = { method = "isph"; end_time = "0.3 s"; };
domain = { size = ["0.4 m", "0.3 m"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.4 m", "0.15 m"]; },
  { type = "porous"; box = ["0.3 m", "0", "0.4 m", "0.05 m"]; porosity = 0.4; grain_size = "5 mm"; },
  { type = "inflow"; box = ["0", "0", "1 cm", "0.15 m"]; flux = "0.2 m/s"; },
  { type = "inflow"; box = ["0.39 m", "0", "0.4 m", "0.3 m"]; head = "0.15 m"; radiates = true; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
  same_on_ranks radiating "$@"
}
@test "isph: a side that lets waves out, the same bits on 1 and 3 ranks" { radiating_on 3; }

calm_on() { # RANKS...
  cat > calm.cfg << 'END'
scene = { method = "isph"; end_time = "0.3 s"; };
domain = { size = ["0.4 m", "0.3 m"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.1 m", "0.15 m"]; velocity = ["0", "-0.5 m/s"]; },
  { type = "water"; box = ["0.1 m", "0", "0.4 m", "0.15 m"]; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
  same_on_ranks calm "$@"
}
@test "isph: calm free water, stirred and not, the same bits on 1 and 3 ranks" { calm_on 3; }

wells_on() { # RANKS...
  cat > wells.cfg << 'END'
scene = { method = "isph"; end_time = "0.1 s"; };
domain = { size = ["0.6 m", "0.2 m"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.6 m", "0.18 m"]; },
  { type = "porous"; box = ["0", "0", "0.6 m", "0.2 m"]; porosity = 0.4; grain_size = "1 cm"; saturated = false; },
  { type = "well"; name = "a"; box = ["0.25 m", "2 cm", "0.35 m", "0.1 m"]; rate = "0.01 m^2/s"; },
  { type = "drain"; name = "b"; box = ["0.1 m", "2 cm", "0.22 m", "8 cm"]; head = "5 cm"; },
  { type = "well"; name = "c"; box = ["0.4 m", "2 cm", "0.5 m", "0.1 m"]; rate = "0.005 m^2/s"; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
  same_on_ranks wells "$@"
  /usr/bin/python3 -c 'import h5py; h = h5py.File("wells.hdf")["history"]; taken = [h["taken_" + w][-1] for w in "abc"]; assert min(taken) > 0, taken'
}
@test "isph: wells and a drain across the cut between ranks, the same bits on 1 and 3 ranks" { wells_on 3; }
# bats test_tags=long
@test "isph: beds, rain, calm water, wells and a drain: the same bits on 1 and 2 ranks" {
  for scene in beds rain calm wells; do ${scene}_on 2; done
}

@test "isph: a rank killed on 2, taken up by 3 and by one, bit for bit" {
  rm -f lone-part*
  sphsolve $(isph dam-break 0.04s whole) > /dev/null
  killed part 2 sphsolve-mpi $(isph dam-break 0.04s part --set checkpoint.interval=1us)
  for f in part*; do cp "$f" "lone-$f"; done
  on 3 sphsolve-mpi $(isph dam-break 0.04s part --resume) > /dev/null
  same whole part
  sphsolve $(isph dam-break 0.04s lone-part --resume) > /dev/null
  same whole lone-part run/snapshots/name # those from before are called as the run was then
}

with_petsc() { # SCENE RANKS...: one step, against method isph's own solver
  local scene=$1 n
  sphsolve $(isph $scene 1e-3s exact --set output.interval=1e-3s --set isph.tolerance=1e-13) > /dev/null
  for n in "${@:2}"; do
    on $n sphsolve-mpi $(isph $scene 1e-3s petsc --set output.interval=1e-3s --set isph.tolerance=1e-13 --set isph.solver=petsc) > /dev/null
    $AGREE exact.hdf petsc.hdf 1e-12 history/darcy_velocity history/kinetic_energy history/momentum
    $AGREE exact-0001.hdf petsc-0001.hdf 1e-12 VTKHDF/PointData/pressure VTKHDF/Points
  done
}

@test "isph: one step with PETSc on 2 and 4 ranks" {
  with_petsc dam-break 4
  with_petsc seepage-heads 2
}

# bats test_tags=long
@test "isph: one step with PETSc on 1, 2, 4 ranks, whatever the preconditioner" {
  with_petsc dam-break 1 2
  with_petsc seepage-heads 1 4
  for petsc in "-grid_pc_type gamg" "-pc_type hypre" "-pc_type gamg" "-pc_type bjacobi"; do
    PETSC_OPTIONS=$petsc on 2 sphsolve-mpi $(isph seepage-heads 1e-3s petsc --set output.interval=1e-3s --set isph.tolerance=1e-13 --set isph.solver=petsc) > /dev/null
    $AGREE exact.hdf petsc.hdf 1e-12 history/darcy_velocity history/kinetic_energy
  done
}

memory_of_ranks() { # N...: on so many, and on one
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --size 40x40x18 -q -o middle.hdf > /dev/null
  cat > tank.cfg << 'END'
scene = { name = "tank"; method = "isph"; end_time = "1 ms"; };
domain = { size = ["2 m", "0.486 m", "1.189 m"]; spacing = "0.027 m"; periodic = [false, false, false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0", "1 m", "0.486 m", "0.81 m"]; } );
force = { gravity = ["0", "0", "-9.81 m/s^2"]; };
isph = { dt = "1 ms"; };
END
  cat > lid.cfg << 'END'
scene = { name = "lid"; method = "wcsph"; end_time = "6 ms"; };
domain = { size = ["3.2 m", "0.18 m", "0.18 m"]; spacing = "0.01 m"; periodic = [true, false, false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0", "3.2 m", "0.18 m", "0.18 m"]; },
            { type = "wall"; box = ["0", "0", "0.16 m", "3.2 m", "0.18 m", "0.18 m"]; velocity = ["1 m/s", "0", "0"]; } );
wcsph = { sound_speed = "20 m/s"; };
END
  local n tank=tank.cfg sand="s06.cfg --set model.file=middle.hdf --set scene.method=stokes --set stokes.tolerance=1e-2"
  sphsolve explain $tank --threads 1 --json > tank.json
  sphsolve explain $sand --threads 1 --json > sand.json
  sphsolve explain lid.cfg --threads 1 --json > lid.json
  for n in 1 "$@"; do
    on $n sphsolve-mpi run $tank -o tank$n --quiet > /dev/null
    on $n sphsolve-mpi run $sand -o sand$n --quiet > /dev/null
    on $n sphsolve-mpi run lid.cfg -o lid$n --quiet > /dev/null
  done
  /usr/bin/python3 - "$@" << 'END'
import h5py, json, sys
ON = (1, *map(int, sys.argv[1:]))
PROGRAM, HELD_BESIDE = 9e6, 1.065  # predicted, not counted
for name in "tank", "sand", "lid":
    said = (json.load(open(f"{name}.json"))["memory_bytes"] - PROGRAM) / HELD_BESIDE
    clock = {n: h5py.File(f"{name}{n}.hdf")["run/timing"].attrs for n in ON}
    peak = {n: max(clock[n]["memory_peak_bytes"], clock[n]["memory_peak_bytes_all"] / n) for n in clock}
    assert abs(peak[1] / said - 1) < (0.03 if name == "sand" else 0.1), (peak, said) # the sand's lattice of other sides is counted
    for n in peak:
        print(f"{name} on {n}: {peak[n] / 1e6:.2f} MB, of one process {peak[n] / peak[1]:.3f}")
        assert peak[n] < peak[1] * (1 / n + 1 / 8)
END
}
@test "the memory of a rank falls with their number, from what explain predicts, to 4" { memory_of_ranks 4; }
# bats test_tags=long
@test "the memory of a rank falls with their number, from what explain predicts, on 2" { memory_of_ranks 2; }
