#!/usr/bin/env bats
# Nothing lost: a run that was killed and resumed is, bit for bit, the run that never was.
bats_require_minimum_version 1.5.0

load programs
setup_file() {
  programs_path
  . "$ROOT/tests/cli/resumable.bash"
  resumable_make
}
# METHOD: whole-METHOD, the run that is never stopped, made when a test first asks for it
whole() { [ -e "whole-$1.hdf" ] || (resumable_start "$1" "whole-$1" > /dev/null); }
setup() {
  cd "$BATS_FILE_TMPDIR"
  . "$ROOT/tests/cli/resumable.bash"
}

# METHOD SEED: a run killed up to three times, also while it writes
torn() {
  whole $1
  RANDOM=$2
  rm -f rent*
  resumable_tear $1 rent 3
  resumable_same whole-$1 rent
  # What converged needs no checkpoint any more; what its end time ended can be given a later one.
  case $1 in stokes) ! compgen -G "rent.ckpt*" ;; *) [ -s rent.ckpt.hdf ] ;; esac
}
@test "wcsph: killed by SIGKILL, at random and while it writes, and resumed" { torn wcsph 1; }
@test "stokes: killed by SIGKILL, at random and while it writes, and resumed" { torn stokes 1; }
@test "isph: killed by SIGKILL, at random and while it writes, and resumed" { torn isph 1; }
# bats test_tags=long
@test "richards: killed by SIGKILL, at random and while it writes, and resumed" { torn richards 1; }

# bats test_tags=long
@test "each method: killed at other moments, and while it writes a snapshot, and resumed" {
  for method in wcsph stokes isph richards; do tried=0 aimed=1 torn $method 2; done
}

# METHOD...
no_row_lost() {
  for method in "$@"; do
    whole $method
    rm -f lost*
    (CHECKPOINT="1 min" resumable_start $method lost > /dev/null 2>&1) &
    until [ -s lost.history.csv ] && [ "$(wc -l < lost.history.csv)" -gt 3 ]; do sleep 0.02; done
    kill -9 $!
    wait $! 2> /dev/null || true
    [ ! -e lost.hdf ]
    [ ! -e lost.ckpt.hdf ]
    cp lost.history.csv seen.csv
    printf '0.5,7,1e-3,torn' >> lost.history.csv # what a crash of the machine leaves
    # Resumed with nothing to go on from, it starts anew, and does not forget what had been written.
    (CHECKPOINT="1 min" resumable_start $method lost --resume > /dev/null 2>&1) &
    sleep 0.15
    kill -9 $! 2> /dev/null || true
    wait $! 2> /dev/null || true
    [ -e lost.hdf ] || cmp -n "$(stat -c %s seen.csv)" seen.csv lost.history.csv
    /usr/bin/python3 - seen.csv whole-$method.hdf << 'END'
import csv, sys, h5py
rows = list(csv.reader(open(sys.argv[1])))
history = h5py.File(sys.argv[2])["history"]
names = rows[0][:-1]
assert len(rows) > 3 and len(names) == sum(1 if d.ndim == 1 else d.shape[1] for d in history.values())
for i, row in enumerate(rows[1:]):
    for name, value in zip(names, row):
        stored = history[name][i] if name in history else history[name[:-2]][i]["xyz".index(name[-1])]
        assert float(value) == stored or stored != stored, (name, i, value, stored)
END
  done
  (CHECKPOINT='1 min' resumable_start $method lost --resume > /dev/null)
  [ ! -e lost.history.csv ]
  resumable_same whole-$method lost
}
@test "a crash loses no row of the history" { no_row_lost isph; }

# bats test_tags=long
@test "a crash loses no row of the history, of wcsph" { no_row_lost wcsph; }

@test "SIGTERM writes a checkpoint and ends with exit code 130" {
  whole wcsph
  (resumable_start wcsph term > /dev/null 2>&1) &
  until [ -s term.history.csv ] && [ "$(wc -l < term.history.csv)" -gt 3 ]; do sleep 0.02; done
  kill -TERM $!
  code=0
  wait $! || code=$?
  [ $code -eq 130 ]
  [ -s term.ckpt.hdf ]
  (resumable_start wcsph term --resume > /dev/null)
  resumable_same whole-wcsph term
}

# bats test_tags=long
@test "stokes: after SIGTERM k is the estimate from the lattices that were solved, with its error; --resume goes on" {
  sample_model 64x64x28 full.hdf
  term() { sphsolve run s06.cfg --set model.file=full.hdf --set scene.method=stokes --set stokes.tolerance=1e-7 --error 0.001% "$@"; }
  (term -o stopped > stopped.txt 2> stopped.log) &
  until [ "$(grep -c '^lattice' stopped.log)" -ge 4 ] || [ -s stopped.hdf ]; do sleep 0.02; done
  rows=$(wc -l < stopped.history.csv) # of the next lattice one more, and one after its first round
  until [ "$(wc -l < stopped.history.csv)" -ge $((rows + 2)) ] || [ -s stopped.hdf ]; do sleep 0.02; done
  pkill -TERM -P $!
  wait $! && false || [ $? -eq 130 ]
  /usr/bin/python3 - << 'END'
import re, h5py
run = h5py.File("stopped.hdf")["run"]
line = [l for l in open("stopped.log") if l.startswith("lattice")][-1]
k, estimate = (float(x) / 100 for x in re.search(r"k (\S+), estimate (\S+) cm/s", line).groups())
assert run.attrs["status"] in ("interrupted", b"interrupted")
assert abs(run.attrs["k"] / estimate - 1) < 1e-3, (run.attrs["k"], line)
assert abs(run.attrs["k_finest"] / k - 1) < 1e-3, (run.attrs["k_finest"], line)
assert run["error"].attrs["steadiness"] < 1e-3, run["error"].attrs["steadiness"]
END
  # Asked for less than the lattices before it know, the one that was stopped is finished all the same.
  for f in stopped*; do cp "$f" "less${f#stopped}"; done
  sphsolve run s06.cfg --set model.file=full.hdf --set scene.method=stokes --set stokes.tolerance=1e-7 --error 90% -o less --resume > less.txt 2>&1
  estimate=$(sed -n 's/^lattice 5: .*, estimate \([0-9.]*\) cm.*/\1/p' less.txt)
  [ -n "$estimate" ] && grep -q "^status     converged" less.txt && grep -q "^k          $estimate" less.txt && grep -q "from 5 lattices" less.txt || { cat less.txt; false; }
  term -o stopped --resume > /dev/null 2>&1
  term -o never > /dev/null 2>&1
  resumable_same never stopped
}

# METHOD...
damaged() {
  for method in "$@"; do
    whole $method
    rm -f bad*
    # Once more where it was killed between the names of its two checkpoints, or had ended.
    until [ -s bad.ckpt.1.hdf ] && [ -s bad.ckpt.hdf ]; do
      rm -f bad*
      (CHECKPOINT="10 ms" resumable_start $method bad > /dev/null 2>&1) &
      until [ -s bad.ckpt.1.hdf ] || [ -s bad.hdf ]; do sleep 0.02; done
      kill -9 $! 2> /dev/null || true
      wait $! 2> /dev/null || true
    done
    cp bad.ckpt.1.hdf whole.1
    size=$(stat -c %s bad.ckpt.hdf)
    for damage in flip cut; do
      if [ $damage = flip ]; then python3 -c 'import sys; f = open("bad.ckpt.hdf", "r+b"); f.seek(int(sys.argv[1])); b = f.read(1)[0] ^ 1; f.seek(-1, 1); f.write(bytes([b]))' $((size / 2))
      else truncate -s $((size - 7)) bad.ckpt.hdf; fi
      (CHECKPOINT="10 ms" VOICE=--verbose resumable_start $method bad --resume > /dev/null 2> err.log)
      grep -q "missing or damaged; resuming from bad.ckpt.1.hdf" err.log
      resumable_same whole-$method bad
      rm -f bad.hdf bad.ckpt*
      cp whole.1 bad.ckpt.1.hdf
      cp whole.1 bad.ckpt.hdf
    done
    truncate -s 1000 bad.ckpt.hdf bad.ckpt.1.hdf
    CHECKPOINT="10 ms" run --separate-stderr resumable_start $method bad --resume
    [ "$status" -eq 3 ]
    [[ "$stderr" == *"remove both to start anew"* ]]
  done
}
@test "a flipped or truncated checkpoint is known, and the older one used" { damaged isph; }

# bats test_tags=long
@test "a flipped or truncated checkpoint is known, and the older one used, of wcsph and stokes" { damaged wcsph stokes; }

@test "stokes: a checkpoint on other lattices than --error takes is told" {
  lattices() {
    sphsolve run s06.cfg --set model.file=32.hdf --set scene.method=stokes --set stokes.tolerance=1e-7 \
      --set checkpoint.interval="1 ms" -o lattices --quiet "$@"
  }
  (lattices) &
  until [ -s lattices.ckpt.hdf ] || [ -s lattices.hdf ]; do sleep 0.02; done
  pkill -9 -P $! || true
  wait $! 2> /dev/null || true
  run --separate-stderr lattices --resume --error 50%
  [ "$status" -eq 3 ]
  [[ "$stderr" == *"lattices.ckpt.hdf: is of a run on other lattices; go on with the --error"* ]]
}

@test "stokes: a run that an asked error ends leaves no checkpoint, whether it was reached or not" {
  sphsolve run s06.cfg --set model.file=32.hdf --set scene.method=stokes --error 0.001% --set checkpoint.interval="1 ms" \
    -o asked --json --quiet > asked.json
  grep -q '"status": "budget"' asked.json
  run ! compgen -G "asked.ckpt*"
  run -3 --separate-stderr sphsolve explain s06.cfg --set model.file=32.hdf --set scene.method=stokes --set lattice.spacing='"1 nm"'
  [[ "$stderr" == *": lattice.spacing: 1e-09 m makes too many points ("*"lattice.spacing = \"34.98 um\", that of the model's voxels, fits"* ]]
}

@test "a file of another's under a checkpoint's name is not written over" {
  echo mine > other.ckpt.1.hdf
  run --separate-stderr resumable_start stokes other
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"other.ckpt.1.hdf"*"--force"* ]]
  [ "$(cat other.ckpt.1.hdf)" = mine ]
}

# METHOD THREADS...
same_bits() {
  local method=$1
  whole $method
  for threads in "${@:2}"; do
    [ $threads != "${OMP_NUM_THREADS:-}" ] || continue # those of the whole run
    (resumable_start $method threads --threads $threads > /dev/null)
    resumable_same whole-$method threads
  done
}
@test "the same bits for other numbers of threads" {
  for method in wcsph isph; do same_bits $method 2; done
}

# bats test_tags=long
@test "the same bits for 1, 2 and 3 threads" {
  for method in wcsph isph richards; do same_bits $method 1 3; done
  same_bits richards 2
}

# METHOD...
full_disk() {
  for method in "$@"; do
    whole $method
    rm -f full*
    (
      ulimit -f 8 # blocks of 1 KB: no snapshot fits
      export TEST_TMPDIR=/nowhere # where the thread sanitizer keeps a file that it maps
      trap '' XFSZ
      code=0
      (resumable_start $method full > out.log 2> err.log) || code=$?
      [ $code -eq 1 ] || { echo "exit code $code"; cat err.log; exit 1; }
    )
    [ ! -e full.hdf ]
    [ -z "$(ls full*.part full*.new.hdf 2> /dev/null)" ]
    [ "$(wc -l < err.log)" -eq 1 ]
    grep -q "full\|large" err.log
    # With room again the run goes on from what it could keep.
    (resumable_start $method full --resume > /dev/null 2>&1)
    resumable_same whole-$method full
  done
}
@test "a full disk leaves no half file and ends with exit code 1; with room again the run is as ever" { full_disk isph; }

# bats test_tags=long
@test "a full disk: the same of wcsph and stokes" { full_disk wcsph stokes; }

@test "a finished run that left no checkpoint is not replaced by --resume" {
  cat > over.cfg <<'END'
scene = { name = "over"; method = "isph"; end_time = "20 ms"; };
domain = { size = ["20 cm", "10 cm"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "20 cm", "8 cm"]; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
END
  sphsolve run over.cfg -o over --quiet
  sum=$(sha256sum < over.hdf)
  run -2 --separate-stderr sphsolve run over.cfg -o over --set 'scene.end_time="40 ms"' --resume
  [[ "$stderr" == "sphsolve: over.hdf: this run is finished and left no checkpoint to go on from; leave out --resume"* ]]
  [ "$sum" = "$(sha256sum < over.hdf)" ]
  # One that left checkpoints goes on.
  sphsolve run over.cfg -o kept --quiet --set 'checkpoint.interval="1 ms"'
  sphsolve run over.cfg -o kept --set 'scene.end_time="40 ms"' --resume > said 2>&1
  run ! grep "starting anew" said
}

# bats test_tags=long
@test "a direction of the tensor that knows k well enough is taken, whatever was asked of it" {
  /usr/bin/python3 "$BATS_TEST_DIRNAME/tensor_models.py"
  cat > balls.cfg <<'END'
scene = { name = "pores"; method = "stokes"; };
model = { file = "mirrored.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };
END
  sphsolve run balls.cfg -o balls --tensor --error 0.01% --quiet
  /usr/bin/python3 -c 'import h5py; assert h5py.File("balls-x.hdf")["run"].attrs["status"] in ("budget", b"budget")'
  run --separate-stderr sphsolve run balls.cfg -o balls --tensor --error 20% --resume
  [[ "$stderr" == *"direction x: its record is there already"* ]]
  run --separate-stderr sphsolve run balls.cfg -o balls --tensor --error 0.01% --resume
  [[ "$stderr" != *"already"* ]]
}
