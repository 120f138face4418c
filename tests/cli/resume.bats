#!/usr/bin/env bats
# Nothing lost: a run that was killed and resumed is, bit for bit, the run that never was.
bats_require_minimum_version 1.5.0

setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH" SAME="/usr/bin/python3 $ROOT/tests/cli/same_run.py"
  cd "$BATS_FILE_TMPDIR"
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --size 32x32x14 -o dense.hdf --quiet > /dev/null
  cp "$ROOT/data-samples/scenes/s06.cfg" s06.cfg
  (run_it whole > /dev/null)
}
setup() {
  /usr/bin/python3 -c 'import h5py' 2> /dev/null || skip "python3-h5py is not installed"
  cd "$BATS_FILE_TMPDIR"
}

run_it() { # NAME [options]; exec'ed in a subshell, so that a signal to $! meets the program itself
  local name=$1; shift
  exec sphsolve run s06.cfg --set model.file=dense.hdf --set scene.steady_tolerance=0.0 --set scene.end_time='0.03 s' \
    --set output.interval='0.01 s' --set checkpoint.interval='0.2 s' -o "$name" --quiet "$@"
}
equal_to_whole() {
  $SAME whole.hdf "$1.hdf"
  for s in whole-0*.hdf; do $SAME "$s" "$1${s#whole}"; done
}

@test "killed by SIGKILL at random moments, and resumed" {
  # Three seeds of moments; each run is killed up to four times, also while it writes.
  for seed in 1 2 3; do
    RANDOM=$seed
    rm -f cut*
    for _ in 1 2 3 4; do
      (run_it cut --resume > /dev/null 2>&1) &
      sleep "0.$((RANDOM % 90 + 10))"
      kill -9 $! 2> /dev/null || true
      wait $! 2> /dev/null || true
    done
    (run_it cut --resume > /dev/null 2>&1)
    equal_to_whole cut
  done
}

@test "stokes: killed by SIGKILL between and in its rounds, and resumed" {
  stokes() {
    local name=$1; shift
    exec sphsolve run s06.cfg --set model.file=dense.hdf --set scene.method=stokes --set stokes.tolerance=1e-7 \
      --set checkpoint.interval='1 us' --threads 1 -o "$name" --quiet "$@"
  }
  (stokes smooth > /dev/null)
  for moment in 0.1 0.3 0.5; do
    (stokes torn --resume > /dev/null 2>&1) &
    sleep $moment
    kill -9 $! 2> /dev/null || true
    wait $! 2> /dev/null || true
  done
  (stokes torn --resume > /dev/null)
  $SAME smooth.hdf torn.hdf && cmp smooth-0000.hdf torn-0000.hdf
}

@test "SIGTERM writes a checkpoint and ends with exit code 130" {
  rm -f term*
  (run_it term > /dev/null 2>&1) &
  sleep 0.5
  kill -TERM $!
  code=0
  wait $! || code=$?
  [ $code -eq 130 ] || [ $code -eq 0 ] # 0: the run was over before
  [ $code -eq 0 ] || [ -s term.ckpt.hdf ]
  (run_it term --resume > /dev/null)
  equal_to_whole term
}

@test "a flipped or truncated checkpoint is known, and the older one used" {
  rm -f bad*
  (run_it bad > /dev/null 2>&1) &
  sleep 0.9
  kill -9 $! 2> /dev/null || true
  wait $! 2> /dev/null || true
  [ -s bad.ckpt.1.hdf ] || skip "the machine was too slow for two checkpoints"
  size=$(stat -c %s bad.ckpt.hdf)
  printf '\xa5' | dd of=bad.ckpt.hdf bs=1 seek=$((size / 2)) conv=notrunc status=none
  run --separate-stderr sphsolve run s06.cfg --set model.file=dense.hdf --set scene.steady_tolerance=0.0 --set scene.end_time='0.03 s' \
    --set output.interval='0.01 s' --set checkpoint.interval='0.2 s' -o bad --resume
  [ "$status" -eq 0 ] && [[ "$stderr" == *"missing or damaged; resuming from bad.ckpt.1.hdf"* ]]
  equal_to_whole bad
  truncate -s 1000 bad.ckpt.hdf
  truncate -s 1000 bad.ckpt.1.hdf
  run --separate-stderr run_it bad --resume
  [ "$status" -eq 3 ] && [[ "$stderr" == *"remove both to start anew"* ]]
}

@test "the same bits for 1, 2 and 3 threads" {
  for threads in 1 2 3; do
    (run_it "threads$threads" --threads $threads > /dev/null)
    equal_to_whole "threads$threads"
  done
}

@test "two equal runs give equal bytes" {
  (run_it again > /dev/null)
  for s in whole-0*.hdf; do cmp "$s" "again${s#whole}"; done
}

@test "a full disk leaves no half file and ends with exit code 1" {
  (
    ulimit -f 64 # blocks of 1 KB: no snapshot fits
    trap '' XFSZ
    code=0
    (run_it full > out.log 2> err.log) || code=$?
    [ $code -eq 1 ] || { echo "exit code $code"; cat err.log; exit 1; }
  )
  [ ! -e full.hdf ] && [ -z "$(ls full*.part 2> /dev/null)" ]
  [ "$(wc -l < err.log)" -eq 1 ] && grep -q "full" err.log
}
