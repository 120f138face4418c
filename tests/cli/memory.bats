#!/usr/bin/env bats
# Memory: what explain promises of wcsph, a run keeps, as its own count of every allocation says, from
# reading the model to the last snapshot; with subvoxel and frozen walls at most 100 bytes per fluid site and 16
# per grain site. A state to go back to, kept near a bound, lies on disk; the error of k is split afterwards, by method
# stokes and with its memory: the whole program keeps to the larger of the two.

bats_require_minimum_version 1.5.0

setup_file() {
  export SPH="${BUILD:-build}/bin/sphsolve"
  cd "$BATS_FILE_TMPDIR"
  # Spheres of two sizes at random in a periodic box: half pore, half grain, smooth distances.
  /usr/bin/python3 - <<'END'
import h5py
import numpy as np
rng = np.random.default_rng(4)
n, dx = 60, 4e-5
d = np.full((n, n, n), 1e9)
grid = np.stack(np.meshgrid(*[np.arange(n) + 0.5] * 3, indexing="ij"))
for i in range(150):
    r = 5.5 if i % 2 else 8.0
    away = np.abs(grid - rng.uniform(0, n, 3).reshape(3, 1, 1, 1))
    d = np.minimum(d, np.sqrt((np.minimum(away, n - away) ** 2).sum(0)) - r)
with h5py.File("spheres.hdf", "w") as f:
    f["model/solid"] = (d < 0).astype("u1")
    f["model/wall_distance"] = (d * dx).astype("f4")
    f["model/grain_fraction"] = np.clip(0.5 - d, 0, 1).astype("f4")
    f["model"].attrs["spacing"] = [dx, dx, dx]
END
  cat > scene.cfg <<'END'
scene = { name = "memory"; method = "wcsph"; end_time = "1 s"; steady_tolerance = 0.0; };
model = { file = "spheres.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "-100 m/s^2"]; };
END
}
setup() { cd "$BATS_FILE_TMPDIR"; }

# Runs 60 steps with three snapshots and holds plan.json against the counts of the run.
march() { # wall, further checks (python), further settings...
  local wall=$1 checks=$2
  shift 2
  "$SPH" explain scene.cfg --json --set wcsph.wall="$wall" "$@" > plan.json
  end=$(/usr/bin/python3 -c "import json; print(json.load(open('plan.json'))['dt'] * 60)")
  "$SPH" run scene.cfg --set wcsph.wall="$wall" --set scene.end_time="$end s" \
    --set output.interval="$(awk "BEGIN { print $end / 3 }") s" --threads 2 --quiet -o out "$@"
  /usr/bin/python3 - <<END
import h5py
import json
plan = json.load(open("plan.json"))
fluid, wall = plan["fluid_sites"], plan["wall_sites"]
measured = h5py.File("out.hdf")["run/timing"].attrs
peak, whole, total = float(measured["method_peak_bytes"]), float(measured["memory_peak_bytes"]), plan["memory_bytes"]
said = fluid * plan["bytes_per_fluid_site"] + wall * plan["bytes_per_wall_site"]
method = plan["memory_method_bytes"]
print(f"{fluid} fluid, {wall} wall: peak {peak / 1e6:.2f} MB, said {said / 1e6:.2f} MB; "
      f"whole {whole / 1e6:.2f} of {total / 1e6:.2f} MB; "
      f"{plan['bytes_per_fluid_site']:.1f} and {plan['bytes_per_wall_site']:.1f} bytes a site; "
      f"{measured['list_rebuilds']:.0f} times lists")
assert 0.3 < fluid / (fluid + wall) < 0.7
assert said <= method <= total and plan["memory_error_split_bytes"] <= total
assert whole <= total
$checks
END
}

@test "the counted peak of a run is what explain said, within its bounds" {
  march '"subvoxel"' '
assert measured["list_rebuilds"] >= 3
assert plan["bytes_per_fluid_site"] <= 100 and plan["bytes_per_wall_site"] <= 16
assert peak <= 100 * fluid + 16 * wall
assert 0.9 * said <= peak <= method'
}

# bats test_tags=long
@test "frozen grains: the same, with densities of their own" {
  march '"frozen"' '
assert measured["list_rebuilds"] >= 3
assert plan["bytes_per_fluid_site"] <= 100 and plan["bytes_per_wall_site"] <= 16
assert peak <= 100 * fluid + 16 * wall
assert 0.9 * said <= peak <= method'
}

@test "what the machine counts, libraries and files with it, is what explain said at most" {
  [[ -z "$SANITIZE" ]] || skip "a sanitizer's shadows are not ours"
  "$SPH" explain scene.cfg --json --set scene.method=stokes > plan.json
  /usr/bin/python3 - "$SPH" <<'END'
import json, os, subprocess, sys
child = subprocess.Popen([sys.argv[1], "run", "scene.cfg", "--set", "scene.method=stokes", "--threads", "1", "--quiet", "-o", "counted"])
_, code, usage = os.wait4(child.pid, 0)
child.returncode = code
said, peak = json.load(open("plan.json"))["memory_bytes"], 1024 * usage.ru_maxrss
print(f"{peak / 1e6:.1f} of {said / 1e6:.1f} MB")
assert code == 0 and 0.9 * said < peak <= said
END
}

# (A calm flow: where nearly all particles run as fast as the fastest, lists grow beyond what is counted.)
# bats test_tags=long
@test "a state to go back to takes no memory: near its limit a step keeps one on disk" {
  local calm='force.body_acceleration=["0","0","-5 m/s^2"]' moving='effects.shifting="on"'
  dt=$("$SPH" explain scene.cfg --json --set "$calm" --set "$moving" |
    /usr/bin/python3 -c "import json, sys; print(0.95 * json.load(sys.stdin)['dt_limit'])")
  march '"subvoxel"' '
assert plan["disk_bytes"] >= 44 * fluid
assert peak <= 100 * fluid + 16 * wall
assert 0.9 * said <= peak <= method' --set wcsph.dt="$dt s" --set "$calm" --set "$moving"
}

# bats test_tags=long
@test "Eulerian particles: the same bounds" {
  march '"subvoxel"' '
assert measured["list_rebuilds"] <= 8 # only those that snapshots and rows gave back
assert plan["bytes_per_fluid_site"] <= 100 and plan["bytes_per_wall_site"] <= 16
assert peak <= 100 * fluid + 16 * wall
assert 0.9 * said <= peak <= method' --set 'force.body_acceleration=["0","0","-1 m/s^2"]'
}

@test "more memory than --max-memory allows is refused before a lattice is solved, with a spacing that fits; what fits runs" {
  local stokes='--set scene.method=stokes --set scene.steady_tolerance=1e-3 --quiet --threads 1'
  most=$("$SPH" explain scene.cfg --json $stokes | /usr/bin/python3 -c 'import json, sys; print(round(json.load(sys.stdin)["memory_bytes"] / 1e6))')
  run --separate-stderr "$SPH" run scene.cfg $stokes --max-memory $((most / 2))MB -o large
  echo "$stderr"
  [ "$status" -eq 1 ] && [[ "$stderr" == *"takes at least "*" MB of memory (explain: $most MB at most), and $((most / 2)) MB are allowed"* ]]
  [ ! -e large.history.csv ]
  spacing=$(sed -n "s/.*lattice.spacing='\([0-9.]* um\)' fits/\1/p" <<< "$stderr")
  "$SPH" run scene.cfg $stokes --max-memory $((most / 2))MB --set lattice.spacing="$spacing" -o coarser
  "$SPH" run scene.cfg $stokes --max-memory "${most}MB" -o whole
}
