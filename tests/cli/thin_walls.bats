#!/usr/bin/env bats
# Walls thinner than the spacing: of domains, where they may have no site, and of models on coarser lattices.

bats_require_minimum_version 1.5.0
setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH" OMP_NUM_THREADS=1
}
setup() { cd "$BATS_FILE_TMPDIR"; }

# A channel 40 mm wide and across it a wall from $2 to $3 mm with a slit of 4 mm. A slit of width d passes
# q = pi d^2 dp / (32 mu) (Hasimoto 1958), the channel W^3 dp / (12 mu L): k = L / (W (32 / (pi d^2) + 12 L / W^3)).
slit() {
  cat > slit.cfg <<EOF
scene = { name = "slit"; method = "$1"; end_time = "0.3 s"; };
domain = { size = ["40 mm", "60 mm"]; spacing = "1 mm"; periodic = [false, true]; };
fluids = ( { density = "998.2 kg/m^3"; viscosity = "1 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "40 mm", "60 mm"]; },
  { type = "wall"; box = ["0", "$2 mm", "18 mm", "$3 mm"]; }, { type = "wall"; box = ["22 mm", "$2 mm", "40 mm", "$3 mm"]; } );
force = { body_acceleration = ["0", "0.01 m/s^2"]; };
EOF
  sphsolve run slit.cfg -o slit --force --quiet --json > slit.json
  /usr/bin/python3 - <<'EOF'
import json, math
run, wide, long, slit = json.load(open("slit.json")), 0.04, 0.06, 0.004
exact = long / (wide * (32 / (math.pi * slit ** 2) + 12 * long / wide ** 3))
unit = run["intrinsic_permeability"] / run["k"]
assert run["k_low"] * unit < exact < run["k_high"] * unit, run  # without the wall k is 60 times as large
assert 0.5 < run["intrinsic_permeability"] / exact < 2, run
EOF
}

@test "a wall of a domain thinner than the spacing holds water back, and the interval holds: between sites, on them, as thick as the spacing" {
  slit stokes 30.52 30.6
  slit stokes 30.4 30.5
  slit stokes 30.5 31.5
  slit wcsph 30.52 30.6
  slit wcsph 30.5 31.5
}

# A channel 40 mm wide and across it an oblique plate $1 mm thick along the channel, with a gap of 4 mm at its end. The
# reference is a staggered-grid Stokes solver on voxels of 1/4 and 1/8 mm, its limit at first order.
oblique() {
  cat > oblique.cfg <<EOF
scene = { name = "oblique"; method = "stokes"; };
domain = { size = ["40 mm", "60 mm"]; spacing = "1 mm"; periodic = [false, true]; };
fluids = ( { density = "998.2 kg/m^3"; viscosity = "1 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "40 mm", "60 mm"]; }, { type = "wall";
  corners = ["0", "10.2 mm", "36 mm", "35.4 mm", "36 mm", "$(awk "BEGIN{print 35.4 + $1}") mm", "0", "$(awk "BEGIN{print 10.2 + $1}") mm"]; } );
force = { body_acceleration = ["0", "0.01 m/s^2"]; };
EOF
  sphsolve run oblique.cfg -o oblique --force --quiet --json > oblique.json
  /usr/bin/python3 - "$2" <<'EOF'
import json, sys
run, exact = json.load(open("oblique.json")), float(sys.argv[1])
assert abs(run["k"] / exact - 1) < 0.12, (run["k"], exact)  # without the plate k is 70 times as large
EOF
}

@test "an oblique wall of any thickness holds water back, though few or none of its points are in it" {
  oblique 0.01 0.0129 # the limit of thin plates
  oblique 0.3 0.0129
  oblique 0.6 0.0129
  oblique 1.1 0.01197
  oblique 2.6 0.00978
}

# The plate as a body of triangles from wall to wall: nothing passes, however thin it is.
@test "a body of triangles thinner than the spacing holds water back" {
  for thick in 0.01 0.4 0.9 1.3; do
    /usr/bin/python3 - $thick <<'EOF'
import sys
thick = float(sys.argv[1])
def corner(i, j, k):
    return "vertex %g %g %g" % (20 * i, 20 * j, 10.2 + 0.7 * 20 * i + k * thick)
faces = [(0, 2, 6, 4), (1, 5, 7, 3), (0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5)]
with open("plate.stl", "w") as file:
    file.write("solid plate\n")
    for a, b, c, d in faces:
        for triangle in ((a, b, c), (a, c, d)):
            file.write("facet normal 0 0 0 outer loop %s endloop endfacet\n" % " ".join(corner(v >> 2, v >> 1 & 1, v & 1) for v in triangle))
    file.write("endsolid plate\n")
EOF
    cat > plate.cfg <<'EOF'
scene = { name = "plate"; method = "stokes"; };
domain = { size = ["20 mm", "20 mm", "30 mm"]; spacing = "1 mm"; periodic = [false, false, true]; };
fluids = ( { density = "998.2 kg/m^3"; viscosity = "1 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0", "20 mm", "20 mm", "30 mm"]; }, { type = "wall"; stl = "plate.stl"; stl_unit = "1 mm"; } );
force = { body_acceleration = ["0", "0", "0.01 m/s^2"]; };
EOF
    sphsolve run plate.cfg -o plate --force --json > plate.json 2> plate.err
    [ "$(jq .k plate.json)" = 0 ]
  done
}

# Under a sheet pile from $1 to $2 m, the kg of water that pass in a day.
pile() {
  cat > pile.cfg <<EOF
scene = { name = "pile"; method = "richards"; end_time = "1 d"; };
domain = { size = ["10 m", "5 m"]; spacing = "20 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "porous"; box = ["0", "0", "10 m", "5 m"]; porosity = 0.4; permeability = "1e-4 m/s"; head = "6 m";
    van_genuchten = { alpha = "3.6 1/m"; n = 1.56; theta_r = 0.05; }; },
  { type = "wall"; box = ["$1 m", "1 m", "$2 m", "5 m"]; },
  { type = "inflow"; box = ["0", "0", "20 cm", "5 m"]; head = "7 m"; }, { type = "inflow"; box = ["9.8 m", "0", "10 m", "5 m"]; head = "6 m"; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
EOF
  sphsolve run pile.cfg -o pile --force 2>&1 | sed -n 's/^budget .* kg + \([0-9.]*\) in - .*/\1/p'
}

@test "a sheet pile of any thickness holds seepage back" {
  # One row of sites thick, then between two rows, on a row of faces, as thick as the spacing.
  thick=$(pile 4.8 5)
  for thin in "4.99 5.01" "4.999 5.001" "4.9 5.1" "4.93 4.94"; do
    passed=$(pile $thin)
    awk -v a="$thick" -v b="$passed" 'BEGIN { exit !(b > a && b < 1.08 * a) }'
  done
}

# A membrane one voxel thick across a channel of 40 x 60 voxels, with a gap of 6, on sites three voxels apart.
membrane() {
  [ -e membrane.hdf ] && return
  /usr/bin/python3 - <<'EOF'
import numpy as np
a = np.zeros((60, 1, 44), np.uint8)
a[:, :, :2] = a[:, :, -2:] = a[33] = 1
a[33, :, 20:26] = 0
np.save("membrane.npy", a)
EOF
  ct2model build membrane.npy --segmented 0 --mirror none --voxel-size 2um --size 44x1x60 -o membrane.hdf --quiet
}
flow() {
  cat > flow.cfg <<EOF
scene = { name = "membrane"; method = "$1"; };
model = { file = "membrane.hdf"; };
fluids = ( { density = "998.2 kg/m^3"; viscosity = "1.002e-3 Pa s"; } );
force = { body_acceleration = ["0", "0", "9.80665 m/s^2"]; };
$2
EOF
}

@test "wcsph with each of its walls keeps a membrane that lies between its particles" {
  membrane
  flow stokes
  sphsolve run flow.cfg -o fine --force --quiet --json > fine.json
  flow wcsph 'lattice = { spacing = "6 um"; };'
  for wall in subvoxel adami frozen; do
    sphsolve run flow.cfg -o coarse --force --quiet --json -s "wcsph.wall=\"$wall\"" -s 'scene.end_time="40 us"' > coarse.json
    /usr/bin/python3 - <<'EOF'
import json
fine, coarse = (json.load(open(f"{n}.json"))["intrinsic_permeability"] for n in ("fine", "coarse"))
assert 0.3 * fine < coarse < 3 * fine, (fine, coarse)  # without the membrane 20 times
EOF
  done
}

@test "a solute does not spread through a membrane, thick as a site or thinner" {
  membrane
  cat > solute.cfg <<'EOF'
scene = { name = "solute"; };
flow = { file = "flow.hdf"; };
solute = { peclet = [0.1]; };
EOF
  for spacing in "2 um" "6 um"; do
    flow stokes "lattice = { spacing = \"$spacing\"; };"
    sphsolve run flow.cfg -o flow --force --quiet
    sphsolve run solute.cfg -o solute --force --quiet --json > solute.json
    # The constriction adds 2 W / pi ln(1 / sin(pi d / 2 W)) to the way (d = 12, W = 80, 120 um long): F = 1.7 to 1.8.
    /usr/bin/python3 - <<'EOF'
import json, math
found = json.load(open("solute.json"))
factor, error = found["formation_factor"], found["formation_factor_error"]
assert factor > 1.5, found  # 1.1 without the membrane
assert abs(factor / 1.75 - 1) < error + 0.03, found
EOF
  done
  run sphsolve run solute.cfg -o solute --force -s 'solute.way="walk"'
  [ "$status" -eq 3 ]
  [[ "$output" == *"walls thinner than its spacing, through which walkers would go"* ]]
}

@test "sides that the user states to be periodic cost k no error; as a default they do" {
  /usr/bin/python3 -c 'import numpy as np; a = np.zeros((60, 1, 44), np.uint8); a[10:30, 0, 24:] = a[28:50, 0, 8:20] = 1; np.save("step.npy", a)'
  for sides in "" "--sides periodic"; do
    ct2model build step.npy --segmented 0 --mirror none $sides --voxel-size 2um --size 44x1x60 -o membrane.hdf --quiet --force
    flow stokes
    sphsolve run flow.cfg -o flow --force --quiet --json > "flow$sides.json"
  done
  rm membrane.hdf
  /usr/bin/python3 - <<'EOF'
import json
default, stated = (json.load(open(f"flow{n}.json")) for n in ("", "--sides periodic"))
assert default["k"] == stated["k"] and default["error"]["sides"] > 0.01, default["error"]
assert stated["error"]["sides"] is None and stated["k_high"] < default["k_high"], stated["error"]
EOF
}

# Cylinders of radius R in a square array of width L, dilute: k = L^2 (ln(L/R) - 1.3105)/(4 pi) (Hasimoto 1959); of a
# square of 1 mm the radius is .59 mm, that of the circle which the outside of the square maps to.
@test "a wall of one point, which coarser lattices lose, holds the fluid back, and the interval of k holds" {
  for method in stokes wcsph; do
    cat > point.cfg <<EOF
scene = { name = "point"; method = "$method"; };
domain = { size = ["8 mm", "8 mm"]; spacing = "1 mm"; periodic = [true, true]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "8 mm", "8 mm"]; },
  { type = "wall"; box = ["4 mm", "4 mm", "5 mm", "5 mm"]; } );
force = { body_acceleration = ["1 mm/s^2", "0"]; };
EOF
    sphsolve run point.cfg -o point --force --quiet --json > point.json
    /usr/bin/python3 - <<'EOF'
import json, math
run = json.load(open("point.json"))
exact = 0.008 ** 2 * (math.log(8 / 0.59) - 1.3105) / (4 * math.pi)
unit = run["intrinsic_permeability"] / run["k"]
assert run["k_low"] * unit < exact < run["k_high"] * unit, run
EOF
  done
}

@test "a thin pile under a weir whose base is between two rows of sites lets nothing through" {
  for pile in '{ type = "wall"; box = ["0.199 m", "0", "0.202 m", "0.25 m"]; }' \
    '{ type = "wall"; corners = ["0.199 m", "0", "0.202 m", "0", "0.202 m", "0.203 m", "0.199 m", "0.203 m"]; }'; do
    cat > weir.cfg <<EOF
scene = { name = "weir"; method = "darcy"; };
domain = { size = ["0.4 m", "0.4 m"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "porous"; box = ["0", "0", "0.4 m", "0.4 m"]; porosity = 0.4; permeability = "1e-4 m/s"; },
  $pile, { type = "wall"; box = ["0.1 m", "0.203 m", "0.3 m", "0.4 m"]; },
  { type = "inflow"; box = ["0", "0", "1 cm", "0.4 m"]; head = "1 m"; },
  { type = "inflow"; box = ["0.39 m", "0", "0.4 m", "0.4 m"]; head = "0.5 m"; } );
force = { gravity = ["0", "-9.81 m/s^2"]; };
EOF
    sphsolve run weir.cfg -o weir --force --quiet
    /usr/bin/python3 - <<'EOF'
import h5py, numpy as np
with h5py.File("weir.hdf") as file:
    assert np.abs(file["history/darcy_velocity"][-1]).max() < 1e-14
EOF
  done
}

@test "darcy, richards: an inflow behind a wedge that covers all of its side is refused, one with a part open is not" {
  cd "$BATS_TEST_TMPDIR"
  cat > wedge.cfg <<'SCENE'
scene = { name = "wedge"; method = "darcy"; end_time = "1 s"; };
domain = { size = ["20 cm", "10 cm"]; spacing = "1 cm"; periodic = [false, false]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "porous"; box = ["0", "0", "20 cm", "10 cm"]; porosity = 0.4; permeability = "1e-3 m/s"; },
  { type = "inflow"; box = ["0", "0", "1 cm", "10 cm"]; head = "1 m"; },
  { type = "inflow"; box = ["19 cm", "0", "20 cm", "10 cm"]; head = "0.5 m"; },
  { type = "wall"; corners = ["0", "0", "4 cm", "0", "0", "10 cm"]; } );
SCENE
  run sphsolve run wedge.cfg -o wedge
  [ "$status" -ne 0 ]
  [[ "$output" == *"wedge.cfg:5: a wall or a later inflow covers the whole of this inflow"* ]]
  sed -e 's/method = "darcy"; //' -e 's/head = /pressure_head = /' wedge.cfg > dry.cfg
  sed -i 's|permeability = "1e-3 m/s";|& van_genuchten = { alpha = "3 1/m"; n = 3.0; }; pressure_head = "-1 m";|' dry.cfg
  run sphsolve run dry.cfg -o dry
  [ "$status" -ne 0 ]
  [[ "$output" == *"dry.cfg:5: a wall or a later inflow covers the whole of this inflow"* ]]
  sed 's/"0", "10 cm"\]; } );/"0", "9 cm"]; } );/' wedge.cfg > open.cfg
  sphsolve run open.cfg -o open
}
