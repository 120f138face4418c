load sample
load page
# Called by setup_file of the tests of the programs: ROOT, the programs in PATH, a folder of the file's own.
programs_path() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH"
  cd "$BATS_FILE_TMPDIR"
}
# The same, with one thread.
programs_setup() {
  programs_path
  export OMP_NUM_THREADS=1
}
setup() { cd "$BATS_FILE_TMPDIR"; }

# A scene of flow through a model's pores.
scene() { # METHOD MODEL
  cat <<END
scene = { name = "pores"; method = "$1"; };
model = { file = "$2"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };
END
}
