#!/usr/bin/env bats
# Real CT data, where it is at hand (../shared/data beside the repository); skipped with a message elsewhere.

setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  export DATA=$ROOT/../shared/data
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH"
}
setup() {
  [ -d "$DATA" ] || skip "no real scans at ../shared/data"
  cd "$BATS_TEST_TMPDIR"
}

# bats test_tags=long
@test "fiberform, grey, 100^3: calibrated, percolates, k positive; blur, noise and resolution are measured, its blur is a share of the error of k" {
  ct2model build "$DATA/fiberform/100_fiberform.tif" --voxel-size 1.3um --void-ratio 5.67 --size 25x25x25 -o fiber.hdf --json > fiber.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=fiber.hdf -o run --json > run.json
  python3 - <<'END'
import json
model, run = json.load(open("fiber.json")), json.load(open("run.json"))
assert abs(model["void_ratio"] / 5.67 - 1) < 0.01 and all(model["percolates"].values())
# Carbon-fibre felts of porosity 0.85 and fibres of about 10 um: 1e-11 to 3e-10 m^2.
assert 1e-11 < run["intrinsic_permeability"] < 3e-10, run
scanner, error = model["scanner"], run["error"]
print(scanner, error)
assert 1.3e-6 < scanner["blur_m"] < 4e-6 and 8 < scanner["contrast_to_noise"] < 30
assert scanner["blur_m"] < scanner["resolution_m"] < 10e-6   # fibres are some 10 um thick
assert 0 < error["scan"] < 0.2
END
}

@test "berea, segmented, 400^3: porosity as published" {
  command -v unzip > /dev/null || python3 -c 'import zipfile' || skip "no unzip"
  python3 -c "import zipfile; zipfile.ZipFile('$DATA/berea/berea.zip').extractall('.')"
  tif=$(find . -name '*.tif*' | head -1)
  ct2model build "$tif" --voxel-size 5.345um --void-ratio 0.2445 --threshold 128 --crop 0,0,0,400,400,200 --size 50x50x25 \
    -o berea.hdf --json > berea.json
  python3 - <<'END'
import json
model = json.load(open("berea.json"))
n = model["void_ratio_original"] / (1 + model["void_ratio_original"])
assert abs(n - 0.196) < 0.01, n   # .19645 in all 400 layers
END
}

@test "versa: Otsu fails on one slice, the void-ratio match does not" {
  for slice in 0000 0200 0400; do
    ct2model sweep "$DATA/versa/Sandstone_Versa$slice.tif" --voxel-size 2.231um --crop 287,248,0,450,500,1 --void-ratio 0.2 \
      -o "$slice.csv" --json > "$slice.json" 2> log
  done
  python3 - <<'END'
import json
slices = [json.load(open(f"{s}.json")) for s in ("0000", "0200", "0400")]
matched = [s["threshold"] for s in slices]
otsu = [s["threshold_otsu"] for s in slices]
assert max(matched) - min(matched) < 10 and all(70 < t < 110 for t in matched), matched
assert max(otsu) > 150, otsu
END
}

@test "35_1: an oolitic carbonate in a round field of view: the black around it must not count" {
  local slice=$DATA/slices/35_1.tiff
  # All of the picture: a quarter of it is black, and the warning says so.
  ct2model sweep "$slice" --voxel-size 10um --void-ratio 0.2 --json > whole.json 2> log
  grep -q "lies near a peak" log
  for e in 0.2 0.3; do
    ct2model sweep "$slice" --voxel-size 10um --void-ratio $e --crop auto --json > auto-$e.json 2> log-$e
    ct2model sweep "$slice" --voxel-size 10um --void-ratio $e --crop auto --roi cylinder:496,504,470 --json > round-$e.json 2>> log
    # Its ooids are full of pores finer than a pixel: greys between pore and cement, no valley. One threshold is not enough.
    grep -q "no valley between pore and grain" log-$e
  done
  sed -n 's/.*--crop auto: --crop //p' log-0.2 > box
  /usr/bin/python3 "$BATS_TEST_DIRNAME/round_view.py" "$slice"
}

# bats test_tags=long
@test "berea: how a solute spreads in a corner of it, against the Peclet number" {
  python3 -c "import zipfile; zipfile.ZipFile('$DATA/berea/berea.zip').extractall('.')"
  ct2model build berea.tif --segmented 0 --voxel-size 5.345um --crop 0,0,0,64,64,64 --mirror none -o berea.hdf --quiet
  cat > flow.cfg <<'END'
scene  = { name = "berea"; };
model  = { file = "berea.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force  = { body_acceleration = ["9.80665 m/s^2", "0", "0"]; };
END
  cat > solute.cfg <<'END'
scene  = { name = "berea, solute"; };
flow   = { file = "flow.hdf"; };
solute = { peclet = [0.1, 1.0, 10.0]; };
END
  sphsolve run flow.cfg -o flow --quiet
  sphsolve run solute.cfg -o solute --json > solute.json
  python3 - <<'END'
import json
found = json.load(open("solute.json"))
print(found)
rest = 1 / found["tortuosity"]
low, middle, high = found["longitudinal"]
# Sandstones of a porosity of 0.18: F of 15 to 45 (Archie 1942, F = porosity^-m with m of 1.6 to 2.2).
assert 15 < found["formation_factor"] < 45
assert rest < low < middle < high and low < 1.3 * rest and high > 10 * middle
# An error that is stated is no chance meeting of two lattices.
assert all(error > 0.005 for error in found["longitudinal_error"] + found["transverse_error"])
# Two grains wide: of another sample it may differ by half, and that is said.
assert all(0.2 < share < 2 for share in found["longitudinal_sample"])
END
}

# bats test_tags=long
@test "fiberform, mirrored: fibres that no coarse lattice has are in the error of a quick k" {
  ct2model build "$DATA/fiberform/100_fiberform.tif" --voxel-size 1.3um --threshold 100 --crop 50,0,0,50,50,50 \
    --sides mirrored -o half.hdf --quiet
  for error in 12% 5%; do
    sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=half.hdf --set scene.method=stokes -o quick \
      --error $error --json > "half-$error.json"
  done
  python3 - << 'EOF'
import json
quick, long = json.load(open("half-12%.json")), json.load(open("half-5%.json"))
assert quick["k_low"] < long["k"] < quick["k_high"], (quick["k_low"], long["k"], quick["k_high"])
EOF
}

@test "berea: where k goes up and down from lattice to lattice, four are not enough" {
  python3 -c "import zipfile; zipfile.ZipFile('$DATA/berea/berea.zip').extractall('.')"
  ct2model build berea.tif --segmented 0 --voxel-size 5.345um --crop 140,40,120,128,128,128 -o berea.hdf --quiet
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=berea.hdf --error 15% -o run --json > run.json
  python3 - <<'END'
import json
run = json.load(open("run.json"))
# On the model's own voxels .00225 cm/s, as another solver has it; from four lattices .00282 +- 14 %.
assert abs(run["k"] / 2.25e-5 - 1) < run["error"]["total"] < 0.2, run
END
}

# bats test_tags=long
@test "berea: steps of k that do not shrink are no convergence, nor is a round that by chance changes nothing" {
  python3 -c "import zipfile; zipfile.ZipFile('$DATA/berea/berea.zip').extractall('.')"
  ct2model build berea.tif --segmented 0 --voxel-size 5.345um --crop 32,132,112,112,112,112 -o slow.hdf --quiet
  ct2model build berea.tif --segmented 0 --voxel-size 5.345um --crop 150,20,240,112,112,112 -o chance.hdf --quiet
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=slow.hdf --error 15% -o slow-run --json > slow.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=chance.hdf --error 8% -o chance-run --json > chance.json
  python3 - <<'END'
import json
slow, chance = json.load(open("slow.json")), json.load(open("chance.json"))
# On the model's own voxels .00223 cm/s; from four lattices .00250, of a resolution's error of 7 %.
assert abs(slow["k"] / 2.23e-5 - 1) < slow["error"]["resolution"] < 0.1, slow
# The share was 250 % where the solve of the blurred body had ended after its first round.
assert 0.05 < chance["error"]["scan"] < 0.2, chance
END
}

# bats test_tags=long
@test "berea: a mirrored crop that coarse lattices shut, or let too much through, is looked at on finer ones" {
  python3 -c "import zipfile; zipfile.ZipFile('$DATA/berea/berea.zip').extractall('.')"
  ct2model build berea.tif --segmented 0 --voxel-size 5.345um --crop 23,241,57,100,100,100 -o tight.hdf --quiet
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=tight.hdf --error 20% -o tight-run --json > tight.json
  python3 - <<'END'
import json
run = json.load(open("tight.json"))
# Mirrored it has 7.68e-14 m^2 as another solver has it, of 4.44e-13 as it is: -83 %.
assert 0.75 < run["error"]["sides"] < 1, run["error"]
assert run["k_low"] * 1.0197e-7 < 7.68e-14, run["k_low"]
END
}
