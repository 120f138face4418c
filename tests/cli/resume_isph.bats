#!/usr/bin/env bats
# Method isph with all it can contain, killed and resumed, is bit for bit the run that never was: water with a surface, two
# soils of which one moves, a gate that moves, a given head and a given flux.
bats_require_minimum_version 1.5.0

setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH" SAME="/usr/bin/python3 $ROOT/tests/cli/same_run.py"
  cd "$BATS_FILE_TMPDIR"
  cat > all.cfg << 'END'
scene = { method = "isph"; end_time = "0.3 s"; };
domain = { size = ["0.6 m","0.3 m"]; spacing = "1 cm"; periodic = [false,false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0","0","0.6 m","0.15 m"]; }, { type = "water"; box = ["0","0.15 m","0.2 m","0.25 m"]; },
  { type = "porous"; box = ["0.25 m","0","0.35 m","0.2 m"]; porosity = 0.4; grain_size = "5 mm"; velocity = ["0.1 m/s","0"]; },
  { type = "porous"; box = ["0.45 m","0","0.5 m","0.2 m"]; porosity = 0.5; grain_size = "1 cm"; },
  { type = "wall"; box = ["0.203 m","0.02 m","0.217 m","0.3 m"]; velocity = ["0","0.2 m/s"]; },
  { type = "inflow"; box = ["0","0","1 cm","0.1 m"]; flux = "0.2 m/s"; },
  { type = "inflow"; box = ["0.59 m","0","0.6 m","0.3 m"]; head = "0.12 m"; } );
force = { gravity = ["0","-9.81 m/s^2"]; };
gauges = ( { name = "foot"; at = ["0.3 m","0"]; } );
planes = ( { name = "mid"; x = "0.4 m"; } );
output = { interval = "0.1 s"; };
END
  (run_it whole > /dev/null)
}
setup() {
  /usr/bin/python3 -c 'import h5py' 2> /dev/null || skip "python3-h5py is not installed"
  cd "$BATS_FILE_TMPDIR"
}

run_it() { # NAME [options]; exec'ed in a subshell, so that a signal to $! meets the program itself
  local name=$1; shift
  exec sphsolve run all.cfg --set checkpoint.interval='0.1 s' -o "$name" --quiet "$@"
}
equal_to_whole() {
  $SAME whole.hdf "$1.hdf"
  for s in whole-0*.hdf; do $SAME "$s" "$1${s#whole}"; done
}

@test "isph: killed by SIGKILL at random moments, and resumed" {
  for seed in 1 2 3; do
    RANDOM=$seed
    rm -f cut*
    for _ in 1 2 3; do
      (run_it cut --resume > /dev/null 2>&1) &
      sleep "0.$((RANDOM % 90 + 10))"
      kill -9 $! 2> /dev/null || true
      wait $! 2> /dev/null || true
    done
    (run_it cut --resume > /dev/null 2>&1)
    equal_to_whole cut
  done
}

@test "isph: the same bits for 1, 2 and 3 threads" {
  for threads in 1 2 3; do
    (run_it "threads$threads" --threads $threads > /dev/null)
    equal_to_whole "threads$threads"
  done
}
