# Small runs of the three methods with all that a scene can hold, for resume.bats and scripts/stress-resume. ROOT is the
# repository; the programs are on PATH.
. "$ROOT/tests/cli/sample.bash"
resumable_make() {
  for size in 16x16x7 32x32x14; do
    sample_model $size ${size%%x*}.hdf
  done
  cp "$ROOT/data-samples/scenes/s06.cfg" s06.cfg
  # water with a surface, two soils of which one moves, a well and a drain in the other; rain; a gate, a head that lets waves out and a flux, which change with time
  cat > all.cfg << 'END'
scene = { method = "isph"; end_time = "0.3 s"; };
domain = { size = ["0.6 m","0.3 m"]; spacing = "1 cm"; periodic = [false,false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0","0","0.6 m","0.15 m"]; }, { type = "water"; box = ["0","0.15 m","0.2 m","0.25 m"]; },
  { type = "porous"; box = ["0.25 m","0","0.35 m","0.2 m"]; porosity = 0.4; grain_size = "5 mm"; velocity = ["0.1 m/s","0"]; },
  { type = "porous"; box = ["0.45 m","0","0.5 m","0.2 m"]; porosity = 0.5; grain_size = "1 cm"; },
  { type = "wall"; box = ["0.203 m","0.02 m","0.217 m","0.3 m"]; times = ["0 s","0.1 s","0.3 s"]; velocity = ["0","0.3 m/s", "0","0.1 m/s", "0","0.3 m/s"]; },
  { type = "well"; box = ["0.46 m","0.06 m","0.49 m","0.1 m"]; times = ["0 s","0.3 s"]; rate = ["1e-3 m^2/s","2e-3 m^2/s"]; },
  { type = "drain"; name = "foot"; head = "5 cm"; box = ["0.46 m","0.01 m","0.49 m","0.05 m"]; },
  { type = "rain"; box = ["0.35 m","0.29 m","0.6 m","0.3 m"]; times = ["0 s","0.2 s","0.3 s"]; rate = ["2 cm/s","0","1 cm/s"]; },
  { type = "inflow"; box = ["0","0","1 cm","0.1 m"]; times = ["0 s","0.3 s"]; flux = ["0.3 m/s","0.1 m/s"]; },
  { type = "inflow"; box = ["0.59 m","0","0.6 m","0.3 m"]; times = ["0 s","0.1 s","0.2 s"]; head = ["0.12 m","0.095 m","0.13 m"]; radiates = true; } );
force = { gravity = ["0","-9.81 m/s^2"]; };
gauges = ( { name = "foot"; at = ["0.3 m","0"]; } );
planes = ( { name = "mid"; x = "0.4 m"; } );
output = { interval = "0.1 s"; };
END
  # two soils that are not full, of which one is in beds; rain that comes and goes, a ditch whose level falls
  cat > wet.cfg << 'END'
scene = { end_time = "4 h"; };
domain = { size = ["1 m","1 m"]; spacing = "2 cm"; periodic = [false,false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = (
  { type = "porous"; box = ["0","0","1 m","0.5 m"]; porosity = 0.4; permeability = ["2e-5 m/s","1e-5 m/s"]; head = "0.3 m";
    van_genuchten = { alpha = "2 1/m"; n = 1.5; theta_r = 0.05; }; },
  { type = "porous"; box = ["0","0.5 m","1 m","1 m"]; porosity = 0.35; permeability = "1e-4 m/s"; head = "0.3 m";
    van_genuchten = { alpha = "5 1/m"; n = 3.0; }; },
  { type = "rain"; name = "storm"; box = ["0","0.98 m","0.5 m","1 m"]; times = ["0 s","10 min","2 h"]; rate = ["0","2e-5 m/s","0"]; },
  { type = "water"; box = ["0.6 m","0.8 m","0.8 m","1 m"]; },
  { type = "inflow"; box = ["0.98 m","0","1 m","1 m"]; times = ["0 s","3 h"]; head = ["0.3 m","0.1 m"]; } );
force = { gravity = ["0","-9.80665 m/s^2"]; };
gauges = ( { name = "foot"; at = ["0.3 m","0.2 m"]; } );
planes = ( { name = "mid"; x = "0.41 m"; } );
output = { interval = "1 h"; history_interval = "1 min"; };
END
}

# METHOD NAME [options]: becomes the program, so that a signal to a subshell's $! meets it, or `under` of it. VOICE may be
# --verbose.
resumable_start() {
  local method=$1 name=$2
  shift 2
  case $method in
    wcsph) set -- s06.cfg --set model.file=16.hdf --set scene.steady_tolerance=0.0 --set scene.end_time='0.06 s' \
      --set output.interval='0.02 s' "$@" ;;
    stokes) set -- s06.cfg --set model.file=32.hdf --set scene.method=stokes --set stokes.tolerance=1e-7 --set lattice.spacing='25 um' "$@" ;;
    isph) set -- all.cfg "$@" ;;
    richards) set -- wet.cfg "$@" ;;
  esac
  exec "${under[@]}" sphsolve run "$@" --set checkpoint.interval="${CHECKPOINT:-0.1 s}" -o "$name" "${VOICE:---quiet}"
}

# METHOD NAME KILLS: started or resumed and killed by SIGKILL, KILLS times, and then resumed to its end. Every third kill is
# aimed at a write: in turn at a checkpoint, a snapshot, a row of the history and the record. Counts in fell_CHECKPOINT and
# so on what the kills, random ones too, fell into; those that came when the run had ended do not count.
resumable_tear() {
  local method=$1 name=$2 what skip delay fell
  local -a aims=(checkpoint snapshot history record)
  for ((kill = 0; kill < $3;)); do
    what=moment skip=0 delay=0.$(printf %03d $((RANDOM % 900 + 20)))
    if [ $((tried++ % 3)) -eq 0 ]; then
      what=${aims[$((aimed++ % 4))]} delay=0.00$(printf %02d $((RANDOM % 30)))
      case $what in checkpoint) skip=$((RANDOM % 3)) ;; history) skip=$((RANDOM % 20)) delay=0.0000 ;; esac
    fi
    fell=$(under=(/usr/bin/python3 "$ROOT/tests/cli/kill_at.py" "$name" $what $skip $delay)
      resumable_start "$method" "$name" --resume --threads 1) || return 1
    declare -g "fell_$fell=$((fell_$fell + 1))"
    [ "$fell" = over ] || kill=$((kill + 1))
  done
  (resumable_start "$method" "$name" --resume > /dev/null 2>&1)
  ! compgen -G "$name*.part" > /dev/null && ! compgen -G "$name*.new.hdf" > /dev/null
}

# WHOLE NAME: both hold the same bits.
resumable_same() {
  # Their checkpoints were asked for at other intervals, which the scene in the file says.
  /usr/bin/python3 "$ROOT/tests/cli/same_run.py" "$1.hdf" "$2.hdf" run/scene provenance/input_hashes || return 1
  local snapshot
  for snapshot in "$1"-0*.hdf; do cmp "$snapshot" "$2${snapshot#"$1"}" || return 1; done
}
